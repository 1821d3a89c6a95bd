#include "bespoke/page/detail/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::ElementsAre;

const Vector3 red(1, 0, 0), blue(0, 0, 1);

std::vector<int> pixel(const Picture& picture, int column, int row) {
  const auto at = static_cast<std::size_t>(3 * (row * picture.width + column));
  return {picture.pixels[at], picture.pixels[at + 1], picture.pixels[at + 2]};
}

/// A unit square facing the eye at a height above the sheet.
PaintedMesh sheet(double z, const Vector3& colour) {
  const TriangleMesh grid = shapes::moved(shapes::square_grid(2), {Matrix3::Identity(), Vector3(0, 0, z)});
  return {grid.vertices, grid.faces, {colour}};
}

TEST(Draw, ShowsTheNearerOfTwoSheetsWhateverTheirOrder) {
  for (const bool is_red_first : {true, false}) {
    const std::vector<PaintedMesh> meshes = is_red_first ? std::vector{sheet(0, red), sheet(1, blue)}
                                                         : std::vector{sheet(1, blue), sheet(0, red)};
    EXPECT_THAT(pixel(draw(meshes, DrawnFrom::front, 40), 20, 20), ElementsAre(0, 0, 255));
  }
  EXPECT_THAT(pixel(draw({sheet(0, red), sheet(-1, blue)}, DrawnFrom::front, 40), 20, 20),
              ElementsAre(255, 0, 0));
}

TEST(Draw, FillsThePictureAndLeavesAMargin) {
  const Picture picture = draw({sheet(0, red)}, DrawnFrom::front, 100);
  EXPECT_THAT(pixel(picture, 0, 50), ElementsAre(255, 255, 255));
  EXPECT_THAT(pixel(picture, 6, 6), ElementsAre(255, 0, 0));
  EXPECT_THAT(pixel(picture, 93, 93), ElementsAre(255, 0, 0));
}

TEST(Draw, FromTheSideLooksAlongX) {
  // Two cubes, of which the blue one stands farther along x.
  const TriangleMesh cube = shapes::cube(1),
                     other = shapes::moved(cube, {Matrix3::Identity(), Vector3(3, 0, 0)});
  const std::vector<PaintedMesh> meshes{{cube.vertices, cube.faces, {red}},
                                        {other.vertices, other.faces, {blue}}};
  EXPECT_THAT(pixel(draw(meshes, DrawnFrom::side, 40), 20, 20), ElementsAre(0, 0, 255));
  const Picture front = draw(meshes, DrawnFrom::front, 40);
  EXPECT_THAT(pixel(front, 4, 20), ElementsAre(255, 0, 0));
  EXPECT_THAT(pixel(front, 35, 20), ElementsAre(0, 0, 255));
}

TEST(Draw, BlendsColoursOverATriangle) {
  const TriangleMesh triangle = shapes::triangle();
  const Picture picture = draw({{triangle.vertices, triangle.faces, {red, red, blue}}}, DrawnFrom::front, 60);
  const std::vector<int> low = pixel(picture, 10, 54), high = pixel(picture, 5, 12);
  EXPECT_GT(low[0], 200);
  EXPECT_GT(high[2], 150);
}

TEST(Draw, RefusesColoursOfAnotherMesh) {
  const TriangleMesh triangle = shapes::triangle();
  EXPECT_THROW(draw({{triangle.vertices, triangle.faces, {red, red}}}, DrawnFrom::front, 10), InvalidInput);
  EXPECT_THROW(draw({}, DrawnFrom::front, 10), InvalidInput);
}

TEST(Png, HoldsTheRowsWithTheirChecksum) {
  const Picture picture{2, 1, {255, 0, 0, 1, 2, 3}};
  const std::string file = png(picture);
  EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(file.substr(12, 4), "IHDR");
  EXPECT_EQ(file[19], 2);
  EXPECT_EQ(file[23], 1);
  const auto* header = reinterpret_cast<const Bytef*>(file.data() + 12);
  const auto check = static_cast<std::uint32_t>(crc32(0, header, 17));
  for (int byte = 0; byte < 4; ++byte)
    EXPECT_EQ(static_cast<unsigned char>(file[static_cast<std::size_t>(29 + byte)]),
              check >> (24 - 8 * byte) & 0xFF);
  ASSERT_EQ(file.substr(37, 4), "IDAT");
  const auto length = static_cast<uLong>(static_cast<unsigned char>(file[36]));
  std::string row(7, 'x');
  uLongf size = 7;
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(row.data()), &size,
                       reinterpret_cast<const Bytef*>(file.data() + 41), length),
            Z_OK);
  EXPECT_EQ(row, std::string("\0\xFF\0\0\1\2\3", 7));
  EXPECT_EQ(file.substr(file.size() - 8, 4), "IEND");
}

TEST(ColourOf, IsPaleInTheMiddleOfADivergingRangeAndGreyWhereNothingIsKnown) {
  EXPECT_GT(colour_of(0, -1, 1, true).minCoeff(), 0.85);
  EXPECT_GT(colour_of(-1, -1, 1, true).z(), colour_of(-1, -1, 1, true).x());
  EXPECT_LT(colour_of(1, -1, 1, true).z(), colour_of(1, -1, 1, true).x());
  EXPECT_EQ(colour_of(5, 0, 1, false), colour_of(1, 0, 1, false));
  EXPECT_EQ(colour_of(std::nan(""), 0, 1, false), Vector3::Constant(0.6));
}

}  // namespace
}  // namespace bespoke

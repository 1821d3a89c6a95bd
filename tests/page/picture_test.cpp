#include "bespoke/page/detail/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

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

TEST(Png, IsReadBackAsThePicture) {
  const Picture picture{2, 3, {255, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 255, 254, 253}};
  const std::string file = png(picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, file.data(), file.size()));
  EXPECT_EQ(image.width, 2u);
  EXPECT_EQ(image.height, 3u);
  EXPECT_EQ(image.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
  std::vector<std::uint8_t> pixels(picture.pixels.size());
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
  EXPECT_EQ(pixels, picture.pixels);
}

TEST(Png, HasTheSameBytesEveryTime) {
  const Picture picture = draw({sheet(0, red)}, DrawnFrom::front, 50);
  EXPECT_EQ(png(picture), png(picture));
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

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "bespoke/product/mesh_io.h"
#include "product/mesh_files.h"
#include "product/product_files.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

using MeshFormats = test::MeshFiles;
using test::bytes;
using test::ply;
using test::square_obj;

TEST_F(MeshFormats, KeepsPolygonsOrderAndTextureOfObj) {
  const Product product =
      read_product(file("a.obj", square_obj + "vt 0 0.75\nf 4/4 3/3 2/2 1/1\nf 1/2 2/1 3/1\n"));
  EXPECT_EQ(product.vertices, (Points{{0, 1, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 0}}));
  EXPECT_THAT(product.polygon_start, ElementsAre(0, 4, 7));
  EXPECT_THAT(product.corners, ElementsAre(3, 2, 1, 0, 0, 1, 2));
  EXPECT_EQ(product.texture, (Eigen::Matrix2Xd{{0, 0.5, 0.5, 0, 0.5, 0, 0}, {0.75, 0.25, 0, 0, 0, 0, 0}}));
  EXPECT_FALSE(product.has_normals);
}

TEST_F(MeshFormats, GivesFacesWithoutTextureZero) {
  const Product product = read_product(file("a.obj", square_obj + "f 1 2 3\nf 1/2 2/2 3/3\nf 1 3 4\n"));
  EXPECT_EQ(product.texture.cols(), 9);
  EXPECT_EQ(product.texture.leftCols(3), Eigen::Matrix2Xd::Zero(2, 3));
  EXPECT_EQ(product.texture.col(5), Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(product.texture.rightCols(3), Eigen::Matrix2Xd::Zero(2, 3));
}

TEST_F(MeshFormats, UnderstandsEveryFormOfObj) {
  const Product product = read_product(
      file("a.OBJ",
           "# comment\r\nmtllib /dev/stdin\r\no thing\r\n\tv  +0 0 0 # first\r\nv 1 0 0 0.5 0.5 0.5\r\n"
           "v 1e0 1. -0.0 1\r\ng part\r\nusemtl none\r\nvn 0 0 1\r\nf -3//-1 -2//1 \\\r\n-1//1\r\ns off\r\n"
           "f 1//1 2//1 4//1 # later vertex\r\nl 1 2\r\n\r\nv 0 1 0"));
  EXPECT_EQ(product.vertices.cols(), 4);
  EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 0, 1, 3));
  EXPECT_TRUE(product.has_normals);
  EXPECT_EQ(product.texture.cols(), 0);
}

TEST_F(MeshFormats, KeepsNonManifoldDuplicateAndUnreferencedVertices) {
  const Product product = read_product(file(
      "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 9 9 9\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 6\nf 1 2 3\n"));
  EXPECT_EQ(product.vertices.cols(), 6);
  EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 0, 1, 3, 0, 1, 5, 0, 1, 2));
}

TEST_F(MeshFormats, MayBeAPointSet) {
  EXPECT_EQ(read_product(file("a.obj", "v 1 2 3\n")).vertices, Points(Vector3(1, 2, 3)));
  EXPECT_EQ(read_product(file("a.off", "OFF\n1 0 0\n1 2 3\n")).vertices, Points(Vector3(1, 2, 3)));
  EXPECT_EQ(read_product(file("a.ply",
                              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                              "property float z\nend_header\n1 2 3\n"))
                .vertices,
            Points(Vector3(1, 2, 3)));
}

TEST_F(MeshFormats, NamesTheLineOfABadNumberInObj) {
  const std::string good = "# a\nv 0 0 0\nv 1 0 0\n";
  EXPECT_THAT(complaint("a.obj", good + "v 1 abc 0\n"),
              AllOf(HasSubstr("a.obj:4: y: 'abc' is not a finite number"), Not(HasSubstr("\n"))));
  EXPECT_THAT(complaint("a.obj", good + "v 1 nan 0\n"), HasSubstr("a.obj:4: y: 'nan' is not a finite"));
  EXPECT_THAT(complaint("a.obj", good + "v inf 1 0\n"), HasSubstr(":4: x"));
  EXPECT_THAT(complaint("a.obj", good + "v 1e39 1 0\n"),
              HasSubstr(":4: x is not finite in single precision"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 2\n"), HasSubstr(":4: missing z"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 2 0x10\n"), HasSubstr("'0x10' is not a finite number"));
  EXPECT_THAT(complaint("a.obj", good + "v 1,5 2 0\n"), HasSubstr("'1,5' is not a finite number"));
  EXPECT_THAT(complaint("a.obj", good + "vt nan 0\n"), HasSubstr(":4: texture coordinate"));
  EXPECT_THAT(complaint("a.obj", "v 1 \\\n2 \\\n3\nv x 0 0\n"), HasSubstr("a.obj:4: x"));
  EXPECT_THAT(complaint("a.obj", std::string("v 1 2 \x01\n")), HasSubstr(":1: missing z"));
}

TEST_F(MeshFormats, NamesTheLineOfABadFaceInObj) {
  const auto face = [&](const std::string& line) { return complaint("a.obj", square_obj + line + "\n"); };
  EXPECT_THAT(face("f 1 2 99"), HasSubstr("a.obj:8: a face names vertex 99 of 4"));
  EXPECT_THAT(face("f 1 2 0"), HasSubstr(":8: a face has the corner '0'"));
  EXPECT_THAT(face("f 1 2 -5"), HasSubstr(":8: a face names vertex -5 of 4"));
  EXPECT_THAT(face("f 1/1 2/2 3/4"), HasSubstr("a face names texture coordinate 4 of 3"));
  EXPECT_THAT(face("f 1//1 2//1 3//1"), HasSubstr("a face names normal 1 of 0"));
  EXPECT_THAT(face("f 1 2"), HasSubstr("a face of 2 corners"));
  EXPECT_THAT(face("f"), HasSubstr("a face of 0 corners"));
  // Degenerate, but no fault of the file's: models leave it out, products keep it.
  EXPECT_NO_THROW(read_triangle_mesh(file("a.obj", square_obj + "f 1 2 2 3\n")));
  EXPECT_THAT(face("f 1 2 x"), HasSubstr("a face has the corner 'x'"));
  EXPECT_THAT(face("f 1 2 3.0"), HasSubstr("a face has the corner '3.0'"));
  EXPECT_THAT(face("f 1/1 2/2 3"), HasSubstr("the corners of a face differ"));
  for (const char* corner : {"3///", "/3", "3/1/1/1", "//", "3/1/1/"})
    EXPECT_THAT(face(std::string("f 1 2 ") + corner), HasSubstr(":8: a face has the corner")) << corner;
  // Two references beyond the end so far: the later vertices cover the first one only.
  EXPECT_THAT(complaint("a.obj", "f 1 2 3\nf 1 2 4\nf 1 2 5\nv 0 0 0\nv 1 0 0\nv 1 1 0\n"),
              HasSubstr("a.obj:2: a face names vertex 4 of 3"));
}

TEST_F(MeshFormats, UnderstandsOffWithCommentsColoursAndNormals) {
  const Product product = read_product(
      file("a.off",
           "# made by hand\nCNOFF 3 1 0 # counts\n\n0 0 0 0 0 1 255 0 0\n# between\n1 0 0 0 0 1 0 255 0\n"
           "0 1e-20 0 0 0 1 0 0 255\n3 2 1 0 0.5 0.5 0.5\n"));
  EXPECT_EQ(product.vertices, (Points{{0, 1, 0}, {0, 0, 1e-20}, {0, 0, 0}}));
  EXPECT_THAT(product.corners, ElementsAre(2, 1, 0));
  EXPECT_TRUE(product.has_normals);
}

TEST_F(MeshFormats, NamesTheLineOfABadOff) {
  EXPECT_THAT(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
              HasSubstr("a.off:6: a face names vertex 3, outside 0 … 2"));
  EXPECT_THAT(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"),
              HasSubstr("a.off:6: missing corner"));
  EXPECT_THAT(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), HasSubstr("a.off:4: y"));
  EXPECT_THAT(complaint("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), HasSubstr("ends after 2 of 3 vertices"));
  EXPECT_THAT(complaint("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              HasSubstr("ends after 1 of 2 faces"));
  EXPECT_THAT(complaint("a.off", "OFF\n99999999999999999999 2 0\n"), HasSubstr("number of vertices"));
  EXPECT_THAT(complaint("a.off", "OFF\n3 2000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              HasSubstr("of 2000000000 faces"));
  EXPECT_THAT(complaint("a.off", "4OFF\n1 0 0\n0 0 0 0\n"), HasSubstr(":1: an OFF file begins with OFF"));
  EXPECT_THAT(complaint("a.off", "OFF BINARY\n1234"), HasSubstr("binary OFF is not read"));
}

TEST_F(MeshFormats, UnderstandsPlyOfEitherEndianness) {
  for (const bool big : {false, true}) {
    std::string body;
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      body += bytes(static_cast<float>(x), big) + bytes(y + 0.5, big) + bytes(2.0f, big) +
              bytes(std::uint8_t{200});
    body += bytes(std::uint16_t{4}, big) + bytes(3u, big) + bytes(2u, big) + bytes(1u, big) + bytes(0u, big) +
            bytes(std::uint8_t{1}) + bytes(7.0, big);
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    const std::string whole =
        ply(format, body, "property uchar red\n",
            "property list ushort uint vertex_index\nproperty list uchar double texcoord\n");
    const Product product = read_product(file("a.ply", whole));
    EXPECT_EQ(product.vertices, (Points{{0, 1, 1, 0}, {0.5, 0.5, 1.5, 1.5}, {2, 2, 2, 2}}));
    EXPECT_THAT(product.corners, ElementsAre(3, 2, 1, 0));
    // Every shorter file is refused, whereever it ends.
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_NE(complaint("short.ply", whole.substr(0, size)), "accepted") << size;
  }
}

TEST_F(MeshFormats, UnderstandsAsciiPlyWithTextureAndOtherElements) {
  const Product product =
      read_product(file("a.ply",
                        "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uchar float "
                        "view\r\nelement vertex 3\r\nproperty float quality\r\n"
                        "property float x\r\nproperty float y\r\nproperty float z\r\nproperty float "
                        "nx\r\nproperty float ny\r\nproperty float nz\r\n"
                        "property float s\r\nproperty float t\r\nelement face 1\r\nproperty uchar "
                        "flags\r\nproperty list uchar int vertex_indices\r\nelement edge 1\r\n"
                        "property int vertex1\r\nend_header\r\n2 9 9\r\nnan 0 0 0 0 0 1 0.25 0.5\r\n1 1 0 0 "
                        "0 0 1 0.5 0.75\r\n1 0 1 0 0 0 1 0 1\r\n1 3 0 1 2\r\n0"));
  EXPECT_EQ(product.vertices, (Points{{0, 1, 0}, {0, 0, 1}, {0, 0, 0}}));
  EXPECT_EQ(product.texture, (Eigen::Matrix2Xd{{0.25, 0.5, 0}, {0.5, 0.75, 1}}));
  EXPECT_TRUE(product.has_normals);
}

TEST_F(MeshFormats, NamesThePlaceOfABadPly) {
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  EXPECT_EQ(complaint("a.ply", ply("ascii", points + "4 0 1 2 3\n")), "accepted");
  EXPECT_THAT(complaint("a.ply", ply("ascii", points + "4 0 1 2 4\n")),
              HasSubstr("a.ply:16: a face names vertex 4, outside 0 … 3"));
  EXPECT_THAT(complaint("a.ply", ply("ascii", points + "4 0 1 2\n")), HasSubstr("a.ply:16: missing corner"));
  EXPECT_THAT(complaint("a.ply", ply("ascii", points + "4294967295 0 1 2\n")), HasSubstr("a.ply:16: "));
  EXPECT_THAT(complaint("a.ply", ply("ascii", "0 0 0\n1 inf 0\n")), HasSubstr("a.ply:13: y"));
  EXPECT_THAT(complaint("a.ply", ply("ascii", points)), HasSubstr("the file ends here"));
  EXPECT_THAT(complaint("a.ply", ply("runes", points)), HasSubstr("a.ply:2: unknown format 'runes'"));
  EXPECT_THAT(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
              HasSubstr("ends before end_header"));
  EXPECT_THAT(
      complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
      HasSubstr("vertices have no x, y and z"));
  EXPECT_THAT(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n"),
              HasSubstr("a.ply:4: unknown type 'quad'"));
  EXPECT_THAT(complaint("a.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                        "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
                        "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              HasSubstr("a.ply: its faces are triangle strips (element tristrips), which are not read"));
  std::string four, nan;
  for (int i = 0; i < 4; ++i) four += bytes(static_cast<float>(i)) + bytes(0.0) + bytes(0.0f);
  for (int i = 0; i < 4; ++i) nan += bytes(0.0f) + bytes(i == 2 ? std::nan("") : 0.0) + bytes(0.0f);
  const std::string triangle = '\x03' + bytes(0) + bytes(1) + bytes(2);
  EXPECT_THAT(complaint("a.ply", ply("binary_little_endian", nan + triangle)),
              HasSubstr("a.ply: vertex 2: y is not finite"));
  EXPECT_THAT(
      complaint("a.ply", ply("binary_little_endian", four + '\x03' + bytes(0) + bytes(1) + bytes(-1))),
      HasSubstr("a.ply: face 0 of 1: a face names vertex -1"));
  EXPECT_THAT(complaint("a.ply", ply("binary_little_endian", four + bytes(2000000000), "",
                                     "property list int int vertex_indices\n")),
              HasSubstr("the file ends here"));
}

std::string stl_facet(const Vector3& a, const Vector3& b, const Vector3& c) {
  std::string facet(12, '\0');
  for (const Vector3& corner : {a, b, c})
    for (const double value : corner) facet += bytes(static_cast<float>(value));
  return facet + std::string(2, '\0');
}

TEST_F(MeshFormats, JoinsTheCornersOfStl) {
  const std::string facets = stl_facet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}) +
                             stl_facet({1, 0, 0}, {1, 1, 0}, {0, 1, 0}) +
                             stl_facet({1, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const std::string binary = std::string("solid in name only").append(62, ' ') + bytes(3u) + facets;
  const std::string ascii =
      "solid a b c\n facet normal 0 0 1\n  OUTER LOOP\n   vertex 0 0 0\n\n   vertex 1 0 0\n   vertex 0 1 0\n "
      " endloop\n endfacet\n"
      "facet normal 0 0 nan\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
      "0\nendloop\nendfacet\nendsolid a b c\n";
  for (const auto& content : {binary, ascii}) {
    const Product product = read_product(file("a.stl", content));
    EXPECT_EQ(product.vertices, (Points{{0, 1, 0, 1}, {0, 0, 1, 1}, {0, 0, 0, 0}}));
    EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 1, 3, 2));
  }
  for (std::size_t size = 0; size < binary.size(); ++size)
    EXPECT_NE(complaint("short.stl", binary.substr(0, size)), "accepted") << size;
}

TEST_F(MeshFormats, NamesThePlaceOfABadStl) {
  EXPECT_THAT(complaint("a.stl", std::string(80, ' ') + bytes(1u) +
                                     stl_facet({0, std::nan(""), 0}, {1, 0, 0}, {0, 1, 0})),
              HasSubstr("facet 0 of 1 has a coordinate that is not finite"));
  EXPECT_THAT(complaint("a.stl", std::string(80, ' ') + bytes(0u)), HasSubstr("no facets"));
  EXPECT_THAT(
      complaint("a.stl", std::string(80, ' ') + bytes(3u) + stl_facet({0, 0, 0}, {1, 0, 0}, {0, 1, 0})),
      HasSubstr("of 3 facets has 234 bytes, this one has 134"));
  const std::string begin = "solid\nfacet normal 0 0 1\nouter loop\n";
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\nvertex 1 x 0\n"),
              HasSubstr("a.stl:5: y: 'x' is not a finite number"));
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\nvertex 1 0 0\nendloop\n"),
              HasSubstr("a.stl:6: 'endloop' where vertex must stand"));
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\n"),
              HasSubstr("the file ends before the facet's vertex"));
  EXPECT_THAT(complaint("a.stl", "solid\nendsolid\n"), HasSubstr("no facets"));
}

}  // namespace
}  // namespace bespoke

#include "bespoke/mesh/product_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_io.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class MeshFiles : public ::testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& content) const {
    test::write_text(directory_ / name, content);
    return directory_ / name;
  }
  static std::string complaint(const fs::path& path) {
    return test::error_message<FormatError>([&] { read_product(path); });
  }
  std::string complaint(const std::string& name, const std::string& content) const {
    return complaint(file(name, content));
  }

  test::ScratchDirectory directory_;
};

using ReadProduct = MeshFiles;
using WriteProduct = MeshFiles;
using ReadTriangleMesh = MeshFiles;

template <class Value>
std::string bytes(Value value, bool big_endian = false) {
  std::string result(sizeof value, '\0');
  std::memcpy(result.data(), &value, sizeof value);
  return big_endian ? std::string(result.rbegin(), result.rend()) : result;
}

const std::string square_obj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    "vt 0 0\nvt 0.5 0\nvt 0.5 0.25\n";

TEST_F(ReadProduct, KeepsPolygonsOrderAndTextureOfObj) {
  const Product product =
      read_product(file("a.obj", square_obj + "vt 0 0.75\nf 4/4 3/3 2/2 1/1\nf 1/2 2/1 3/1\n"));
  EXPECT_EQ(product.vertices, (Points{{0, 1, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 0}}));
  EXPECT_THAT(product.polygon_start, ElementsAre(0, 4, 7));
  EXPECT_THAT(product.corners, ElementsAre(3, 2, 1, 0, 0, 1, 2));
  EXPECT_EQ(product.texture, (Eigen::Matrix2Xd{{0, 0.5, 0.5, 0, 0.5, 0, 0}, {0.75, 0.25, 0, 0, 0, 0, 0}}));
  EXPECT_FALSE(product.has_normals);
}

TEST_F(ReadProduct, GivesFacesWithoutTextureZero) {
  const Product product = read_product(file("a.obj", square_obj + "f 1 2 3\nf 1/2 2/2 3/3\nf 1 3 4\n"));
  EXPECT_EQ(product.texture.cols(), 9);
  EXPECT_EQ(product.texture.leftCols(3), Eigen::Matrix2Xd::Zero(2, 3));
  EXPECT_EQ(product.texture.col(5), Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(product.texture.rightCols(3), Eigen::Matrix2Xd::Zero(2, 3));
}

TEST_F(ReadProduct, UnderstandsEveryFormOfObj) {
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

TEST_F(ReadProduct, KeepsNonManifoldDuplicateAndUnreferencedVertices) {
  const Product product = read_product(file(
      "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 9 9 9\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 6\nf 1 2 3\n"));
  EXPECT_EQ(product.vertices.cols(), 6);
  EXPECT_THAT(product.corners, ElementsAre(0, 1, 2, 0, 1, 3, 0, 1, 5, 0, 1, 2));
}

TEST_F(ReadProduct, MayBeAPointSet) {
  EXPECT_EQ(read_product(file("a.obj", "v 1 2 3\n")).vertices, Points(Vector3(1, 2, 3)));
  EXPECT_EQ(read_product(file("a.off", "OFF\n1 0 0\n1 2 3\n")).vertices, Points(Vector3(1, 2, 3)));
  EXPECT_EQ(read_product(file("a.ply",
                              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                              "property float z\nend_header\n1 2 3\n"))
                .vertices,
            Points(Vector3(1, 2, 3)));
}

TEST_F(ReadProduct, NamesTheLineOfABadNumberInObj) {
  const std::string good = "# a\nv 0 0 0\nv 1 0 0\n";
  EXPECT_THAT(complaint("a.obj", good + "v 1 abc 0\n"),
              AllOf(HasSubstr("a.obj:4: y: 'abc' is not a number"), Not(HasSubstr("\n"))));
  EXPECT_THAT(complaint("a.obj", good + "v 1 nan 0\n"), HasSubstr("a.obj:4: y: 'nan' is not finite"));
  EXPECT_THAT(complaint("a.obj", good + "v inf 1 0\n"), HasSubstr(":4: x"));
  EXPECT_THAT(complaint("a.obj", good + "v 1e39 1 0\n"), HasSubstr("not finite in single precision"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 2\n"), HasSubstr(":4: missing z"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 2 0x10\n"), HasSubstr("'0x10' is not a number"));
  EXPECT_THAT(complaint("a.obj", good + "v 1,5 2 0\n"), HasSubstr("'1,5' is not a number"));
  EXPECT_THAT(complaint("a.obj", good + "vt nan 0\n"), HasSubstr(":4: texture coordinate"));
  EXPECT_THAT(complaint("a.obj", "v 1 \\\n2 \\\n3\nv x 0 0\n"), HasSubstr("a.obj:4: x"));
  EXPECT_THAT(complaint("a.obj", std::string("v 1 2 \x01\n")), HasSubstr("'?' is not a number"));
}

TEST_F(ReadProduct, NamesTheLineOfABadFaceInObj) {
  const auto face = [&](const std::string& line) { return complaint("a.obj", square_obj + line + "\n"); };
  EXPECT_THAT(face("f 1 2 99"), HasSubstr("a.obj:8: a face names vertex 99 of 4"));
  EXPECT_THAT(face("f 1 2 0"), HasSubstr(":8: a face names vertex 0 of 4"));
  EXPECT_THAT(face("f 1 2 -5"), HasSubstr(":8: a face names vertex -5 of 4"));
  EXPECT_THAT(face("f 1/1 2/2 3/4"), HasSubstr("a face names texture coordinate 4 of 3"));
  EXPECT_THAT(face("f 1//1 2//1 3//1"), HasSubstr("a face names normal 1 of 0"));
  EXPECT_THAT(face("f 1 2"), HasSubstr("a face of 2 corners"));
  EXPECT_THAT(face("f"), HasSubstr("a face of 0 corners"));
  EXPECT_THAT(face("f 1 2 2 3"), HasSubstr("a face names vertex 2 twice"));
  EXPECT_THAT(face("f 1 2 x"), HasSubstr("a face has the index 'x'"));
  EXPECT_THAT(face("f 1 2 3.0"), HasSubstr("a face has the index '3.0'"));
  EXPECT_THAT(face("f 1/1 2/2 3"), HasSubstr("the corners of a face differ"));
  for (const char* corner : {"3/", "3//", "/3", "3/1/", "3/1/1/1", "//"})
    EXPECT_THAT(face(std::string("f 1 2 ") + corner), HasSubstr(":8: a face has the corner")) << corner;
  // Two references beyond the end so far: the later vertices cover the first one only.
  EXPECT_THAT(complaint("a.obj", "f 1 2 3\nf 1 2 4\nf 1 2 5\nv 0 0 0\nv 1 0 0\nv 1 1 0\n"),
              HasSubstr("a.obj:2: a face names vertex 4 of 3"));
}

TEST_F(ReadProduct, NeedsAFileWithVertices) {
  EXPECT_THROW(read_product(directory_ / "absent.obj"), FileError);
  EXPECT_THROW(read_product(directory_ / "mesh.xyz"), InvalidInput);
  fs::create_directory(directory_ / "directory.obj");
  EXPECT_THROW(read_product(directory_ / "directory.obj"), FileError);
  EXPECT_THROW(read_product("/dev/null"), InvalidInput);
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.off"}) {
    EXPECT_THAT(complaint(name, ""), HasSubstr("the file is empty"));
    EXPECT_NE(complaint(name, "\n"), "accepted");
    EXPECT_NE(complaint(name, "# nothing\n"), "accepted");
    EXPECT_NE(complaint(name, std::string(1000, '\0')), "accepted");
    EXPECT_NE(complaint(name, std::string(1000, '\xff')), "accepted");
  }
  EXPECT_THAT(complaint("a.obj", "# nothing\n"), HasSubstr("the file has no vertices"));
}

TEST_F(ReadProduct, UnderstandsOffWithCommentsColoursAndNormals) {
  const Product product = read_product(
      file("a.off",
           "# made by hand\nCNOFF 3 1 0 # counts\n\n0 0 0 0 0 1 255 0 0\n# between\n1 0 0 0 0 1 0 255 0\n"
           "0 1e-20 0 0 0 1 0 0 255\n3 2 1 0 0.5 0.5 0.5\n"));
  EXPECT_EQ(product.vertices, (Points{{0, 1, 0}, {0, 0, 1e-20f}, {0, 0, 0}}));
  EXPECT_THAT(product.corners, ElementsAre(2, 1, 0));
  EXPECT_TRUE(product.has_normals);
}

TEST_F(ReadProduct, NamesTheLineOfABadOff) {
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

std::string ply(const std::string& format, const std::string& body, const std::string& vertex_properties = "",
                const std::string& list = "property list uchar int vertex_indices\n") {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nobj_info element none\nelement vertex 4\nproperty float x\nproperty double "
         "y\nproperty float z\n" +
         vertex_properties + "element face 1\n" + list + "end_header\n" + body;
}

TEST_F(ReadProduct, UnderstandsPlyOfEitherEndianness) {
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

TEST_F(ReadProduct, UnderstandsAsciiPlyWithTextureAndOtherElements) {
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

TEST_F(ReadProduct, NamesThePlaceOfABadPly) {
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
      HasSubstr("vertices have no y"));
  EXPECT_THAT(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n"),
              HasSubstr("a.ply:4: unknown type 'quad'"));
  const std::string nan = bytes(0.0f) + bytes(std::nan("")) + bytes(0.0f);
  EXPECT_THAT(complaint("a.ply", ply("binary_little_endian", nan)),
              HasSubstr("a.ply: vertex 0 of 4: y is not finite"));
  std::string four;
  for (int i = 0; i < 4; ++i) four += bytes(static_cast<float>(i)) + bytes(0.0) + bytes(0.0f);
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

TEST_F(ReadProduct, JoinsTheCornersOfStl) {
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

TEST_F(ReadProduct, NamesThePlaceOfABadStl) {
  EXPECT_THAT(complaint("a.stl", std::string(80, ' ') + bytes(1u) +
                                     stl_facet({0, std::nan(""), 0}, {1, 0, 0}, {0, 1, 0})),
              HasSubstr("facet 0 has a coordinate that is not finite"));
  EXPECT_THAT(complaint("a.stl", std::string(80, ' ') + bytes(0u)), HasSubstr("no facets"));
  EXPECT_THAT(
      complaint("a.stl", std::string(80, ' ') + bytes(3u) + stl_facet({0, 0, 0}, {1, 0, 0}, {0, 1, 0})),
      HasSubstr("of 3 facets has 234 bytes, this one has 134"));
  const std::string begin = "solid\nfacet normal 0 0 1\nouter loop\n";
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\nvertex 1 x 0\n"),
              HasSubstr("a.stl:5: y: 'x' is not a number"));
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\nvertex 1 0 0\nendloop\n"),
              HasSubstr("a.stl:6: a loop of 2 vertices"));
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\n"), HasSubstr("the file ends inside of a loop"));
  EXPECT_THAT(complaint("a.stl", "solid\nendsolid\n"), HasSubstr("no facets"));
}

Product two_polygons() {
  Product product;
  product.vertices = Points{{0, 1.0 / 3, 1e-12, 0, 7}, {0, 1e7 + 0.1, 1, 1, 7}, {-3e-30, 0, 0, 1, 7}};
  product.polygon_start = {0, 4, 7};
  product.corners = {3, 2, 1, 0, 0, 1, 2};
  return product;
}

TEST_F(WriteProduct, IsReadBackAsTheSameFloats) {
  const Product product = two_polygons();
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    write_product(directory_ / name, product);
    const Product back = read_product(directory_ / name);
    EXPECT_EQ(back.vertices, product.vertices.cast<float>().cast<double>()) << name;
    EXPECT_EQ(back.polygon_start, product.polygon_start) << name;
    EXPECT_EQ(back.corners, product.corners) << name;
    EXPECT_FALSE(back.has_normals) << name;
  }
}

TEST_F(WriteProduct, OfWhatWasReadGivesTheSameBytes) {
  for (const char* name : {"a.obj", "a.ply", "a.off", "a.stl"}) {
    write_product(directory_ / name, two_polygons());
    const fs::path again = directory_ / (std::string("again") + name);
    write_product(again, read_product(directory_ / name));
    EXPECT_EQ(test::read_text(directory_ / name), test::read_text(again)) << name;
  }
}

TEST_F(WriteProduct, KeepsTextureOfEveryCorner) {
  Product product = two_polygons();
  product.texture = Eigen::Matrix2Xd{{0, 0.5, 0.5, 0, 0.1f, 1, 1}, {0.75, 0.25, 0, 0, 0.3f, 0, 0}};
  write_product(directory_ / "a.obj", product);
  EXPECT_EQ(read_product(directory_ / "a.obj").texture, product.texture);
}

TEST_F(WriteProduct, RecomputesNormals) {
  Product product;
  product.vertices = Points{{0, 1, 1, 0}, {0, 0, 1, 1}, {0, 0, 0, 0}};
  product.polygon_start = {0, 4};
  product.corners = {0, 1, 2, 3};
  product.has_normals = true;
  write_product(directory_ / "a.obj", product);
  EXPECT_THAT(test::read_text(directory_ / "a.obj"), HasSubstr("vn 0 0 1\n"));
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    write_product(directory_ / name, product);
    EXPECT_TRUE(read_product(directory_ / name).has_normals) << name;
  }
}

TEST_F(WriteProduct, DividesPolygonsForStl) {
  write_product(directory_ / "a.stl", two_polygons());
  EXPECT_THAT(read_product(directory_ / "a.stl").polygon_start, ElementsAre(0, 3, 6, 9));
}

TEST_F(WriteProduct, RefusesWhatAFileCannotHold) {
  Product product = two_polygons();
  EXPECT_THROW(write_product(directory_ / "a.xyz", product), InvalidInput);
  EXPECT_THROW(write_product(directory_ / "absent" / "a.obj", product), FileError);
  product.vertices(0, 0) = std::nan("");
  EXPECT_THROW(write_product(directory_ / "a.obj", product), InvalidInput);
  product.vertices(0, 0) = 1e39;
  EXPECT_THROW(write_product(directory_ / "a.obj", product), InvalidInput);
  product = two_polygons();
  product.corners.clear();
  product.polygon_start = {0};
  EXPECT_THROW(write_product(directory_ / "a.stl", product), InvalidInput);
  write_product(directory_ / "a.obj", product);
  EXPECT_EQ(read_product(directory_ / "a.obj").vertices.cols(), 5);
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_.path()), {}), 1);
}

TEST_F(ReadProduct, MayBeCalledFromSeveralThreads) {
  const fs::path ply_file = file("a.ply", ply("ascii", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"));
  const fs::path obj_file = file("a.obj", square_obj + "f 1 2 3\n");
  const auto read = [](const fs::path& path, Eigen::Index vertices) {
    for (int i = 0; i < 50; ++i) EXPECT_EQ(read_product(path).vertices.cols(), vertices);
  };
  std::thread other(read, ply_file, 4);
  read(obj_file, 4);
  other.join();
}

TEST_F(ReadTriangleMesh, TurnsPolygonsIntoFansInPlace) {
  const TriangleMesh mesh = read_triangle_mesh(
      file("a.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\nf 5 4 3\n"));
  EXPECT_EQ(mesh.faces, (Faces{{0, 0, 0, 4}, {1, 2, 3, 3}, {2, 3, 4, 2}}));
}

TEST_F(ReadTriangleMesh, RoundTripsThroughEveryFormat) {
  const TriangleMesh sphere = shapes::icosphere(2);
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    write_triangle_mesh(directory_ / name, sphere);
    const TriangleMesh back = read_triangle_mesh(directory_ / name);
    EXPECT_EQ(back.faces, sphere.faces) << name;
    EXPECT_LT((back.vertices - sphere.vertices).cwiseAbs().maxCoeff(), 6e-8) << name;
  }
  write_triangle_mesh(directory_ / "a.stl", sphere);
  EXPECT_EQ(read_triangle_mesh(directory_ / "a.stl").vertices.cols(), sphere.vertices.cols());
  EXPECT_TRUE(inspect_mesh(read_triangle_mesh(directory_ / "a.stl")).boundary_edges == 0);
}

TEST_F(ReadTriangleMesh, ReadsTheSharedCases) {
  const fs::path cases = fs::path(BESPOKE_SHARED_DIR) / "cases";
  if (!fs::is_directory(cases)) GTEST_SKIP() << "no shared cases here";
  for (const auto& entry : fs::directory_iterator(cases)) {
    const fs::path path = entry.path() / "reference_a.obj";
    if (!fs::exists(path)) continue;
    EXPECT_NO_THROW(require_valid(read_triangle_mesh(path), path.string()));
  }
}

}  // namespace
}  // namespace bespoke

#include "bespoke/product/product_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <thread>

#include "bespoke/error.h"
#include "bespoke/product/mesh_io.h"
#include "product/mesh_files.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using ReadProduct = test::MeshFiles;
using WriteProduct = test::MeshFiles;
using ReadTriangleMesh = test::MeshFiles;
using test::ply;
using test::random_points;
using test::square_obj;

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
    EXPECT_EQ(back.vertices.cast<float>(), product.vertices.cast<float>()) << name;
    EXPECT_EQ(back.polygon_start, product.polygon_start) << name;
    EXPECT_EQ(back.corners, product.corners) << name;
    EXPECT_FALSE(back.has_normals) << name;
  }
}

// A model of one unit, a million units from the origin: floats lie 0.06 apart there.
TEST_F(WriteProduct, TakesDoublesWhereFloatsAreTooCoarse) {
  TriangleMesh far = shapes::icosphere(2);
  far.vertices.colwise() += Vector3(1e6, -2e6, 0);
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    write_triangle_mesh(directory_ / name, far);
    EXPECT_EQ(read_triangle_mesh(directory_ / name).vertices, far.vertices) << name;
  }
}

TEST_F(WriteProduct, HoldsPolygonsOfAnyLength) {
  Product disk;
  disk.vertices = random_points(300, 1);
  disk.polygon_start = {0, 300};
  for (int i = 0; i < 300; ++i) disk.corners.push_back(i);
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    write_product(directory_ / name, disk);
    EXPECT_EQ(read_product(directory_ / name).corners, disk.corners) << name;
  }
}

TEST_F(ReadProduct, KeepsEveryDigit) {
  EXPECT_EQ(read_product(file("a.obj", "v 0.1 1e-300 123456789.123456789\n")).vertices,
            Points(Vector3(0.1, 1e-300, 123456789.123456789)));
}

// Larger than a block, so that blocks are read at the same time and counts are carried over.
TEST_F(ReadProduct, ReadsManyBlocksInTheirOrder) {
  Product many;
  many.vertices = random_points(200'000, 2);
  many.polygon_start = {0};
  for (int i = 0; i + 2 < 200'000; i += 2) {
    many.corners.insert(many.corners.end(), {i, i + 1, i + 2});
    many.polygon_start.push_back(static_cast<int>(many.corners.size()));
  }
  many.texture = random_points(static_cast<Eigen::Index>(many.corners.size()), 3).topRows<2>();
  for (const char* name : {"a.obj", "a.ply", "a.off"}) {
    write_product(directory_ / name, many);
    const Product back = read_product(directory_ / name);
    EXPECT_EQ(back.vertices.cast<float>(), many.vertices.cast<float>()) << name;
    EXPECT_EQ(back.corners, many.corners) << name;
    EXPECT_EQ(back.polygon_start, many.polygon_start) << name;
  }
  EXPECT_EQ(read_product(directory_ / "a.obj").texture.cast<float>(), many.texture.cast<float>());
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
  EXPECT_EQ(read_product(directory_ / "a.obj").texture.cast<float>(), product.texture.cast<float>());
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

#include "bespoke/cloud/target_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "bespoke/product/mesh_io.h"
#include "cloud/sampled_clouds.h"
#include "product/mesh_files.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

/// Of floats; normals only where there are some, and an empty list of faces, as some programs write it.
std::string ply_text(const OrientedPoints& cloud, const std::string& more_elements = "") {
  const bool with_normals = cloud.normals.cols() > 0;
  std::ostringstream text;
  text.precision(9);
  text << "ply\nformat ascii 1.0\nelement vertex " << cloud.points.cols()
       << "\nproperty float x\nproperty float y\nproperty float z\n"
       << (with_normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "") << more_elements
       << "end_header\n";
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    text << cloud.points.col(i).cast<float>().transpose();
    if (with_normals) text << ' ' << cloud.normals.col(i).cast<float>().transpose();
    text << '\n';
  }
  return text.str();
}

std::string binary_ply_text(const OrientedPoints& cloud) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(cloud.points.cols()) +
                     "\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
                     "property float x\nproperty float y\nproperty float z\nend_header\n";
  const auto add = [&](const Vector3& triple) {
    const Eigen::Vector3f floats = triple.cast<float>();
    text.append(reinterpret_cast<const char*>(floats.data()), sizeof floats);
  };
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    add(cloud.normals.col(i));
    text += '\7';
    add(cloud.points.col(i));
  }
  return text;
}

class TargetModels : public test::MeshFiles {
 protected:
  const OrientedPoints cloud_ = test::sphere_cloud(2000);
};

TEST_F(TargetModels, OfACloudAreItsSurfaceInEveryEncoding) {
  const TargetModel made = read_target(
      file("a.ply", ply_text(cloud_, "element face 0\nproperty list uchar int vertex_indices\n")));
  ASSERT_TRUE(made.cloud);
  EXPECT_EQ(made.cloud->points, 2000u);
  EXPECT_EQ(content_hash(made), content_hash(cloud_));
  EXPECT_THAT(to_string(inspect_mesh(made.mesh)), HasSubstr("closed"));
  const TargetModel binary = read_target(file("b.ply", binary_ply_text(cloud_)));
  EXPECT_EQ(content_hash(binary), content_hash(made));
  ASSERT_EQ(binary.mesh.vertices.cols(), made.mesh.vertices.cols());
  EXPECT_LT((binary.mesh.vertices - made.mesh.vertices).cwiseAbs().maxCoeff(), 1e-6)
      << "decimals are no floats";

  std::string off = ply_text(cloud_);
  off = "NOFF\n2000 0 0\n" + off.substr(off.find("end_header\n") + std::strlen("end_header\n"));
  EXPECT_EQ(content_hash(read_target(file("a.off", off))), content_hash(made));
}

TEST_F(TargetModels, OfAMeshAreTheMesh) {
  const TriangleMesh cube = shapes::cube();
  write_triangle_mesh(directory_ / "cube.ply", cube);
  const TargetModel read = read_target(directory_ / "cube.ply");
  EXPECT_FALSE(read.cloud);
  EXPECT_EQ(content_hash(read), content_hash(cube));
  const std::string normals =
      test::ply("ascii", "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
                "property float nx\nproperty float ny\nproperty float nz\n");
  EXPECT_EQ(read_target(file("n.ply", normals)).mesh.faces.cols(), 1)
      << "of a mesh normals are not asked for";
}

TEST_F(TargetModels, LeaveDegenerateFacesOut) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 3\nf 1 2 2 3\nf 1 3 4\n";
  const TargetModel target = read_target(file("a.obj", obj));
  const SourceModel source = read_source_model(file("a.obj", obj));
  for (const auto& [mesh, left_out] :
       {std::pair(target.mesh, target.left_out), {source.mesh, source.left_out}}) {
    EXPECT_EQ(mesh.vertices.cols(), 4);
    EXPECT_EQ(mesh.faces, (Faces(3, 3) << 0, 0, 0, 1, 1, 2, 2, 2, 3).finished())
        << "of a quadrangle its triangle";
    EXPECT_EQ(left_out.count, 2u);
    EXPECT_THAT(left_out_text(left_out), HasSubstr("2 degenerate faces, which were left out ("));
    EXPECT_THAT(left_out.first, HasSubstr("a.obj:6: a face names vertex 3 twice"));
  }
}

TEST_F(TargetModels, WithoutFacesAndNormalsSayWhatACloudNeeds) {
  const std::string text = ply_text({cloud_.points, Points(3, 0)});
  EXPECT_THAT(
      test::error_message<InvalidInput>([&] { read_target(file("a.ply", text)); }),
      HasSubstr("a.ply has no faces, and its points have no normals; a point cloud as target is a PLY "
                "file whose vertices have the properties nx, ny and nz"));
}

TEST_F(TargetModels, AreNoSourcesAsClouds) {
  EXPECT_THAT(test::error_message<InvalidInput>([&] { read_source(file("a.ply", ply_text(cloud_))); }),
              HasSubstr("a.ply: is a point cloud, which can be a target only"));
}

TEST_F(TargetModels, NameTheFileOfACloudThatIsNotValid) {
  OrientedPoints cloud = cloud_;
  cloud.normals.col(4).setZero();
  EXPECT_THAT(test::error_message<InvalidInput>([&] { read_target(file("a.ply", ply_text(cloud))); }),
              HasSubstr("a.ply: 1 of 2000 normals are zero"));
}

}  // namespace
}  // namespace bespoke

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/product/mesh_io.h"
#include "mannequin.h"
#include "samples.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

double volume(const TriangleMesh& mesh) {
  double six_volumes = 0;
  for (Eigen::Index i = 0; i < mesh.faces.cols(); ++i) {
    const Vector3 a = mesh.vertices.col(mesh.faces(0, i));
    const Vector3 b = mesh.vertices.col(mesh.faces(1, i));
    const Vector3 c = mesh.vertices.col(mesh.faces(2, i));
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6;
}

// Radians.
double min_angle(const TriangleMesh& mesh) {
  double least = 4;
  for (Eigen::Index i = 0; i < mesh.faces.cols(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const Vector3 at = mesh.vertices.col(mesh.faces(corner, i));
      const Vector3 to_b = mesh.vertices.col(mesh.faces((corner + 1) % 3, i)) - at;
      const Vector3 to_c = mesh.vertices.col(mesh.faces((corner + 2) % 3, i)) - at;
      least = std::min(least, std::atan2(to_b.cross(to_c).norm(), to_b.dot(to_c)));
    }
  }
  return least;
}

// Length of the longest closed line in which the plane y = height cuts the mesh.
double girth_at(const TriangleMesh& mesh, double height) {
  using Edge = std::pair<int, int>;
  std::map<Edge, Vector3> crossings;
  std::map<Edge, std::vector<Edge>> next;
  for (Eigen::Index i = 0; i < mesh.faces.cols(); ++i) {
    std::vector<Edge> crossed;
    for (int side = 0; side < 3; ++side) {
      const Edge edge = std::minmax(mesh.faces(side, i), mesh.faces((side + 1) % 3, i));
      const Vector3 a = mesh.vertices.col(edge.first);
      const Vector3 b = mesh.vertices.col(edge.second);
      if ((a.y() < height) == (b.y() < height)) continue;
      crossings[edge] = a + (height - a.y()) / (b.y() - a.y()) * (b - a);
      crossed.push_back(edge);
    }
    if (crossed.size() != 2) continue;
    next[crossed[0]].push_back(crossed[1]);
    next[crossed[1]].push_back(crossed[0]);
  }
  double longest = 0;
  std::set<Edge> seen;
  for (const auto& [start, point] : crossings) {
    double length = 0;
    Edge at = start;
    while (seen.insert(at).second) {
      const std::vector<Edge>& ways = next.at(at);
      const Edge to = seen.contains(ways[0]) && !seen.contains(ways[1]) ? ways[1] : ways[0];
      const Edge onward = seen.contains(to) ? start : to;
      length += (crossings.at(onward) - crossings.at(at)).norm();
      at = onward;
    }
    longest = std::max(longest, length);
  }
  return longest;
}

void expect_closed_and_outward(const TriangleMesh& mesh) {
  const MeshFindings found = inspect_mesh(mesh);
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.boundary_edges, 0u);
  EXPECT_EQ(found.non_manifold_edges, 0u);
  EXPECT_EQ(found.inconsistent_edges, 0u);
  EXPECT_EQ(found.degenerate_faces, 0u);
  EXPECT_EQ(found.unreferenced_vertices, 0u);
  EXPECT_EQ(found.duplicate_vertices, 0u);
  EXPECT_EQ(mesh.faces.cols(), 2 * mesh.vertices.cols() - 4) << "not of the topology of a sphere";
  EXPECT_GT(volume(mesh), 0);
  EXPECT_GT(min_angle(mesh), 0.05);
  EXPECT_TRUE(found.vertices >= 2000 && found.vertices <= 12500) << found.vertices << " nodes";
}

// Distance of the point from the surface, negative inside.
class SignedDistance {
 public:
  explicit SignedDistance(const TriangleMesh& mesh)
      : mesh_(mesh), tree_(mesh), normals_(vertex_normals(mesh)) {}

  double operator()(const Vector3& point) const {
    const SurfacePoint nearest = *tree_.closest(point);
    Vector3 normal = Vector3::Zero();
    for (int corner = 0; corner < 3; ++corner) {
      normal += nearest.barycentric[corner] * normals_.col(mesh_.faces(corner, nearest.face));
    }
    return std::copysign(std::sqrt(nearest.squared_distance), normal.dot(point - nearest.point));
  }

 private:
  const TriangleMesh& mesh_;
  ClosestPointTree tree_;
  Points normals_;
};

void expect_clear_of(const SignedDistance& source, const TriangleMesh& product) {
  const MeshFindings found = inspect_mesh(product);
  EXPECT_EQ(found.non_manifold_edges, 0u);
  EXPECT_EQ(found.inconsistent_edges, 0u);
  EXPECT_EQ(found.degenerate_faces, 0u);
  EXPECT_TRUE(found.vertices >= 500 && found.vertices <= 6500) << found.vertices << " nodes";
  double least = 1e9;
  for (Eigen::Index i = 0; i < product.faces.cols(); ++i) {
    Vector3 middle = Vector3::Zero();
    for (const int corner : product.faces.col(i)) {
      middle += product.vertices.col(corner) / 3;
      least = std::min(least, source(product.vertices.col(corner)));
    }
    least = std::min(least, source(middle));
  }
  EXPECT_GT(least, 0.05) << "cm between product and source";
}

void expect_anchors_on(const std::vector<AnchorPair>& anchors, const SignedDistance& source,
                       const SignedDistance& target) {
  EXPECT_GE(anchors.size(), 12u);
  EXPECT_LE(anchors.size(), 40u);
  std::set<std::string> names;
  for (const AnchorPair& pair : anchors) {
    EXPECT_TRUE(names.insert(pair.name).second) << pair.name;
    EXPECT_LT(std::abs(source(pair.a)), 1e-9) << pair.name;
    EXPECT_LT(std::abs(target(pair.b)), 1e-9) << pair.name;
  }
}

/// That the girths are met on the mesh at the stated height.
void expect_girths(const Sample& sample) {
  std::map<int, const TriangleMesh*> mesh_of_girth = {{88, &sample.source}};
  for (const SampleTarget& target : sample.targets) mesh_of_girth[std::stoi(target.name)] = &target.mesh;
  ASSERT_EQ(mesh_of_girth.size(), 5u);
  for (const auto& [girth, mesh] : mesh_of_girth) {
    SCOPED_TRACE(girth);
    EXPECT_NEAR(girth_at(*mesh, hip_height({})), girth, 0.3);
    const Box box = bounding_box(mesh->vertices);
    EXPECT_NEAR(box.min().y(), 0, 0.1);
    EXPECT_NEAR(box.max().y(), 165, 0.2);
  }
}

class Samples : public ::testing::TestWithParam<std::string> {};

// One test, since making a sample takes seconds.
TEST_P(Samples, ReferencesAreSoundProductsClearAnchorsOnBothSurfaces) {
  const Sample sample = make_sample(GetParam());
  EXPECT_EQ(sample.name, GetParam());
  expect_closed_and_outward(sample.source);
  const SignedDistance to_source(sample.source);
  EXPECT_FALSE(sample.products.empty());
  for (const SampleProduct& product : sample.products) {
    SCOPED_TRACE(product.name);
    expect_clear_of(to_source, product.mesh);
  }
  EXPECT_FALSE(sample.targets.empty());
  for (const SampleTarget& target : sample.targets) {
    SCOPED_TRACE("target " + target.name);
    expect_closed_and_outward(target.mesh);
    EXPECT_NE(target.mesh.vertices.cols(), sample.source.vertices.cols());
    expect_anchors_on(target.anchors, to_source, SignedDistance(target.mesh));
  }
  if (sample.name == "girths") expect_girths(sample);
}

INSTANTIATE_TEST_SUITE_P(All, Samples, ::testing::ValuesIn(sample_names()),
                         [](const auto& parameter) { return parameter.param; });

TEST(MakeSample, GivesTheSameBytesTwice) {
  const Sample first = make_sample("shoe");
  const Sample second = make_sample("shoe");
  EXPECT_EQ(content_hash(first.source), content_hash(second.source));
  EXPECT_EQ(content_hash(first.targets[0].mesh), content_hash(second.targets[0].mesh));
  for (std::size_t i = 0; i < first.products.size(); ++i) {
    EXPECT_EQ(content_hash(first.products[i].mesh), content_hash(second.products[i].mesh));
  }
  for (std::size_t i = 0; i < first.targets[0].anchors.size(); ++i) {
    EXPECT_EQ(first.targets[0].anchors[i].b, second.targets[0].anchors[i].b);
  }
}

TEST(WriteSample, WritesWhatReadsBack) {
  TriangleMesh triangle;
  triangle.vertices = Points::Identity(3, 3);
  triangle.faces = Eigen::Vector3i(0, 1, 2);
  const AnchorPair pair{"tip", Vector3(0.1, 1.0 / 3, 2), Vector3(-1e-7, 4, 5e6)};
  const Sample sample{
      "folder", triangle, {{"hat", triangle}}, {{"", triangle, {pair}}, {"94", triangle, {pair}}}};
  const test::ScratchDirectory directory;
  std::vector<std::string> names;
  for (const std::filesystem::path& path : write_sample(sample, directory.path())) {
    EXPECT_EQ(path.parent_path(), directory / "folder");
    names.push_back(path.filename().string());
    if (path.extension() == ".obj") {
      EXPECT_EQ(read_triangle_mesh(path).vertices, triangle.vertices);
      continue;
    }
    const Anchors anchors = read_anchors(path);
    EXPECT_EQ(anchors.unit, "cm");
    ASSERT_EQ(anchors.pairs.size(), 1u);
    EXPECT_EQ(anchors.pairs[0].name, pair.name);
    EXPECT_EQ(anchors.pairs[0].a, pair.a);
    EXPECT_EQ(anchors.pairs[0].b, pair.b);
  }
  EXPECT_THAT(names, ElementsAre("source.obj", "hat.obj", "target.obj", "anchors.json", "target_94.obj",
                                 "anchors_94.json"));
}

TEST(WriteSample, RefusesADirectoryThatIsAFile) {
  const test::ScratchDirectory directory;
  const std::filesystem::path file = directory / "not_a_directory";
  test::write_text(file, "text");
  EXPECT_THROW(write_sample({"folder", {}, {}, {}}, file), FileError);
}

TEST(MakeSample, ListsTheNamesForAnUnknownOne) {
  try {
    make_sample("hat");
    FAIL() << "no exception";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("hat"), HasSubstr("dress"), HasSubstr("shoe")));
  }
}

}  // namespace
}  // namespace bespoke

// The vectors of tests/vectors, which src/pages passes too (tests/pages/shared_vectors_test.ts).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/anchors/detail/enclosed_faces.h"
#include "bespoke/error.h"
#include "bespoke/rbf/global_rbf.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::error_message;
using testing::HasSubstr;
using testing::StartsWith;

json vectors_of(const std::string& name) {
  return json::parse(test::read_text(std::filesystem::path(BESPOKE_SOURCE_DIR) / "tests/vectors" / name));
}

Vector3 vector_of(const json& numbers) {
  return Vector3(numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>());
}

Points points_of(const json& list) {
  Points points(3, static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = vector_of(list.at(i));
  return points;
}

TriangleMesh mesh_of(const json& mesh) {
  TriangleMesh result{points_of(mesh.at("vertices")),
                      Faces(3, static_cast<Eigen::Index>(mesh.at("faces").size()))};
  for (Eigen::Index f = 0; f < result.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      result.faces(k, f) = mesh.at("faces").at(static_cast<std::size_t>(f)).at(static_cast<std::size_t>(k));
  return result;
}

/// Whose vertices and triangles files of `wrap` and `indices` name.
TriangleMesh tetrahedron_corner() {
  TriangleMesh mesh{Points(3, 4), Faces(3, 2)};
  mesh.vertices << 0, 1, 0, 0,  //
      0, 0, 1, 0,               //
      0, 0, 0, 1;
  mesh.faces << 0, 1,  //
      1, 2,            //
      2, 3;
  return mesh;
}

TEST(SharedVectors, OfAnchorFiles) {
  const test::ScratchDirectory directory;
  const TriangleMesh corner_mesh = tetrahedron_corner();
  for (const json& each : vectors_of("anchor_files.json")) {
    SCOPED_TRACE(each.at("name").get<std::string>());
    std::vector<std::filesystem::path> paths;
    for (const json& file : each.at("files")) {
      paths.push_back(directory / file.at(0).get<std::string>());
      test::write_text(paths.back(), file.at(1));
    }
    AnchorFileOptions options{&corner_mesh, &corner_mesh};
    if (each.value("models", "LPS") == "RAS") options.models = PatientSystem::ras;
    if (each.contains("fault")) {
      const std::string fault = error_message<FormatError>([&] { read_anchor_files(paths, options); });
      for (const json& words : each.at("fault")) EXPECT_THAT(fault, HasSubstr(words.get<std::string>()));
      continue;
    }
    const Anchors found = read_anchor_files(paths, options);
    ASSERT_EQ(found.pairs.size(), each.at("pairs").size());
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
      const json& pair = each.at("pairs").at(i);
      EXPECT_EQ(found.pairs[i].name, pair.at(0).get<std::string>());
      EXPECT_EQ(found.pairs[i].a, vector_of(pair.at(1)));
      EXPECT_EQ(found.pairs[i].b, vector_of(pair.at(2)));
    }
  }
}

TEST(SharedVectors, OfEnclosedFaces) {
  const json vectors = vectors_of("enclosed_faces.json");
  for (const json& each : vectors.at("cases")) {
    SCOPED_TRACE(each.at("name").get<std::string>());
    const TriangleMesh mesh = mesh_of(vectors.at("meshes").at(each.at("mesh").get<std::string>()));
    const Points border = points_of(each.at("border"));
    if (each.contains("trouble"))
      EXPECT_THAT(error_message<InvalidInput>([&] { enclosed_faces(mesh, border, "patch"); }),
                  StartsWith("patch: " + each.at("trouble").get<std::string>()));
    else
      EXPECT_EQ(enclosed_faces(mesh, border, "patch").inside, each.at("inside").get<std::vector<int>>());
  }
}

// Of lengths like those of the images; the system's condition costs some of the 16 digits.
TEST(SharedVectors, OfTheCoarseWarp) {
  constexpr double precision = 1e-10;
  for (const json& each : vectors_of("warp.json")) {
    SCOPED_TRACE(each.at("name").get<std::string>());
    Anchors anchors;
    for (std::size_t i = 0; i < each.at("a").size(); ++i) {
      AnchorPair pair{"", vector_of(each.at("a").at(i)), vector_of(each.at("b").at(i))};
      pair.sigma = each.at("sigmas").at(i);
      anchors.pairs.push_back(pair);
    }
    const GlobalRbf warp(source_points(anchors), target_points(anchors), spline_weights(anchors));
    const Points images = points_of(each.at("images"));
    EXPECT_LT((warp(points_of(each.at("points"))) - images).colwise().norm().maxCoeff(),
              precision * images.colwise().norm().maxCoeff());
  }
}

}  // namespace
}  // namespace bespoke

#include "bespoke/anchors/patch_faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

PatchSide faces(std::vector<int> numbers) { return {Points(3, 0), std::move(numbers)}; }

PatchSide rectangle(double left, double right) {
  return {Points{{left, right, right, left}, {0.1, 0.1, 0.9, 0.9}, {0, 0, 0, 0}}, {}};
}

std::string complaint(const TriangleMesh& mesh, const std::vector<AnchorPatch>& patches) {
  return test::error_message<InvalidInput>([&] { face_patches(mesh, patches, ModelSide::target); });
}

TEST(FacePatches, NumberTheFacesOfEachPatch) {
  const TriangleMesh cube = shapes::cube();
  const std::vector<AnchorPatch> patches{{"front", faces({0, 1}), faces({3, 2}), false},
                                         {"", faces({11, 11, 4}), faces({0}), false}};
  const FacePatches source = face_patches(cube, patches, ModelSide::source);
  EXPECT_THAT(source.of_face, ElementsAre(0, 0, -1, -1, 1, -1, -1, -1, -1, -1, -1, 1));
  EXPECT_THAT(source.sizes, ElementsAre(2, 2));
  EXPECT_FALSE(source.has_excluded());
  EXPECT_THAT(face_patches(cube, patches, ModelSide::target).of_face,
              ElementsAre(1, -1, 0, 0, -1, -1, -1, -1, -1, -1, -1, -1));
  EXPECT_TRUE(face_patches(cube, {}, ModelSide::source).is_empty());
}

TEST(FacePatches, OfWhatIsExcludedAreNoOther) {
  const std::vector<AnchorPatch> patches{{"side", faces({0, 1}), faces({0, 1}), false},
                                         {"stand", {}, faces({1, 2}), true}};
  const FacePatches target = face_patches(shapes::cube(), patches, ModelSide::target);
  EXPECT_THAT(target.of_face, ElementsAre(0, -2, -2, -1, -1, -1, -1, -1, -1, -1, -1, -1));
  EXPECT_THAT(target.sizes, ElementsAre(1, 2));
  EXPECT_TRUE(target.has_excluded());
  EXPECT_FALSE(face_patches(shapes::cube(), patches, ModelSide::source).has_excluded());
}

TEST(FacePatches, MayShareABorderLineButNoFace) {
  const TriangleMesh square = shapes::square_grid(20);
  const FacePatches found = face_patches(
      square, {{"left", {}, rectangle(0.12, 0.48), false}, {"right", {}, rectangle(0.48, 0.83), false}},
      ModelSide::target);
  for (Eigen::Index face = 0; face < square.faces.cols(); ++face) {
    const Vector3 middle = square.vertices(Eigen::all, square.faces.col(face)).rowwise().mean();
    if (middle.y() < 0.15 || middle.y() > 0.85) continue;
    const std::optional<int> expected = middle.x() > 0.17 && middle.x() < 0.43   ? std::optional(0)
                                        : middle.x() > 0.53 && middle.x() < 0.78 ? std::optional(1)
                                        : middle.x() < 0.07 || middle.x() > 0.88
                                            ? std::optional(FacePatches::none)
                                            : std::nullopt;
    if (expected) {
      EXPECT_EQ(found.of_face[static_cast<std::size_t>(face)], *expected);
    }
  }
  EXPECT_THAT(
      complaint(square,
                {{"left", {}, rectangle(0.12, 0.6), false}, {"right", {}, rectangle(0.4, 0.83), false}}),
      AllOf(HasSubstr("patch \"right\" on the target"), HasSubstr("patch \"left\" on the target too")));
}

TEST(FacePatches, RefuseWhatTheModelDoesNotHave) {
  const TriangleMesh cube = shapes::cube();
  EXPECT_THAT(complaint(cube, {{"stand", {}, faces({3, 12}), true}}),
              AllOf(HasSubstr("patch \"stand\" on the target"), HasSubstr("no face 12"),
                    HasSubstr("12 triangles, numbered from 0")));
  EXPECT_THAT(complaint(cube, {{"", {}, faces({-1}), true}}), HasSubstr("patch 0 on the target"));
  EXPECT_THAT(complaint(cube, {{"", {}, faces({0, 1, 2, 3, 4, 5}), true},
                               {"", {}, faces({6, 7, 8, 9, 10, 11}), true}}),
              HasSubstr("cover the whole target"));
}

TEST(VertexPatches, AreThoseOfAllFacesAtAVertex) {
  const TriangleMesh square = shapes::joined(shapes::square_grid(1), shapes::triangle());
  FacePatches patches;
  patches.of_face = {0, FacePatches::none, FacePatches::excluded};
  const auto found = vertex_patches(square, patches);
  ASSERT_EQ(found.size(), 7u);
  for (int vertex = 0; vertex < 7; ++vertex) {
    const bool in_first = (square.faces.col(0).array() == vertex).any();
    const bool in_second = (square.faces.col(1).array() == vertex).any();
    const std::optional<int> own = in_first && in_second ? std::nullopt
                                   : in_first            ? std::optional(0)
                                   : in_second           ? std::optional(FacePatches::none)
                                                         : std::optional(FacePatches::excluded);
    EXPECT_EQ(found[static_cast<std::size_t>(vertex)], own) << vertex;
  }
  EXPECT_TRUE(vertex_patches(square, {}).empty());
}

TEST(WithoutExcluded, KeepsVerticesAndTheOtherFaces) {
  const TriangleMesh cube = shapes::cube();
  const FacePatches patches = face_patches(
      cube, {{"stand", {}, faces({0, 5}), true}, {"top", faces({1}), faces({1}), false}}, ModelSide::target);
  const PatchedMesh kept = without_excluded(cube, patches);
  EXPECT_EQ(kept.mesh.vertices, cube.vertices);
  ASSERT_EQ(kept.mesh.faces.cols(), 10);
  EXPECT_EQ(kept.mesh.faces.col(0), cube.faces.col(1));
  EXPECT_EQ(kept.mesh.faces.col(4), cube.faces.col(6));
  EXPECT_THAT(kept.patches.of_face, ElementsAre(1, -1, -1, -1, -1, -1, -1, -1, -1, -1));
  EXPECT_EQ(without_excluded(cube, {}).mesh.faces, cube.faces);
}

}  // namespace
}  // namespace bespoke

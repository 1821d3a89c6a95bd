#include "bespoke/pattern/cut_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/topology/half_edge_mesh.h"
#include "pattern/tubes.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string refusal(const Garment& garment, const CutOptions& options = {}) {
  return test::error_message<InvalidInput>([&] { cut_pieces(garment, options); });
}

/// A torus: one handle, no boundary.
TriangleMesh torus(int n) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, n * n);
  mesh.faces.resize(3, 2 * n * n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / n;
      mesh.vertices.col(i * n + j) << (100 + 30 * std::cos(v)) * std::cos(u), 30 * std::sin(v),
          (100 + 30 * std::cos(v)) * std::sin(u);
      const int a = i * n + j, b = (i + 1) % n * n + j, c = (i + 1) % n * n + (j + 1) % n,
                d = i * n + (j + 1) % n;
      mesh.faces.col(2 * (i * n + j)) << a, c, b;
      mesh.faces.col(2 * (i * n + j) + 1) << a, d, c;
    }
  return mesh;
}

TEST(CutPieces, RefusesWhatIsNoDiskAndNamesItsLoops) {
  EXPECT_THAT(refusal(test::garment_of(test::tube(40, 5, 100, 200))),
              AllOf(HasSubstr("2 boundary loops (62.77 cm at vertex 1, 62.77 cm at vertex 161)"),
                    HasSubstr("--auto-cut")));
  EXPECT_THAT(refusal(test::garment_of(shapes::icosphere(2))), HasSubstr("it is closed; cut it open"));
  EXPECT_THAT(refusal(test::garment_of(torus(12))), HasSubstr("it is closed and 1 handle"));
  EXPECT_THAT(refusal(test::garment_of(shapes::triangle())), HasSubstr("one triangle"));
}

TEST(CutPieces, CutsToDisksAlongShortestLoops) {
  const CutPieces tube = cut_pieces(test::garment_of(test::tube(40, 5, 100, 200)), {.auto_cut = true});
  ASSERT_EQ(tube.pieces.size(), 1u);
  EXPECT_EQ(tube.pieces[0].mesh.vertices.cols(), 200 + 5);  // one straight way up
  for (const TriangleMesh& mesh : {shapes::icosphere(3), torus(16)}) {
    const CutPieces cut = cut_pieces(test::garment_of(mesh), {.auto_cut = true});
    ASSERT_EQ(cut.pieces.size(), 1u);
    EXPECT_EQ(cut.pieces[0].mesh.faces.cols(), mesh.faces.cols());
    EXPECT_THAT(cut.auto_cut, ElementsAre("piece"));
  }
}

TEST(CutPieces, GroupsEndPiecesAndNameThem) {
  Garment garment = test::garment_of(shapes::square_grid(4));
  garment.rule = PieceRule::groups;
  garment.group_names = {"front", "back"};
  for (std::size_t f = 0; f < garment.group_of_face.size(); ++f) garment.group_of_face[f] = f < 16 ? 0 : 1;
  const CutPieces cut = cut_pieces(garment);
  ASSERT_EQ(cut.pieces.size(), 2u);
  EXPECT_EQ(cut.pieces[0].name, "front");
  EXPECT_EQ(cut.pieces[1].name, "back");
  EXPECT_EQ(cut.pieces[0].faces.size() + cut.pieces[1].faces.size(), garment.group_of_face.size());
}

TEST(CutPieces, ChartsEndWhereTextureJumps) {
  Garment garment = test::garment_of(shapes::square_grid(2));
  garment.rule = PieceRule::charts;
  garment.texture.resize(2, garment.mesh.faces.size());
  for (Eigen::Index c = 0; c < garment.mesh.faces.size(); ++c) {
    const Vector3 x = garment.mesh.vertices.col(garment.mesh.faces.reshaped()[c]);
    const double middle = garment.mesh.vertices(0, garment.mesh.faces.col(c / 3)).mean();
    garment.texture.col(c) << 0.1 * x.x() + (middle > 0.5 ? 0.5 : 0), 0.1 * x.y();
  }
  const CutPieces cut = cut_pieces(garment);
  EXPECT_EQ(cut.pieces.size(), 2u);
  ASSERT_TRUE(cut.charts);
  EXPECT_NEAR(cut.charts->mm_per_unit, 10, 1e-9);
  EXPECT_NEAR(cut.charts->p95, 1, 1e-9);
}

TEST(CutPieces, SeamsCutAndName) {
  const TriangleMesh mesh = test::tube(40, 5, 100, 200);
  SeamFile seams;
  seams.cuts.resize(1);
  for (int r = 0; r < 4; ++r)
    for (const int s : {0, 20}) seams.cuts.front().edges.push_back({40 * r + s, 40 * (r + 1) + s});
  seams.names = {{"left", 5}, {"right", 30}};
  const CutPieces cut = cut_pieces(test::garment_of(mesh), {.seams = seams});
  ASSERT_EQ(cut.pieces.size(), 2u);
  EXPECT_EQ(cut.pieces[0].name, "left");
  EXPECT_EQ(cut.pieces[1].name, "right");
}

TEST(PiecesAt, AreTheSamePiecesElsewhere) {
  const Garment garment = test::garment_of(test::tube(40, 5, 100, 200));
  const CutPieces cut = cut_pieces(garment, {.auto_cut = true});
  const std::vector<Piece> moved = pieces_at(cut.pieces, 2 * garment.mesh.vertices);
  EXPECT_EQ(moved[0].mesh.vertices, 2 * cut.pieces[0].mesh.vertices);
}

}  // namespace
}  // namespace bespoke

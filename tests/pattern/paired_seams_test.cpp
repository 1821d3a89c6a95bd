#include "bespoke/pattern/flattening/paired_seams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/pattern/cut_pieces.h"
#include "pattern/tubes.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

TEST(PairedSeams, OfACutTubeAreOneWithItself) {
  const CutPieces cut = cut_pieces(test::garment_of(test::tube(30, 6, 100, 250)), {.auto_cut = true});
  const std::vector<Seam> seams = paired_seams(cut.pieces);
  ASSERT_EQ(seams.size(), 1u);
  for (const SeamSide& side : seams[0].sides) {
    EXPECT_EQ(side.piece, 0);
    EXPECT_NEAR(side_length(side, cut.pieces[0].mesh.vertices), 250, 1e-9);
  }
  for (std::size_t k = 0; k < seams[0].sides[0].vertices.size(); ++k) {
    const auto product_vertex = [&](std::size_t side) {
      return cut.pieces[0].vertices[static_cast<std::size_t>(seams[0].sides[side].vertices[k])];
    };
    EXPECT_EQ(product_vertex(0), product_vertex(1));
  }
}

TEST(PairedSeams, OfTwoHalvesAreTwo) {
  Garment garment = test::garment_of(test::tube(30, 6, 100, 250));
  garment.rule = PieceRule::groups;
  garment.group_names = {"front", "back"};
  for (Eigen::Index f = 0; f < garment.mesh.faces.cols(); ++f)
    garment.group_of_face[static_cast<std::size_t>(f)] = f % 60 < 30 ? 0 : 1;
  const CutPieces cut = cut_pieces(garment);
  const std::vector<Seam> seams = paired_seams(cut.pieces);
  ASSERT_EQ(seams.size(), 2u);
  for (const Seam& seam : seams) EXPECT_NE(seam.sides[0].piece, seam.sides[1].piece);
}

TEST(PairedSeams, RefuseThreeLayers) {
  TriangleMesh book;
  book.vertices.resize(3, 5);
  book.vertices << 0, 10, 0, 0, 0, 0, 0, 10, -10, 0, 0, 0, 0, 0, 10;
  book.faces.resize(3, 3);
  book.faces << 0, 1, 0, 1, 0, 1, 2, 3, 4;
  const CutPieces cut = cut_pieces(test::garment_of(book));
  EXPECT_THAT(test::error_message<InvalidInput>([&] { paired_seams(cut.pieces); }),
              HasSubstr("meet along the edge between vertices 1 and 2"));
}

}  // namespace
}  // namespace bespoke

#include "bespoke/pattern/garment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/exchange/glb_file.h"
#include "bespoke/pattern/cut_pieces.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string square_vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class Garments : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const {
    test::write_text(directory_ / "garment.obj", text);
    return directory_ / "garment.obj";
  }
  std::string refusal(const std::string& text,
                      const GarmentOptions& options = {PieceRule::automatic, "cm"}) const {
    return test::error_message<InvalidInput>([&] { read_garment(file(text), options); });
  }

  test::ScratchDirectory directory_;
};

TEST_F(Garments, AreInMillimetres) {
  const Garment garment = read_garment(file(square_vertices + "f 1 2 3 4\n"), {PieceRule::automatic, "cm"});
  EXPECT_EQ(garment.mesh.vertices.col(2), Vector3(10, 10, 0));
  EXPECT_EQ(garment.mesh.faces.cols(), 2);
  EXPECT_EQ(garment.rule, PieceRule::components);
}

TEST_F(Garments, TakeTheFirstRuleThatTheFileHas) {
  const std::string faces = "g front\no part\nf 1 2 3\ng back\nf 1 3 4\n";
  const Garment grouped = read_garment(file(square_vertices + faces), {PieceRule::automatic, "mm"});
  EXPECT_EQ(grouped.rule, PieceRule::groups);
  EXPECT_THAT(grouped.group_names, ElementsAre("front", "back"));
  EXPECT_THAT(grouped.group_of_face, ElementsAre(0, 1));
  const Garment charted = read_garment(file(square_vertices + "vt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n"),
                                       {PieceRule::automatic, "mm"});
  EXPECT_EQ(charted.rule, PieceRule::charts);
  EXPECT_EQ(charted.texture.col(2), Eigen::Vector2d(1, 1));
}

// glTF has one texture coordinate a vertex: its corners are apart along the edges of charts, and joined
// again.
TEST_F(Garments, OfGltfHaveCharts) {
  MorphingMesh mesh;
  mesh.product.vertices.resize(3, 4);
  mesh.product.vertices << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  mesh.product.polygon_start = {0, 3, 6};
  mesh.product.corners = {0, 1, 2, 0, 2, 3};
  mesh.product.texture.resize(2, 6);
  mesh.product.texture << 0, 0.25, 0.25, 0.5, 0.75, 0.5, 0, 0, 0.25, 0, 0.25, 0.25;
  mesh.targets = {mesh.product.vertices};
  write_glb(directory_ / "garment.glb", mesh, {});
  const Garment garment = read_garment(directory_ / "garment.glb", {});
  EXPECT_EQ(garment.rule, PieceRule::charts);
  EXPECT_EQ(garment.mesh.vertices.cols(), 4);
  EXPECT_LT((garment.texture - mesh.product.texture).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(cut_pieces(garment).pieces.size(), 2u);
}

TEST_F(Garments, AreRefusedWithWhatToDo) {
  EXPECT_THAT(refusal(square_vertices + "f 1 2 3\n", {}), HasSubstr("--unit cm"));
  EXPECT_THAT(refusal(square_vertices + "f 1 2 3\n", {PieceRule::automatic, "ell"}), HasSubstr("ell"));
  EXPECT_THAT(refusal(square_vertices), HasSubstr("no faces"));
  EXPECT_THAT(refusal(square_vertices + "f 1 2 3\n", {PieceRule::charts, "cm"}),
              HasSubstr("no texture coordinates"));
  EXPECT_THAT(refusal(square_vertices + "f 1 2 3\n", {PieceRule::materials, "cm"}),
              HasSubstr("it has no materials"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\n"),
              HasSubstr("face 2 has no area"));
}

}  // namespace
}  // namespace bespoke

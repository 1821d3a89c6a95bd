#include "bespoke/pattern/read_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/pattern/write_pattern.h"
#include "pattern/tubes.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

class ReadPatterns : public ::testing::Test {
 protected:
  std::string complaint(const std::string& text) const {
    test::write_text(directory_ / "pieces.json", text);
    return test::error_message<FormatError>([&] { read_pattern(directory_ / "pieces.json"); });
  }

  test::ScratchDirectory directory_;
};

TEST_F(ReadPatterns, AreWhatWasWritten) {
  PatternOptions options;
  options.cut.auto_cut = true;
  const FlatPattern pattern = flat_pattern(test::garment_of(test::tube(12, 4, 60, 400)), nullptr, options);
  const Sheet sheet = pattern_sheet(pattern);
  write_pattern(directory_ / "pieces.json", pattern, sheet, {});
  const WrittenPattern read = read_pattern(directory_ / "pieces.json");
  ASSERT_EQ(read.pieces.size(), 1u);
  const WrittenPiece& piece = read.pieces[0];
  EXPECT_EQ(piece.name, pattern.pieces[0].piece.name);
  EXPECT_EQ(piece.faces, pattern.pieces[0].piece.mesh.faces);
  EXPECT_EQ(piece.outline, pattern.pieces[0].piece.outline);
  EXPECT_EQ(piece.product_faces, pattern.pieces[0].piece.faces);
  EXPECT_EQ(piece.strain.size(), 72u);
  // On the sheet, where its sew line is drawn.
  const Eigen::AlignedBox2d& box = sheet.pieces[0].box;
  for (const int vertex : piece.outline)
    EXPECT_LT(box.exteriorDistance(Eigen::Vector2d(piece.places.col(vertex).head<2>())), 1e-9);
  EXPECT_NO_THROW(require_pattern_of(read, "tube.obj", 72));
  for (const Eigen::Index other : {71, 73})
    EXPECT_THAT(
        test::error_message<InvalidInput>([&] { require_pattern_of(read, "tube.obj", other); }),
        HasSubstr("pieces.json: its pieces are not the " + std::to_string(other) + " triangles of tube.obj"));
}

TEST_F(ReadPatterns, AreRefusedWithWhatIsWrong) {
  const auto of_piece = [](const std::string& rest) {
    return R"({"unit":"mm","pieces":[{"name":"front","vertices":[[0,0],[1,0],[0,1]],"on_sheet":[0,0],)" +
           rest + "}]}";
  };
  EXPECT_THAT(complaint("{"), HasSubstr("is no pattern"));
  EXPECT_THAT(complaint(R"({"seams":[]})"), HasSubstr("is no pattern"));
  EXPECT_THAT(complaint(R"({"unit":"cm","pieces":[]})"), HasSubstr("not mm"));
  EXPECT_THAT(complaint(R"({"unit":"mm","pieces":[]})"), HasSubstr("no pieces"));
  EXPECT_THAT(
      complaint(of_piece(R"("faces":[[0,1,3]],"outline":[0],"product_faces":[0],"strain_of_faces":[0])")),
      HasSubstr("piece 'front': face 0 names 3 of 3"));
  EXPECT_THAT(
      complaint(of_piece(R"("faces":[[0,1]],"outline":[],"product_faces":[0],"strain_of_faces":[0])")),
      HasSubstr("is no triangle"));
  EXPECT_THAT(
      complaint(of_piece(R"("faces":[[0,1,2]],"outline":[-1],"product_faces":[0],"strain_of_faces":[0])")),
      HasSubstr("its outline names -1"));
  EXPECT_THAT(
      complaint(of_piece(R"("faces":[[0,1,2]],"outline":[0],"product_faces":[],"strain_of_faces":[0])")),
      HasSubstr("1 faces, 0 \"product_faces\""));
  EXPECT_THAT(
      complaint(of_piece(R"("faces":[[0,1,1.7]],"outline":[0],"product_faces":[0],"strain_of_faces":[0])")),
      HasSubstr("face 0 names 1.7 of 3"));
  EXPECT_THAT(
      complaint(of_piece(R"("faces":[[0,1,2]],"outline":[0],"product_faces":[0.5],"strain_of_faces":[0])")),
      HasSubstr("\"product_faces\" names 0.5"));
  EXPECT_THAT(complaint("\xFF\xFE{"), HasSubstr("UTF-16"));
  EXPECT_THROW(read_pattern(directory_ / "none.json"), FileError);
}

}  // namespace
}  // namespace bespoke

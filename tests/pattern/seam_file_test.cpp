#include "bespoke/pattern/seam_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SeamFiles : public ::testing::Test {
 protected:
  SeamFile read(const std::string& text) const {
    test::write_text(directory_ / "seams.json", text);
    return read_seam_file(directory_ / "seams.json", grid_);
  }
  std::string complaint(const std::string& text) const {
    return test::error_message<FormatError>([&] { read(text); });
  }

  TriangleMesh grid_ = shapes::square_grid(4);  // 5 × 5 vertices
  test::ScratchDirectory directory_;
};

TEST_F(SeamFiles, HaveEdgesPathsAndNames) {
  const SeamFile file = read(
      R"({"seams":[{"edges":[[1,2]]},{"name":"side","path":[1,5]}],"pieces":[{"name":"front","vertex":7}]})");
  EXPECT_EQ(file.edges().size(), 1u + 4u);
  EXPECT_EQ(file.edges().front(), (std::array<int, 2>{0, 1}));
  ASSERT_EQ(file.names.size(), 1u);
  EXPECT_EQ(file.names[0].name, "front");
  EXPECT_EQ(file.names[0].vertex, 6);
}

TEST_F(SeamFiles, HaveLinesEaseAndWidths) {
  const SeamFile file = read(
      R"({"seams":[{"line":[1,[2,7,0.25],12],"ease":8,"longer":"sleeve"}],"widths":[{"name":"waist","vertex":3}]})");
  ASSERT_EQ(file.cuts.size(), 1u);
  ASSERT_EQ(file.cuts[0].line.size(), 3u);
  EXPECT_EQ(file.cuts[0].line[1].b, 6);
  EXPECT_EQ(file.cuts[0].line[1].share, 0.25);
  EXPECT_EQ(file.cuts[0].ease, 8);
  EXPECT_EQ(file.cuts[0].longer, "sleeve");
  ASSERT_EQ(file.widths.size(), 1u);
  EXPECT_EQ(file.widths[0].vertex, 2);
}

TEST_F(SeamFiles, AreRefusedWithWhatIsWrong) {
  EXPECT_THAT(complaint("{"), HasSubstr("seams.json"));
  EXPECT_THAT(complaint("[]"), HasSubstr("one object"));
  EXPECT_THAT(complaint("{}"), HasSubstr("\"seams\" must be a list"));
  EXPECT_THAT(complaint(R"({"seams":[{"path":[1,26]}]})"), HasSubstr("seam 1: vertex 26 is none of 1 … 25"));
  EXPECT_THAT(complaint(R"({"seams":[{"path":[1]}]})"), HasSubstr("two vertices or more"));
  EXPECT_THAT(complaint(R"({"seams":[{"path":[1,"a"]}]})"), HasSubstr("no number of a vertex"));
  EXPECT_THAT(complaint(R"({"seams":[{"edges":[[1,2,3]]}]})"), HasSubstr("pair of vertices"));
  EXPECT_THAT(complaint(R"({"seams":[{"way":[1,2]}]})"), HasSubstr("\"way\""));
  EXPECT_THAT(complaint(R"({"seams":[],"pieces":[{"vertex":2}]})"), HasSubstr("piece 1 needs"));
  EXPECT_THAT(complaint(R"({"seams":[{"line":[1,[1,2]]}]})"), HasSubstr("the share of the way"));
  EXPECT_THAT(complaint(R"({"seams":[{"line":[1,[1,2,1.5]]}]})"), HasSubstr("share 1.5 is not in 0 … 1"));
  EXPECT_THAT(complaint(R"({"seams":[{"path":[1,2],"line":[1,2]}]})"), HasSubstr("needs one of"));
  EXPECT_THAT(complaint(R"({"seams":[{"path":[1,2],"ease":3}]})"), HasSubstr("both, or neither"));
  EXPECT_THAT(complaint(R"({"seams":[],"widths":[{"vertex":2}]})"), HasSubstr("width 1 needs"));
  EXPECT_THROW(read_seam_file(directory_ / "none.json", grid_), FileError);
}

TEST_F(SeamFiles, AreTextsAsOtherProgramsWriteThem) {
  EXPECT_EQ(read("\xEF\xBB\xBF{\"seams\":[{\"edges\":[[1,2]]}]}").edges().size(), 1u);
  EXPECT_THAT(complaint("{"), HasSubstr("seams.json: not valid JSON: parse error"));
  EXPECT_THAT(complaint("{"), Not(HasSubstr("json.exception")));
  EXPECT_THROW(read_seam_file(directory_ / "none.json", grid_), FileError);
}

}  // namespace
}  // namespace bespoke

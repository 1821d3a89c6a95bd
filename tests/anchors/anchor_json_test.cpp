#include "bespoke/anchors/detail/anchor_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string border_ring = R"({"border": [[0,0,0],[1,0,0],[1,1,0],[0,0,0]]})";

std::string complaint(const std::string& patches) {
  return test::error_message<FormatError>(
      [&] { parse_anchor_json(R"({"patches": [)" + patches + "]}", "a.json"); });
}

TEST(PatchJson, TakesALineAroundItOrFaces) {
  const Anchors anchors = parse_anchor_json(
      R"({"pairs": [], "patches": [{"name": "face", "a": )" + border_ring +
          R"(, "b": {"faces": [5, 2]}}, {"name": "hair", "a": {"faces": [0]}, "exclude": true, "why": ""}]})",
      "a.json");
  ASSERT_EQ(anchors.patches.size(), 2u);
  EXPECT_EQ(anchors.patches[0].name, "face");
  EXPECT_EQ(anchors.patches[0].a.border.cols(), 3);  // the first point again at the end closes the line
  EXPECT_EQ(anchors.patches[0].a.border.col(2), Vector3(1, 1, 0));
  EXPECT_THAT(anchors.patches[0].b.faces, ElementsAre(5, 2));
  EXPECT_FALSE(anchors.patches[0].exclude);
  EXPECT_TRUE(anchors.patches[1].exclude);
  EXPECT_TRUE(anchors.patches[1].b.is_empty());
}

TEST(PatchJson, IsReadAsItWasWritten) {
  Anchors anchors;
  anchors.patches = {{"face", {Points{{0, 1, 1}, {0, 0, 1}, {0, 0, 0.1}}, {}}, {Points(3, 0), {7, 1}}, false},
                     {"", {}, {Points(3, 0), {3}}, true}};
  const test::ScratchDirectory directory;
  write_anchor_files({directory / "a.json"}, anchors);
  const Anchors back = read_anchors(directory / "a.json");
  ASSERT_EQ(back.patches.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(back.patches[k].name, anchors.patches[k].name);
    EXPECT_EQ(back.patches[k].a.border, anchors.patches[k].a.border);
    EXPECT_EQ(back.patches[k].a.faces, anchors.patches[k].a.faces);
    EXPECT_EQ(back.patches[k].b.faces, anchors.patches[k].b.faces);
    EXPECT_EQ(back.patches[k].exclude, anchors.patches[k].exclude);
  }
}

TEST(PatchJson, NamesThePatchAndWhatIsWrong) {
  EXPECT_EQ(complaint(R"({"a": )" + border_ring + R"(, "b": )" + border_ring + "}"), "accepted");
  EXPECT_THAT(complaint(R"({"name": "face", "a": )" + border_ring + "}"),
              AllOf(HasSubstr("a.json: patch 0 (\"face\")"), HasSubstr("\"b\" is missing"),
                    HasSubstr("\"exclude\": true")));
  EXPECT_THAT(complaint(R"({"name": "hair", "exclude": true})"), HasSubstr("neither \"a\" nor \"b\""));
  EXPECT_THAT(complaint(R"({"a": [[0,0,0]], "b": )" + border_ring + "}"),
              HasSubstr("\"a\" must be {\"border\""));
  EXPECT_THAT(complaint(R"({"a": {}, "b": )" + border_ring + "}"), HasSubstr("one of them"));
  EXPECT_THAT(complaint(R"({"a": {"faces": []}, "exclude": true})"), HasSubstr("one face at least"));
  EXPECT_THAT(complaint(R"({"a": {"faces": [1, -2]}, "exclude": true})"), HasSubstr("holds -2"));
  EXPECT_THAT(complaint(R"({"a": {"faces": [99999999999]}, "exclude": true})"),
              HasSubstr("holds 99999999999"));
  EXPECT_THAT(complaint(R"({"a": {"border": [[0,0,0],[1,0,0]]}, "exclude": true})"),
              HasSubstr("three at least"));
  EXPECT_THAT(complaint(R"({"a": {"border": [[0,0,0],[1,0,0],[1,1,0]], "closed": false}, "exclude": true})"),
              AllOf(HasSubstr("\"closed\" is false"), HasSubstr("back to its first point")));
  EXPECT_THAT(complaint(R"({"a": {"border": [[0,0,0],[1,"x",0],[1,1,0]]}, "exclude": true})"),
              HasSubstr("point 1"));
  EXPECT_THAT(complaint(R"({"a": {"faces": [1]}, "exclude": "yes"})"), HasSubstr("true or false"));
  EXPECT_THAT(complaint(R"({"name": "x", "a": {"faces": [1]}, "exclude": true},
                           {"name": "x", "b": {"faces": [1]}, "exclude": true})"),
              HasSubstr("two patches are named \"x\""));
  EXPECT_THAT(complaint("7"), HasSubstr("patch 0 is number, not an object"));
}

}  // namespace
}  // namespace bespoke

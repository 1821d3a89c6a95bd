#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// A build without Node.js has no pages; then the commands must say so.
bool has_pages(const ExamplePair& pair) {
  const ProgramResult result =
      bespoke({"pick", pair.file("source.obj"), pair.file("target.obj"), "-o", pair.file("pick.html")});
  if (result.exit_code == 0) return true;
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("built without its pages"));
  return false;
}

TEST(ViewCommand, WritesOneFileThatNamesNoOther) {
  const ExamplePair pair;
  if (!has_pages(pair)) GTEST_SKIP() << "built without pages";
  ASSERT_EQ(pair.fit("map.vdb", {"--confidence-out", pair.file("a.conf"), "--report", pair.file("fit.json")})
                .exit_code,
            0);
  const ProgramResult result =
      bespoke({"view", pair.file("map.vdb"), "--source", pair.file("source.obj"), "--target",
               pair.file("target.obj"), "--product", pair.file("product.obj"), "--confidence",
               pair.file("a.conf"), "--fit-report", pair.file("fit.json"), "-o", pair.file("view.html")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string page = read_text(pair.file("view.html"));
  EXPECT_THAT(page, HasSubstr("<!doctype html>"));
  EXPECT_THAT(page, Not(AnyOf(HasSubstr("src=\"http"), HasSubstr("href=\"http"))));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
}

TEST(ViewCommand, IsWhatFitWritesWithItsFindings) {
  const ExamplePair pair;
  if (!has_pages(pair)) GTEST_SKIP() << "built without pages";
  const ProgramResult result = pair.fit("map.vdb", {"--html", pair.file("pages")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(read_text(pair.file("pages/map.html")), HasSubstr("<!doctype html>"));
  EXPECT_THAT(read_text(pair.file("pages/map.png")), testing::StartsWith("\x89PNG"));
  EXPECT_THAT(read_text(pair.file("pages/index.html")), HasSubstr("href=\"map.html\""));

  // A map called as the index takes another name there.
  ASSERT_EQ(pair.fit("index.vdb", {"--html", pair.file("pages")}).exit_code, 0);
  EXPECT_THAT(read_text(pair.file("pages/index.html")), HasSubstr("href=\"index_2.html\""));
}

TEST(ViewCommand, RefusesOtherModelsAndFindings) {
  const ExamplePair pair;
  if (!has_pages(pair)) GTEST_SKIP() << "built without pages";
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto view = [&](const std::string& source, const std::vector<std::string>& more) {
    std::vector<std::string> words{"view",     pair.file("map.vdb"),    "--source", pair.file(source),
                                   "--target", pair.file("target.obj"), "-o",       pair.file("view.html")};
    words.insert(words.end(), more.begin(), more.end());
    return bespoke(words);
  };
  EXPECT_THAT(view("target.obj", {}).err, HasSubstr("is not the source that the map was made of"));
  write_text(pair.file("bad.conf"), "0.5\n1.5\n");
  const ProgramResult bad = view("source.obj", {"--confidence", pair.file("bad.conf")});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("bad.conf:2"));
  write_text(pair.file("bad.json"), "{}");
  EXPECT_THAT(view("source.obj", {"--fit-report", pair.file("bad.json")}).err, HasSubstr("not a report"));
  EXPECT_FALSE(pair.has("view.html"));
}

TEST(ViewCommand, ShowsThePiecesOfItsProducts) {
  const ExamplePair pair;
  if (!has_pages(pair)) GTEST_SKIP() << "built without pages";
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto view = [&](const std::string& product, const std::string& pattern) {
    return bespoke({"view", pair.file("map.vdb"), "--source", pair.file("source.obj"), "--target",
                    pair.file("target.obj"), "--product", pair.file(product), "--pattern", pair.file(pattern),
                    "-o", pair.file("view.html")});
  };
  // Two triangles around the source, which is about the origin.
  write_text(pair.file("square.obj"), "v 0 0 0\nv 0.2 0 0\nv 0.2 0.2 0\nv 0 0.2 0\nf 1 2 3 4\n");
  ASSERT_EQ(
      bespoke({"flatten", pair.file("square.obj"), "--unit", "cm", "-o", pair.file("pieces.json")}).exit_code,
      0);
  const ProgramResult result = view("square.obj", "pieces.json");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const ProgramResult other = view("product.obj", "pieces.json");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("pieces.json: its pieces are not the"));
  EXPECT_THAT(view("square.obj", "anchors.json").err, HasSubstr("is no pattern"));
}

TEST(ViewCommand, ShowsProductsThatAreKeptClear) {
  const ExamplePair pair;
  if (!has_pages(pair)) GTEST_SKIP() << "built without pages";
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto view = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"view",     pair.file("map.vdb"),    "--source",  pair.file("source.obj"),
                                   "--target", pair.file("target.obj"), "--product", pair.file("product.obj"),
                                   "-o",       pair.file("view.html")};
    words.insert(words.end(), more.begin(), more.end());
    return bespoke(words);
  };
  const ProgramResult kept = view({"--clearance", "keep"});
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, HasSubstr("product.obj: clearance: of "));
  EXPECT_THAT(view({}).out, Not(HasSubstr("clearance")));
  EXPECT_EQ(view({"--clearance", "near"}).exit_code, 1);
  EXPECT_EQ(view({"--layers"}).exit_code, 1);
  const ProgramResult nothing_worn =
      bespoke({"view", pair.file("map.vdb"), "--source", pair.file("source.obj"), "--target",
               pair.file("target.obj"), "--clearance", "keep", "-o", pair.file("view.html")});
  EXPECT_EQ(nothing_worn.exit_code, 1);
  EXPECT_THAT(nothing_worn.err, HasSubstr("--clearance: needs --product"));
}

TEST(PickCommand, WritesAPageForSeams) {
  const ExamplePair pair;
  if (!has_pages(pair)) GTEST_SKIP() << "built without pages";
  const auto pick = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"pick", pair.file("product.obj"), "-o", pair.file("seams.html")};
    words.insert(words.end(), more.begin(), more.end());
    return bespoke(words);
  };
  EXPECT_EQ(pick({"--seams"}).exit_code, 0);
  EXPECT_THAT(read_text(pair.file("seams.html")), HasSubstr("<!doctype html>"));
  write_text(pair.file("seams.json"), R"({"seams":[{"edges":[[1,2]]}]})");
  EXPECT_EQ(pick({"--seams", pair.file("seams.json")}).exit_code, 0);
  write_text(pair.file("bad.json"), R"({"seams":[{"edges":[[1,99999]]}]})");
  EXPECT_THAT(pick({"--seams", pair.file("bad.json")}).err, HasSubstr("vertex 99999 is none"));
}

TEST(PickCommand, RefusesModelsThatDoNotSuit) {
  const ExamplePair pair;
  const auto refusal = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"pick", pair.file("source.obj"), "-o", pair.file("pick.html")};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = bespoke(words);
    EXPECT_EQ(result.exit_code, 1);
    return result.err;
  };
  EXPECT_THAT(refusal({}), HasSubstr("B: is required"));
  EXPECT_THAT(refusal({pair.file("target.obj"), "--seams"}), HasSubstr("is a second"));
  EXPECT_THAT(refusal({"--anchors", pair.file("anchors.json"), "--seams"}), HasSubstr("excludes --anchors"));
  EXPECT_THAT(refusal({"--pose", "stored", "--seams"}), HasSubstr("--seams: excludes --pose"));
}

TEST(ReportCommand, WritesPicturesBesideMarkdownAndIntoHtml) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto report = [&](const std::string& output) {
    return bespoke({"report", pair.file("map.vdb"), "--source", pair.file("source.obj"), "--target",
                    pair.file("target.obj"), "-o", pair.file(output)});
  };
  EXPECT_EQ(report("map.md").exit_code, 0);
  EXPECT_TRUE(pair.has("map_surface_front.png"));
  EXPECT_THAT(read_text(pair.file("map.md")), HasSubstr("](map_surface_front.png)"));
  EXPECT_EQ(report("map.html").exit_code, 0);
  EXPECT_THAT(read_text(pair.file("map.html")), HasSubstr("data:image/png;base64,"));
  EXPECT_EQ(report("map.pdf").exit_code, 1);
}

}  // namespace
}  // namespace bespoke::test

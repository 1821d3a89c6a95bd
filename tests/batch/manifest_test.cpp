#include "bespoke/batch/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "product/text_dialects.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ReadManifest : public ::testing::Test {
 protected:
  Manifest read(const std::string& name, const std::string& text) const {
    test::write_text(directory_ / name, text);
    return read_manifest(directory_ / name);
  }
  /// The fault of a manifest whose second line is `line`.
  std::string fault(const std::string& name, const std::string& first, const std::string& line) const {
    const Manifest manifest = read(name, first + "\n" + line + "\n");
    EXPECT_EQ(manifest.faults.size(), 1u) << line;
    if (manifest.faults.empty()) return {};
    EXPECT_EQ(manifest.faults[0].line, 2u);
    return manifest.faults[0].what;
  }

  test::ScratchDirectory directory_;
};

TEST_F(ReadManifest, TakesOneObjectALine) {
  const Manifest manifest = read("m.jsonl",
                                 "{\"command\":\"fit\",\"source\":\"a "
                                 "b.obj\",\"steps\":3,\"tolerance\":0.25,\"half\":true,\"strict\":false}\r\n"
                                 "\n"
                                 "{\"product\":[\"x.obj\",\"y.obj\"],\"command\":\"apply\"}\n");
  EXPECT_THAT(manifest.faults, IsEmpty());
  ASSERT_EQ(manifest.jobs.size(), 2u);
  const ManifestJob& fit = manifest.jobs[0];
  EXPECT_EQ(fit.line, 1u);
  EXPECT_EQ(fit.command, "fit");
  ASSERT_EQ(fit.entries.size(), 5u);
  EXPECT_EQ(fit.entries[0].key, "source");
  EXPECT_THAT(fit.entries[0].values, ElementsAre("a b.obj"));
  EXPECT_THAT(fit.entries[1].values, ElementsAre("3"));
  EXPECT_THAT(fit.entries[2].values, ElementsAre("0.25"));
  EXPECT_TRUE(fit.entries[3].flag);
  EXPECT_THAT(fit.entries[3].values, ElementsAre("true"));
  EXPECT_TRUE(fit.entries[4].flag);
  EXPECT_THAT(fit.entries[4].values, IsEmpty());
  EXPECT_EQ(manifest.jobs[1].line, 3u);
  EXPECT_THAT(manifest.jobs[1].entries[0].values, ElementsAre("x.obj", "y.obj"));
}

TEST_F(ReadManifest, TakesATableWithAHeader) {
  const Manifest manifest = read("m.csv",
                                 "\xEF\xBB\xBF"  // as spreadsheets begin it
                                 "command,map,product,output,inverse\n"
                                 "apply,m.vdb,\"a, \"\"b\"\".obj\",out.obj,true\n"
                                 "apply,m.vdb,c.obj,d.obj,\n");
  EXPECT_THAT(manifest.faults, IsEmpty());
  ASSERT_EQ(manifest.jobs.size(), 2u);
  EXPECT_THAT(manifest.jobs[0].entries[1].values, ElementsAre("a, \"b\".obj"));
  EXPECT_TRUE(manifest.jobs[0].entries[3].flag);
  EXPECT_EQ(manifest.jobs[1].line, 3u);
  EXPECT_EQ(manifest.jobs[1].entries.size(), 3u);
}

TEST_F(ReadManifest, IsReadInAllDialectsOfTexts) {
  const std::string csv = "command,map,tolerance\napply,\"a, b.vdb\",0.5%\n",
                    json = "{\"command\":\"fit\"}\n{\"command\":\"apply\"}\n";
  for (const test::TextDialect& dialect : test::line_dialects()) {
    SCOPED_TRACE(dialect.name);
    const Manifest table = read("m.csv", dialect.of(csv)), lines = read("m.jsonl", dialect.of(json));
    EXPECT_THAT(table.faults, IsEmpty());
    ASSERT_EQ(table.jobs.size(), 1u);
    EXPECT_EQ(table.jobs[0].line, 2u);
    EXPECT_THAT(table.jobs[0].entries[0].values, ElementsAre("a, b.vdb"));
    EXPECT_THAT(lines.faults, IsEmpty());
    ASSERT_EQ(lines.jobs.size(), 2u);
    EXPECT_EQ(lines.jobs[1].line, 2u);
  }
  for (const std::string separator : {";", "\t"}) {
    std::string odd = "command,map,tolerance\napply,\"a; b.vdb\",0_5%\n";
    for (std::size_t at = 0; (at = odd.find(',', at)) != std::string::npos;) odd.replace(at, 1, separator);
    odd[odd.find('_')] = ',';
    const Manifest table = read("m.csv", odd);
    EXPECT_THAT(table.faults, IsEmpty());
    ASSERT_EQ(table.jobs.size(), 1u);
    EXPECT_THAT(table.jobs[0].entries[0].values, ElementsAre("a; b.vdb"));
    EXPECT_THAT(table.jobs[0].entries[1].values, ElementsAre("0.5%"));
  }
  EXPECT_THAT(test::error_message<FormatError>([&] { read("m.csv", test::utf16(csv, false, true)); }),
              HasSubstr("m.csv: is UTF-16; save as UTF-8"));
}

TEST_F(ReadManifest, SaysWhatIsWrongWithALine) {
  const auto json = [&](const std::string& line) { return fault("m.jsonl", "{\"command\":\"fit\"}", line); };
  EXPECT_THAT(json("{\"command\":\"fit\""), HasSubstr("not one JSON object"));
  EXPECT_THAT(json("{\"command\":\"fit\"} {}"), HasSubstr("not one JSON object"));
  EXPECT_THAT(json("[1]"), HasSubstr("array"));
  EXPECT_THAT(json("{\"source\":\"a.obj\"}"), HasSubstr("no \"command\""));
  EXPECT_THAT(json("{\"command\":true}"), HasSubstr("\"command\" must be"));
  EXPECT_THAT(json("{\"command\":\"fit\",\"source\":null}"), HasSubstr("\"source\" must be"));
  EXPECT_THAT(json("{\"command\":\"fit\",\"source\":{\"a\":1}}"), HasSubstr("\"source\" must be"));
  EXPECT_THAT(json("{\"command\":\"fit\",\"product\":[]}"), HasSubstr("\"product\" is an empty list"));
  EXPECT_THAT(json("{\"command\":\"fit\",\"half\":true,\"half\":false}"),
              HasSubstr("\"half\" is given twice"));
  const auto csv = [&](const std::string& line) { return fault("m.csv", "command,map", line); };
  EXPECT_THAT(csv("apply"), HasSubstr("1 cells, but the header has 2"));
  EXPECT_THAT(csv("apply,\"a.vdb"), HasSubstr("quote"));
  EXPECT_THAT(csv(",a.vdb"), HasSubstr("no \"command\""));
}

TEST_F(ReadManifest, NeedsAFile) {
  EXPECT_THROW(read_manifest(directory_ / "absent.jsonl"), FileError);
  EXPECT_THROW(read_manifest(directory_.path()), FileError);
}

}  // namespace
}  // namespace bespoke

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <utility>

#include "bespoke/anchors/anchors.h"
#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

TEST(AnchorsCommand, ConvertsThereAndBack) {
  const ExamplePair pair;
  const ProgramResult there =
      bespoke({"anchors", "convert", pair.file("anchors.json"), "-o", pair.file("a.mrk.json"),
               pair.file("b.mrk.json"), "--coordinates", "RAS"});
  EXPECT_EQ(there.exit_code, 0) << there.err;
  EXPECT_THAT(read_text(pair.file("a.mrk.json")), HasSubstr("RAS"));
  const ProgramResult back = bespoke({"anchors", "convert", pair.file("a.mrk.json"), pair.file("b.mrk.json"),
                                      "-o", pair.file("back.csv"), "--coordinates", "RAS"});
  EXPECT_EQ(back.exit_code, 0) << back.err;
  const Anchors first = read_anchors(pair.file("anchors.json")), last = read_anchors(pair.file("back.csv"));
  EXPECT_EQ(source_points(first), source_points(last));
  EXPECT_EQ(target_points(first), target_points(last));
}

TEST(AnchorsCommand, SaysWhatAFormatHasNoPlaceFor) {
  const ExamplePair pair;
  write_text(pair.file("all.json"),
             R"({"units": "cm", "pairs": [{"name": "p", "a": [0,0,0], "b": [0,0,1], "sigma": 0.5}],
                 "curves": [{"name": "waist", "a": [[0,0,0],[1,0,0]], "b": [[0,0,1],[2,0,0]]}],
                 "patches": [{"a": {"faces": [0]}, "exclude": true}]})");
  const auto said = [&](const std::vector<std::string>& outputs) {
    std::vector<std::string> words{"anchors", "convert", pair.file("all.json"), "-o"};
    for (const std::string& output : outputs) words.push_back(pair.file(output));
    return bespoke(words).out;
  };
  EXPECT_EQ(said({"x.json"}), "1 pair and 1 curve and 1 patch\n");
  EXPECT_EQ(
      said({"a.mrk.json", "b.mrk.json"}),
      "1 pair and 1 curve; left out, since the format has no place for it: the unit (cm), the accuracies of "
      "1 pair, 1 patch\n");
  EXPECT_EQ(
      said({"a.pp", "b.pp"}),
      "1 pair; left out, since the format has no place for it: the unit (cm), the accuracies of 1 pair, 1 "
      "curve, 1 patch\n");
}

TEST(AnchorsCommand, NamesWhatIsSuspicious) {
  const ExamplePair pair;
  const ProgramResult sound = bespoke({"anchors", "audit", pair.file("anchors.json"), "--source",
                                       pair.file("source.obj"), "--target", pair.file("target.obj")});
  EXPECT_EQ(sound.exit_code, 0) << sound.err;
  EXPECT_THAT(sound.out, HasSubstr("nothing is suspicious"));
  const auto written = [&](const char* name, const Anchors& anchors) {
    std::ostringstream rows;
    for (const AnchorPair& each : anchors.pairs) {
      rows << each.name;
      for (const Vector3& x : {each.a, each.b}) rows << ',' << x.x() << ',' << x.y() << ',' << x.z();
      rows << '\n';
    }
    write_text(pair.file(name), rows.str());
    return pair.file(name);
  };
  Anchors anchors = read_anchors(pair.file("anchors.json"));
  std::swap(anchors.pairs[2].b, anchors.pairs[9].b);
  const ProgramResult swapped = bespoke({"anchors", "audit", written("swapped.csv", anchors)});
  EXPECT_EQ(swapped.exit_code, 0) << swapped.err;
  EXPECT_THAT(swapped.out, HasSubstr("p2"));
  EXPECT_THAT(swapped.out, HasSubstr("p9"));
  for (AnchorPair& each : anchors.pairs) each.b += Vector3(20, 0, 0);
  const ProgramResult elsewhere = bespoke({"anchors", "audit", written("elsewhere.csv", anchors), "--source",
                                           pair.file("source.obj"), "--target", pair.file("target.obj")});
  EXPECT_THAT(elsewhere.out, HasSubstr("as points at random would"));
}

TEST(AnchorsCommand, NamesAnchorsAtOnePlace) {
  const ExamplePair pair;
  const std::string one = R"({"a":[0,0,0],"b":[0,0,0],"sigma":0.1})";
  write_text(pair.file("a.json"), "{\"pairs\":[" + one + "," + one + "," + one + "," + one + "]}");
  const ProgramResult audit = bespoke({"anchors", "audit", pair.file("a.json")});
  EXPECT_EQ(audit.exit_code, 0) << audit.err;
  EXPECT_THAT(audit.out, HasSubstr("all at one place"));
  EXPECT_THAT(audit.out, Not(HasSubstr("nothing is suspicious")));
}

TEST(AnchorsCommand, SuggestsPairsThatFitAccepts) {
  const ExamplePair pair;
  const std::vector<std::string> suggest{"anchors",
                                         "suggest",
                                         pair.file("source.obj"),
                                         pair.file("target.obj"),
                                         "--anchors",
                                         pair.file("anchors.json"),
                                         "--count",
                                         "2",
                                         "--tolerance",
                                         "1e-6",
                                         "-o",
                                         pair.file("more.csv")};
  const ProgramResult result = bespoke(suggest);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("suggested_2"));
  const Anchors before = read_anchors(pair.file("anchors.json")), after = read_anchors(pair.file("more.csv"));
  ASSERT_EQ(after.pairs.size(), before.pairs.size() + 2);
  EXPECT_GT(after.pairs.back().sigma.value_or(0), 0);
  EXPECT_EQ(bespoke({"anchors", "audit", pair.file("more.csv")}).exit_code, 0);
  EXPECT_EQ(bespoke({"fit", pair.file("source.obj"), pair.file("target.obj"), "--anchors",
                     pair.file("more.csv"), "--tolerance", "2%", "-o", pair.file("map.vdb"), "-q"})
                .exit_code,
            0);
}

TEST(AnchorsCommand, RefusesWhatItCannotRead) {
  const ExamplePair pair;
  const ProgramResult mesh =
      bespoke({"anchors", "convert", pair.file("source.obj"), "-o", pair.file("x.json")});
  EXPECT_EQ(mesh.exit_code, 1);  // as for every unknown ending
  EXPECT_THAT(mesh.err, testing::HasSubstr("unknown ending"));
  EXPECT_EQ(bespoke({"anchors", "audit", pair.file("none.csv")}).exit_code, 4);
  EXPECT_EQ(bespoke({"anchors"}).exit_code, 1);
}

}  // namespace
}  // namespace bespoke::test

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command/refusal.h"

// What the command says of arguments that were mistyped or do not fit together: what is wrong and what to
// type.
namespace bespoke::test {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Mistake {
  std::vector<std::string> arguments;
  std::string message;
};

TEST(MistypedArguments, SuggestTheNearestName) {
  const Mistake mistakes[] = {
      {{"fit", "a.obj", "b.obj", "--anchor", "x.json", "-o", "m.vdb"},
       "there is no option --anchor (did you mean --anchors?); see bespoke fit --help"},
      {{"fit", "a.obj", "b.obj", "--anchros=x.json", "-o", "m.vdb"}, "--anchros (did you mean --anchors?)"},
      {{"fit", "a.obj", "b.obj", "--outptu", "m.vdb"}, "--outptu (did you mean --output?)"},
      {{"fit", "a.obj", "b.obj", "-o", "m.vdb", "--conf", "c.txt"}, "did you mean --confidence-out?"},
      {{"apply", "m.vdb", "p.obj", "--out_dir", "x"}, "--out_dir (did you mean --out-dir?)"},
      {{"batch", "jobs.jsonl", "--keepgoing"}, "--keepgoing (did you mean --keep-going?)"},
      {{"aply", "m.vdb"}, "there is no subcommand 'aply' (did you mean apply?)"},
      {{"chekc", "m.vdb"}, "there is no subcommand 'chekc' (did you mean check?)"},
      {{"anchors", "convrt", "a.pp", "b.pp"}, "there is no subcommand 'convrt' (did you mean convert?)"}};
  for (const Mistake& mistake : mistakes) expect_refusal(bespoke(mistake.arguments), 1, mistake.message);
}

TEST(MistypedArguments, SuggestNothingThatIsFarOff) {
  const ProgramResult unknown = bespoke({"fit", "a.obj", "b.obj", "-o", "m.vdb", "--gravity"});
  expect_refusal(unknown, 1, "there is no option --gravity");
  EXPECT_THAT(unknown.err, Not(HasSubstr("did you mean")));
  EXPECT_THAT(bespoke({"knit"}).err, Not(HasSubstr("did you mean")));
}

TEST(MistypedArguments, OfJobsSuggestNamesToo) {
  const ExamplePair pair;
  write_text(pair.file("jobs.jsonl"),
             "{\"command\":\"check\",\"map\":\"m.vdb\",\"outptu\":\"x\"}\n{\"command\":\"aply\"}\n");
  const ProgramResult batch = bespoke({"batch", pair.file("jobs.jsonl")});
  EXPECT_EQ(batch.exit_code, 2);
  EXPECT_THAT(batch.err, HasSubstr("unknown key \"outptu\" (did you mean output?)"));
  EXPECT_THAT(batch.err, HasSubstr("unknown command \"aply\" (did you mean apply?)"));
}

TEST(UnknownEndings, HaveOneExitCode) {
  const ExamplePair pair;
  const std::string source = pair.file("source.obj"), target = pair.file("target.obj"),
                    anchors = pair.file("anchors.json"), odd = pair.file("odd.foo"), map = pair.file("m.vdb");
  write_text(odd, "0 0 0\n");
  const Mistake mistakes[] = {
      {{"fit", odd, target, "-o", map}, "odd.foo: the name must end in .obj"},
      {{"fit", source, odd, "-o", map}, "odd.foo"},
      {{"fit", source, target, "--anchors", odd, "-o", map}, "odd.foo: unknown ending; known are .json"},
      {{"fit", source, target, "--anchors", anchors, "-o", odd}, "odd.foo must end in .vdb"},
      {{"fit", source, target, "--anchors", anchors, "-o", map, "--fitted-out", odd}, "odd.foo must end in"},
      {{"fit", source, target, "--fitted", odd, "-o", map}, "odd.foo: the name must end in"},
      {{"apply", map, odd, "-o", pair.file("out.obj")}, "odd.foo must end in"},
      {{"apply", map, odd, "-o", "-"}, "odd.foo must end in"},
      {{"apply", map, source, "-o", odd}, "odd.foo must end in"},
      {{"invert", map, "-o", odd}, "odd.foo must end in .vdb"},
      {{"compose", map, map, "-o", odd}, "odd.foo must end in .vdb"},
      {{"export", map, "--grid", "1%", "-o", odd}, "odd.foo: unknown ending"},
      {{"export", map, "--morph", "2", "--product", source, "-o", odd}, "odd.foo must end in .glb"},
      {{"export", map, "--morph", "2", "--product", odd, "-o", "x.glb"}, "odd.foo must end in"},
      {{"report", map, "--source", source, "--target", target, "-o", odd}, "must end in .md or .html"},
      {{"anchors", "convert", odd, "-o", pair.file("a.json")}, "odd.foo: unknown ending"},
      {{"anchors", "convert", anchors, "-o", odd}, "odd.foo: unknown ending"},
      {{"batch", "jobs.jsonl", "--pack", odd}, "odd.foo must end in .tar"}};
  for (const Mistake& mistake : mistakes) expect_refusal(bespoke(mistake.arguments), 1, mistake.message);
  EXPECT_EQ(read_text(odd), "0 0 0\n");
}

TEST(UnfitArguments, AreNamedWithWhatToType) {
  const ExamplePair pair;
  const std::string map = pair.file("m.vdb"), product = pair.file("product.obj"),
                    source = pair.file("source.obj"), target = pair.file("target.obj");
  write_text(pair.file("taken"), "content");
  write_text(pair.file("a.xyz"), "0 0 0\n");
  write_text(pair.file("x.3mf"), "PK");
  expect_refusal(bespoke({"apply", map, product, "--out-dir", pair.file("taken")}), 4,
                 "taken: is no directory but a file; name another");
  EXPECT_EQ(read_text(pair.file("taken")), "content");
  expect_refusal(bespoke({"apply", map, pair.file("a.xyz"), "--refine", "1%", "-o", pair.file("b.xyz")}), 1,
                 "holds points, which have no edges to split; carry it without --refine");
  const ProgramResult converted = bespoke({"apply", map, pair.file("x.3mf"), "-o", pair.file("x.glb")});
  expect_refusal(converted, 1, "x.3mf cannot become .glb, which is written only from files that are .glb");
  EXPECT_THAT(converted.err, HasSubstr("name an output that ends in "));
}

TEST(AnchorsOfOneModel, AreRefusedWithTheLineThatJoinsThem) {
  const ExamplePair pair;
  const std::string points =
      "<!DOCTYPE PickedPoints>\n<PickedPoints>\n"
      "<point active=\"1\" x=\"0\" y=\"0\" z=\"0\" name=\"a\"/>\n</PickedPoints>\n";
  const auto fit = [&](const std::string& anchors) {
    return bespoke({"fit", pair.file("source.obj"), pair.file("target.obj"), "--anchors", anchors, "-o",
                    pair.file("map.vdb"), "-q"});
  };
  const std::string end = " -o " + pair.file("anchors.json");
  write_text(pair.file("woman.pp"), points);
  expect_refusal(fit(pair.file("woman.pp")), 2,
                 "bespoke anchors convert " + pair.file("woman.pp") + " " + pair.file("OTHER.pp") + end);
  write_text(pair.file("man.pp"), points);
  expect_refusal(fit(pair.file("woman.pp")), 2,
                 "bespoke anchors convert " + pair.file("woman.pp") + " " + pair.file("man.pp") + end);
  for (const std::string name : {"a.fcsv", "a.mrk.json", "a.pts", "a.wrap.json", "lists.json"}) {
    write_text(pair.file(name), name == "lists.json" ? "[[0, 0.2, 0.3]]" : "");
    expect_refusal(fit(pair.file(name)), 2, "bespoke anchors convert " + pair.file(name) + " ");
  }
  EXPECT_FALSE(pair.has("map.vdb"));
}

/// The line that is named does what it says, and a file with both sides is read as it is.
TEST(AnchorsOfOneModel, AreReadWhereOneFileHasBothSides) {
  const ExamplePair pair;
  const auto file = [&](const std::string& name) { return pair.file(name); };
  ASSERT_EQ(bespoke({"anchors", "convert", file("anchors.json"), "-o", file("numbers.txt"), "--source",
                     file("source.obj"), "--target", file("target.obj")})
                .exit_code,
            0);
  const ProgramResult fitted =
      bespoke({"fit", file("source.obj"), file("target.obj"), "--anchors", file("numbers.txt"), "--tolerance",
               "5%", "-o", file("map.vdb"), "-q"});
  EXPECT_EQ(fitted.exit_code, 0) << fitted.err;
}

}  // namespace
}  // namespace bespoke::test

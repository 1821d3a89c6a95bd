#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "bespoke/product/mesh_io.h"
#include "command/example_pair.h"

namespace bespoke::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// The number in a column of measures.csv, by the measure's name; -1 without one.
double cell(const std::string& csv, const std::string& measure, int column) {
  const std::size_t line = csv.find("\n" + measure + ",");
  if (line == std::string::npos) return -1;
  std::size_t at = line + 1;
  for (int i = 0; i < column; ++i) at = csv.find(',', at) + 1;
  double number = -1;
  std::sscanf(csv.c_str() + at, "%lf", &number);
  return number;
}

class GradeCommand : public testing::Test {
 protected:
  GradeCommand() {
    write_text(file("measures.json"),
               "{\"units\":\"cm\",\"measures\":[{\"name\":\"waist\",\"plane\":{\"point\":[0,0,0],\"normal\":["
               "0,1,0]}},"
               "{\"name\":\"side\",\"path\":[\"p1\",\"p4\"]}]}");
  }
  std::string file(const std::string& name) const { return pair_.file(name); }
  ProgramResult grade(const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments{"grade",      file("source.obj"),    file("product.obj"),
                                       "--measures", file("measures.json"), "--out-dir",
                                       file("sizes")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  ExamplePair pair_;
};

TEST_F(GradeCommand, GivesEverySizeAFolderWithItsProductsAndMeasures) {
  write_text(file("sizes.csv"), "\xEF\xBB\xBFsize,target,anchors,tolerance\r\nM," + file("target.obj") + "," +
                                    file("anchors.json") + ",0.5%\r\n");
  const ProgramResult result = grade({"--sizes", file("sizes.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("| source | M |"), HasSubstr("| waist | ")));
  EXPECT_EQ(result.out, read_text(file("sizes/measures.md")));
  // What the single commands write.
  ASSERT_EQ(pair_.fit("single.vdb").exit_code, 0);
  EXPECT_TRUE(read_text(file("sizes/M/map.vdb")) == read_text(file("single.vdb")));
  ASSERT_EQ(pair_.apply("single.vdb", {"-o", file("single.obj")}).exit_code, 0);
  EXPECT_TRUE(read_text(file("sizes/M/product.obj")) == read_text(file("single.obj")));

  const std::string csv = read_text(file("sizes/M/measures.csv"));
  // Girths of ellipses of radii 1 and 0.8, 1.1 and 0.95, by Ramanujan's second formula.
  EXPECT_NEAR(cell(csv, "waist", 1), 5.6723, 0.03);
  EXPECT_NEAR(cell(csv, "waist", 2), 6.4494, 0.03);
  EXPECT_NEAR(cell(csv, "waist", 3), cell(csv, "waist", 2), 0.03);
  EXPECT_NEAR(cell(csv, "side", 3), cell(csv, "side", 2), 0.03);
  EXPECT_EQ(cell(read_text(file("sizes/measures.csv")), "waist", 3), cell(csv, "waist", 2));
  EXPECT_THAT(read_text(file("sizes/M/measures.md")), HasSubstr("| model | carried |"));
  EXPECT_THAT(grade({"--sizes", file("sizes.csv")}).err, HasSubstr("4 up to date"));
}

TEST_F(GradeCommand, FillsTheSizesBetweenFromOneMap) {
  const ProgramResult result =
      grade({"--target", file("target.obj"), "--anchors", file("anchors.json"), "--between", "1", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string half = read_text(file("sizes/1_of_2/measures.csv"));
  const std::string whole = read_text(file("sizes/2_of_2/measures.csv"));
  for (const std::string measure : {"waist", "side"}) {
    EXPECT_NEAR(cell(half, measure, 3), (cell(half, measure, 1) + cell(whole, measure, 3)) / 2, 0.02);
    EXPECT_GT(cell(whole, measure, 2), 0);
    EXPECT_EQ(cell(half, measure, 2), -1);  // there is no model of that size
  }
  const ProgramResult apply =
      bespoke({"apply", file("sizes/map.vdb"), file("product.obj"), "-o", file("half.obj"), "--t", "0.5"});
  ASSERT_EQ(apply.exit_code, 0) << apply.err;
  EXPECT_TRUE(read_text(file("half.obj")) == read_text(file("sizes/1_of_2/product.obj")));

  // The same by a table.
  write_text(file("sizes.csv"), "size,target,anchors,t\nhalf," + file("target.obj") + "," +
                                    file("anchors.json") + ",0.5\nwhole," + file("target.obj") + "," +
                                    file("anchors.json") + ",\n");
  ASSERT_EQ(grade({"--sizes", file("sizes.csv"), "-q"}).exit_code, 0);
  EXPECT_TRUE(read_text(file("sizes/half/product.obj")) == read_text(file("half.obj")));
  EXPECT_TRUE(read_text(file("sizes/half/map.vdb")) == read_text(file("sizes/map.vdb")));
  EXPECT_FALSE(pair_.has("sizes/whole/map.vdb"));
}

TEST_F(GradeCommand, GoesOnWithTheOtherSizes) {
  // A line is no model that the source could be registered to.
  write_text(file("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  write_text(file("sizes.csv"), "size,target,anchors\nS," + file("flat.obj") + "," + file("anchors.json") +
                                    "\nM," + file("target.obj") + "," + file("anchors.json") + "\n");
  const ProgramResult result = grade({"--sizes", file("sizes.csv"), "--keep-going"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("sizes.csv:2: "), HasSubstr("flat.obj has no area")));
  EXPECT_TRUE(pair_.has("sizes/M/product.obj"));
  EXPECT_TRUE(pair_.has("sizes/M/measures.md"));
  EXPECT_FALSE(pair_.has("sizes/S/measures.md"));
  EXPECT_FALSE(pair_.has("sizes/measures.md"));

  // Repaired, only what lacks is made: map, product and table of the size, the table of all.
  fs::copy_file(file("target.obj"), file("flat.obj"), fs::copy_options::overwrite_existing);
  const ProgramResult again = grade({"--sizes", file("sizes.csv")});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("3 up to date"));
  EXPECT_THAT(again.out, HasSubstr("| source | S | M |"));
}

// No shift of a stiff shell clears a body of other proportions.
TEST_F(GradeCommand, RequiresThatProductsAreClear) {
  const TriangleMesh source = read_triangle_mesh(file("source.obj"));
  write_text(file("product.obj"), "g shell\n" + obj_text(1.001 * source.vertices, source.faces));
  const std::vector<std::string> options{
      "--target", file("target.obj"), "--anchors", file("anchors.json"), "--rigid",
      "shell",    "--clearance",      "keep"};
  EXPECT_EQ(grade(options).exit_code, 0);
  std::vector<std::string> required = options;
  required.push_back("--require-clear");
  const ProgramResult result = grade(required);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("not clear: product.obj"));
}

TEST_F(GradeCommand, ShowsTheSizesOnPages) {
  const ProgramResult result = grade({"--target", file("target.obj"), "--anchors", file("anchors.json"),
                                      "--between", "1", "--html", file("pages")});
  if (result.exit_code == 4) GTEST_SKIP() << result.err;  // built without pages
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string index = read_text(file("pages/index.html"));
  for (const std::string size : {"1_of_2", "2_of_2"}) {
    EXPECT_THAT(index, HasSubstr("src=\"" + size + ".png\""));
    EXPECT_TRUE(pair_.has("pages/" + size + ".png"));
  }
  EXPECT_NE(read_text(file("pages/1_of_2.png")), read_text(file("pages/2_of_2.png")));
  EXPECT_TRUE(pair_.has("pages/1_of_2.html"));
  EXPECT_FALSE(pair_.has("pages/2_of_2.html"));  // both sizes are of one map
}

// The purpose of grading: the paper's Fig. 7.
TEST_F(GradeCommand, ReproducesTheHipGirthsOfTheSamples) {
  ASSERT_EQ(bespoke({"samples", file("models"), "girths", "-q"}).exit_code, 0);
  std::string table = "size,target,anchors\n";
  for (const std::string girth : {"94", "100", "106", "112"})
    table += girth + "," + file("models/girths/target_" + girth + ".obj") + "," +
             file("models/girths/anchors_" + girth + ".json") + "\n";
  write_text(file("girths.csv"), table);
  const ProgramResult result =
      bespoke({"grade", file("models/girths/source.obj"), "--sizes", file("girths.csv"), "--measures",
               BESPOKE_SOURCE_DIR "/samples/grading/measures.json", "--out-dir", file("girths"), "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // Of the models' centimetres. Faces of source and target are 1 to 3 cm wide: the source's vertices lie on
  // the target's faces, and the middles of its own faces below them once more.
  constexpr double two_millimetres = 0.2, two_facets = 0.4;
  for (const int girth : {94, 100, 106, 112}) {
    const std::string csv = read_text(file("girths/" + std::to_string(girth) + "/measures.csv"));
    EXPECT_NEAR(cell(csv, "hips", 2), girth, two_millimetres);
    EXPECT_NEAR(cell(csv, "hips", 3), girth, two_facets);
  }
}

TEST_F(GradeCommand, WantsOneKindOfSizes) {
  EXPECT_EQ(grade({}).exit_code, 1);
  EXPECT_EQ(grade({"--sizes", file("a.csv"), "--target", file("target.obj")}).exit_code, 1);
  EXPECT_EQ(grade({"--sizes", file("a.csv"), "--between", "3"}).exit_code, 1);
  EXPECT_EQ(bespoke({"grade", file("source.obj"), "--target", file("target.obj"), "--out-dir", file("sizes")})
                .exit_code,
            1);
  EXPECT_EQ(bespoke({"grade", file("source.obj"), file("product.obj"), "--target", file("target.obj"),
                     "--out-dir", file("anchors.json")})
                .exit_code,
            4);
}

TEST_F(GradeCommand, NamesWhatIsMissingWithoutATable) {
  const ProgramResult result = grade({"--target", file("absent.obj")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("bespoke: grade: measure \"side\": there is no anchor"));
  EXPECT_THAT(grade({"--target", file("absent.obj"), "--anchors", file("anchors.json")}).err,
              HasSubstr("bespoke: grade: target " + file("absent.obj") + " does not exist"));
}

TEST_F(GradeCommand, NamesTheLineOfATableBeforeAnythingRuns) {
  const auto table = [&](const std::string& text) {
    write_text(file("sizes.csv"), text);
    return grade({"--sizes", file("sizes.csv")});
  };
  const std::string target = file("target.obj"), anchors = file("anchors.json");
  struct Bad {
    std::string text;
    const char* line;
    const char* message;
  };
  for (const Bad& bad : {
           Bad{"size,target\n../x," + target + "\n", ":2: ", "cannot be the name of a folder"},
           Bad{"size,target\nM," + target + "\nM," + target + "\n", ":3: ", "a second size \"M\""},
           Bad{"size,target\nM," + file("absent.obj") + "\n", ":2: ", "absent.obj does not exist"},
           Bad{"size,target\nM,\n", ":2: ", "has no target"},
           Bad{"name,target\nM," + target + "\n", ":2: ", "there is no \"size\""},
           Bad{"size,target,t\nM," + target + ",half\n", ":2: ", "\"half\" is no number"},
           Bad{"size,target,speed\nM," + target + ",3\n", ":2: ", "unknown key \"speed\""},
           Bad{"size,target,output\nM," + target + ",x.vdb\n", ":2: ", "no column \"output\""},
           Bad{"size,target,anchors\nM," + target + "," + anchors + "\nL," + target + ",\n",
               ":3: ", "no anchor \"p1\""},
           Bad{"size,target\nM\n", ":2: ", "1 cells"},
       }) {
    const ProgramResult result = table(bad.text);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr("sizes.csv" + std::string(bad.line)), HasSubstr(bad.message),
                                  HasSubstr("nothing was run")));
    EXPECT_FALSE(pair_.has("sizes")) << bad.message;
  }
  EXPECT_EQ(table("size,target\n").exit_code, 2);
  EXPECT_EQ(grade({"--sizes", file("absent.csv")}).exit_code, 4);
  write_text(file("measures.json"),
             "{\"units\":\"mm\",\"measures\":[{\"name\":\"side\",\"path\":[\"p1\",\"p4\"]}]}");
  EXPECT_THAT(table("size,target,anchors\nM," + target + "," + anchors + "\n").err,
              HasSubstr("the measures are in mm, but " + anchors + " is in cm"));
}

}  // namespace
}  // namespace bespoke::test

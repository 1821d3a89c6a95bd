#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bespoke/product/mesh_io.h"
#include "command/example_pair.h"
#include "support/shapes.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

ProgramResult measure(const ExamplePair& pair, const std::vector<std::string>& extra = {}) {
  std::vector<std::string> arguments{"measure",  pair.file("map.vdb"),    "--source", pair.file("source.obj"),
                                     "--target", pair.file("target.obj"), "--quiet"};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  return bespoke(arguments);
}

TEST(MeasureCommand, PutsNumbersOnAMap) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const ProgramResult text = measure(pair, {"--product", pair.file("product.obj")});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_EQ(text.err, "");
  for (const char* part :
       {"mesh units (cm)", "anchor residuals", "mapped source to target", "target to mapped source",
        "Hausdorff", "conformal", "least det", "product.obj: 729 vertices", "clearance kept within",
        "inside the body", "self-intersecting"})
    EXPECT_THAT(text.out, HasSubstr(part));
}

/// A ball onto an equal one, but by a fitted ball of 0.8 times its size, and a shell around it: what it makes
/// of the shell lies inside.
void write_penetrating(const ExamplePair& pair) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const auto write = [&](const char* name, double size) {
    write_triangle_mesh(pair.file(name), {size * sphere.vertices, sphere.faces});
  };
  write("source.obj", 1);
  write("target.obj", 1.001);
  write("fitted.obj", 0.8);
  write("shell.obj", 1.1);
  EXPECT_EQ(bespoke({"fit", pair.file("source.obj"), pair.file("target.obj"), "--fitted",
                     pair.file("fitted.obj"), "-o", pair.file("map.vdb"), "--quiet"})
                .exit_code,
            0);
}

TEST(MeasureCommand, WarnsOfProductsThatPenetrateTheTargetAlone) {
  const ExamplePair pair;
  write_penetrating(pair);
  const ProgramResult shell = measure(pair, {"--json", "--product", pair.file("shell.obj")});
  ASSERT_EQ(shell.exit_code, 0) << shell.err;
  EXPECT_THAT(shell.err, HasSubstr("shell.obj: 100 % of it lies inside the target, though not inside"));
  EXPECT_EQ(nlohmann::json::parse(shell.out)["products"][0]["newly_inside"]["share"], 1);
  EXPECT_EQ(measure(pair, {"--product", pair.file("fitted.obj")}).err, "");
}

TEST(MeasureCommand, MeasuresWhatApplyWrites) {
  const ExamplePair pair;
  write_penetrating(pair);
  write_text(pair.file("rigid.obj"), "g shell\n" + read_text(pair.file("shell.obj")));
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--clearance", "keep"}, {"--rigid", "shell"}}) {
    ASSERT_EQ(bespoke([&] {
                std::vector<std::string> apply{"apply", pair.file("map.vdb"), pair.file("rigid.obj"),
                                               "-o",    pair.file("out.obj"), "-q"};
                apply.insert(apply.end(), options.begin(), options.end());
                return apply;
              }())
                  .exit_code,
              0);
    std::vector<std::string> further{"--json", "--product", pair.file("rigid.obj")};
    further.insert(further.end(), options.begin(), options.end());
    const ProgramResult result = measure(pair, further);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Points written = read_triangle_mesh(pair.file("out.obj")).vertices;
    std::vector<double> distances;
    for (const auto& vertex : written.colwise()) distances.push_back(vertex.norm() - 1.001);
    const auto after = nlohmann::json::parse(result.out)["products"][0]["clearance_after"];
    EXPECT_NEAR(after["max"].get<double>(), *std::max_element(distances.begin(), distances.end()), 0.01)
        << options.front();
  }
  const ProgramResult alone = measure(pair, {"--clearance", "keep"});
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_THAT(alone.err, HasSubstr("needs --product"));
}

TEST(ProductOnPagesAndReports, WarnsOfPenetrationToo) {
  const ExamplePair pair;
  write_penetrating(pair);
  for (const std::string output : {"page.html", "report.md"}) {
    const ProgramResult result =
        bespoke({output == "page.html" ? "view" : "report", pair.file("map.vdb"), "--source",
                 pair.file("source.obj"), "--target", pair.file("target.obj"), "--product",
                 pair.file("shell.obj"), "-o", pair.file(output), "-q"});
    if (result.exit_code == 1) continue;  // built without pages
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("shell.obj: 100 % of it lies inside the target")) << output;
  }
}

TEST(ProductOfASize, WarnsOfPenetrationToo) {
  const ExamplePair pair;
  write_penetrating(pair);
  write_text(pair.file("sizes.csv"),
             "size,target,fitted\nS," + pair.file("target.obj") + "," + pair.file("fitted.obj") + "\n");
  const ProgramResult result = bespoke({"grade", pair.file("source.obj"), pair.file("shell.obj"), "--sizes",
                                        pair.file("sizes.csv"), "--out-dir", pair.file("sizes"), "-q"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("shell.obj: 100 % of it lies inside the target"));
}

// What lies on a surface lies to either side of it after a fit.
TEST(ProductAfterApply, WarnsOfNoProductOnTheSurfaceItself) {
  const ExamplePair pair;
  const TriangleMesh sphere = shapes::icosphere(3);
  const auto write = [&](const char* name, double size) {
    write_triangle_mesh(pair.file(name), {size * sphere.vertices, sphere.faces});
  };
  write("source.obj", 1);
  write("target.obj", 1);
  write("fitted.obj", 0.999);  // 0.03 % of the diagonal inside
  ASSERT_EQ(bespoke({"fit", pair.file("source.obj"), pair.file("target.obj"), "--fitted",
                     pair.file("fitted.obj"), "-o", pair.file("map.vdb"), "--quiet"})
                .exit_code,
            0);
  const ProgramResult result = measure(pair, {"--product", pair.file("source.obj")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

TEST(ProductAfterApply, WarnsOfProductsThatPenetrateTheTargetWhereBothModelsAreKnown) {
  const ExamplePair pair;
  write_penetrating(pair);
  std::vector<std::string> apply{
      "apply",    pair.file("map.vdb"),   pair.file("shell.obj"), "-o", pair.file("carried.obj"),
      "--source", pair.file("source.obj")};
  EXPECT_EQ(bespoke(apply).exit_code, 1);  // a source alone is sought in a catalogue
  apply.insert(apply.end(), {"--target", pair.file("target.obj")});
  const ProgramResult warned = bespoke(apply);
  EXPECT_EQ(warned.exit_code, 0) << warned.err;
  EXPECT_THAT(warned.err, HasSubstr("lies inside the target, though not inside the source"));
  EXPECT_TRUE(pair.has("carried.obj"));
  apply.back() = pair.file("shell.obj");
  apply[4] = pair.file("refused.obj");
  const ProgramResult refused = bespoke(apply);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("shell.obj: is not the model that the map was made of"));
  EXPECT_FALSE(pair.has("refused.obj"));
}

TEST(MeasureCommand, PutsTheSameNumbersIntoJson) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const std::vector<std::string> options{"--json", "--product", pair.file("product.obj"), "--product",
                                         pair.file("source.obj")};
  const ProgramResult result = measure(pair, options);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto printed = nlohmann::json::parse(result.out);
  EXPECT_EQ(printed["anchor_residuals"]["count"], 14);
  EXPECT_EQ(printed["source_faces"], 1280);
  EXPECT_EQ(printed["flipped_faces"], 0);
  // The bake adds at most its tolerance, and chords of either mesh lie up to 1 % of the largest radius, 1.4,
  // below its ellipsoid.
  const double off =
      0.014 +
      nlohmann::json::parse(bespoke({"info", pair.file("map.vdb"), "--json"}).out)["tolerance"].get<double>();
  EXPECT_LT(printed["source_to_target"]["p99"].get<double>(), off);
  EXPECT_LT(printed["target_to_source"]["p99"].get<double>(), off);
  EXPECT_GE(printed["hausdorff"].get<double>(), printed["source_to_target"]["max"].get<double>());
  EXPECT_GT(printed["distortion"]["min_determinant"].get<double>(), 0);
  EXPECT_GE(printed["distortion"]["conformal"]["min"].get<double>(), 1);
  ASSERT_EQ(printed["products"].size(), 2u);
  EXPECT_EQ(printed["products"][0]["name"], "product.obj");
  // The source as a product lies on its own surface and lands on the target's.
  const auto& itself = printed["products"][1];
  EXPECT_EQ(itself["clearance_before"]["max"], 0);
  EXPECT_EQ(itself["penetration_before"]["vertices"], 0);
  EXPECT_LT(itself["clearance_change"]["p95"].get<double>(), off);
  EXPECT_EQ(itself["self_intersections_after"], 0);
  EXPECT_EQ(measure(pair, options).out, result.out);
  std::vector<std::string> one_thread = options;
  one_thread.insert(one_thread.end(), {"--threads", "1"});
  EXPECT_EQ(measure(pair, one_thread).out, result.out);
  std::vector<std::string> in_a_child = options;
  in_a_child.push_back("--untrusted");
  EXPECT_EQ(measure(pair, in_a_child).out, result.out);
}

TEST(MeasureCommand, RefusesOtherModelsThanTheMaps) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const ProgramResult swapped = bespoke({"measure", pair.file("map.vdb"), "--source", pair.file("target.obj"),
                                         "--target", pair.file("source.obj")});
  EXPECT_EQ(swapped.exit_code, 2);
  EXPECT_THAT(swapped.err, HasSubstr("target.obj: is not the source that the map was made of"));
  const ProgramResult same = bespoke({"measure", pair.file("map.vdb"), "--source", pair.file("source.obj"),
                                      "--target", pair.file("source.obj")});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_THAT(same.err, HasSubstr("source.obj: is not the target that the map was made of"));
}

TEST(MeasureCommand, ExactDiffersFromTheGridsByNoMoreThanTheTolerance) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb", {"--strict", "--keep-exact", "--tolerance", "0.02"}).exit_code, 0);
  const auto largest_residual = [&](const std::vector<std::string>& extra) {
    const ProgramResult result = measure(pair, extra);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out)["anchor_residuals"]["max"].get<double>();
  };
  const double baked = largest_residual({"--json"});
  const double exact = largest_residual({"--json", "--exact"});
  EXPECT_NE(baked, exact);
  EXPECT_NEAR(baked, exact, 0.02);
}

TEST(MeasureCommand, NamesWhatIsWrong) {
  const ExamplePair pair;
  EXPECT_EQ(bespoke({"measure"}).exit_code, 1);
  EXPECT_EQ(bespoke({"measure", pair.file("map.vdb"), "--source", pair.file("source.obj")}).exit_code, 1);
  const ProgramResult no_map = measure(pair);
  EXPECT_EQ(no_map.exit_code, 4);
  EXPECT_THAT(no_map.err, HasSubstr("map.vdb"));
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const ProgramResult no_product = measure(pair, {"--product", pair.file("none.obj")});
  EXPECT_EQ(no_product.exit_code, 4);
  EXPECT_THAT(no_product.err, HasSubstr("none.obj"));
  const ProgramResult no_exact_map = measure(pair, {"--exact"});
  EXPECT_EQ(no_exact_map.exit_code, 2);
  EXPECT_THAT(no_exact_map.err, HasSubstr("map.vdb: holds no exact map"));
  write_text(pair.file("bad.obj"), "v 0 0\n");
  const ProgramResult bad_product = measure(pair, {"--product", pair.file("bad.obj")});
  EXPECT_EQ(bad_product.exit_code, 2);
  EXPECT_THAT(bad_product.err, HasSubstr("bad.obj:1: missing z"));
  const ProgramResult no_asset = bespoke({"measure", pair.file("source.obj"), "--source",
                                          pair.file("source.obj"), "--target", pair.file("target.obj")});
  EXPECT_EQ(no_asset.exit_code, 2);
  EXPECT_THAT(bespoke({"measure", "--help"}).out, HasSubstr("Examples:\n  bespoke measure"));
}

}  // namespace
}  // namespace bespoke::test

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/model_distances.h"
#include "bespoke/product/mesh_io.h"
#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class ApplyClearance : public testing::Test {
 protected:
  ApplyClearance() {
    EXPECT_EQ(pair_.fit("map.vdb", {"--lambda", "20%"}).exit_code, 0);
    const TriangleMesh source = read_triangle_mesh(pair_.file("source.obj"));
    // Tight shirts: they touch, so that the error of the map is enough to miss.
    for (const auto& [name, size] : {std::pair("shirt.obj", 1.001), {"jacket.obj", 1.01}})
      write_text(pair_.file(name), obj_text(size * source.vertices, source.faces));
    write_text(pair_.file("rigid.obj"), "g shell\n" + obj_text(1.001 * source.vertices, source.faces));
  }

  ProgramResult apply(const std::vector<std::string>& products,
                      const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"apply", pair_.file("map.vdb")};
    for (const std::string& product : products) arguments.push_back(pair_.file(product));
    arguments.insert(arguments.end(), {"--report", pair_.file("report.json")});
    arguments.insert(arguments.end(), options.begin(), options.end());
    return bespoke(arguments);
  }
  json clearance(std::size_t product = 0) const {
    return json::parse(read_text(pair_.file("report.json")))["products"][product].value("clearance", json());
  }
  json layer_order() const {
    return json::parse(read_text(pair_.file("report.json"))).value("layer_order", json());
  }
  std::string out() const { return pair_.file("out.obj"); }
  double nearest_of_output() const {
    const auto distances = model_distances(read_asset(pair_.file("map.vdb")));
    const std::vector<double> outside = distances->target(read_obj_points(out()));
    return *std::min_element(outside.begin(), outside.end());
  }

  ExamplePair pair_;
};

TEST_F(ApplyClearance, OffIsTheDefaultAndThePureMap) {
  ASSERT_EQ(apply({"shirt.obj"}, {"-o", out()}).exit_code, 0);
  EXPECT_TRUE(clearance().is_null());
  const std::string pure = read_text(out());
  ASSERT_EQ(apply({"shirt.obj"}, {"--clearance", "off", "-o", out()}).exit_code, 0);
  EXPECT_EQ(read_text(out()), pure);
}

TEST_F(ApplyClearance, KeepsWhatTheProductHad) {
  const ProgramResult result = apply({"shirt.obj"}, {"--clearance", "keep", "--require-clear", "-o", out()});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  EXPECT_THAT(result.out, HasSubstr("clearance: of "));
  EXPECT_GT(clearance()["missed_before"]["samples"], 0);
  EXPECT_EQ(clearance()["missed_after"]["samples"], 0);
  EXPECT_EQ(clearance()["new_self_intersections"], 0);
  EXPECT_TRUE(clearance()["clear"]);
  EXPECT_TRUE(layer_order().is_null());
  // What is written is what was checked.
  EXPECT_GT(nearest_of_output(), -1e-4 * extent(read_obj_points(out())));
}

TEST_F(ApplyClearance, GivesTheEaseThatIsNamed) {
  ASSERT_EQ(apply({"shirt.obj"}, {"--clearance", "1%", "--require-clear", "-o", out()}).exit_code, 0);
  EXPECT_GT(nearest_of_output(), 0.0095 * extent(read_obj_points(pair_.file("source.obj"))));
}

TEST_F(ApplyClearance, LayersKeepTheirOrder) {
  const ProgramResult result =
      apply({"shirt.obj", "jacket.obj"},
            {"--clearance", "keep", "--layers", "--require-clear", "--out-dir", pair_.file("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  EXPECT_THAT(result.out, HasSubstr("shirt.obj under jacket.obj: 0 pairs"));
  EXPECT_EQ(clearance(1)["layers"][0]["lower"], "shirt.obj");
  EXPECT_EQ(clearance(1)["layers"][0]["new_intersections"], 0);
  EXPECT_FALSE(layer_order()["found_on_source"]);
  EXPECT_FALSE(layer_order()["circular"]);
}

// In whichever order they are named.
TEST_F(ApplyClearance, LayersAreFoundByHowTheyLieOnTheSource) {
  const ProgramResult result = apply({"jacket.obj", "shirt.obj"}, {"--clearance", "keep", "--require-clear",
                                                                   "--out-dir", pair_.file("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  EXPECT_THAT(result.out, HasSubstr("shirt.obj under jacket.obj: 0 pairs"));
  EXPECT_THAT(result.out, HasSubstr("layers, from the inside to the outside: shirt.obj, jacket.obj (found"));
  EXPECT_EQ(layer_order()["names"], json({"shirt.obj", "jacket.obj"}));
  EXPECT_TRUE(layer_order()["found_on_source"]);
  EXPECT_EQ(clearance(0)["layers"][0]["lower"], "shirt.obj");
  EXPECT_TRUE(clearance(0)["passed_through"].empty());
  EXPECT_TRUE(clearance(1)["layers"].empty());
}

TEST_F(ApplyClearance, SameKeepsAndDrawsBack) {
  ASSERT_EQ(apply({"jacket.obj"}, {"--clearance", "keep", "-o", out()}).exit_code, 0);
  const json kept = clearance();
  ASSERT_EQ(apply({"jacket.obj"}, {"--clearance", "same", "--require-clear", "-o", out()}).exit_code, 0);
  EXPECT_TRUE(clearance()["clear"]);
  EXPECT_GE(clearance()["moved"], kept["moved"]);
}

// No shift of a stiff shell clears a body of other proportions.
TEST_F(ApplyClearance, WhatCannotBeClearedIsReportedAndExitsWithThree) {
  const ProgramResult result = apply({"rigid.obj"}, {"--clearance", "keep", "--rigid", "shell", "-o", out()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, testing::AnyOf(HasSubstr("no space at ("), HasSubstr("held back at (")));
  EXPECT_THAT(result.err, HasSubstr("rigid.obj: not clear, although it was corrected: "));
  EXPECT_FALSE(clearance()["clear"]);
  EXPECT_FALSE(clearance()["places"].empty());
  const ProgramResult required =
      apply({"rigid.obj"}, {"--clearance", "keep", "--rigid", "shell", "--require-clear", "-o", out()});
  EXPECT_EQ(required.exit_code, 3);
  EXPECT_THAT(required.err, HasSubstr("not clear: rigid.obj"));
  EXPECT_TRUE(pair_.has("out.obj"));
}

// A stiff sole and a soft upper are layers of one call.
TEST_F(ApplyClearance, PartsAreOfTheProductsThatHaveThem) {
  const ProgramResult both =
      apply({"shirt.obj", "rigid.obj"}, {"--rigid", "shell", "--out-dir", pair_.file("out")});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("rigid.obj: shell: "));
  EXPECT_EQ(both.out.find("shirt.obj: shell"), std::string::npos);
  const ProgramResult none =
      apply({"shirt.obj", "rigid.obj"}, {"--rigid", "heel", "--out-dir", pair_.file("none")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("none of the products has a part 'heel'"));
  EXPECT_THAT(apply({"shirt.obj"}, {"--rigid", "shell", "-o", out()}).err, HasSubstr("has no part 'shell'"));
}

TEST_F(ApplyClearance, RefusesWhatHasNoMeaning) {
  for (const auto& [options, message] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--clearance", "lots"}, "is off, keep, same, a length"},
           {{"--require-clear"}, "needs --clearance: keep, same, a length"},
           {{"--layers"}, "needs --clearance"},
           {{"--clearance", "keep", "--t", "0.5"}, "--t is 1"},
           {{"--clearance", "keep", "--frames", "2"}, "--t is 1"}}) {
    std::vector<std::string> arguments = options;
    arguments.insert(arguments.end(), {"-o", out()});
    const ProgramResult result = apply({"shirt.obj"}, arguments);
    EXPECT_EQ(result.exit_code, 1) << options.front();
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_FALSE(pair_.has("out.obj"));
  }
}

TEST_F(ApplyClearance, RefusesPointFilesTooMuchEaseAndOldMaps) {
  write_text(pair_.file("points.xyz"), "1 2 3\n");
  ProgramResult result = bespoke({"apply", pair_.file("map.vdb"), pair_.file("points.xyz"), "--clearance",
                                  "keep", "-o", pair_.file("out.xyz")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("points.xyz"));
  result = apply({"shirt.obj"}, {"--clearance", "50%", "-o", out()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("that the map's file can tell"));
  const Asset asset = read_asset(pair_.file("map.vdb"));
  write_asset(pair_.file("map.vdb"), with_preview(asset, read_triangle_mesh(pair_.file("source.obj"))));
  result = apply({"shirt.obj"}, {"--clearance", "keep", "-o", out()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("make it anew by `bespoke fit`"));
  EXPECT_FALSE(pair_.has("out.obj"));
}

}  // namespace
}  // namespace bespoke::test

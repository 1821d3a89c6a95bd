#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

TEST(CheckCommand, ProvesTheBijectionFromTheFileAloneAtAnyTime) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb", {"--require-certified"}).exit_code, 0);
  const ProgramResult text = bespoke({"check", pair.file("map.vdb"), "--quiet"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("a bijection of space"));
  const ProgramResult json = bespoke({"check", pair.file("map.vdb"), "--t", "0.5", "--json", "--untrusted"});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_TRUE(nlohmann::json::parse(json.out)["bijection"]);
  // Far beyond the map the motion turns space over.
  const ProgramResult beyond = bespoke({"check", pair.file("map.vdb"), "--t", "-20"});
  EXPECT_EQ(beyond.exit_code, 3) << beyond.out;
  EXPECT_THAT(beyond.err, HasSubstr("not proved"));
  EXPECT_EQ(bespoke({"check", pair.file("none.vdb")}).exit_code, 4);
  EXPECT_EQ(bespoke({"check", pair.file("source.obj")}).exit_code, 2);
}

TEST(InvertCommand, LeadsBackAsTheCellsOfTheMapDo) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  ASSERT_EQ(pair.apply("map.vdb", {"-o", pair.file("there.obj")}).exit_code, 0);
  const ProgramResult inverted =
      bespoke({"invert", pair.file("map.vdb"), "-o", pair.file("back.vdb"), "--tolerance", "0.05%"});
  ASSERT_EQ(inverted.exit_code, 0) << inverted.err;
  EXPECT_THAT(inverted.out, HasSubstr("round trip"));
  EXPECT_EQ(bespoke({"check", pair.file("back.vdb")}).exit_code, 0);
  const Points product = read_obj_points(pair.file("product.obj"));
  const double length = (product.rowwise().maxCoeff() - product.rowwise().minCoeff()).norm();

  const ProgramResult cells = bespoke(
      {"apply", pair.file("map.vdb"), pair.file("there.obj"), "--inverse", "-o", pair.file("cells.obj")});
  ASSERT_EQ(cells.exit_code, 0) << cells.err;
  EXPECT_LT((read_obj_points(pair.file("cells.obj")) - product).colwise().norm().maxCoeff(), 1e-5 * length);

  ASSERT_EQ(bespoke({"apply", pair.file("back.vdb"), pair.file("there.obj"), "-o", pair.file("baked.obj")})
                .exit_code,
            0);
  EXPECT_LT((read_obj_points(pair.file("baked.obj")) - product).colwise().norm().maxCoeff(), 0.01 * length);
}

TEST(ComposeCommand, JoinsMapsWhoseModelsMeet) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  ASSERT_EQ(bespoke({"invert", pair.file("map.vdb"), "-o", pair.file("back.vdb")}).exit_code, 0);
  const ProgramResult joined =
      bespoke({"compose", pair.file("map.vdb"), pair.file("back.vdb"), "-o", pair.file("round.vdb")});
  ASSERT_EQ(joined.exit_code, 0) << joined.err;
  ASSERT_EQ(pair.apply("round.vdb", {"-o", pair.file("same.obj")}).exit_code, 0);
  const Points product = read_obj_points(pair.file("product.obj"));
  const double length = (product.rowwise().maxCoeff() - product.rowwise().minCoeff()).norm();
  EXPECT_LT((read_obj_points(pair.file("same.obj")) - product).colwise().norm().maxCoeff(), 0.01 * length);

  const ProgramResult apart =
      bespoke({"compose", pair.file("map.vdb"), pair.file("map.vdb"), "-o", pair.file("x.vdb")});
  EXPECT_EQ(apart.exit_code, 2);
  EXPECT_THAT(apart.err, HasSubstr("another model"));
  EXPECT_FALSE(pair.has("x.vdb"));
  EXPECT_EQ(bespoke({"compose", pair.file("map.vdb"), pair.file("map.vdb"), "-o", pair.file("x.vdb"),
                     "--any-models"})
                .exit_code,
            0);
}

// One vertex pulled far through its neighbours folds the space around it, and one uniform level repairs
// nothing.
TEST(CertifiedFit, WritesNothingUnlessCertifiedWhenAskedTo) {
  const ExamplePair pair;
  const Points source = read_obj_points(pair.file("source.obj"));
  const double length = (source.rowwise().maxCoeff() - source.rowwise().minCoeff()).norm();
  std::ifstream lines(pair.file("source.obj"));
  std::ofstream pulled(pair.file("pulled.obj"));
  bool first = true;
  for (std::string line; std::getline(lines, line);) {
    double x = 0, y = 0, z = 0;
    if (first && std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) {
      first = false;
      pulled << "v " << x + 0.3 * length << ' ' << y << ' ' << z << '\n';
    } else {
      pulled << line << '\n';
    }
  }
  pulled.close();
  const ProgramResult result = bespoke({"fit", pair.file("source.obj"), pair.file("target.obj"), "--fitted",
                                        pair.file("pulled.obj"), "--elastic", "csrbf", "--voxel-size", "1%",
                                        "--require-certified", "-o", pair.file("map.vdb"), "--quiet"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("not certified"));
  EXPECT_FALSE(pair.has("map.vdb"));
}

}  // namespace
}  // namespace bespoke::test

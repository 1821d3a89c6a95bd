#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "bespoke/asset/asset_io.h"
#include "command/example_pair.h"
#include "product/gltf_scene.h"

namespace bespoke::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

double largest_distance(const Points& a, const Points& b) { return (a - b).colwise().norm().maxCoeff(); }

class ApplyCommand : public testing::Test {
 protected:
  ApplyCommand() { EXPECT_EQ(pair_.fit("map.vdb", {"--keep-exact", "--lambda", "20%"}).exit_code, 0); }

  Points product() const { return read_obj_points(pair_.file("product.obj")); }
  /// The product's points after `apply` with the options, which must succeed.
  Points applied(const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments{"-o", pair_.file("out.obj")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const ProgramResult result = pair_.apply("map.vdb", arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_obj_points(pair_.file("out.obj"));
  }
  void expect_refusal(const ProgramResult& result, int exit_code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(pair_.has("out.obj"));
  }

  ExamplePair pair_;
};

TEST_F(ApplyCommand, KeepsFacesAndCountsTheBand) {
  const ProgramResult result = pair_.apply("map.vdb", {"-o", pair_.file("out.obj")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("729"));
  const std::string before = read_text(pair_.file("product.obj"));
  const std::string after = read_text(pair_.file("out.obj"));
  const auto lines_of_faces = [](const std::string& text) { return text.substr(text.find("\nf ")); };
  EXPECT_EQ(lines_of_faces(after), lines_of_faces(before));
}

TEST_F(ApplyCommand, AtTimeZeroIsTheIdentity) {
  EXPECT_EQ(largest_distance(applied({"--t", "0"}), product()), 0);
}

// A map is large from 64 MiB on, here for what it holds besides its grids.
TEST_F(ApplyCommand, ReadsOfALargeMapWhatTheProductAsksFor) {
  Asset asset = read_asset(pair_.file("map.vdb"));
  asset.exact_map.assign(std::size_t{1} << 26, 'e');
  write_asset(pair_.file("large.vdb"), asset);
  struct Variant {
    std::vector<std::string> options;
    bool is_in_part;
  };
  for (auto& [options, is_in_part] :
       std::vector<Variant>{{{"--frames", "2"}, true},
                            {{"--refine", "1%"}, true},
                            {{"--t", "1"}, true},
                            {{"--inverse"}, false},
                            {{"--untrusted"}, false},
                            {{"--order", "moving-point", "--t", "0.5"}, false}}) {
    const std::string output = pair_.file(options.front() == "--frames" ? "out_002.obj" : "out.obj");
    const std::string name = options.front();
    options.insert(options.end(), {"-o", pair_.file("out.obj")});
    ASSERT_EQ(pair_.apply("map.vdb", options).exit_code, 0) << name;
    const std::string expected = read_text(output);
    const ProgramResult result = pair_.apply("large.vdb", options);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(read_text(output), expected) << name;
    EXPECT_EQ(result.out.find(" MB read") != std::string::npos, is_in_part) << name << result.out;
  }
}

TEST_F(ApplyCommand, FramesAreTheSameAsSingleTimes) {
  ASSERT_EQ(pair_.apply("map.vdb", {"-o", pair_.file("frame.obj"), "--frames", "4"}).exit_code, 0);
  EXPECT_FALSE(pair_.has("frame.obj"));
  EXPECT_FALSE(pair_.has("frame_005.obj"));
  for (int k = 0; k <= 4; ++k) {
    const std::string frame = read_text(pair_.file("frame_00" + std::to_string(k) + ".obj"));
    applied({"--t", std::to_string(0.25 * k)});
    EXPECT_EQ(frame, read_text(pair_.file("out.obj"))) << k;
  }
}

TEST_F(ApplyCommand, ReachesTheSameEndOnEveryPathAndInEveryOrder) {
  const Points end = applied({});
  for (const std::string path : {"geodesic", "euler"})
    for (const std::string order : {"elastic-first", "rigid-first", "moving-point", "linear"})
      EXPECT_LE(largest_distance(applied({"--path", path, "--order", order}), end), 2 * float_rounding(end))
          << path << order;
}

TEST_F(ApplyCommand, TravelsAsThePathAndTheOrderSay) {
  const Points geodesic = applied({"--t", "0.5"});
  const double rounding = 2 * float_rounding(applied({}));
  EXPECT_GT(largest_distance(applied({"--t", "0.5", "--path", "euler"}), geodesic), rounding);
  EXPECT_GT(largest_distance(applied({"--t", "0.5", "--order", "rigid-first"}), geodesic), rounding);
  EXPECT_GT(largest_distance(applied({"--t", "0.5", "--order", "moving-point"}), geodesic), rounding);
  // Eq. of Fig. 1: half-way on straight lines.
  const Points half = 0.5 * (product() + applied({}));
  EXPECT_LE(largest_distance(applied({"--t", "0.5", "--order", "linear"}), half), rounding);
  expect_refusal((std::filesystem::remove(pair_.file("out.obj")),
                  pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--order", "reverse"})),
                 1, "reverse");
}

TEST_F(ApplyCommand, ExactOfABakedMapDiffersByTheMeasuredError) {
  const ProgramResult fit = pair_.fit("map.vdb", {"--strict", "--keep-exact"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const ProgramResult info = bespoke({"info", pair_.file("map.vdb"), "--json"});
  const double tolerance = json::parse(info.out)["tolerance"];
  const Points baked = applied({});
  const double difference = largest_distance(baked, applied({"--exact"}));
  EXPECT_LE(difference, tolerance + 2 * float_rounding(baked));
  EXPECT_GT(difference, 2 * float_rounding(baked));
}

TEST_F(ApplyCommand, ExactIsWhatIsStoredOfTheMapOfLeastDistortion) {
  const Points baked = applied({});
  EXPECT_LE(largest_distance(baked, applied({"--exact"})), 2 * float_rounding(baked));
}

TEST_F(ApplyCommand, ExactIsTheSameForEveryMethod) {
  for (const std::string elastic : {"finite-elements", "pffd-smooth", "multiscale", "diffeomorphic"}) {
    const ProgramResult fit = pair_.fit("map.vdb", {"--elastic", elastic, "--keep-exact", "--lambda", "20%"});
    ASSERT_EQ(fit.exit_code, 0) << fit.err;
    const double tolerance = json::parse(bespoke({"info", pair_.file("map.vdb"), "--json"}).out)["tolerance"];
    EXPECT_LE(largest_distance(applied({}), applied({"--exact"})), tolerance) << elastic;
  }
}

TEST_F(ApplyCommand, ExactNeedsTheStoredMap) {
  ASSERT_EQ(pair_.fit("plain.vdb").exit_code, 0);
  expect_refusal(pair_.apply("plain.vdb", {"-o", pair_.file("out.obj"), "--exact"}), 2, "--keep-exact");
}

TEST_F(ApplyCommand, WritesSeveralProductsIntoADirectory) {
  const ProgramResult result = bespoke({"apply", pair_.file("map.vdb"), pair_.file("product.obj"),
                                        pair_.file("source.obj"), "--out-dir", pair_.file("moved/here")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(pair_.has("moved/here/product.obj"));
  EXPECT_TRUE(pair_.has("moved/here/source.obj"));
}

TEST_F(ApplyCommand, CarriesGltfAsObj) {
  const Eigen::Matrix3Xf points = product().cast<float>();
  GltfScene scene;
  const auto bound = [](const Eigen::Vector3f& x) { return json{x[0], x[1], x[2]}; };
  scene.accessor(std::vector<float>(points.data(), points.data() + points.size()), "VEC3", 5126,
                 {{"min", bound(points.rowwise().minCoeff())}, {"max", bound(points.rowwise().maxCoeff())}});
  scene.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  scene.root["nodes"] = {
      {{"mesh", 0}, {"scale", {0.01, 0.01, 0.01}}}};  // a scene is in metres, the map in cm
  write_text(pair_.file("a.glb"), scene.glb());
  write_text(pair_.file("b.gltf"), scene.gltf("data.bin"));
  write_text(pair_.file("data.bin"), scene.data);
  const ProgramResult result = bespoke({"apply", pair_.file("map.vdb"), pair_.file("a.glb"),
                                        pair_.file("b.gltf"), "--out-dir", pair_.file("out")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const GlbContent out(read_text(pair_.file("out/a.glb")));
  EXPECT_EQ(read_text(pair_.file("out/b.bin")), out.data);
  const std::vector<float> carried = out.floats(0);
  const Points expected = applied({});
  const Points found = Eigen::Map<const Eigen::Matrix3Xf>(carried.data(), 3, expected.cols()).cast<double>();
  EXPECT_LE(largest_distance(found, expected), 4 * float_rounding(expected));
}

TEST_F(ApplyCommand, KeepsTheShapeOfAPart) {
  std::string text = read_text(pair_.file("product.obj"));
  write_text(pair_.file("product.obj"), text.insert(text.find("f "), "g lens\n"));
  const auto spread = [](const Points& x) -> Eigen::VectorXd {
    return (x.colwise() - x.rowwise().mean().eval()).colwise().norm();
  };
  const Eigen::VectorXd before = spread(product());
  EXPECT_LE((spread(applied({"--rigid", "lens"})) - before).cwiseAbs().maxCoeff(), 1e-5 * before.maxCoeff());
  const Eigen::VectorXd scaled = spread(applied({"--similar", "lens"}));
  const double scale = scaled.maxCoeff() / before.maxCoeff();
  EXPECT_GT(std::abs(scale - 1), 1e-3);
  EXPECT_LE((scaled - scale * before).cwiseAbs().maxCoeff(), 1e-5 * before.maxCoeff());
  applied({"--rigid", "lens", "--report", pair_.file("report.json")});
  const json part = json::parse(read_text(pair_.file("report.json")))["products"][0]["parts"][0];
  EXPECT_EQ(part["name"], "lens");
  EXPECT_EQ(part["points"], 729);
  EXPECT_GT(part["distance_from_map"]["max"], 0);
  std::filesystem::remove(pair_.file("out.obj"));
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--rigid", "glass"}), 2,
                 "its groups are lens");
}

TEST_F(ApplyCommand, SplitsEdgesThatTheMapBends) {
  const auto report = [&] {
    return json::parse(read_text(pair_.file("report.json")))["products"][0]["chord_error"];
  };
  applied({"--report", pair_.file("report.json")});
  const double error = report()["length"];
  EXPECT_GT(error, 0);
  EXPECT_EQ(report()["splits"], 0);
  const Points refined =
      applied({"--refine", std::to_string(error / 3), "--report", pair_.file("report.json")});
  EXPECT_LE(report()["length"], error / 3);
  EXPECT_EQ(refined.cols(), product().cols() + report()["splits"].get<Eigen::Index>());
  EXPECT_LE(largest_distance(refined.leftCols(product().cols()), applied({})), 2 * float_rounding(refined));
}

TEST_F(ApplyCommand, NeedsOneOfTheTwoOutputs) {
  expect_refusal(pair_.apply("map.vdb"), 1, "--out-dir");
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--out-dir", pair_.file("moved")}), 1,
                 "--out-dir");
  expect_refusal(bespoke({"apply", pair_.file("map.vdb"), pair_.file("product.obj"), pair_.file("source.obj"),
                          "-o", pair_.file("out.obj")}),
                 1, "2 are given");
}

TEST_F(ApplyCommand, RefusesTwoProductsOfOneName) {
  std::filesystem::create_directory(pair_.file("other"));
  std::filesystem::copy(pair_.file("product.obj"), pair_.file("other/product.obj"));
  expect_refusal(bespoke({"apply", pair_.file("map.vdb"), pair_.file("product.obj"),
                          pair_.file("other/product.obj"), "--out-dir", pair_.file("moved")}),
                 1, "twice");
}

TEST_F(ApplyCommand, DoesNotOverwriteTheProduct) {
  const std::string before = read_text(pair_.file("product.obj"));
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("product.obj")}), 1, "overwritten");
  expect_refusal(pair_.apply("map.vdb", {"--out-dir", pair_.file(".")}), 1, "overwritten");
  EXPECT_EQ(read_text(pair_.file("product.obj")), before);
}

TEST_F(ApplyCommand, RefusesBadTimesAndFrames) {
  for (const std::string t : {"nan", "inf", "half"})
    expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--t", t}), 1, t);
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--frames", "0"}), 1, "--frames");
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--frames", "2", "--t", "1"}), 1,
                 "--t");
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "--exact", "--inverse"}), 1, "--exact");
}

TEST_F(ApplyCommand, ReportsCountsAndMemory) {
  applied({"--report", pair_.file("report.json")});
  const json report = json::parse(read_text(pair_.file("report.json")));
  const json& entry = report["products"][0];
  EXPECT_EQ(entry["name"], "product.obj");
  EXPECT_EQ(entry["points"], 729);
  EXPECT_EQ(entry["in_band"].get<int>() + entry["affine_only"].get<int>(), 729);
  EXPECT_GT(entry["in_band"], 0);
  EXPECT_GT(entry["affine_only"], 0);
  EXPECT_GT(report["peak_memory"], 1000000);
}

TEST_F(ApplyCommand, ChecksUntrustedAssetsInAChild) {
  const Points trusted = applied({});
  EXPECT_EQ(largest_distance(applied({"--untrusted"}), trusted), 0);
}

TEST_F(ApplyCommand, GivesTheSameOnAnyNumberOfThreads) {
  const Points one = applied({"--threads", "1"});
  EXPECT_EQ(largest_distance(applied({"--threads", "8"}), one), 0);
}

TEST_F(ApplyCommand, SaysNothingWhenQuiet) {
  const ProgramResult result = pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), "-q"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(ApplyCommand, RejectsADamagedAsset) {
  std::string bytes = read_text(pair_.file("map.vdb"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(pair_.file("map.vdb"), bytes);
  for (const std::string mode : {"--quiet", "--untrusted"})
    expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.obj"), mode}), 2, "map.vdb");
}

TEST_F(ApplyCommand, NamesTheFileAtFault) {
  expect_refusal(pair_.apply("none.vdb", {"-o", pair_.file("out.obj")}), 4, "none.vdb");
  expect_refusal(
      bespoke({"apply", pair_.file("map.vdb"), pair_.file("none.obj"), "-o", pair_.file("out.obj")}), 4,
      "none.obj");
  write_text(pair_.file("empty.obj"), "# nothing\n");
  expect_refusal(
      bespoke({"apply", pair_.file("map.vdb"), pair_.file("empty.obj"), "-o", pair_.file("out.obj")}), 2,
      "empty.obj");
  write_text(pair_.file("nan.obj"), "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refusal(
      bespoke({"apply", pair_.file("map.vdb"), pair_.file("nan.obj"), "-o", pair_.file("out.obj")}), 2,
      "nan.obj");
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("out.step")}), 1, "out.step");
  expect_refusal(pair_.apply("map.vdb", {"-o", pair_.file("no/out.obj")}), 4, "no");
}

TEST_F(ApplyCommand, LeavesNoneOfSeveralOutputsWhenOneFails) {
  write_text(pair_.file("broken.obj"), "v 0 0\n");
  const ProgramResult result = bespoke({"apply", pair_.file("map.vdb"), pair_.file("product.obj"),
                                        pair_.file("broken.obj"), "--out-dir", pair_.file("moved")});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_FALSE(pair_.has("moved/product.obj"));
}

}  // namespace
}  // namespace bespoke::test

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bespoke/product/mesh_io.h"
#include "support/run_program.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path cases = fs::path(BESPOKE_SHARED_DIR) / "cases";

/// What is recorded of a pair, by its name; null where nothing is.
Json recorded(const std::string& id) {
  const Json all = Json::parse(std::ifstream(BESPOKE_SOURCE_DIR "/tests/accuracy/recorded.json"));
  for (const Json& pair : all["pairs"])
    if (pair["id"] == id) return pair;
  return nullptr;
}

/// To the three digits that are recorded.
double rounded(double value) { return std::round(1000 * value) / 1000; }

/// Between ranks, as the recorded figures of the other programs are.
double percentile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

/// A real pair whose true correspondence is known.
class SharedCase : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!fs::exists(cases)) GTEST_SKIP() << cases << " is absent";
    for (const fs::directory_entry& entry : fs::directory_iterator(cases))
      if (entry.path().filename().string().starts_with(GetParam())) folder_ = entry.path();
    ASSERT_FALSE(folder_.empty()) << GetParam();
    recorded_ = recorded(GetParam());
    ASSERT_FALSE(recorded_.is_null()) << "tests/accuracy/recorded.json has no pair " << GetParam();
  }

  /// Fits with these options, carries the source and compares it with the truth and with the figures `of`.
  void expect_as_recorded(const std::vector<std::string>& options, const Json& of) {
    const test::ScratchDirectory scratch;
    const std::string source_path = folder_ / "reference_a.obj";
    std::vector<std::string> fit = {BESPOKE_COMMAND,
                                    "fit",
                                    source_path,
                                    folder_ / "reference_b.obj",
                                    "--anchors",
                                    folder_ / "anchors.json",
                                    "-o",
                                    scratch / "map.vdb",
                                    "--quiet"};
    fit.insert(fit.end(), options.begin(), options.end());
    const test::ProgramResult fitted = test::run_program(fit);
    ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
    if (of.value("meets_tolerance", false)) {
      EXPECT_EQ(fitted.err.find("exceeds the tolerance"), std::string::npos) << fitted.err;
    }
    const test::ProgramResult applied =
        test::run_program({BESPOKE_COMMAND, "apply", scratch / "map.vdb", source_path, "-o",
                           scratch / "mapped.obj", "--quiet"});
    ASSERT_EQ(applied.exit_code, 0) << applied.err;

    const TriangleMesh source = read_triangle_mesh(source_path);
    const TriangleMesh mapped = read_triangle_mesh(scratch / "mapped.obj");
    const TriangleMesh truth{true_places(source.vertices.cols()), source.faces};
    const Eigen::VectorXd distances =
        (mapped.vertices - truth.vertices).colwise().norm() * (100 / diagonal(source.vertices));
    EXPECT_LE(rounded(distances.mean()), of["mean"].get<double>());
    EXPECT_LE(rounded(percentile({distances.begin(), distances.end()}, 0.95)), of["p95"].get<double>());
    EXPECT_LE(flipped(mapped, truth), of["flipped"].get<long>());
  }

  Points true_places(Eigen::Index count) const {
    Points places(3, count);
    std::ifstream file(folder_ / "gt_a_on_b.xyz");
    for (Eigen::Index i = 0; i < places.size(); ++i) file >> places(i);
    EXPECT_TRUE(file) << folder_;
    return places;
  }

  static long flipped(const TriangleMesh& mapped, const TriangleMesh& truth) {
    const Points normals = face_normals(mapped);
    const Points true_normals = face_normals(truth);
    return (normals.cwiseProduct(true_normals).colwise().sum().array() <= 0).count();
  }

  fs::path folder_;
  Json recorded_;
};

TEST_P(SharedCase, DefaultIsAsAccurateAsRecorded) { expect_as_recorded({}, recorded_["default"]); }

TEST_P(SharedCase, PaperIsAsAccurateAsRecorded) {
  expect_as_recorded({"--paper", "--lambda", "6.5%"}, recorded_["paper"]);
}

// The experiments with the method itself are no other programs.
TEST_P(SharedCase, BestOtherProgramIsRecorded) {
  const std::map<std::string, std::string> names = {{"amm_nrr", "AMM_NRR"},
                                                    {"bcpd", "BCPD"},
                                                    {"meshmonk", "MeshMonk"},
                                                    {"nricp_amberg", "trimesh"},
                                                    {"spare", "SPARE"}};
  const Json peers = Json::parse(std::ifstream(cases / "peers.json"))[folder_.filename()];
  for (const auto& [key, statistic] : {std::pair("best_mean", 0), std::pair("best_p95", 2)}) {
    std::string best;
    double least = INFINITY;
    for (const auto& [peer, name] : names) {
      if (!peers.contains(peer)) continue;
      const double value = peers[peer]["gt"][static_cast<std::size_t>(statistic)];
      if (value < least) best = name;
      least = std::min(least, value);
    }
    EXPECT_EQ(recorded_[key]["program"], best);
    EXPECT_NEAR(recorded_[key]["value"].get<double>(), least, 0.000501);  // three digits are recorded
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, SharedCase,
                         ::testing::Values("d00", "d01", "d02", "d03", "d04", "d05", "d06", "d07", "d08",
                                           "d10"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace bespoke

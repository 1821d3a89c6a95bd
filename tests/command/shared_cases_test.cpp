#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "bespoke/product/mesh_io.h"
#include "support/run_program.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path cases = fs::path(BESPOKE_SHARED_DIR) / "cases";

/// The accuracy table's columns, by their headings in the README.
constexpr const char* default_errors = "default: mean / p95";
constexpr const char* default_flips = "default: flipped faces";
constexpr const char* paper_errors = "`--paper`: mean / p95";
constexpr const char* paper_flips = "`--paper`: flipped faces";
constexpr const char* best_mean = "best other program by its mean";
constexpr const char* best_p95 = "best other program by its p95";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" *");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" *") + 1 - first);
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found;
  std::istringstream stream(line.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) found.push_back(trimmed(cell));
  return found;
}

/// Heading to cell of the row whose first cell begins with the case's id.
std::map<std::string, std::string> readme_row(const std::string& id) {
  std::ifstream readme(fs::path(BESPOKE_SOURCE_DIR) / "README.md");
  std::vector<std::string> headings;
  for (std::string line; std::getline(readme, line);) {
    if (line.starts_with("| reference pair |")) headings = cells(line);
    if (headings.empty() || !line.starts_with("| `" + id + "`")) continue;
    const std::vector<std::string> row = cells(line);
    std::map<std::string, std::string> result;
    for (std::size_t i = 0; i < std::min(row.size(), headings.size()); ++i) result[headings[i]] = row[i];
    return result;
  }
  return {};
}

/// Whether it is among "All but `d08` … meet their tolerance".
bool may_miss_its_tolerance(const std::string& id) {
  std::ifstream readme(fs::path(BESPOKE_SOURCE_DIR) / "README.md");
  const std::string text{std::istreambuf_iterator<char>(readme), {}};
  const std::size_t end = text.find("meet their tolerance");
  const std::size_t begin = text.rfind("All but", end);
  return begin < end && text.substr(begin, end - begin).find("`" + id + "`") != std::string::npos;
}

/// "0.115 / 0.484".
struct Errors {
  double mean = 0;
  double p95 = 0;
};

Errors errors_from(const std::string& cell) {
  Errors errors{NAN, NAN};
  std::sscanf(cell.c_str(), "%lf / %lf", &errors.mean, &errors.p95);
  return errors;
}

/// To the three digits of the table.
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
    row_ = readme_row(GetParam());
    ASSERT_FALSE(row_.empty()) << "the README's accuracy table has no row " << GetParam();
  }

  /// Fits with these options, carries the source and compares it with the truth and with the table.
  void expect_as_printed(const std::vector<std::string>& options, const char* errors_column,
                         const char* flips_column) {
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
    if (row_[errors_column].starts_with("no map")) {
      EXPECT_NE(fitted.exit_code, 0) << "there is a map now";
      return;
    }
    ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
    if (options.empty() && !may_miss_its_tolerance(GetParam())) {
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
    const Errors printed = errors_from(row_[errors_column]);
    EXPECT_LE(rounded(distances.mean()), printed.mean);
    EXPECT_LE(rounded(percentile({distances.begin(), distances.end()}, 0.95)), printed.p95);
    EXPECT_LE(flipped(mapped, truth), std::stol(row_[flips_column]));
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
  std::map<std::string, std::string> row_;
};

TEST_P(SharedCase, DefaultIsAsAccurateAsTheReadmeSays) {
  expect_as_printed({}, default_errors, default_flips);
}

TEST_P(SharedCase, PaperIsAsAccurateAsTheReadmeSays) {
  expect_as_printed({"--paper", "--lambda", "6.5%"}, paper_errors, paper_flips);
}

// The experiments with the method itself are no other programs.
TEST_P(SharedCase, ReadmeNamesTheBestOtherProgram) {
  const std::map<std::string, std::string> names = {{"amm_nrr", "AMM_NRR"},
                                                    {"bcpd", "BCPD"},
                                                    {"meshmonk", "MeshMonk"},
                                                    {"nricp_amberg", "trimesh"},
                                                    {"spare", "SPARE"}};
  const Json peers = Json::parse(std::ifstream(cases / "peers.json"))[folder_.filename()];
  for (const auto& [column, statistic] : {std::pair(best_mean, 0), std::pair(best_p95, 2)}) {
    std::string best;
    double least = INFINITY;
    for (const auto& [key, name] : names) {
      if (!peers.contains(key)) continue;
      const double value = peers[key]["gt"][static_cast<std::size_t>(statistic)];
      if (value < least) best = name;
      least = std::min(least, value);
    }
    char cell[40];
    std::snprintf(cell, sizeof cell, "%s %.3f", best.c_str(), least);
    EXPECT_EQ(row_[column], cell);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, SharedCase,
                         ::testing::Values("d00", "d01", "d02", "d03", "d04", "d05", "d06", "d07", "d08",
                                           "d10"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace bespoke

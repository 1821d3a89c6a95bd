#include "grade_sizes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/number_format.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

// Options of `fit` that the table cannot name, because `grade` does.
constexpr std::array keys_of_grade{"source", "output"};

double time_of(const std::string& text) {
  double t = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), t);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(t))
    throw InvalidInput("t \"" + text + "\" is no number");
  return t;
}

GradeSize size_of(const ManifestJob& row) {
  GradeSize size{row.line, row.command, {}, {}, {}, {}};
  if (size.name.empty() || fs::path(size.name).filename() != size.name || size.name == "." ||
      size.name == "..")
    throw InvalidInput("the size \"" + size.name + "\" cannot be the name of a folder");
  for (const ManifestEntry& entry : row.entries) {
    if (std::find(keys_of_grade.begin(), keys_of_grade.end(), entry.key) != keys_of_grade.end())
      throw InvalidInput("a table of sizes has no column \"" + entry.key + "\"; `grade` sets it");
    if (entry.key == "target")
      size.target = entry.values.front();
    else if (entry.key == "anchors")
      size.anchors = entry.values.front();
    else if (entry.key == "t")
      size.t = time_of(entry.values.front());
    else
      size.fit.push_back(entry);
  }
  if (size.target.empty()) throw InvalidInput("the size \"" + size.name + "\" has no target");
  return size;
}

/// What shapes the map of a size.
std::vector<std::string> map_key(const GradeSize& size) {
  std::vector<std::string> key{size.target, size.anchors};
  for (const ManifestEntry& entry : size.fit) {
    key.push_back(entry.key);
    key.insert(key.end(), entry.values.begin(), entry.values.end());
  }
  return key;
}

std::string digits(double value) { return format_number(value, 17); }

ManifestJob fit_job(const GradeRequest& request, const GradeSize& size) {
  ManifestJob job{size.line,
                  "fit",
                  {{"source", {request.source}}, {"target", {size.target}}, {"output", {size.map.string()}}}};
  if (!size.anchors.empty()) job.entries.push_back({"anchors", {size.anchors}});
  job.entries.insert(job.entries.end(), size.fit.begin(), size.fit.end());
  return job;
}

ManifestJob apply_job(const GradeRequest& request, const GradeSize& size) {
  ManifestJob job{size.line,
                  "apply",
                  {{"map", {size.map.string()}}, {"product", request.products}, {"t", {digits(size.t)}}}};
  job.entries.push_back({"out-dir", {folder(request, size).string()}});
  if (size.t == 1) {  // what the products are checked against
    job.entries.push_back({"source", {request.source}});
    job.entries.push_back({"target", {size.target}});
    if (request.clearance != "off") job.entries.push_back({"clearance", {request.clearance}});
    if (request.require_clear) job.entries.push_back({"require-clear", {"true"}, true});
  }
  if (const auto pose = pose_of(size)) job.entries.push_back({"pose", {*pose}});
  if (!request.rigid.empty()) job.entries.push_back({"rigid", request.rigid});
  if (!request.similar.empty()) job.entries.push_back({"similar", request.similar});
  return job;
}

}  // namespace

std::optional<std::string> pose_of(const GradeSize& size) {
  for (const ManifestEntry& entry : size.fit)
    if (entry.key == "pose" && !entry.values.empty()) return entry.values.front();
  return std::nullopt;
}

fs::path folder(const GradeRequest& request, const GradeSize& size) { return request.out_dir / size.name; }

GradeSizes sizes_of_table(const fs::path& table, const fs::path& out_dir) {
  Manifest rows = read_table(table, "size");
  GradeSizes found{{}, std::move(rows.faults)};
  std::map<std::vector<std::string>, fs::path> maps;
  std::set<std::string> names;
  for (const ManifestJob& row : rows.jobs) {
    try {
      GradeSize size = size_of(row);
      if (!names.insert(size.name).second) throw InvalidInput("a second size \"" + size.name + "\"");
      size.map = maps.try_emplace(map_key(size), out_dir / size.name / "map.vdb").first->second;
      found.sizes.push_back(std::move(size));
    } catch (const InvalidInput& error) {
      found.faults.push_back({row.line, error.what()});
    }
  }
  if (found.sizes.empty() && found.faults.empty()) throw InvalidInput(table.string() + ": holds no size");
  return found;
}

GradeSizes sizes_between(const std::string& target, const std::string& anchors, int count,
                         const fs::path& out_dir) {
  GradeSizes found;
  const int last = count + 1;
  for (int k = 1; k <= last; ++k)
    found.sizes.push_back({0,
                           std::to_string(k) + "_of_" + std::to_string(last),
                           target,
                           anchors,
                           {},
                           out_dir / "map.vdb",
                           static_cast<double>(k) / last});
  return found;
}

Manifest grade_manifest(const GradeRequest& request, const GradeSizes& sizes) {
  Manifest manifest{{}, sizes.faults};
  std::set<fs::path> fitted;
  for (const GradeSize& size : sizes.sizes) {
    if (fitted.insert(size.map).second) manifest.jobs.push_back(fit_job(request, size));
    if (!request.products.empty()) manifest.jobs.push_back(apply_job(request, size));
  }
  return manifest;
}

}  // namespace bespoke::command

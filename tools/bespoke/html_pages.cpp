#include "html_pages.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "bespoke/catalog/map_index.h"
#include "bespoke/error.h"
#include "bespoke/page/carried_picture.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/product/product_io.h"
#include "output_files.h"
#include "page_output.h"
#include "planned_run.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

constexpr int picture_pixels = 320;  // shown at half of it, sharp on dense screens

std::vector<std::string> values_of(const ManifestJob& line, const std::string& key) {
  for (const ManifestEntry& entry : line.entries)
    if (entry.key == key) return entry.values;
  return {};
}

std::string value_of(const ManifestJob& line, const std::string& key) {
  const std::vector<std::string> values = values_of(line, key);
  return values.empty() ? "" : values.front();
}

/// ../maps/anna.vdb is "maps_anna"; a second one of that name, "maps_anna_2".
std::string name_of(const fs::path& map, std::set<std::string>& names) {
  std::string first;
  for (const fs::path& part : fs::path(map).replace_extension().relative_path().lexically_normal())
    if (part != "..") first += (first.empty() ? "" : "_") + part.string();
  std::string name = first;
  for (int i = 2; !names.insert(name).second; ++i) name = first + "_" + std::to_string(i);
  return name;
}

std::vector<TriangleMesh> meshes_of(const std::vector<std::string>& products) {
  std::vector<TriangleMesh> meshes;
  for (const std::string& path : products) {
    const Product product = read_product(path);
    meshes.push_back({product.vertices, triangulated(product)});
  }
  return meshes;
}

std::vector<std::string> file_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) names.push_back(fs::path(path).filename().string());
  return names;
}

std::vector<JobFile> inputs_of(const ShownMap& shown) {
  std::vector<JobFile> inputs{{"map", shown.map}, {"source", shown.source}, {"target", shown.target}};
  for (const std::string& product : shown.products) inputs.push_back({"product", product});
  return inputs;
}

}  // namespace

std::vector<ShownMap> fitted_maps(const Manifest& manifest) {
  std::vector<ShownMap> shown;
  std::map<fs::path, std::size_t> row_of;
  std::set<std::string> names;
  for (const ManifestJob& line : manifest.jobs) {
    const std::string map = value_of(line, "output");
    if (line.command != "fit" || map.empty()) continue;
    row_of.try_emplace(fs::path(map).lexically_normal(), shown.size());
    shown.push_back({line.line,
                     name_of(map, names),
                     map,
                     value_of(line, "source"),
                     value_of(line, "target"),
                     {},
                     value_of(line, "confidence-out"),
                     value_of(line, "report"),
                     1});
  }
  for (const ManifestJob& line : manifest.jobs) {
    const auto row = row_of.find(fs::path(value_of(line, "map")).lexically_normal());
    const bool goes_there = line.command == "apply" && values_of(line, "inverse").empty();
    if (!goes_there || row == row_of.end()) continue;
    std::vector<std::string>& products = shown[row->second].products;
    for (std::string& product : values_of(line, "product"))
      if (std::find(products.begin(), products.end(), product) == products.end())
        products.push_back(std::move(product));
  }
  return shown;
}

HtmlPages::HtmlPages(fs::path directory, std::vector<ShownMap> maps)
    : directory_(std::move(directory)), maps_(std::move(maps)) {
  require_pages();
  if (fs::exists(directory_) && !fs::is_directory(directory_))
    throw FileError(directory_.string() + ": is no directory");
}

std::vector<ManifestJob> HtmlPages::page_lines() const {
  std::vector<ManifestJob> lines;
  std::set<fs::path> pages;
  for (const ShownMap& shown : maps_) {
    if (!pages.insert(page(shown)).second) continue;
    ManifestJob line{shown.line, "view", {}};
    line.entries = {{"map", {shown.map}},
                    {"source", {shown.source}},
                    {"target", {shown.target}},
                    {"output", {page(shown).string()}}};
    if (!shown.products.empty()) line.entries.push_back({"product", shown.products});
    if (!shown.confidence.empty()) line.entries.push_back({"confidence", {shown.confidence}});
    if (!shown.fit_report.empty()) line.entries.push_back({"fit-report", {shown.fit_report}});
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<BatchJob> HtmlPages::picture_jobs(OpenedMaps& maps) const {
  std::vector<BatchJob> jobs;
  for (const ShownMap& shown : maps_) {
    BatchJob job;
    job.line = shown.line;
    job.command = "picture";
    job.options = {{"t", std::to_string(shown.t)}};
    job.inputs = inputs_of(shown);
    job.outputs = {{"output", picture(shown)}};
    job.shared_map = shown.map;
    job.run = [this, shown, &maps](const Progress&) {
      write_picture(shown, *maps.open(shown.map, MapForm::grids, {}));
      return JobFindings{};
    };
    jobs.push_back(std::move(job));
  }
  return jobs;
}

void HtmlPages::make_directory() const {
  std::error_code error;
  fs::create_directories(directory_, error);
  if (error) throw FileError(directory_.string() + ": cannot be made: " + error.message());
}

void HtmlPages::write_picture(const ShownMap& shown, const OpenedMap& map) const {
  const TriangleMesh source = read_triangle_mesh(shown.source), target = read_triangle_mesh(shown.target);
  const std::vector<TriangleMesh> products = meshes_of(shown.products);
  OutputFiles files;
  files.write_text(
      picture(shown),
      carried_picture({*map.elastic, map.target_from_source, {map.path}, shown.t, source, target, products},
                      picture_pixels));
  files.keep();
}

void HtmlPages::write_index() const {
  std::vector<MapIndexRow> rows;
  std::vector<std::string> missing;
  for (const ShownMap& shown : maps_) {
    if (!fs::exists(shown.map) || !fs::exists(page(shown)) || !fs::exists(picture(shown))) {
      missing.push_back(shown.name);
      continue;
    }
    CatalogEntry entry = catalog_entry(shown.map);
    entry.file = fs::proximate(shown.map, directory_).generic_string();
    rows.push_back({shown.name, shown.t, std::move(entry), page(shown).filename().string(),
                    picture(shown).filename().string(), file_names(shown.products)});
  }
  OutputFiles files;
  files.write_text(index(), map_index(rows, missing));
  files.keep();
}

bool HtmlPages::has_index() const { return fs::exists(index()); }

fs::path HtmlPages::page(const ShownMap& shown) const {
  const auto first =
      std::find_if(maps_.begin(), maps_.end(), [&](const ShownMap& other) { return other.map == shown.map; });
  return directory_ / ((first == maps_.end() ? shown : *first).name + ".html");
}

fs::path HtmlPages::picture(const ShownMap& shown) const { return directory_ / (shown.name + ".png"); }

fs::path HtmlPages::index() const { return directory_ / "index.html"; }

}  // namespace bespoke::command

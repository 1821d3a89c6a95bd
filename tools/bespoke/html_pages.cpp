#include "html_pages.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "bespoke/atomic_file.h"
#include "bespoke/catalog/map_index.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/page/carried_picture.h"
#include "bespoke/parallel.h"
#include "map_models.h"
#include "output_files.h"
#include "page_output.h"

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

/// ../maps/anna.vdb is "maps_anna".
std::string name_of(const fs::path& map) {
  std::string name;
  for (const fs::path& part : fs::path(map).replace_extension().relative_path().lexically_normal())
    if (part != "..") name += (name.empty() ? "" : "_") + part.string();
  return name;
}

/// The name, or with a number behind it where it is taken.
std::string free_name(const std::string& name, std::set<std::string>& taken) {
  std::string free = name;
  for (int i = 2; !taken.insert(free).second; ++i) free = name + "_" + std::to_string(i);
  return free;
}

/// How a job carries its products.
ProductsAsWorn worn_by(const ManifestJob& line) {
  ProductsAsWorn worn{{}, value_of(line, "unit"), std::nullopt, {}};
  worn.pose = bespoke::value_of(model_poses, value_of(line, "pose"));
  if (const std::string distance = value_of(line, "clearance"); !distance.empty())
    worn.clearance.distance = distance;
  worn.clearance.layers = !values_of(line, "layers").empty();
  worn.files = values_of(line, "product");
  return worn;
}

/// The same for jobs that one page can show: their options and, where products are kept clear, which these
/// are, since they are kept from each other.
std::string wearing(const ProductsAsWorn& worn) {
  std::string text = "unit " + worn.unit + ", clearance " + worn.clearance.distance;
  if (worn.pose) text += ", pose " + std::string(name_of(model_poses, *worn.pose));
  if (worn.clearance.layers) text += ", layers";
  if (worn.clearance.is_used())
    for (const std::string& file : worn.files) text += "\n" + file;
  return text;
}

std::vector<std::string> file_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) names.push_back(fs::path(path).filename().string());
  return names;
}

std::vector<JobFile> inputs_of(const ShownMap& shown) {
  std::vector<JobFile> inputs{{"map", shown.map}, {"source", shown.source}, {"target", shown.target}};
  for (const std::string& product : shown.worn.files) inputs.push_back({"product", product});
  return inputs;
}

void add_worn(const ProductsAsWorn& worn, ManifestJob& line) {
  line.entries.push_back({"product", worn.files});
  if (!worn.unit.empty()) line.entries.push_back({"unit", {worn.unit}});
  if (worn.pose) line.entries.push_back({"pose", {std::string(name_of(model_poses, *worn.pose))}});
  if (worn.clearance.is_used()) line.entries.push_back({"clearance", {worn.clearance.distance}});
  if (worn.clearance.layers) line.entries.push_back({"layers", {"true"}, true});
}

/// Adds what a job carries to one of the rows of its map, or as a row more.
void add_products(ProductsAsWorn worn, std::vector<std::size_t>& rows, std::vector<ShownMap>& shown) {
  const auto is_free = [&](std::size_t row) {
    return shown[row].worn.files.empty() || wearing(shown[row].worn) == wearing(worn);
  };
  const auto row = std::find_if(rows.begin(), rows.end(), is_free);
  if (row == rows.end()) {
    ShownMap further = shown[rows.front()];
    further.worn = std::move(worn);
    rows.push_back(shown.size());
    shown.push_back(std::move(further));
    return;
  }
  std::vector<std::string> files = std::move(shown[*row].worn.files);
  for (std::string& file : worn.files)
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(std::move(file));
  worn.files = std::move(files);
  shown[*row].worn = std::move(worn);
}

}  // namespace

std::vector<ShownMap> fitted_maps(const Manifest& manifest) {
  std::vector<ShownMap> shown;
  std::map<fs::path, std::vector<std::size_t>> rows_of;
  for (const ManifestJob& line : manifest.jobs) {
    const std::string map = value_of(line, "output");
    if (line.command != "fit" || map.empty()) continue;
    rows_of.try_emplace(fs::path(map).lexically_normal(), std::vector{shown.size()});
    ShownMap row;
    row.line = line.line;
    row.name = name_of(map);
    row.map = map;
    row.source = value_of(line, "source");
    row.target = value_of(line, "target");
    row.confidence = value_of(line, "confidence-out");
    row.fit_report = value_of(line, "report");
    shown.push_back(std::move(row));
  }
  for (const ManifestJob& line : manifest.jobs) {
    const auto rows = rows_of.find(fs::path(value_of(line, "map")).lexically_normal());
    const bool goes_there = line.command == "apply" && values_of(line, "inverse").empty();
    if (goes_there && rows != rows_of.end()) add_products(worn_by(line), rows->second, shown);
  }
  return shown;
}

HtmlPages::HtmlPages(fs::path directory, const std::vector<ShownMap>& maps)
    : directory_(std::move(directory)), index_(directory_ / "index.html") {
  require_pages();
  if (fs::exists(directory_) && !fs::is_directory(directory_))
    throw FileError(directory_.string() + ": is no directory but a file; name another");
  std::map<std::string, fs::path> page_of;
  std::set<std::string> taken{"index"};
  for (const ShownMap& shown : maps) {
    const std::string name = free_name(shown.name, taken);
    const fs::path& page =
        page_of.try_emplace(shown.map + "\n" + wearing(shown.worn), directory_ / (name + ".html"))
            .first->second;
    rows_.push_back({shown, page, directory_ / (name + ".png")});
  }
}

std::vector<ManifestJob> HtmlPages::page_lines() const {
  std::vector<ManifestJob> lines;
  std::set<fs::path> pages;
  for (const Row& row : rows_) {
    if (!pages.insert(row.page).second) continue;
    const ShownMap& shown = row.shown;
    ManifestJob line{shown.line, "view", {}};
    line.entries = {{"map", {shown.map}},
                    {"source", {shown.source}},
                    {"target", {shown.target}},
                    {"output", {row.page.string()}}};
    if (!shown.worn.files.empty()) add_worn(shown.worn, line);
    if (!shown.confidence.empty()) line.entries.push_back({"confidence", {shown.confidence}});
    if (!shown.fit_report.empty()) line.entries.push_back({"fit-report", {shown.fit_report}});
    lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<BatchJob> HtmlPages::picture_jobs(OpenedMaps& maps) const {
  std::vector<BatchJob> jobs;
  for (const Row& row : rows_) {
    BatchJob job;
    job.line = row.shown.line;
    job.command = "picture";
    job.options = {{"t", format_number(row.shown.t, 17)}, {"worn", wearing(row.shown.worn)}};
    job.inputs = inputs_of(row.shown);
    job.outputs = {{"output", row.picture}};
    job.shared_map = row.shown.map;
    job.run = [&row, &maps](const Progress&) {
      write_picture(row, *maps.open(row.shown.map, MapForm::grids, {}));
      return JobFindings{};
    };
    jobs.push_back(std::move(job));
  }
  return jobs;
}

void HtmlPages::make_directory() const { make_directories(directory_); }

bool HtmlPages::has_index() const { return fs::exists(index_); }

void HtmlPages::write_index() const {
  std::vector<std::optional<MapIndexRow>> made(rows_.size());
  parallel_for(rows_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [shown, page, picture] = rows_[i];
      if (!fs::exists(shown.map) || !fs::exists(page) || !fs::exists(picture)) continue;
      CatalogEntry entry = catalog_entry(shown.map);
      entry.file = fs::proximate(shown.map, directory_).generic_string();
      made[i] = {shown.name,
                 shown.t,
                 std::move(entry),
                 page.filename().string(),
                 picture.filename().string(),
                 file_names(shown.worn.files)};
    }
  });
  std::vector<MapIndexRow> rows;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < made.size(); ++i)
    if (made[i])
      rows.push_back(std::move(*made[i]));
    else
      missing.push_back(rows_[i].shown.name);
  OutputFiles files;
  files.write_text(index_, map_index(rows, missing));
  files.keep();
}

void HtmlPages::write(const std::string& scene, const OpenedMap& map) const {
  make_directory();
  OutputFiles files;
  files.write_text(rows_.front().page, whole_page(scene));
  files.keep();
  write_picture(rows_.front(), map);
  write_index();
}

void HtmlPages::write_picture(const Row& row, const OpenedMap& map) {
  const TriangleMesh source = read_source(row.shown.source, map.unit, map.source_hash);
  const TriangleMesh target = read_target(row.shown.target, map.unit, map.target_hash).mesh;
  const ProductsAsWorn& worn = row.shown.worn;
  std::vector<NamedProduct> products;
  for (const std::string& path : worn.files)
    products.push_back(read_product_in(path, map.unit, worn.unit, worn.pose_or_shown()));
  std::vector<Points> cleared;
  if (row.shown.t == 1) cleared = corrected_products(worn, products, map).places;
  std::vector<TriangleMesh> meshes;
  for (NamedProduct& product : products) meshes.push_back(std::move(product.mesh));
  OutputFiles files;
  files.write_text(
      row.picture,
      carried_picture(
          {*map.elastic, map.target_from_source, {map.path}, row.shown.t, source, target, meshes, cleared},
          picture_pixels));
  files.keep();
}

}  // namespace bespoke::command

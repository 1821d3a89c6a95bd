#include "bespoke/catalog/catalog.h"

#include <algorithm>
#include <fstream>
#include <string_view>
#include <utility>
#include <variant>

#include "bespoke/error.h"
#include "bespoke/page/source_thumbnail.h"
#include "bespoke/parallel.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

constexpr int thumbnail_pixels = 96;

// Assets in memory at a time, at most: some tens of megabytes each.
constexpr std::size_t files_per_round = 8;

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with("."); }

std::vector<fs::path> vdb_files(const fs::path& directory) {
  if (!fs::is_directory(directory)) throw FileError(directory.string() + ": is no directory");
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator entry(directory, fs::directory_options::skip_permission_denied, error),
      end;
  for (; !error && entry != end; entry.increment(error)) {
    if (entry->is_directory() && is_hidden(entry->path())) entry.disable_recursion_pending();
    if (entry->is_regular_file() && entry->path().extension() == ".vdb" && !is_hidden(entry->path()))
      files.push_back(entry->path());
  }
  if (error) throw FileError(directory.string() + ": cannot be listed: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

CatalogEntry entry_of(const fs::path& path, const Asset& asset) {
  const Certificate certificate = whole_certificate(asset);
  CatalogEntry entry;
  entry.sha256 = sha256_of_file(path);
  entry.bytes = fs::file_size(path);
  entry.unit = asset.record.unit;
  entry.source = asset.record.source;
  entry.target = asset.record.target;
  entry.surface_fit = asset.record.surface_fit_method;
  entry.elastic = asset.record.elastic_method;
  entry.lambda = asset.record.lambda;
  entry.tolerance = asset.record.tolerance;
  entry.error_p99 = asset.record.bake_error.p99;
  entry.error_max = asset.record.bake_error.max;
  entry.bijection = certificate.is_bijection();
  entry.min_determinant = certificate.min_determinant;
  entry.undecided = certificate.undecided;
  entry.folded = certificate.folded;
  entry.steps = asset.steps.size();
  entry.voxels = voxel_count(asset);
  entry.anchors = asset.record.anchors.size();
  return entry;
}

/// Whether a file is OpenVDB's and says nothing in its head of being an asset: a volume of another program,
/// or an exported image. An asset that was cut short does say so.
bool is_other_volume(const fs::path& path) {
  constexpr std::string_view magic(" BDV\0\0\0\0", 8);
  constexpr std::string_view entry = "bespoke:format_version";
  std::string head(std::size_t{1} << 16, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.starts_with(magic) && head.find(entry) == std::string::npos;
}

using Indexed = std::variant<CatalogEntry, RefusedFile, std::string>;

Indexed index_file(const fs::path& path, const std::string& name, const ReadAssetOptions& options) {
  if (is_other_volume(path)) return name;
  try {
    const Asset asset = read_asset(path, options);
    CatalogEntry entry = entry_of(path, asset);
    entry.file = name;
    entry.thumbnail = source_thumbnail(asset, thumbnail_pixels);
    return entry;
  } catch (const Error& error) {
    // The catalogue may be moved with its directory: it does not say where that lay.
    std::string reason = error.what();
    if (reason.starts_with(path.string() + ": ")) reason.erase(0, path.string().size() + 2);
    return RefusedFile{name, reason};
  }
}

}  // namespace

CatalogEntry catalog_entry(const fs::path& path, const ReadAssetOptions& options) {
  return entry_of(path, read_asset(path, options));
}

Catalog index_assets(const fs::path& directory, const ReadAssetOptions& options, const Progress& progress) {
  const std::vector<fs::path> files = vdb_files(directory);
  std::vector<Indexed> indexed(files.size());
  for (std::size_t first = 0; first < files.size(); first += files_per_round) {
    progress.step("catalog", first, files.size());
    const std::size_t count = std::min(files_per_round, files.size() - first);
    parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i)
        indexed[i] = index_file(files[i], files[i].lexically_relative(directory).generic_string(), options);
    });
  }
  progress.step("catalog", files.size(), files.size());
  Catalog catalog;
  for (Indexed& file : indexed) {
    if (CatalogEntry* entry = std::get_if<CatalogEntry>(&file))
      catalog.assets.push_back(std::move(*entry));
    else if (RefusedFile* refused = std::get_if<RefusedFile>(&file))
      catalog.refused.push_back(std::move(*refused));
    else
      catalog.others.push_back(std::get<std::string>(std::move(file)));
  }
  return catalog;
}

}  // namespace bespoke

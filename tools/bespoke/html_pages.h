#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/manifest.h"
#include "bespoke/batch/opened_maps.h"
#include "corrected_products.h"

namespace bespoke::command {

/// A map that `--html` shows, as far as t, with what it carries.
struct ShownMap {
  std::size_t line = 0;  ///< of the manifest; 0: there is none
  std::string name;      ///< of its row; its files are called after it
  std::string map;
  std::string source;
  std::string target;
  ProductsAsWorn worn;
  std::string confidence;  ///< what the fit wrote beside the map; empty without
  std::string fit_report;
  double t = 1;
};

/// What a manifest fits, with the products that its other jobs carry by it, to the target: one for each way
/// in which they are worn.
std::vector<ShownMap> fitted_maps(const Manifest& manifest);

/// The directory of `--html`: a page for every map and way of wearing, a picture for every row, and an index
/// of them.
class HtmlPages {
 public:
  /// Throws FileError in a build without pages, and where `directory` is something else.
  HtmlPages(std::filesystem::path directory, const std::vector<ShownMap>& maps);

  /// The jobs that write the pages, as lines of a manifest.
  std::vector<ManifestJob> page_lines() const;

  /// The jobs that draw the pictures. This and `maps` must outlive them.
  std::vector<BatchJob> picture_jobs(OpenedMaps& maps) const;

  /// Makes the directory where there is none. Throws FileError.
  void make_directory() const;

  bool has_index() const;

  /// Writes the index over what has been made; names what has not.
  void write_index() const;

  /// All of it for a single map, whose page shows this scene.
  void write(const std::string& scene, const OpenedMap& map) const;

 private:
  struct Row {
    ShownMap shown;
    std::filesystem::path page;  ///< that of the first row of its map
    std::filesystem::path picture;
  };

  static void write_picture(const Row& row, const OpenedMap& map);

  std::filesystem::path directory_;
  std::filesystem::path index_;
  std::vector<Row> rows_;
};

}  // namespace bespoke::command

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/batch/manifest.h"

namespace bespoke::command {

/// What `grade` is given besides its sizes.
struct GradeRequest {
  std::string source;
  std::vector<std::string> products;
  std::vector<std::string> rigid, similar;  ///< parts, as for `apply`
  std::string clearance = "off";            ///< as for `apply`, of sizes that are targets
  bool require_clear = false;
  std::filesystem::path out_dir;
};

/// One size: what it is called, and how the source gets there.
struct GradeSize {
  std::size_t line = 0;  ///< of the table; 0: there is none
  std::string name;
  std::string target;              ///< the model that the map leads to
  std::string anchors;             ///< empty: none
  std::vector<ManifestEntry> fit;  ///< further options of the fit
  std::filesystem::path map;       ///< sizes of one target, anchors and options share it
  double t = 1;
};

/// Of skinned models, as the size's fit takes them: the value of its option "pose", if it has one.
std::optional<std::string> pose_of(const GradeSize& size);

struct GradeSizes {
  std::vector<GradeSize> sizes;
  std::vector<ManifestFault> faults;
};

/// Reads a table size,target[,anchors][,t] whose further columns are options of `fit`. A size's map lies in
/// its folder, or in that of the first size with the same target. Throws FileError; InvalidInput for a table
/// without sizes.
GradeSizes sizes_of_table(const std::filesystem::path& table, const std::filesystem::path& out_dir);

/// `count` sizes between source and target and the target itself, "1_of_4" … "4_of_4" for three between.
GradeSizes sizes_between(const std::string& target, const std::string& anchors, int count,
                         const std::filesystem::path& out_dir);

/// The folder of a size.
std::filesystem::path folder(const GradeRequest& request, const GradeSize& size);

/// The fits and applies of all sizes as jobs of a batch; with the faults of the sizes.
Manifest grade_manifest(const GradeRequest& request, const GradeSizes& sizes);

}  // namespace bespoke::command

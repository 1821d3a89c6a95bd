#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bespoke {

struct FittedMapping;

/// What a fit found at the source's vertices and does not store in the map.
struct FitFindings {
  struct Unmet {
    int vertex = 0;
    double residual = 0;  ///< mesh units
    std::string reason;
  };
  std::vector<double> confidence;           ///< of every vertex, 0 to 1; empty when not given
  std::optional<std::vector<Unmet>> unmet;  ///< empty when not given
};

/// What a fit that has just been made found.
FitFindings findings_of(const FittedMapping& fit);

/// One number a line, as `fit --confidence-out` writes it. Throws FileError, FormatError naming the line.
std::vector<double> read_confidence(const std::filesystem::path& path);

/// The vertices that the map misses, out of what `fit --report` wrote. Throws FileError, FormatError.
std::vector<FitFindings::Unmet> read_unmet_vertices(const std::filesystem::path& path);

}  // namespace bespoke

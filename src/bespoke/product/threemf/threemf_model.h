#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bespoke/product/threemf/zip_file.h"
#include "bespoke/types.h"

namespace bespoke {

/// Where an object is shown.
struct ThreemfPlace {
  std::string part;  ///< that holds the object; empty for the one that says so
  std::uint64_t object = 0;
  AffineMap to_outer;    ///< from the object's coordinates
  std::size_t line = 0;  ///< that says so
};

/// A mesh, or objects put together.
struct ThreemfObject {
  std::vector<double> coordinates;  ///< three a vertex, model units
  std::vector<int> corners;         ///< three a triangle
  std::vector<ThreemfPlace> components;
};

/// A part of a 3MF package that holds models (3MF Core Specification 1.3, and the paths of its Production
/// Extension).
struct ThreemfModel {
  std::string unit = "millimeter";
  std::map<std::uint64_t, ThreemfObject> objects;  ///< by their ids
  std::vector<ThreemfPlace> items;                 ///< of the build: what is shown
};

/// The name of the part that the package begins with, as its relationships say. Throws FormatError.
std::string root_part_of_3mf(const ZipFile& package);

/// Reads a part. Throws FormatError naming the part and the line at fault: XML that is none, a number or an
/// index that is none, an extension that changes shapes and is not known here.
ThreemfModel read_3mf_part(const ZipFile& package, const std::string& part);

/// What a 3MF file calls a unit ("millimeter" for "mm"). Throws InvalidInput for one that it has no name for.
std::string threemf_name_of_unit(const std::string& unit);

/// Its unit alone, of which only the beginning is read: "mm", "um", "cm", "m", "in" or "ft".
std::string unit_of_3mf(const InputFile& file);

}  // namespace bespoke

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "bespoke/exchange/morphing_mesh.h"

namespace bespoke {

struct GlbNotes {
  std::string name;                       ///< of the mesh
  std::optional<double> metres_per_unit;  ///< glTF is in metres: the node is scaled; 1 if unknown
  double seconds = seconds_of_morphing;
};

/// Writes a binary glTF file: triangles, morph targets named by their t, and an animation of their weights
/// that follows the pieces. Texture coordinates are kept; normals are recomputed for every target where the
/// product had some. The file appears whole or not at all, with the same bytes for the same mesh. Throws
/// FileError, and InvalidInput for more than 4 GiB, which the format cannot count.
void write_glb(const std::filesystem::path& path, const MorphingMesh& mesh, const GlbNotes& notes);

}  // namespace bespoke

#pragma once

#include <string>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A garment to pick seams on.
struct SeamInput {
  std::string path;          ///< as typed, for the command that the page shows
  const TriangleMesh& mesh;  ///< vertices as in its file
  std::string unit;          ///< that its format says; or empty
  std::string seams;         ///< text of a seam file that the work begins with; or empty
  std::string title;
  std::string command;  ///< that made the page, as one would type it
};

/// The scene of the page `seams` (README.md, "The scene"): the whole garment, however large, since seams run
/// along its edges. Throws InvalidInput for garments that are not valid, FormatError for seams that are no
/// JSON.
std::string seam_scene(const SeamInput& input);

}  // namespace bespoke

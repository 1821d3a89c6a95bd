#pragma once

#include <string>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/page/fit_findings.h"

namespace bespoke {

/// A place of the source that is worth a look.
struct Place {
  std::string kind;  ///< for instance "folded cells"
  std::string text;
  Vector3 at;  ///< source frame, mesh units
};

/// Folded cells, regions that miss the tolerance, vertices in cavities, stretched or unmet: the largest of
/// each kind first, vertices near each other (3 % of the source's diagonal) as one place, at most 100 a kind.
/// Folds of a later step stand where the source's vertex begins that this step has nearest to them. Throws
/// InvalidInput for vertices that the source does not have.
std::vector<Place> places_to_see(const Asset& asset, const TriangleMesh& source, const FitFindings& findings);

}  // namespace bespoke

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Where parts of a fitted surface that the source keeps apart touch or pass through each other, no map
/// without folds can follow: the space between them would have no volume left.
struct ContactOptions {
  double gap = 0;  ///< least distance to hold such parts apart, ≥ 0, mesh units; 0 leaves all as it is
  /// Parts nearer than this fraction of their distance on the source, were it as large as they are (growth,
  /// triangle_mesh.h), count as in contact. A quarter leaves
  /// lips and eyelids alone, which are as near on the source; not varied.
  double compression = 0.25;
  double reach = 0;         ///< deepest penetration that is looked for, ≥ gap, mesh units
  int max_iterations = 30;  ///< of separation
};

/// A vertex that gave up its place.
struct ReleasedVertex {
  int vertex = 0;
  Vector3 place = Vector3::Zero();  ///< where the surface fitting had placed it, mesh units
};

struct ContactSummary {
  std::vector<ReleasedVertex> released;  ///< by index
  std::size_t touching = 0;              ///< vertices in contact at first
  std::size_t left = 0;                  ///< vertices still in contact at the end
  double deepest = 0;  ///< largest penetration at first, mesh units; 0 where parts only touch
  int iterations = 0;
  double seconds = 0;
};

/// One line.
std::string to_string(const ContactSummary& summary);

/// A fitted surface whose parts were separated.
struct ContactFit {
  Points vertices;  ///< 3×n, mesh units
  ContactSummary summary;
};

/// Separates parts of a fitted surface (3×n, mesh units, the source's faces) where the target touches itself:
/// a vertex and the nearest point facing it are in contact if their signed distance is below the gap although
/// the source keeps them more than gap / compression apart. Each moves by half, vertices around follow
/// smoothly; the step with the fewest contacts is the result. Sheets back to back (an ear's sides) are no
/// contact. Throws InvalidInput for sizes that differ or options out of range, SolverError, Interrupted.
ContactFit separate_contacts(const TriangleMesh& source, const Points& fitted, const ContactOptions& options,
                             const Progress& progress = {});

}  // namespace bespoke

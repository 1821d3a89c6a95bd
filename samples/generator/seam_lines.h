#pragma once

#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/pattern/seam_file.h"
#include "solid.h"

namespace bespoke {

/// Where a product is cut: where `level` is 0 and `within` is positive (everywhere, if empty).
struct SeamLevel {
  std::string name;
  Field level;
  Field within = {};
};

/// A place that names the piece there, or the width across the grain.
struct SeamPoint {
  std::string name;
  Vector3 near;
};

struct SeamPlan {
  std::vector<SeamLevel> seams;
  std::vector<SeamPoint> pieces;
  std::vector<SeamPoint> widths;
};

/// The lines of the mesh where a level is 0, each of points on edges and of vertices that lie nearly on it;
/// closed ones end where they begin. Levels are straight within faces.
std::vector<std::vector<EdgePoint>> level_lines(const TriangleMesh& mesh, const SeamLevel& seam);

/// The plan of a product as `flatten --seams` reads it (seam_file.h).
std::string seam_file_text(const TriangleMesh& mesh, const SeamPlan& plan);

}  // namespace bespoke

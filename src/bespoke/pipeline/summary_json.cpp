#include "bespoke/pipeline/summary_json.h"

namespace bespoke {

Json to_json(const Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json to_json(const Matrix3& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) rows.push_back(to_json(Vector3(matrix.row(row).transpose())));
  return rows;
}

Json to_json(const Box& box) {
  return {{"min", to_json(Vector3(box.min()))}, {"max", to_json(Vector3(box.max()))}};
}

Json to_json(const Statistics& statistics) {
  return {{"count", statistics.count}, {"min", statistics.min}, {"median", statistics.median},
          {"p95", statistics.p95},     {"p99", statistics.p99}, {"max", statistics.max}};
}

Json to_json(const MeshFindings& findings) {
  return {{"vertices", findings.vertices},
          {"faces", findings.faces},
          {"components", findings.components},
          {"boundary_edges", findings.boundary_edges},
          {"non_manifold_edges", findings.non_manifold_edges},
          {"inconsistent_edges", findings.inconsistent_edges},
          {"degenerate_faces", findings.degenerate_faces},
          {"unreferenced_vertices", findings.unreferenced_vertices},
          {"duplicate_vertices", findings.duplicate_vertices}};
}

Json to_json(const BakeSummary& summary) {
  Json levels = Json::array();
  for (const BakeLevelSummary& level : summary.levels)
    levels.push_back({{"voxel_size", level.voxel_size}, {"leaves", level.leaves}, {"voxels", level.voxels}});
  return {{"levels", std::move(levels)},
          {"error", to_json(summary.error)},
          {"error_random_points", summary.error_random_points},
          {"error_surface_points", summary.error_surface_points},
          {"surface_cells", summary.surface_cells},
          {"tolerance_met", summary.tolerance_met},
          {"refined_folds", summary.refined_folds},
          {"repaired_cells", summary.repaired_cells},
          {"repair_cost", summary.repair_cost},
          {"folded_cells", summary.folded_cells},
          {"evaluated_points", summary.evaluated_points},
          {"peak_bytes", summary.peak_bytes}};
}

Json to_json(const Certificate& certificate) {
  Json places = Json::array();
  for (const FoldedCell& cell : certificate.places)
    places.push_back(
        {{"level", cell.level}, {"center", to_json(cell.center)}, {"determinant", cell.determinant}});
  return {{"bijection", certificate.is_bijection()},
          {"certified", certificate.certified},
          {"undecided", certificate.undecided},
          {"folded", certificate.folded},
          {"least_determinant", certificate.least_determinant},
          {"affine_determinant", certificate.affine_determinant},
          {"places", std::move(places)}};
}

}  // namespace bespoke

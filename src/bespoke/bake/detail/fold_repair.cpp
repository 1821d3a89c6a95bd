#include "bespoke/bake/detail/fold_repair.h"

#include <Eigen/LU>
#include <utility>
#include <vector>

#include "bespoke/bake/detail/repair.h"
#include "bespoke/certificate/certificate.h"

namespace bespoke {
namespace {

constexpr int rounds_of_refinement = 3;
// More are no isolated places: the map itself is too steep for its voxels there, and no local change repairs
// it.
constexpr std::size_t max_mendable_folds = 20'000;
// At the middle of a cell and at the corners of a cube of four voxels around it.
constexpr int probes = 9;

Points probes_around(const FoldedCell& cell, double voxel_size) {
  Points x(3, probes);
  x.col(0) = cell.center;
  for (int corner = 0; corner < 8; ++corner)
    x.col(1 + corner) = cell.center + 2 * voxel_size * (2 * as_vector(corner_step(corner)) - Vector3::Ones());
  return x;
}

// Cells that fold although the map itself keeps its orientation in and around them: finer leaves will repair
// them.
Points needless_folds(const ElasticMap& map, const Pyramid& pyramid, const std::vector<FoldedCell>& folds) {
  Points x(3, probes * static_cast<Eigen::Index>(folds.size()));
  for (std::size_t i = 0; i < folds.size(); ++i)
    x.middleCols<probes>(probes * static_cast<Eigen::Index>(i)) =
        probes_around(folds[i], pyramid.lattice(folds[i].level).voxel_size);
  const Points gradient = map.displacement_gradient(x);
  const auto keeps_orientation = [&](Eigen::Index at) {
    return (map.affine().linear + gradient.middleCols<3>(3 * at)).determinant() > 0;
  };
  std::vector<Eigen::Index> needless;
  for (Eigen::Index first = 0; first < x.cols(); first += probes) {
    bool upright = true;
    for (int probe = 0; probe < probes; ++probe) upright = upright && keeps_orientation(first + probe);
    if (upright) needless.push_back(first);
  }
  return x(Eigen::all, needless);
}

}  // namespace

void refine_folds(const ElasticMap& map, std::unique_ptr<PyramidBuilder>& builder, Bake& bake,
                  const Progress& progress) {
  bake.certificate = certify_listing_all(bake.pyramid, map.affine(), 1, progress);
  for (int round = 0; round < rounds_of_refinement; ++round) {
    const std::size_t folds = bake.certificate.places.size();
    if (folds > max_mendable_folds) break;
    const Points needless = needless_folds(map, bake.pyramid, bake.certificate.places);
    if (needless.cols() == 0) break;
    auto refined = std::make_unique<PyramidBuilder>(*builder);
    if (refined->refine_at(needless, PyramidBuilder::Purpose::reserved) == 0) break;
    refined->refine();
    Pyramid pyramid = refined->pyramid();
    Certificate certificate = certify_listing_all(pyramid, map.affine(), 1, progress);
    if (certificate.places.size() >= folds) break;
    bake.summary.refined_folds += folds - certificate.places.size();
    bake.pyramid = std::move(pyramid);
    bake.certificate = std::move(certificate);
    builder = std::move(refined);
  }
}

void repair_all_or_none(const ElasticMap& map, Bake& bake, const Progress& progress) {
  const std::vector<FoldedCell>& folds = bake.certificate.places;
  if (folds.empty() || folds.size() > max_mendable_folds) return;
  Pyramid repaired = bake.pyramid;
  const RepairSummary summary = repair_folds(repaired, map.affine(), folds, progress);
  if (summary.folded > 0) return;
  bake.summary.repaired_cells = folds.size();
  bake.summary.repair_cost = summary.largest_change;
  bake.pyramid = std::move(repaired);
  bake.certificate = certify(bake.pyramid, map.affine(), 1, progress);
}

}  // namespace bespoke

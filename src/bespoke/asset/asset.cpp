#include "bespoke/asset/asset.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/asset/grids/preview.h"
#include "bespoke/error.h"
#include "bespoke/lattice/atlas_map.h"
#include "bespoke/lattice/baked_map.h"

namespace bespoke {
namespace {

// Far above the rounding of any way to a rotation matrix, far below any rotation that is meant.
constexpr double rotation_tolerance = 1e-9;

// Of the sums of products of three entries, relative to the largest entry's cube.
constexpr double determinant_tolerance = 1e-12;

// Some four full turns of a limb. A file that claims more is damaged.
constexpr std::size_t max_steps = 100;

void require(bool holds, const std::string& what) {
  if (!holds) throw InvalidInput(what);
}

void require_magnitude(double value, const char* what) {
  require(std::isfinite(value) && value >= 0, std::string(what) + " is " + std::to_string(value));
}

void require_valid(const RigidTransform& rigid) {
  require(rigid.rotation.allFinite() && rigid.translation.allFinite(), "the rigid part is not finite");
  const double error = (rigid.rotation * rigid.rotation.transpose() - Matrix3::Identity()).norm();
  require(error < rotation_tolerance && rigid.rotation.determinant() > 0,
          "R is not a rotation: |R Rt - I| = " + std::to_string(error));
}

void require_valid(const ModelRecord& model, const std::string& what) {
  require(model.box.min().allFinite() && model.box.max().allFinite() && !model.box.isEmpty(),
          what + " bounding box is empty or not finite");
}

void require_valid(const AssetRecord& record) {
  require_magnitude(record.lambda, "lambda");
  require_magnitude(record.tolerance, "tolerance");
  for (const double value : {record.bake_error.min, record.bake_error.median, record.bake_error.p95,
                             record.bake_error.p99, record.bake_error.max})
    require_magnitude(value, "bake error");
  for (const AnchorRecord& anchor : record.anchors) {
    require(anchor.a.allFinite() && anchor.b.allFinite(), "anchor " + anchor.name + " is not finite");
    require(anchor.weight > 0, "anchor " + anchor.name + " has weight " + std::to_string(anchor.weight));
    require_magnitude(anchor.residual, "anchor residual");
    require_magnitude(anchor.sigma, "anchor sigma");
  }
  require_valid(record.source, "source");
  require_valid(record.target, "target");
}

/// Refuses a certificate of bijection that the stored step contradicts.
void require_consistent(const MapStep& step) {
  const Certificate& certificate = step.certificate;
  require(std::isfinite(certificate.min_determinant) && std::isfinite(certificate.affine_determinant),
          "the certificate's determinants are not finite");
  if (!certificate.is_bijection()) return;
  require(certificate.min_determinant > 0, "the certificate claims a bijection with least determinant " +
                                               std::to_string(certificate.min_determinant));
  require(step.pyramid.levels.empty() || certificate.certified > 0,
          "the certificate claims a bijection but no cell is certified");
  const double scale = step.affine.linear.cwiseAbs().maxCoeff();
  const double error = std::abs(certificate.affine_determinant - step.affine.linear.determinant());
  require(error <= determinant_tolerance * scale * scale * scale,
          "the certificate's affine determinant " + std::to_string(certificate.affine_determinant) +
              " is not that of the affine part");
}

void require_valid(const MapStep& step) {
  require(step.affine.linear.allFinite() && step.affine.offset.allFinite(), "the affine part is not finite");
  require_valid(step.pyramid);
  for (const PyramidLevel& level : step.pyramid.levels) require_storable(level.voxel_size, "pyramid");
  require_consistent(step);
}

}  // namespace

ElasticChain baked_chain(std::vector<MapStep> steps) {
  std::vector<std::shared_ptr<const ElasticMap>> maps;
  for (MapStep& step : steps)
    maps.push_back(std::make_shared<const BakedMap>(step.affine, std::move(step.pyramid)));
  return ElasticChain(std::move(maps));
}

ElasticChain loaded_chain(std::vector<MapStep> steps) {
  std::vector<std::shared_ptr<const ElasticMap>> maps;
  for (MapStep& step : steps) maps.push_back(loaded_map(step.affine, std::move(step.pyramid)));
  return ElasticChain(std::move(maps));
}

Certificate whole_certificate(const Asset& asset) {
  Certificate whole = asset.steps.front().certificate;
  for (std::size_t k = 1; k < asset.steps.size(); ++k) {
    const Certificate& step = asset.steps[k].certificate;
    whole.certified += step.certified;
    whole.undecided += step.undecided;
    whole.folded += step.folded;
    whole.min_determinant *= step.min_determinant;
    // Two reflections are none together, but neither step is a bijection.
    whole.affine_determinant = whole.affine_determinant > 0 && step.affine_determinant > 0
                                   ? whole.affine_determinant * step.affine_determinant
                                   : std::min(whole.affine_determinant, step.affine_determinant);
    whole.places.insert(whole.places.end(), step.places.begin(), step.places.end());
    whole.seconds += step.seconds;
  }
  return whole;
}

std::size_t voxel_count(const Asset& asset) {
  std::size_t count = 0;
  for (const MapStep& step : asset.steps) count += step.pyramid.voxel_count();
  return count;
}

void require_valid(const Asset& asset) {
  require_valid(asset.target_from_source);
  require(!asset.steps.empty(), "the map has no steps");
  require(asset.steps.size() <= max_steps,
          "the map has " + std::to_string(asset.steps.size()) + " steps, more than any chain needs");
  for (const MapStep& step : asset.steps) {
    require_valid(step);
    require(step.pyramid.precision == asset.steps.front().pyramid.precision,
            "the steps are not of one precision");
  }
  require_valid(asset.record);
}

namespace {

Asset with_grids(Asset asset, const Box& source_box, StoredGrid source_distance) {
  require_valid(asset);
  const ElasticChain baked = baked_chain(asset.steps);
  StoredGrid displacement = displacement_preview(asset, baked, source_box);
  StoredGrid jacobian = jacobian_preview(baked, displacement);
  std::vector<StoredGrid> grids;
  grids.push_back(std::move(displacement));
  grids.push_back(std::move(source_distance));
  grids.push_back(std::move(jacobian));
  asset.preview = std::make_shared<PreviewGrids>(std::move(grids));
  return asset;
}

}  // namespace

Asset with_preview(Asset asset, const TriangleMesh& source) {
  require_valid(source, "source");
  return with_grids(std::move(asset), bounding_box(source.vertices), source_distance_preview(source));
}

Asset with_preview_of(Asset asset, const Asset& original,
                      const std::function<Points(const Points&)>& map_back) {
  require(original.preview != nullptr, "the asset to take the source's distance from has no preview");
  const StoredGrid& distance = original.preview->grids()[1];
  const Box box = asset.record.source.box;
  return with_grids(std::move(asset), box, map_back ? carried_distance(distance, box, map_back) : distance);
}

}  // namespace bespoke

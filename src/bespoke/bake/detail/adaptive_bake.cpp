#include "bespoke/bake/detail/adaptive_bake.h"

#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "bespoke/bake/detail/face_turns.h"
#include "bespoke/bake/detail/fold_repair.h"
#include "bespoke/bake/detail/measurement.h"
#include "bespoke/bake/detail/pyramid_builder.h"
#include "bespoke/mapping/affine_map.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Places where a finished pyramid misses the tolerance are refined and it is measured anew: at a few points a
// cell, then at more, around those that missed it, and everywhere (tests/accuracy/tuning.md).
constexpr std::array<std::size_t, 2> points_of_quick_rounds = {1, 6};
constexpr int local_rounds = 6;
constexpr int full_rounds = 6;
// Where faces turn (FaceTurns).
constexpr int face_rounds = 8;
// A round that leaves more than this share of the points that missed the tolerance is the last: where voxels
// are as small as they get, the worst points stay however often they are found.
constexpr double max_left_by_a_round = 0.7;
// Leaves for folds have level boundaries of their own, at which the tolerance may be missed, and leaves for
// the tolerance may fold: so often they take turns.
constexpr int turns = 3;

class AdaptiveBake {
 public:
  AdaptiveBake(const ElasticMap& map, const BakeOptions& options, const Progress& progress)
      : map_(map),
        options_(options),
        progress_(progress),
        builder_(std::make_unique<PyramidBuilder>(
            map,
            RefinementOptions{
                options.tolerance, options.max_memory, options.precision, options.nodes, options.max_leaves,
                options.surface, options.downstream_map, power_of_two_scale(map.affine()),
                options.downstream_map ? power_of_two_scale(options.downstream_map->affine()) : 1},
            progress)),
        measurement_(map, builder_->coarsest(), builder_->band(), options, progress),
        face_turns_(map, options, builder_->min_voxel()) {}

  Bake run() && {
    refine();
    search();
    turn_faces_back(PyramidBuilder::Purpose::tolerance);
    measure();
    meet_tolerance();
    refine_all();
    summary().evaluated_points = builder_->evaluated_points();
    summary().peak_bytes = builder_->byte_count();
    summary().relaxed = builder_->relaxed();
    builder_.reset();
    repair();
    summary().misoriented_faces = face_turns_.misoriented_faces(result_.pyramid).size();
    keep_first_places(result_.certificate);
    return std::move(result_);
  }

 private:
  BakeSummary& summary() { return result_.summary; }

  void refine() {
    builder_->refine();
    result_.pyramid = builder_->pyramid();
    summary().refine_seconds += watch_.lap();
  }

  void search() {
    for (const std::size_t points : points_of_quick_rounds)
      if (measurement_.quickly(result_.pyramid, points) > options_.tolerance) refine_around_worst();
  }

  // As far as there are leaves. Returns whether anything was refined.
  bool turn_faces_back(PyramidBuilder::Purpose purpose) {
    bool refined = false;
    for (int round = 0; round < face_rounds; ++round) {
      const std::vector<Eigen::Index> turned = face_turns_.misoriented_faces(result_.pyramid);
      if (!refine_at(face_turns_.places(turned), purpose)) break;
      refined = true;
    }
    return refined;
  }

  void measure() {
    measurement_.fully(result_.pyramid, summary());
    summary().measure_seconds += watch_.lap();
  }

  // From the last measurement on. Returns whether anything was refined.
  bool meet_tolerance() {
    bool refined = false;
    for (int round = 1; round < full_rounds && summary().error.max > options_.tolerance; ++round) {
      if (!refine_around_worst()) break;
      refined = true;
      // Rounds that find ever new points just above the tolerance take more around them.
      if (round > 1) measurement_.widen_worst();
      measure();
    }
    return refined;
  }

  void refine_all() {
    refine_folds();
    const bool turned_back = turn_faces_back(PyramidBuilder::Purpose::reserved);
    const bool freed = builder_->free_reserve();
    if (freed) refine();
    if (freed || turned_back) {
      measure();
      refine_folds();
    }
    for (int turn = 0; turn < turns && meet_tolerance(); ++turn) refine_folds();
  }

  void refine_folds() {
    const std::size_t leaves = result_.pyramid.leaf_count();
    bespoke::refine_folds(map_, builder_, result_, progress_);
    summary().repair_seconds += watch_.lap();
    if (result_.pyramid.leaf_count() != leaves) measure();
  }

  void repair() {
    repair_all_or_none(map_, result_, progress_);
    summary().repair_seconds += watch_.lap();
    if (summary().repaired_cells > 0) measure();
  }

  // Around what a sample has found, until nothing more is. Returns whether anything was refined.
  bool refine_around_worst() {
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < local_rounds; ++round) {
      const auto worst = static_cast<double>(measurement_.worst().cols());
      if (worst == 0 || !(worst < max_left_by_a_round * before) ||
          !refine_at(measurement_.worst(), PyramidBuilder::Purpose::tolerance))
        return round > 0;
      before = worst;
      measurement_.near_worst(result_.pyramid);
    }
    return true;
  }

  bool refine_at(const Points& places, PyramidBuilder::Purpose purpose) {
    summary().measure_seconds += watch_.lap();
    const bool refined = places.cols() > 0 && builder_->refine_at(places, purpose) > 0;
    if (refined) refine();
    return refined;
  }

  const ElasticMap& map_;
  const BakeOptions& options_;
  const Progress& progress_;
  Stopwatch watch_;
  std::unique_ptr<PyramidBuilder> builder_;
  Measurement measurement_;
  FaceTurns face_turns_;
  Bake result_;
};

}  // namespace

Bake bake_adaptively(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  return AdaptiveBake(map, options, progress).run();
}

}  // namespace bespoke

#include "bespoke/apply/apply_to_product.h"

#include <algorithm>
#include <atomic>

#include "bespoke/apply/detail/refine_product.h"
#include "bespoke/apply/motion_jacobian.h"
#include "bespoke/apply/unit_check.h"
#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/product/carry_product.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// A file that is open and a block of text in memory each; further frames look up and read once more.
constexpr std::size_t frames_at_a_time = 16;

/// The files of the groups of frames that are done; gone with the object unless all are.
class Written {
 public:
  ~Written() {
    for (const std::filesystem::path& path : paths_) remove_written(path);
  }
  void add(const std::vector<std::filesystem::path>& paths) {
    paths_.insert(paths_.end(), paths.begin(), paths.end());
  }
  void keep() { paths_.clear(); }

 private:
  std::vector<std::filesystem::path> paths_;
};

/// A product's faces, and the parts of its vertices.
struct ReadProduct {
  Product product;
  VertexParts parts;
};

ReadProduct read(const std::filesystem::path& input, const ApplyToProductOptions& options) {
  ReadProduct read{read_product(input, options.pose), {}};
  if (!options.parts.empty())
    read.parts = parts_of_places(input, read.product.vertices,
                                 {options.parts, options.progress, nullptr, options.pose});
  return read;
}

RefinedProduct refined(const std::filesystem::path& input, const ImageOfPoints& image,
                       const ApplyToProductOptions& options) {
  ReadProduct found = read(input, options);
  try {
    return refine_product(std::move(found.product), image, *options.refine, std::move(found.parts));
  } catch (const InvalidInput& error) {
    throw InvalidInput(input.string() + ": " + error.what());
  }
}

void measure_chords(const std::filesystem::path& input, const ImageOfPoints& image,
                    const ApplyToProductOptions& options, ProductSummary& summary) {
  try {
    const ReadProduct found = read(input, options);
    summary.chord = worst_chord(found.product, image, found.parts);
  } catch (const FormatError& error) {
    summary.warnings.push_back(std::string("the chord error is not known: ") + error.what());
  }
}

}  // namespace

ProductSummary apply_to_product(const std::filesystem::path& input,
                                const std::vector<std::filesystem::path>& outputs, const ElasticMap& elastic,
                                const RigidTransform& target_from_source,
                                const ApplyToProductOptions& options) {
  const std::vector<double>& times = options.times;
  if (outputs.size() != times.size() || times.empty())
    throw InvalidInput(std::to_string(outputs.size()) + " outputs for " + std::to_string(times.size()) +
                       " times; the numbers must be equal, and not zero");
  const Stopwatch watch;
  ProductSummary summary;
  const ImageOfPoints last_image = image_at(elastic, target_from_source, times.back(), options.motion);
  std::optional<FaceSplits> splits;
  DegenerateFaces degenerate;  // of the file before its edges were split
  if (options.refine) {
    RefinedProduct found = refined(input, last_image, options);
    degenerate = found.product.degenerate;
    summary.chord = found.chord;
    summary.splits = found.splits.vertices.size();
    if (summary.splits > 0) splits = std::move(found.splits);
  }
  Written written;
  for (std::size_t begin = 0; begin < times.size(); begin += frames_at_a_time) {
    const std::size_t end = std::min(times.size(), begin + frames_at_a_time);
    const auto first = static_cast<std::ptrdiff_t>(begin), last = static_cast<std::ptrdiff_t>(end);
    const std::vector<double> own_times(times.begin() + first, times.begin() + last);
    std::atomic<std::size_t> points = 0, in_band = 0;
    PointMotion point_motion;
    point_motion.frames = own_times.size();
    point_motion.images = [&](const Points& x) {
      AppliedPoints applied = apply_mapping(elastic, target_from_source, x, own_times, options.motion);
      points += applied.summary.points;
      in_band += applied.summary.in_band;
      return std::move(applied.frames);
    };
    point_motion.images_elsewhere = [&](const Points& x) {
      return apply_mapping(elastic, target_from_source, x, own_times, options.motion).frames;
    };
    point_motion.jacobians = [&](const Points& x) {
      return motion_jacobian(elastic, target_from_source, x, own_times, options.motion);
    };
    std::string other_unit;
    point_motion.accept = [&] {
      if (options.model_box && in_band == 0 && can_read_product(input))
        other_unit = require_unit_of_map(input.string(), read_product(input, options.pose).vertices, elastic,
                                         *options.model_box);
    };
    const std::vector<std::filesystem::path> own_outputs(outputs.begin() + first, outputs.begin() + last);
    CarrySummary carried = carry_product(
        input, own_outputs, point_motion,
        {options.parts, options.progress, splits ? &*splits : nullptr, options.pose, options.skeleton});
    written.add(own_outputs);
    written.add(carried.companions);
    summary.companions.insert(summary.companions.end(), carried.companions.begin(), carried.companions.end());
    if (splits)
      std::replace(carried.warnings.begin(), carried.warnings.end(), to_string(carried.degenerate),
                   to_string(degenerate));
    summary.warnings = std::move(carried.warnings);
    if (!other_unit.empty()) summary.warnings.push_back(std::move(other_unit));
    summary.parts = std::move(carried.parts);
    summary.joints = carried.joints;
    summary.points.points = points;
    summary.points.in_band = in_band;
  }
  if (options.measure_chords && !options.refine) measure_chords(input, last_image, options, summary);
  written.keep();
  summary.points.affine_only = summary.points.points - summary.points.in_band;
  summary.points.seconds = watch.seconds();
  return summary;
}

}  // namespace bespoke

#include "bespoke/apply/convert_product.h"

#include <string>
#include <utility>

#include "bespoke/apply/detail/refine_product.h"
#include "bespoke/apply/unit_check.h"
#include "bespoke/error.h"
#include "bespoke/stopwatch.h"
#include "bespoke/strings.h"

namespace bespoke {

ProductSummary convert_product(const std::filesystem::path& input,
                               const std::vector<std::filesystem::path>& outputs, const ElasticMap& elastic,
                               const RigidTransform& target_from_source, const ConvertOptions& options) {
  const std::vector<double>& times = options.times;
  if (outputs.size() != times.size() || times.empty())
    throw InvalidInput(std::to_string(outputs.size()) + " outputs for " + std::to_string(times.size()) +
                       " times; the numbers must be equal, and not zero");
  const Stopwatch watch;
  Product product = read_product(input);
  std::string other_unit;
  if (options.model_box)
    other_unit = require_unit_of_map(input.string(), product.vertices, elastic, *options.model_box);
  if (!options.unit.empty()) product.unit = options.unit;
  ProductSummary summary;
  summary.warnings = {lower_ending(input) == ".3mf"
                          ? "only faces were kept, those of all placed objects as one: names, colours, "
                            "materials and settings were left out"
                          : "only faces and texture coordinates were kept"};
  if (!other_unit.empty()) summary.warnings.push_back(std::move(other_unit));
  if (product.degenerate.count > 0) summary.warnings.push_back(to_string(product.degenerate));
  if (product.unit.empty() && lower_ending(outputs.front()) == ".3mf")
    summary.warnings.emplace_back(
        "nothing says its unit, so that the 3MF file says millimetres; --unit names it");
  try {
    const ImageOfPoints image = image_at(elastic, target_from_source, times.back(), options.motion);
    if (options.refine) {
      RefinedProduct refined = refine_product(std::move(product), image, *options.refine);
      product = std::move(refined.product);
      summary.chord = refined.chord;
      summary.splits = refined.splits.vertices.size();
    } else if (options.measure_chords) {
      summary.chord = worst_chord(product, image);
    }
    AppliedPoints moved = apply_mapping(elastic, target_from_source, product.vertices, times, options.motion);
    summary.points = moved.summary;
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      product.vertices = std::move(moved.frames[k]);
      write_product(outputs[k], product);
    }
  } catch (const InvalidInput& error) {
    throw InvalidInput(input.string() + ": " + error.what());
  }
  summary.points.seconds = watch.seconds();
  return summary;
}

}  // namespace bespoke

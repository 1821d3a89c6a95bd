#include "apply_plan.h"

#include <algorithm>

#include "bespoke/output_stream.h"
#include "bespoke/product/carry_product.h"
#include "bespoke/product/product_io.h"
#include "bespoke/strings.h"
#include "bespoke/unknown_ending.h"
#include "commands.h"
#include "output_files.h"
#include "standard_output.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

/// OUT.obj itself, or OUT_000.obj … OUT_NNN.obj with --frames.
std::vector<fs::path> frame_paths(const fs::path& path, std::optional<int> frames) {
  if (!frames) return {path};
  const int digits = std::max<int>(3, static_cast<int>(std::to_string(*frames).size()));
  std::vector<fs::path> paths;
  for (int k = 0; k <= *frames; ++k) {
    std::string number = std::to_string(k);
    number.insert(0, static_cast<std::size_t>(digits) - number.size(), '0');
    fs::path frame = path;
    frame.replace_filename(path.stem().string() + "_" + number + path.extension().string());
    paths.push_back(std::move(frame));
  }
  return paths;
}

/// Whether the output says no kind of file: standard output, a pipe or a device.
bool takes_any_kind(const fs::path& output) {
  return is_standard_output(output) ||
         (is_stream(output) && !has_product_ending(output) && !can_write_product(output));
}

/// Whether the product keeps its kind of file, and so all that it holds; otherwise its faces are converted.
bool keeps_kind(const fs::path& product, const fs::path& output) {
  const bool is_carried_or_unknown = has_product_ending(output) || !can_write_product(output);
  return takes_any_kind(output) || (is_carried_or_unknown && lower_ending(product) == lower_ending(output));
}

/// Of points without edges, or of a kind whose edges are not split.
[[noreturn]] void refuse_refinement(const fs::path& product) {
  const std::string name = product.string();
  if (!has_product_ending(product))
    throw UnknownEnding("apply: " + name + " must end in " + product_endings() + conversion_advice(product));
  if (!can_read_product(product))
    throw CLI::ValidationError(
        "--refine", name + " holds points, which have no edges to split; carry it without --refine");
  throw CLI::ValidationError("--refine", "edges of " + name + " are split only where the output ends in " +
                                             written_product_endings());
}

/// To a kind of file that is carried but not written anew.
[[noreturn]] void refuse_conversion(const fs::path& product, const fs::path& output) {
  std::string endings = can_read_product(product) ? written_product_endings() : "";
  if (has_product_ending(product) && !can_write_product(product))
    endings = lower_ending(product) + (endings.empty() ? "" : ", or ") + endings;
  throw UnknownEnding("apply: " + product.string() + " cannot become " + lower_ending(output) +
                      ", which is written only from files that are " + lower_ending(output) +
                      " already; name an output that ends in " + endings);
}

void require_known_endings(const ApplyArguments& arguments, const fs::path& product, const fs::path& output) {
  const bool has_parts = !arguments.parts.rigid.empty() || !arguments.parts.similar.empty();
  if (is_carried(arguments, product, output)) {
    if (!has_product_ending(product))
      throw UnknownEnding("apply: " + product.string() + " must end in " + product_endings() +
                          conversion_advice(product));
    return;
  }
  if (keeps_kind(product, output) && !can_write_product(output)) refuse_refinement(product);
  const bool is_known = has_product_ending(product) || can_read_product(product);
  if (is_known && has_product_ending(output) && !can_write_product(output))
    refuse_conversion(product, output);
  if (has_parts)
    throw CLI::ValidationError(
        "apply",
        product.string() +
            ": parts keep their shape only in OBJ, PLY and glTF files that stay of their kind; carry "
            "it in a call without --rigid and --similar");
  require_mesh_ending("apply", output);
  if (!can_read_product(product))
    throw UnknownEnding("apply: " + product.string() + " must end in " + read_product_endings() +
                        conversion_advice(product));
}

/// Skins are known only in a glTF file that keeps its kind, and bound to another skeleton only as a .glb.
void require_known_rig(const ApplyArguments& arguments, const fs::path& product, const fs::path& output) {
  const bool is_stored = arguments.pose == ModelPose::stored;
  if (arguments.skeleton.empty() && !is_stored) return;
  const char* const option = is_stored ? "--pose stored" : "--skeleton";
  if (!keeps_kind(product, output))
    throw CLI::ValidationError(
        option, "is known only where the product keeps its kind of file: " + product.string() + " does not");
  if (arguments.skeleton.empty()) return;
  if (lower_ending(product) != ".glb")
    throw CLI::ValidationError(option, "binds products that end in .glb, which " + product.string() +
                                           " does not; convert it, for instance with Blender");
  if (arguments.frames)
    throw CLI::ValidationError(option, "binds a product where the map takes it, not at several times");
}

}  // namespace

bool is_carried(const ApplyArguments& arguments, const fs::path& product, const fs::path& output) {
  return keeps_kind(product, output) && (!arguments.refine || can_split_product(product));
}

std::vector<std::vector<fs::path>> plan_outputs(const ApplyArguments& arguments) {
  if (arguments.output.empty() == arguments.out_dir.empty())
    throw CLI::ValidationError("apply", "give either -o OUT or --out-dir DIR");
  if (!arguments.output.empty() && arguments.products.size() > 1)
    throw CLI::ValidationError("-o", "takes one product, but " + std::to_string(arguments.products.size()) +
                                         " are given; use --out-dir DIR");
  std::vector<std::vector<fs::path>> plan;
  for (const std::string& product : arguments.products) {
    const fs::path path = arguments.output.empty() ? arguments.out_dir / fs::path(product).filename()
                                                   : fs::path(arguments.output);
    if (arguments.frames && takes_any_kind(path))
      throw CLI::ValidationError("--frames",
                                 "writes several files, which " + path.string() + " is not; name a file");
    require_known_endings(arguments, product, path);
    require_known_rig(arguments, product, path);
    plan.push_back(frame_paths(path, arguments.frames));
  }
  return plan;
}

}  // namespace bespoke::command

#include "clearance_option.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <mutex>
#include <numeric>
#include <sstream>
#include <utility>

#include "bespoke/clearance/nesting.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/product_io.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

/// Products that jobs of a batch carry to many targets, each prepared once.
class PreparedProducts {
 public:
  WornProduct get(const fs::path& file, const std::vector<RigidPart>& parts, double scale, ModelPose pose) {
    std::string key =
        file.string() + "\n" + std::to_string(scale) + (pose == ModelPose::shown ? "" : " stored");
    for (const RigidPart& part : parts)
      key += "\n" + part.name + (part.motion == PartMotion::rigid ? "r" : "s");
    std::error_code error;
    const auto time = fs::last_write_time(file, error);
    const std::lock_guard lock(mutex_);
    const auto found = products_.find(key);
    if (!error && found != products_.end() && found->second.first == time) return found->second.second;
    if (products_.size() >= most_) products_.clear();
    WornProduct product = read_worn_product(file, parts, scale, pose);
    if (!error) products_.insert_or_assign(key, std::pair(time, product));
    return product;
  }

 private:
  static constexpr std::size_t most_ = 32;  // of ten thousand vertices: some 10 MB each
  std::mutex mutex_;
  std::map<std::string, std::pair<fs::file_time_type, WornProduct>> products_;
};

PreparedProducts& prepared_products() {
  static PreparedProducts products;
  return products;
}

std::string file_name(const std::string& path) { return fs::path(path).filename().string(); }

/// Of the two models as the map leads.
ModelSizes sizes_of(const OpenedMap& map) {
  ModelSizes sizes{map.source_diagonal, map.target_diagonal};
  const double around = map.model_box.diagonal().norm();
  if (around == sizes.target_diagonal && around != sizes.source_diagonal)
    std::swap(sizes.source_diagonal, sizes.target_diagonal);
  return sizes;
}

}  // namespace

void add_clearance_options(CLI::App& app, ClearanceOption& option) {
  app.add_option("--clearance", option.distance, std::string(clearance_help) + " (default: off)")
      ->type_name("keep|same|LENGTH|off");
  app.add_flag(
      "--layers", option.layers,
      "The products are layers, from the inside to the outside, in the order of the call: each keeps "
      "its order and its distance to those before it. Pairs that pass through each other on the "
      "source are listed and left (default: the order in which they lie over each other on the source)");
}

void add_require_clear(CLI::App& app, ClearanceOption& option) {
  app.add_flag("--require-clear", option.require_clear, require_clear_help);
}

void require_valid(const ClearanceOption& option) {
  if (option.is_used() && !parse_clearance(option.distance, {1, 1}))
    throw CLI::ValidationError(
        "--clearance", "is off, " + std::string(clearance_grammar) + "; not '" + option.distance + "'");
  if (!option.is_used() && (option.require_clear || option.layers))
    throw CLI::ValidationError(option.layers ? "--layers" : "--require-clear",
                               "needs --clearance: " + std::string(clearance_grammar));
}

std::vector<std::size_t> ClearanceKeeper::order(const std::vector<std::string>& products,
                                                const OpenedMap& map) {
  std::vector<std::size_t> order(products.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!option_.is_used() || products.size() < 2) return order;
  are_layers_ = true;
  if (!std::all_of(products.begin(), products.end(),
                   [](const std::string& name) { return can_read_product(name); }))
    return order;
  layer_order_ = LayerOrder{};
  for (const std::string& name : products) layer_order_->names.push_back(file_name(name));
  if (option_.layers) return order;
  std::vector<TriangleMesh> meshes;
  for (const std::string& name : products) meshes.push_back(worn(name, map.unit).prepared->mesh());
  const Nesting nesting = nesting_of(meshes, sizes_of(map).source_diagonal);
  const std::vector<std::string> names = layer_order_->names;
  layer_order_ = LayerOrder{{}, true, {}, nesting.is_circular};
  for (const std::size_t i : nesting.order) layer_order_->names.push_back(names[i]);
  for (const auto& [a, b] : nesting.interleaved) layer_order_->interleaved.emplace_back(names[a], names[b]);
  return nesting.order;
}

WornProduct ClearanceKeeper::worn(const std::string& product, const std::string& map_unit) const {
  return prepared_products().get(product, parts_of(parts_, product), product_scale(product, map_unit, unit_),
                                 pose_);
}

OpenedMap ClearanceKeeper::corrected(const std::string& product, const OpenedMap& map) {
  if (!option_.is_used()) return map;
  if (!can_read_product(product))
    throw InvalidInput(product +
                       ": is no kind of file whose vertices can be read for --clearance; carry it "
                       "without, or convert it to one that ends in " +
                       read_product_endings());
  const ModelSizes sizes = sizes_of(map);
  if (!clearer_)
    clearer_.emplace(parse_clearance(option_.distance, sizes).value(),
                     are_layers_ ? ProductClearer::Products::layers : ProductClearer::Products::alone);
  OpenedMap own = map;
  own.elastic = clearer_->corrected(worn(product, map.unit),
                                    {map.elastic, map.target_from_source, map.distances, sizes});
  return own;
}

Points ClearanceKeeper::carried(const std::string& product, const OpenedMap& map) const {
  return carried_vertices(worn(product, map.unit), *map.elastic, map.target_from_source);
}

std::optional<ProductClearance> ClearanceKeeper::last() const {
  if (!clearer_) return std::nullopt;
  return clearer_->found().back();
}

void ClearanceKeeper::require_clear() const {
  if (!option_.require_clear || !clearer_) return;
  std::string names;
  for (const ProductClearance& found : clearer_->found())
    if (!found.is_clear()) names += (names.empty() ? "" : ", ") + found.product;
  if (!names.empty())
    throw SolverError("not clear: " + names +
                      "; the lines above and the report say where. More anchors there, a smaller --clearance "
                      "or a looser product may help");
}

std::vector<RigidPart> parts_of(const PartsOfProducts& parts, const std::string& product) {
  const auto found = parts.find(product);
  return found == parts.end() ? std::vector<RigidPart>() : found->second;
}

std::string what_is_not_clear(const ClearanceSummary& summary) {
  std::string text = "not clear, although it was corrected: ";
  if (summary.after.breaches > 0)
    text += std::to_string(summary.after.breaches) + " samples are inside or short of their distance";
  if (!summary.passed_through.empty() || summary.new_self_intersections > 0)
    text += std::string(summary.after.breaches > 0 ? ", " : "") +
            "faces pass through each other that did not before";
  if (!summary.places.empty()) {
    const Vector3& worst = summary.places.front().place;
    text += ", the worst around " + format_number(worst, 3);
  }
  return text;
}

std::string to_string(const LayerOrder& order) {
  std::string text = "layers, from the inside to the outside: ";
  for (const std::string& name : order.names) text += (&name == &order.names.front() ? "" : ", ") + name;
  if (order.is_found) text += " (found on the source; --layers sets another order)";
  for (const auto& [a, b] : order.interleaved)
    text += "; neither of " + a + " and " + b + " lies over the other, so they keep the order of the call";
  return text;
}

void warn_of_layers(const RunContext& context, const LayerOrder& order) {
  if (order.is_circular)
    context.warn("no order of the layers is right: they lie over each other in a circle; " + to_string(order),
                 Entry::order_of_layers);
  else if (!order.interleaved.empty())
    context.warn("the order of the layers is not clear; " + to_string(order), Entry::order_of_layers);
}

void print_clearance(const std::string& output, const ProductClearance& clearance) {
  std::istringstream lines(to_string(clearance.summary));
  for (std::string line; std::getline(lines, line);) std::printf("%s: %s\n", output.c_str(), line.c_str());
  for (const LayerContact& contact : clearance.layers)
    std::printf("%s: %s\n", output.c_str(), to_string(contact).c_str());
}

}  // namespace bespoke::command

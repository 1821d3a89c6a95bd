#include "loaded_asset.h"

#include "bespoke/pipeline/open_map.h"

namespace bespoke::python {
namespace py = pybind11;
const ElasticMap& LoadedAsset::remembered(std::shared_ptr<const ElasticMap>& form,
                                          std::shared_ptr<const ElasticMap> (*make)(const Asset&)) {
  const std::lock_guard lock(making_);
  if (!form) form = make(asset_);
  return *form;
}

const ElasticMap& LoadedAsset::carrier() {
  return remembered(carrier_, [](const Asset& asset) -> std::shared_ptr<const ElasticMap> {
    return std::make_shared<ElasticChain>(loaded_chain(asset.steps));
  });
}

const ElasticMap& LoadedAsset::certified_map() {
  return remembered(certified_, [](const Asset& asset) -> std::shared_ptr<const ElasticMap> {
    return std::make_shared<ElasticChain>(baked_chain(asset.steps));
  });
}

Points LoadedAsset::preimages(const Points& y) {
  const ElasticMap& back = remembered(
      inverse_, [](const Asset& asset) { return inverse_map(asset.steps, asset.target_from_source); });
  return bespoke::inverse(asset_.target_from_source) * back(y);
}

std::pair<Points, Points> anchor_points(const AssetRecord& record) {
  const auto count = static_cast<Eigen::Index>(record.anchors.size());
  Points a(3, count), b(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    a.col(i) = record.anchors[static_cast<std::size_t>(i)].a;
    b.col(i) = record.anchors[static_cast<std::size_t>(i)].b;
  }
  return {a, b};
}

std::optional<Length> to_length(const py::object& value, const std::string& what, LengthRange range) {
  if (value.is_none()) return std::nullopt;
  const std::string text = py::str(value);
  const std::optional<Length> length = parse_length(text, range);
  if (!length)
    throw InvalidInput(what + " " + text + " is not a " +
                       (range == LengthRange::positive ? "positive" : "non-negative") +
                       " length; give mesh units (0.02) or a share of the diagonal ('10%')");
  return length;
}

}  // namespace bespoke::python

#include "loaded_asset.h"

#include "bespoke/certificate/inverse.h"
#include "bespoke/lattice/baked_map.h"

namespace bespoke::python {
namespace py = pybind11;
namespace {

/// The way back through the map's own cells.
std::shared_ptr<const ElasticMap> inverse_map(const Asset& asset) {
  if (!whole_certificate(asset).is_bijection())
    throw InvalidInput("the map is not certified as a bijection, so it has no inverse");
  std::vector<std::shared_ptr<const ElasticMap>> way_back;
  for (auto step = asset.steps.rbegin(); step != asset.steps.rend(); ++step) {
    const auto baked = std::make_shared<BakedMap>(step->affine, step->pyramid);
    // The inverse refers to the baked map, which therefore goes last.
    way_back.emplace_back(new InverseMap(*baked, asset.target_from_source),
                          [baked](const ElasticMap* map) { delete static_cast<const InverseMap*>(map); });
  }
  return std::make_shared<ElasticChain>(std::move(way_back));
}

}  // namespace

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
  const ElasticMap& back = remembered(inverse_, &inverse_map);
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

#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/apply/apply_points.h"
#include "bespoke/apply/apply_to_product.h"
#include "bespoke/apply/motion_jacobian.h"
#include "bespoke/asset/asset.h"
#include "bespoke/error.h"
#include "bespoke/length.h"
#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/report/report.h"
#include "numpy_points.h"

namespace bespoke::python {

/// An asset in memory, and the forms of its map that were requested. Thread-safe.
class LoadedAsset {
 public:
  explicit LoadedAsset(Asset asset) : asset_(std::move(asset)) {}

  const Asset& asset() const { return asset_; }

  /// E in its fastest form, for points and products.
  const ElasticMap& carrier();

  /// E as the certificate proves it.
  const ElasticMap& certified_map();

  /// Ψ(1)⁻¹ at the columns of y, 3×n, mesh units. Throws InvalidInput unless the map is certified as a
  /// bijection.
  Points preimages(const Points& y);

 private:
  const ElasticMap& remembered(std::shared_ptr<const ElasticMap>& form,
                               std::shared_ptr<const ElasticMap> (*make)(const Asset&));

  Asset asset_;
  std::mutex making_;
  std::shared_ptr<const ElasticMap> carrier_, certified_, inverse_;
};

/// 3×k each: the places of the recorded anchors.
std::pair<Points, Points> anchor_points(const AssetRecord& record);

/// None, a number or a text like "10%". Throws InvalidInput naming `what`.
std::optional<Length> to_length(const pybind11::object& value, const std::string& what,
                                LengthRange range = LengthRange::positive);

/// The value of a name in a table. Throws InvalidInput, listing the names.
template <class Table>
auto required(const Table& table, const std::string& name, const std::string& what) {
  const auto value = value_of(table, name);
  if (value) return *value;
  std::string known;
  for (const auto& row : table) known += (known.empty() ? "" : ", ") + std::string(row.name);
  throw InvalidInput(what + " '" + name + "' is none of: " + known);
}

}  // namespace bespoke::python

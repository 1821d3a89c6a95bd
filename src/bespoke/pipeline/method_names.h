#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "bespoke/error.h"
#include "bespoke/mapping/mapping.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/surface_fit/surface_fit_methods.h"

namespace bespoke {

/// What a value of an enumeration is called on the command line, in assets and in reports.
template <class Value>
struct Named {
  std::string_view name;
  Value value;
};

inline constexpr auto surface_fit_methods = [] {
  std::array<Named<SurfaceFitMethod>, surface_fits.size()> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = {surface_fits[i].name, surface_fits[i].value};
  return names;
}();

inline constexpr std::array boundary_rules{Named<BoundaryRule>{"auto", BoundaryRule::automatic},
                                           Named<BoundaryRule>{"free", BoundaryRule::free},
                                           Named<BoundaryRule>{"matched", BoundaryRule::matched}};

inline constexpr std::array elastic_methods{
    Named<ElasticMethod>{"csrbf", ElasticMethod::csrbf},
    Named<ElasticMethod>{"multiscale", ElasticMethod::multiscale},
    Named<ElasticMethod>{"diffeomorphic", ElasticMethod::diffeomorphic},
    Named<ElasticMethod>{"pffd", ElasticMethod::pffd}};

inline constexpr std::array rotation_paths{Named<RotationPath>{"geodesic", RotationPath::geodesic},
                                           Named<RotationPath>{"euler", RotationPath::euler}};

inline constexpr std::array mapping_orders{Named<MappingOrder>{"elastic-first", MappingOrder::elastic_first},
                                           Named<MappingOrder>{"rigid-first", MappingOrder::rigid_first},
                                           Named<MappingOrder>{"linear", MappingOrder::linear}};

template <class Value, std::size_t size>
constexpr std::string_view name_of(const std::array<Named<Value>, size>& names, Value value) {
  const auto named = std::find_if(names.begin(), names.end(),
                                  [&](const Named<Value>& entry) { return entry.value == value; });
  if (named == names.end()) throw InvalidInput("a value has no name in its table");
  return named->name;
}

template <class Value, std::size_t size>
constexpr std::optional<Value> value_of(const std::array<Named<Value>, size>& names, std::string_view name) {
  for (const Named<Value>& named : names)
    if (named.name == name) return named.value;
  return std::nullopt;
}

}  // namespace bespoke

#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "clearance_option.h"

namespace bespoke::command {

/// Parts of products that keep their shape, by name.
struct PartNames {
  std::vector<std::string> rigid, similar;
};

/// Adds --rigid and --similar.
void add_part_options(CLI::App& app, PartNames& names);

/// One product has all parts that are named; of several, each has those that its file knows. Throws
/// InvalidInput for a part that none of several has.
PartsOfProducts parts_of_products(const std::vector<std::string>& products, const PartNames& names,
                                  ModelPose pose);

}  // namespace bespoke::command

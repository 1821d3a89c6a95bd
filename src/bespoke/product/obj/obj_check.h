#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "bespoke/product/carry/product_file.h"
#include "bespoke/product/product_io.h"
#include "bespoke/product/text/number_text.h"
#include "bespoke/progress.h"
#include "bespoke/types.h"

namespace bespoke {

/// What an OBJ file holds.
struct ObjContent {
  std::array<std::uint64_t, 3> counts{};  ///< positions, texture coordinates, normals
  Box box;                                ///< of the positions
  CarriedDecimals position_decimals, normal_decimals;
  bool has_free_form = false;
  DegenerateFaces degenerate;

  static constexpr std::uint32_t unused = 0xffffffff;
  /// For every normal the first position, from 0, that a corner joins it with; empty without normals.
  std::vector<std::uint32_t> first_use;
  /// All others, as (normal, position), sorted.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> more_uses;
  std::size_t unused_normals = 0;
};

/// Reads and checks the whole file. Where no element names a normal and there are as many as positions, they
/// belong together in their order, as in point sets. Throws FormatError naming the first line at fault.
ObjContent check_obj_product(const InputFile& file, const Progress& progress);

}  // namespace bespoke

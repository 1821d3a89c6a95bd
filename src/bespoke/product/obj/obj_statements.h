#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "bespoke/product/text/text_blocks.h"
#include "bespoke/product/text/text_edits.h"

namespace bespoke {

enum class ObjStatement { position, texture, normal, face, line, point, free_form, other };

/// What a statement with this first word is. Free-form geometry (vp, curv, curv2, surf) is told apart because
/// its parameters are not carried.
ObjStatement obj_statement(std::string_view keyword);

inline constexpr LineSyntax obj_syntax{'#', true};

/// Counts positions, texture coordinates and normals.
void count_obj(std::string_view lines, std::array<std::uint64_t, 3>& sums);

/// "v", "v/t", "v//n" or "v/t/n", of which some programs leave parts empty ("v//", "v/t/"): numbers of
/// position, texture coordinate and normal from 1, or back from the last one read when negative; 0 where
/// there is none.
struct ObjCorner {
  std::array<long long, 3> index{};
  std::string_view normal;  ///< the characters of the normal's number
};

/// No value when the word is no corner.
std::optional<ObjCorner> read_corner(std::string_view word);

/// The words x, y, z behind the keyword.
NumberTriple read_triple(TextWords& words);

}  // namespace bespoke

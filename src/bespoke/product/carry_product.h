#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/product/point_motion.h"
#include "bespoke/progress.h"

namespace bespoke {

struct CarrySummary {
  std::size_t points = 0;             ///< positions that were carried
  std::size_t directions = 0;         ///< normals that were carried
  std::vector<std::string> warnings;  ///< what the file holds that was left as it is, a sentence each
};

/// Carries a product: writes the file `input` once for every frame of the motion, with positions and normals
/// moved and every other byte as it was. The ending of the input's name says what it is
/// (`product_endings`); the outputs are files of the same kind, one a frame.
///
/// A normal n becomes cof(J) n, as long as it was, with J the Jacobian at its vertex; an OBJ normal of
/// several vertices becomes several where these differ. Text is written with as many digits as the file has,
/// never fewer than 1e-7 of its diagonal needs; a number that would be read back as it was keeps its
/// characters.
///
/// Blocks of a file are read, moved and written on all threads; memory does not grow with the file but for
/// the normals of OBJ files. Throws FileError, InvalidInput for an unknown ending and for images
/// that the file's numbers cannot hold, FormatError naming the line, the byte or the element at fault, and
/// what the motion throws. Each output is complete or untouched.
CarrySummary carry_product(const std::filesystem::path& input,
                           const std::vector<std::filesystem::path>& outputs, const PointMotion& motion,
                           const Progress& progress = {});

/// Whether the ending of the name is that of a kind of product.
bool has_product_ending(const std::filesystem::path& path);

/// The endings that are known, for messages: ".obj, .ply, … or .xyz".
std::string product_endings();

}  // namespace bespoke

#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/product/face_splits.h"
#include "bespoke/product/point_motion.h"
#include "bespoke/product/rigid_part.h"
#include "bespoke/progress.h"

namespace bespoke {

struct CarrySummary {
  std::size_t points = 0;             ///< positions that were carried
  std::size_t directions = 0;         ///< normals and tangents that were carried
  std::vector<std::string> warnings;  ///< what the file holds that was left as it is, a sentence each
  std::vector<std::filesystem::path> companions;  ///< written besides the outputs: buffers beside a .gltf
  std::vector<PartSummary> parts;                 ///< that kept their shape
};

struct CarryOptions {
  std::vector<RigidPart> parts;  ///< that keep their shape
  Progress progress;
  /// Edges that are split first, of the faces as read_product reads them. What the file says of the ends is
  /// said of the middle too, as their mean. Only where can_split_product. A glTF mesh that is not split alike
  /// wherever nodes show it becomes several; strips and fans become lists. Values that nothing refers to any
  /// longer leave the buffers that are in the file.
  const FaceSplits* splits = nullptr;
};

/// Carries a product: writes the file `input` once for every frame of the motion, with positions, normals
/// and tangents moved and every other byte as it was. The ending of the input's name says what it is
/// (`product_endings`); the outputs are files of the same kind, one a frame.
///
/// A normal n becomes cof(J) n, a tangent t becomes J t, both as long as they were, with J the Jacobian at
/// their vertex (those that a glTF file rounds to whole numbers become unit vectors); an OBJ normal of
/// several vertices becomes several where these differ. Text is written with as many digits as the file has,
/// never fewer than 1e-7 of its diagonal needs; a number that would be read back as it was keeps its
/// characters. The vertices of a glTF mesh move where its node shows it; a mesh that nodes show in several
/// places becomes several.
///
/// Points of the options' parts move with their part, and so does what lies at the same places; no two parts
/// may have a place in common. Points that splits add to a part move with it, but do not tell how.
///
/// Blocks of a file are read, moved and written on all threads; memory does not grow with the file except for
/// the normals of OBJ files and for glTF. Throws FileError, InvalidInput for an unknown ending, an unknown
/// part and for images that the file's numbers cannot hold, FormatError naming the line, the byte or the
/// element at fault, and what the motion throws. Each output is complete or untouched.
CarrySummary carry_product(const std::filesystem::path& input,
                           const std::vector<std::filesystem::path>& outputs, const PointMotion& motion,
                           const CarryOptions& options = {});

/// For each of the places (3×n) of points of the product in `input`, as read_product reads it, the number of
/// the part that it belongs to, or -1. Throws as carry_product.
std::vector<int> parts_of_places(const std::filesystem::path& input, const std::vector<RigidPart>& parts,
                                 const Points& places, const Progress& progress = {});

/// Whether the ending of the name is that of a kind of product.
bool has_product_ending(const std::filesystem::path& path);

/// Whether edges can be split in a product with the ending of this name.
bool can_split_product(const std::filesystem::path& path);

/// The endings that are known, for messages: ".obj, .ply, … or .xyz".
std::string product_endings();

}  // namespace bespoke

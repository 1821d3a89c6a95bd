#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "bespoke/enum_names.h"
#include "bespoke/exchange/displacement_image.h"

namespace bespoke {

/// Which way the models' axes point, for formats that say so.
enum class WorldSpace {
  lps,  ///< x to the left, y to the back (posterior), z up (superior)
  ras,  ///< x to the right, y to the front (anterior), z up
};

inline constexpr std::array world_spaces{Named<WorldSpace>{"lps", WorldSpace::lps},
                                         Named<WorldSpace>{"ras", WorldSpace::ras}};

/// What an image's file says about it besides its numbers.
struct ImageNotes {
  std::string content;  ///< one line: which points go where, and their unit
  WorldSpace space = WorldSpace::lps;
};

/// Writes the image in the format of the name's ending: `.vti` (VTK's image data, vectors `displacement`),
/// `.nrrd` (in LPS: models in RAS are turned), `.nii.gz` (in RAS: models in LPS are turned) or `.vdb`
/// (OpenVDB, one Vec3S grid `displacement`). The file appears whole or not at all. Throws InvalidInput for
/// another ending, listing these, and for what the format cannot hold; FileError.
void write_displacement_image(const std::filesystem::path& path, const DisplacementImage& image,
                              const ImageNotes& notes);

/// Throws as write_displacement_image for an ending that it does not know.
void require_image_ending(const std::filesystem::path& path);

/// Whether files of this ending say which way the axes point; the others are in the models' own frame. Throws
/// as write_displacement_image.
bool says_world_space(const std::filesystem::path& path);

/// ".vti, .nrrd, …".
std::string image_endings();

}  // namespace bespoke

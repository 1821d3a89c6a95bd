#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace bespoke {

/// The two parts of an asset's file, before the trailer.
struct AssetSections {
  std::string_view vdb;
  std::string_view exact_map;  ///< empty without `--keep-exact`
};

/// Bytes of the trailer that ends every asset: 8 magic, 4 version, 4 zero, 8 length of the VDB part, 8 length
/// of the exact map, 32 SHA-256 of all before it, little-endian. OpenVDB ignores what follows the last grid.
inline constexpr std::size_t trailer_size = 64;

/// `sections` and their trailer.
std::string seal(const AssetSections& sections);

/// The sections of a file whose trailer fits it; views into `bytes`. Throws FormatError.
AssetSections unseal(std::string_view bytes);

}  // namespace bespoke

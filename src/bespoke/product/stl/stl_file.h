#pragma once

#include <optional>

#include "bespoke/product/text/text_records.h"

namespace bespoke {

/// A binary STL file is a header, which ends with the number of facets, and the facets: a normal, three
/// corners, two bytes.
inline constexpr std::size_t stl_header_size = 84, stl_facet_size = 50, stl_normal_size = 12;

/// The number of facets of a binary file; none for a text. Throws FormatError for what is neither, and for a
/// binary file without facets.
std::optional<std::size_t> binary_stl_facets(const InputFile& file);

/// Whole facets.
struct FacetBlock {
  std::string_view bytes;
  std::size_t first = 0;
};

/// Cuts the facets of a binary file into blocks.
class FacetCutter {
 public:
  std::vector<FacetBlock> operator()(const Window& window);

 private:
  std::size_t done_ = 0;
};

/// The normals (in the first column of four) and corners of a block's facets, 3×4n. Throws FormatError naming
/// the facet, of so many in the file, that has a corner which is not finite.
Points facet_points(const FacetBlock& block, const InputFile& file, std::size_t facets);

/// An STL file of text; blocks end where facets do. A facet's normal moves as at the middle of its corners.
class StlText : public TextFormat {
 public:
  /// Without normals these may be anything. The path must outlive it.
  explicit StlText(const std::filesystem::path& path, bool with_normals = true)
      : path_(path), with_normals_(with_normals) {}

  TextCutter cutter() const override;
  TextRecords records(const TextBlock& block) const override;
  void require_complete(const std::array<std::uint64_t, 3>& sums) const override;

 private:
  void read_facet(TextWords& words, TextRecords& records) const;

  const std::filesystem::path& path_;
  bool with_normals_;
};

}  // namespace bespoke

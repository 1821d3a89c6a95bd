#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bespoke/product/carry_product.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/text/text_blocks.h"
#include "bespoke/product/text/text_edits.h"

namespace bespoke {

/// What a block of a text file holds that is carried. Normal i belongs to the points i k … i k + k − 1, with
/// k = points / normals, and moves as at their mean.
struct TextRecords {
  std::vector<NumberTriple> points;
  std::vector<NumberTriple> normals;
  std::vector<std::uint32_t> faces;            ///< of each the number of its corners, and the corners
  std::vector<std::array<double, 2>> texture;  ///< of each point, of PLY files that have some
  char point = '.';                            ///< in numbers, or a comma
};

/// A text format whose normals stand beside their points.
class TextFormat {
 public:
  virtual ~TextFormat() = default;

  /// Where its blocks begin, in bytes and lines.
  virtual std::uint64_t begin() const { return 0; }
  virtual TextCutter cutter() const = 0;
  /// Throws FormatError naming the line at fault.
  virtual TextRecords records(const TextBlock& block) const = 0;
  /// Throws FormatError unless the sums over all blocks are those of a whole file.
  virtual void require_complete(const std::array<std::uint64_t, 3>& sums) const = 0;
};

/// Checks the whole file, then carries it.
CarrySummary carry_text(const InputFile& file, std::vector<OutputFile>& outputs, const TextFormat& format,
                        const PointMotion& motion, const Progress& progress);

/// All of a text format's file. The normals of a point cloud are requested: those of a mesh are not needed.
enum class GatheredNormals { none, of_points };
GatheredFaces gather_text(const InputFile& file, const TextFormat& format,
                          GatheredNormals normals = GatheredNormals::none);

/// Decimals that positions in this box are written with: those that the file carries, and no fewer than keep
/// 1e-7 of the box's diagonal.
int position_decimals(const Box& box, const CarriedDecimals& carried);
int position_decimals(const std::vector<NumberTriple>& points);

/// Throws InvalidInput, naming the file, unless all images are finite.
void require_finite(const Points& images, const std::filesystem::path& path);

/// The first bytes of a file, no more than a header can be long, as a block.
std::string file_head(const InputFile& file);
/// The same of a text. Throws FormatError for one in UTF-16.
std::string text_head(const InputFile& file);

}  // namespace bespoke

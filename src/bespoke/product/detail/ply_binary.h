#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/detail/block_walk.h"
#include "bespoke/product/detail/ply_header.h"

namespace bespoke {

/// Whole elements of one kind.
struct PlyBlock {
  std::string_view bytes;
  std::size_t element = 0;  ///< in the header; the number of kinds for what follows the last element
  std::uint64_t first = 0, count = 0;
};

/// Cuts the body of a binary PLY file into blocks, checking the lengths and the faces' indices on the way.
class PlyCutter {
 public:
  /// Both must outlive it.
  PlyCutter(const InputFile& file, const PlyHeader& header) : file_(file), header_(header) {}

  /// Throws FormatError naming the element at fault.
  std::vector<PlyBlock> operator()(const Window& window);

 private:
  std::size_t cut_records(std::string_view bytes, std::uint64_t more, const PlyElement& element,
                          std::uint64_t& count) const;
  [[noreturn]] void fail_short(std::uint64_t record) const;

  const InputFile& file_;
  const PlyHeader& header_;
  std::size_t element_ = 0;
  std::uint64_t done_ = 0;  ///< of the element
};

/// Where a block's vertices have their positions, normals and texture coordinates: offsets into its bytes.
struct PlyOffsets {
  std::vector<std::array<std::size_t, 3>> position, normal;
  std::vector<std::array<std::size_t, 2>> texture;
};
PlyOffsets vertex_offsets(const PlyHeader& header, const PlyBlock& block);

/// The faces of a block: of each the number of its corners, and the corners.
std::vector<std::uint32_t> face_corners(const PlyHeader& header, const PlyBlock& block);

/// A value as the file stores it.
double read_value(const char* bytes, PlyScalar type, PlyHeader::Encoding encoding);
/// `type` is a real one.
void write_value(char* bytes, double value, PlyScalar type, PlyHeader::Encoding encoding);

}  // namespace bespoke

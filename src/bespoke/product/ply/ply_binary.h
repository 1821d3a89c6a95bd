#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/ply/ply_header.h"
#include "bespoke/product/text/block_walk.h"

namespace bespoke {

/// Whole elements of one kind.
struct PlyBlock {
  std::string_view bytes;
  std::size_t element = 0;  ///< in the header; the number of kinds for what follows the last element
  std::uint64_t first = 0, count = 0;
};

/// Cuts the body of a binary PLY file into blocks, checking the lengths of lists on the way.
class PlyCutter {
 public:
  /// Both must outlive it.
  PlyCutter(const InputFile& file, const PlyHeader& header) : file_(file), header_(header) {}

  /// Throws FormatError naming the element at fault.
  std::vector<PlyBlock> operator()(const Window& window);

 private:
  std::size_t cut_records(std::string_view bytes, std::uint64_t more, const PlyElement& element,
                          std::uint64_t& count) const;
  std::size_t cut_lists(std::string_view bytes, std::uint64_t more, const PlyElement& element,
                        std::uint64_t most, std::uint64_t& count) const;
  [[noreturn]] void fail(std::uint64_t record, const std::string& what) const;

  const InputFile& file_;
  const PlyHeader& header_;
  std::size_t element_ = 0;
  std::uint64_t done_ = 0;  ///< of the element
};

/// The faces of a block: of each the number of its corners, and the corners; none of another element. Throws
/// FormatError naming the face that names no vertex.
std::vector<std::uint32_t> face_corners(const PlyHeader& header, const PlyBlock& block,
                                        const std::filesystem::path& path);

/// What face_corners throws.
void require_vertices(const PlyHeader& header, const PlyBlock& block, const std::filesystem::path& path);

/// Where the records of a block begin and their properties lie.
class PlyPlaces {
 public:
  PlyPlaces(const PlyHeader& header, const PlyBlock& block);

  /// The values of some properties of every record, one record's behind the other's.
  void read(std::span<const std::size_t> properties, double* values) const;
  /// Puts such values into properties, which are real ones, of `bytes`, a copy of the block's. What a
  /// property cannot hold is left out, and false returned.
  bool write(std::span<const std::size_t> properties, const double* values, char* bytes) const;

 private:
  std::size_t place(std::size_t record, std::size_t property) const {
    return stride_ > 0 ? starts_[property] + record * stride_
                       : starts_[record * element_.properties.size() + property];
  }

  const PlyElement& element_;
  PlyHeader::Encoding encoding_;
  const PlyBlock& block_;
  std::size_t stride_ = 0;           ///< of records of one size
  std::vector<std::size_t> starts_;  ///< of the properties: of one record, or of all where sizes differ
};

}  // namespace bespoke

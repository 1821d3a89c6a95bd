#pragma once

#include "bespoke/product/text/text_records.h"

namespace bespoke {

struct OffHeader {
  bool has_normals = false, has_texture = false;
  std::uint64_t vertices = 0, faces = 0;
  std::uint64_t counts = 0;  ///< byte at which the number of vertices begins
  std::uint64_t size = 0;    ///< bytes
  std::size_t lines = 0;
};

/// Throws FormatError naming the line at fault.
OffHeader read_off_header(const InputFile& file);

/// Vertices and faces of an OFF file, each on a line of its own.
class OffText : public TextFormat {
 public:
  /// Both must outlive it.
  OffText(const std::filesystem::path& path, const OffHeader& header) : path_(path), header_(header) {}

  std::uint64_t begin() const override { return header_.size; }
  TextCutter cutter() const override;
  TextRecords records(const TextBlock& block) const override;
  void require_complete(const std::array<std::uint64_t, 3>& sums) const override;

 private:
  void read_face(TextWords& words, TextRecords& records) const;

  const std::filesystem::path& path_;
  const OffHeader& header_;
};

}  // namespace bespoke

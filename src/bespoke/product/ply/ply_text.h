#pragma once

#include "bespoke/product/ply/ply_header.h"
#include "bespoke/product/text/text_records.h"

namespace bespoke {

inline constexpr LineSyntax ply_body_syntax{0, false};

/// The body of an ascii PLY file: every element on a line of its own.
class PlyText : public TextFormat {
 public:
  /// Both must outlive it.
  PlyText(const std::filesystem::path& path, const PlyHeader& header);

  std::uint64_t begin() const override { return header_.size; }
  TextCutter cutter() const override;
  TextRecords records(const TextBlock& block) const override;
  void require_complete(const std::array<std::uint64_t, 3>& sums) const override;

 private:
  void read_vertex(TextWords& words, TextRecords& records) const;
  void read_other(TextWords& words, const PlyElement& element, TextRecords& records) const;
  static long long list_length(TextWords& words);

  const std::filesystem::path& path_;
  const PlyHeader& header_;
  std::vector<std::uint64_t> ends_;  ///< number of elements up to and with each kind
};

}  // namespace bespoke

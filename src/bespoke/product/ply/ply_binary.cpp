#include "bespoke/product/ply/ply_binary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "bespoke/error.h"
#include "bespoke/product/ply/ply_scalar.h"

namespace bespoke {
namespace {

constexpr std::size_t records_a_block = std::size_t{1} << 16;
constexpr std::size_t bytes_a_block = std::size_t{1} << 20;

/// Calls visit(record, list, values) with the values of every list of a face's vertices.
template <class Visit>
void for_face_lists(const PlyHeader& header, const PlyBlock& block, const Visit& visit) {
  if (block.element == header.elements.size() || block.count == 0) return;
  const PlyElement& element = header.elements[block.element];
  std::vector<bool> is_face;
  for (const PlyProperty& property : element.properties) is_face.push_back(is_face_list(element, property));
  if (std::find(is_face.begin(), is_face.end(), true) == is_face.end()) return;
  std::size_t at = 0;
  for (std::uint64_t i = 0; i < block.count; ++i)
    for (std::size_t k = 0; k < is_face.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      const std::uint64_t values = skip_property(property, block.bytes.data(), is_big(header), at);
      if (is_face[k]) visit(i, property, block.bytes.data() + at - values * size(property.type), values);
    }
}

/// The first value of a list that is no number of `count` ones, or nothing.
template <class Value>
std::optional<double> value_beyond(const char* list, std::uint64_t values, bool is_big, std::uint64_t count) {
  for (std::uint64_t k = 0; k < values; ++k) {
    const auto index = static_cast<double>(load_scalar<Value>(list + k * sizeof(Value), is_big));
    if (!(index >= 0 && index < static_cast<double>(count))) return index;
  }
  return std::nullopt;
}

bool is_padding(char c) { return c == '\n' || c == '\r' || c == ' ' || c == '\t' || c == '\0'; }

std::size_t lists_of(const PlyElement& element) {
  return static_cast<std::size_t>(std::count_if(element.properties.begin(), element.properties.end(),
                                                [](const PlyProperty& p) { return p.count.has_value(); }));
}

}  // namespace

void PlyCutter::fail(std::uint64_t record, const std::string& what) const {
  const PlyElement& element = header_.elements[element_];
  throw FormatError(file_.path().string() + ": " + element.name + " " + std::to_string(record) + " of " +
                    std::to_string(element.count) + ": " + what);
}

// The file's records are found one after the other, so every other thread waits for this. Nearly all elements
// with lists have one; what lies around it has one size.
std::size_t PlyCutter::cut_lists(std::string_view bytes, std::uint64_t more, const PlyElement& element,
                                 std::uint64_t most, std::uint64_t& count) const {
  const auto list = std::find_if(element.properties.begin(), element.properties.end(),
                                 [](const PlyProperty& p) { return p.count.has_value(); });
  const auto sum = [](std::size_t total, const PlyProperty& p) { return total + size(p.type); };
  const std::size_t before = std::accumulate(element.properties.begin(), list, std::size_t{0}, sum);
  const std::size_t after = std::accumulate(list + 1, element.properties.end(), std::size_t{0}, sum);
  const std::size_t width = size(list->type);
  return with_type(*list->count, [&](auto zero) {
    const std::size_t head = before + sizeof zero;
    std::size_t end = 0;
    for (count = 0; count < most && end < bytes_a_block; ++count) {
      const std::size_t left = bytes.size() - end;
      if (left < head) break;
      const auto length =
          static_cast<long long>(load_scalar<decltype(zero)>(bytes.data() + end + before, is_big(header_)));
      if (length < 0) fail(done_ + count, "a list of negative length");
      const std::size_t record = head + static_cast<std::size_t>(length) * width + after;
      if (left < record) {
        if (left + more < record) fail(done_ + count, "the file ends here");
        break;
      }
      end += record;
    }
    return end;
  });
}

// Returns the bytes of the whole records at the beginning, at most a block of them.
std::size_t PlyCutter::cut_records(std::string_view bytes, std::uint64_t more, const PlyElement& element,
                                   std::uint64_t& count) const {
  const std::uint64_t most = std::min<std::uint64_t>(element.count - done_, records_a_block);
  if (const auto record = element.record_size()) {
    count = *record == 0 ? element.count - done_ : std::min<std::uint64_t>(most, bytes.size() / *record);
    return static_cast<std::size_t>(count) * *record;
  }
  if (lists_of(element) == 1) return cut_lists(bytes, more, element, most, count);
  std::size_t end = 0;
  for (count = 0; count < most && end < bytes_a_block; ++count) {
    std::size_t at = end;
    for (const PlyProperty& property : element.properties) {
      std::uint64_t values = 1;
      if (property.count) {
        if (bytes.size() - at < size(*property.count)) return end;
        const long long length = list_length(bytes.data() + at, *property.count, is_big(header_));
        if (length < 0) fail(done_ + count, "a list of negative length");
        values = static_cast<std::uint64_t>(length);
        at += size(*property.count);
      }
      if ((bytes.size() - at + more) / size(property.type) < values)
        fail(done_ + count, "the file ends here");
      if ((bytes.size() - at) / size(property.type) < values) return end;
      at += static_cast<std::size_t>(values) * size(property.type);
    }
    end = at;
  }
  return end;
}

std::vector<PlyBlock> PlyCutter::operator()(const Window& window) {
  std::vector<PlyBlock> blocks;
  std::string_view rest = window.bytes;
  const std::uint64_t more = file_.size() - window.offset - window.bytes.size();
  while (true) {
    while (element_ < header_.elements.size() && done_ == header_.elements[element_].count) {
      ++element_;
      done_ = 0;
    }
    if (element_ == header_.elements.size()) break;
    const PlyElement& element = header_.elements[element_];
    std::uint64_t count = 0;
    const std::size_t size = cut_records(rest, more, element, count);
    if (count == 0) {
      if (window.is_last) fail(done_, "the file ends here");
      return blocks;
    }
    blocks.push_back({rest.substr(0, size), element_, done_, count});
    done_ += count;
    rest.remove_prefix(size);
  }
  if (rest.empty()) return blocks;
  if (!std::all_of(rest.begin(), rest.end(), is_padding))
    throw FormatError(file_.path().string() + ": bytes behind the last element, from byte " +
                      std::to_string(window.offset + window.bytes.size() - rest.size()) + " on");
  blocks.push_back({rest, element_, 0, 0});
  return blocks;
}

std::vector<std::uint32_t> face_corners(const PlyHeader& header, const PlyBlock& block,
                                        const std::filesystem::path& path) {
  require_vertices(header, block, path);
  std::vector<std::uint32_t> faces;
  for_face_lists(header, block,
                 [&](std::uint64_t, const PlyProperty& property, const char* list, std::uint64_t values) {
                   faces.push_back(static_cast<std::uint32_t>(values));
                   with_type(property.type, [&](auto zero) {
                     for (std::uint64_t k = 0; k < values; ++k)
                       faces.push_back(static_cast<std::uint32_t>(
                           load_scalar<decltype(zero)>(list + k * sizeof zero, is_big(header))));
                   });
                 });
  return faces;
}

void require_vertices(const PlyHeader& header, const PlyBlock& block, const std::filesystem::path& path) {
  const std::uint64_t vertices = header.elements[header.vertex].count;
  for_face_lists(
      header, block,
      [&](std::uint64_t face, const PlyProperty& property, const char* list, std::uint64_t values) {
        with_type(property.type, [&](auto zero) {
          if (const auto index = value_beyond<decltype(zero)>(list, values, is_big(header), vertices))
            throw FormatError(path.string() + ": face " + std::to_string(block.first + face) + " of " +
                              std::to_string(header.elements[block.element].count) + ": " +
                              ply_index_fault(*index, vertices));
        });
      });
}

PlyPlaces::PlyPlaces(const PlyHeader& header, const PlyBlock& block)
    : element_(header.elements[block.element]), encoding_(header.encoding), block_(block) {
  std::size_t at = 0;
  stride_ = element_.record_size().value_or(0);
  for (std::uint64_t i = 0; i < (stride_ > 0 ? 1 : block.count); ++i)
    for (const PlyProperty& property : element_.properties) {
      starts_.push_back(at);
      skip_property(property, block.bytes.data(), is_big(header), at);
    }
}

void PlyPlaces::read(std::span<const std::size_t> properties, double* values) const {
  const bool is_big = encoding_ == PlyHeader::Encoding::big_endian;
  for (std::size_t k = 0; k < properties.size(); ++k)
    with_type(element_.properties[properties[k]].type, [&](auto zero) {
      for (std::size_t i = 0; i < block_.count; ++i)
        values[i * properties.size() + k] = static_cast<double>(
            load_scalar<decltype(zero)>(block_.bytes.data() + place(i, properties[k]), is_big));
    });
}

bool PlyPlaces::write(std::span<const std::size_t> properties, const double* values, char* bytes) const {
  const bool is_big = encoding_ == PlyHeader::Encoding::big_endian;
  bool fits = true;
  for (std::size_t k = 0; k < properties.size(); ++k)
    with_type(element_.properties[properties[k]].type, [&](auto zero) {
      using Value = decltype(zero);
      const auto largest = static_cast<double>(std::numeric_limits<Value>::max());
      for (std::size_t i = 0; i < block_.count; ++i) {
        const double value = values[i * properties.size() + k];
        if (std::abs(value) <= largest)
          store_scalar<Value>(bytes + place(i, properties[k]), value, is_big);
        else
          fits = false;
      }
    });
  return fits;
}

}  // namespace bespoke

#include "bespoke/product/detail/ply_binary.h"

#include <algorithm>
#include <cstring>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::size_t records_a_block = std::size_t{1} << 16;
constexpr std::size_t bytes_a_block = std::size_t{1} << 20;

static_assert(std::endian::native == std::endian::little);

template <class Value>
double as_double(const char* bytes, bool is_big) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), bytes, sizeof(Value));
  if (is_big) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Value>(raw));
}

template <class Value>
void store(char* bytes, double value, bool is_big) {
  auto raw = std::bit_cast<std::array<char, sizeof(Value)>>(static_cast<Value>(value));
  if (is_big) std::reverse(raw.begin(), raw.end());
  std::memcpy(bytes, raw.data(), sizeof(Value));
}

enum class RecordEnd { found, behind_the_bytes, behind_the_file, negative };

/// Goes behind the property of a record, and counts a list's values. The file has `more` behind the bytes.
RecordEnd skip_property(std::string_view bytes, std::uint64_t more, const PlyProperty& property,
                        PlyHeader::Encoding encoding, std::size_t& at, std::uint64_t& values) {
  values = 1;
  if (property.count) {
    if (bytes.size() - at < size(*property.count)) return RecordEnd::behind_the_bytes;
    const double length = read_value(bytes.data() + at, *property.count, encoding);
    if (length < 0) return RecordEnd::negative;
    values = static_cast<std::uint64_t>(length);
    at += size(*property.count);
  }
  if ((bytes.size() - at + more) / size(property.type) < values) return RecordEnd::behind_the_file;
  if ((bytes.size() - at) / size(property.type) < values) return RecordEnd::behind_the_bytes;
  at += static_cast<std::size_t>(values) * size(property.type);
  return RecordEnd::found;
}

/// Whether all of a list's values number one of the vertices.
bool are_vertices(const char* bytes, std::uint64_t values, PlyScalar type, PlyHeader::Encoding encoding,
                  std::uint64_t vertices) {
  if ((type == PlyScalar::int32 || type == PlyScalar::uint32) &&
      encoding == PlyHeader::Encoding::little_endian) {
    // What most files have. A negative number is a large one here.
    std::uint32_t largest = 0;
    for (std::uint64_t i = 0; i < values; ++i, bytes += sizeof largest) {
      std::uint32_t index;
      std::memcpy(&index, bytes, sizeof index);
      largest = std::max(largest, index);
    }
    return largest < vertices && (type == PlyScalar::uint32 || largest <= 0x7fffffff);
  }
  for (std::uint64_t i = 0; i < values; ++i, bytes += size(type)) {
    const double value = read_value(bytes, type, encoding);
    if (!(value >= 0 && value < static_cast<double>(vertices))) return false;
  }
  return true;
}

bool is_blank(char c) { return c == '\n' || c == '\r' || c == ' ' || c == '\t' || c == '\0'; }

}  // namespace

double read_value(const char* bytes, PlyScalar type, PlyHeader::Encoding encoding) {
  const bool is_big = encoding == PlyHeader::Encoding::big_endian;
  switch (type) {
    case PlyScalar::int8:
      return as_double<std::int8_t>(bytes, is_big);
    case PlyScalar::uint8:
      return as_double<std::uint8_t>(bytes, is_big);
    case PlyScalar::int16:
      return as_double<std::int16_t>(bytes, is_big);
    case PlyScalar::uint16:
      return as_double<std::uint16_t>(bytes, is_big);
    case PlyScalar::int32:
      return as_double<std::int32_t>(bytes, is_big);
    case PlyScalar::uint32:
      return as_double<std::uint32_t>(bytes, is_big);
    case PlyScalar::float32:
      return as_double<float>(bytes, is_big);
    case PlyScalar::float64:
      break;
  }
  return as_double<double>(bytes, is_big);
}

void write_value(char* bytes, double value, PlyScalar type, PlyHeader::Encoding encoding) {
  const bool is_big = encoding == PlyHeader::Encoding::big_endian;
  if (type == PlyScalar::float32)
    store<float>(bytes, value, is_big);
  else
    store<double>(bytes, value, is_big);
}

// Returns the bytes of the whole records at the beginning, at most a block of them.
std::size_t PlyCutter::cut_records(std::string_view bytes, std::uint64_t more, const PlyElement& element,
                                   std::uint64_t& count) const {
  const std::uint64_t most = std::min<std::uint64_t>(element.count - done_, records_a_block);
  if (const auto record = element.record_size()) {
    count = *record == 0 ? element.count - done_ : std::min<std::uint64_t>(most, bytes.size() / *record);
    return static_cast<std::size_t>(count) * *record;
  }
  const std::uint64_t vertices = header_.elements[header_.vertex].count;
  std::vector<bool> is_face;
  for (const PlyProperty& property : element.properties) is_face.push_back(is_face_list(element, property));
  std::size_t end = 0;
  for (count = 0; count < most && end < bytes_a_block; ++count) {
    std::size_t at = end;
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      std::uint64_t values = 0;
      const RecordEnd found = skip_property(bytes, more, property, header_.encoding, at, values);
      if (found == RecordEnd::behind_the_bytes) return end;
      const auto fail = [&](const std::string& what) {
        throw FormatError(file_.path().string() + ": " + element.name + " " + std::to_string(done_ + count) +
                          " of " + std::to_string(element.count) + ": " + what);
      };
      if (found == RecordEnd::behind_the_file) fail("the file ends here");
      if (found == RecordEnd::negative) fail("a list of negative length");
      if (!is_face[k]) continue;
      const char* const first = bytes.data() + at - values * size(property.type);
      if (are_vertices(first, values, property.type, header_.encoding, vertices)) continue;
      const std::size_t width = size(property.type);
      for (const char* index = bytes.data() + at - values * width; index != bytes.data() + at;
           index += width) {
        const double value = read_value(index, property.type, header_.encoding);
        if (!(value >= 0 && value < static_cast<double>(vertices))) fail(ply_index_fault(value, vertices));
      }
    }
    end = at;
  }
  return end;
}

void PlyCutter::fail_short(std::uint64_t record) const {
  const PlyElement& element = header_.elements[element_];
  throw FormatError(file_.path().string() + ": " + element.name + " " + std::to_string(record) + " of " +
                    std::to_string(element.count) + ": the file ends here");
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
      if (window.is_last) fail_short(done_);
      return blocks;
    }
    blocks.push_back({rest.substr(0, size), element_, done_, count});
    done_ += count;
    rest.remove_prefix(size);
  }
  if (rest.empty()) return blocks;
  if (!std::all_of(rest.begin(), rest.end(), is_blank))
    throw FormatError(file_.path().string() + ": bytes behind the last element, from byte " +
                      std::to_string(window.offset + window.bytes.size() - rest.size()) + " on");
  blocks.push_back({rest, element_, 0, 0});
  return blocks;
}

PlyOffsets vertex_offsets(const PlyHeader& header, const PlyBlock& block) {
  PlyOffsets offsets;
  offsets.position.reserve(block.count);
  const std::vector<PlyProperty>& properties = header.elements[block.element].properties;
  std::vector<std::size_t> starts(properties.size());
  std::size_t at = 0;
  const auto triple = [&](const std::array<std::size_t, 3>& of) {
    return std::array{starts[of[0]], starts[of[1]], starts[of[2]]};
  };
  const std::optional<std::size_t> record = header.elements[block.element].record_size();
  for (std::uint64_t i = 0; i < block.count; ++i) {
    // Records of one size differ by it alone.
    if (record && i > 0)
      for (std::size_t& start : starts) start += *record;
    for (std::size_t k = 0; k < properties.size() && (!record || i == 0); ++k) {
      starts[k] = at;
      std::uint64_t values = 0;
      skip_property(block.bytes, 0, properties[k], header.encoding, at, values);
    }
    offsets.position.push_back(triple(header.position));
    if (header.normal) offsets.normal.push_back(triple(*header.normal));
    if (header.texture)
      offsets.texture.push_back({starts[(*header.texture)[0]], starts[(*header.texture)[1]]});
  }
  return offsets;
}

std::vector<std::uint32_t> face_corners(const PlyHeader& header, const PlyBlock& block) {
  std::vector<std::uint32_t> faces;
  const PlyElement& element = header.elements[block.element];
  std::size_t at = 0;
  for (std::uint64_t i = 0; i < block.count; ++i)
    for (const PlyProperty& property : element.properties) {
      std::uint64_t values = 0;
      skip_property(block.bytes, 0, property, header.encoding, at, values);
      if (!is_face_list(element, property)) continue;
      faces.push_back(static_cast<std::uint32_t>(values));
      const std::size_t width = size(property.type);
      for (std::uint64_t k = values; k > 0; --k)
        faces.push_back(static_cast<std::uint32_t>(
            read_value(block.bytes.data() + at - k * width, property.type, header.encoding)));
    }
  return faces;
}

}  // namespace bespoke

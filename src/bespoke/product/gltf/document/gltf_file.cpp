#include "bespoke/product/gltf/document/gltf_file.h"

#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "bespoke/base64.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/gltf/document/gltf_extensions.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

// Of the binary container, in bytes.
constexpr std::size_t glb_header_size = 12, chunk_header_size = 8, chunk_alignment = 4;
constexpr std::uint32_t magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

constexpr std::size_t bytes_at_a_time = std::size_t{1} << 22;

constexpr std::string_view base64_mark = ";base64,";

std::string read_bytes(const InputFile& file, std::size_t begin, std::size_t size) {
  std::string bytes(size, '\0');
  parallel_for(size, bytes_at_a_time, [&](std::size_t first, std::size_t last) {
    file.read(begin + first, bytes.data() + first, last - first);
  });
  return bytes;
}

std::uint32_t word_at(const InputFile& file, std::size_t at) {
  std::uint32_t value = 0;
  file.read(at, reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

std::string words(std::initializer_list<std::size_t> values) {
  std::string bytes;
  for (const std::size_t value : values) {
    const auto word = static_cast<std::uint32_t>(value);
    bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
  }
  return bytes;
}

std::size_t aligned(std::size_t size) {
  return (size + chunk_alignment - 1) / chunk_alignment * chunk_alignment;
}

/// Reads the chunks; the second one, where it is binary, becomes `binary`.
void read_chunks(const InputFile& file, GltfFile& gltf, std::optional<GltfBuffer>& binary) {
  const auto fail = [&](std::size_t byte, const std::string& what) {
    throw FormatError(file.path().string() + ": byte " + std::to_string(byte) + ": " + what);
  };
  if (file.size() < glb_header_size + chunk_header_size) fail(file.size(), "the file ends within its header");
  if (word_at(file, 4) != 2) fail(4, "version " + std::to_string(word_at(file, 4)) + ", only 2 is read");
  if (word_at(file, 8) != file.size())
    fail(8, "a length of " + std::to_string(word_at(file, 8)) + " bytes, but the file has " +
                std::to_string(file.size()));
  std::size_t at = glb_header_size;
  for (int chunk = 0; at < file.size() && chunk < 2; ++chunk) {
    const std::size_t left = file.size() - at;
    if (left < chunk_header_size || left - chunk_header_size < word_at(file, at))
      fail(at, "the file ends within a chunk");
    const std::size_t length = word_at(file, at);
    if (length % chunk_alignment != 0) fail(at, "the length of a chunk is no multiple of four");
    const std::uint32_t type = word_at(file, at + 4);
    if (chunk == 0 && type != json_chunk) fail(at + 4, "the first chunk is not JSON");
    if (chunk == 1 && type != binary_chunk) break;
    at += chunk_header_size;
    if (chunk == 0)
      gltf.text = read_bytes(file, at, length);
    else
      binary.emplace(file, at, length);
    at += length;
  }
  gltf.chunks_behind = read_bytes(file, at, file.size() - at);
}

GltfBuffer read_uri(const GltfPart& part, GltfFile& gltf) {
  const std::string uri = part.text("uri");
  if (is_data_uri(uri)) {
    auto bytes = bytes_of_base64(std::string_view(uri).substr(uri.find(base64_mark) + base64_mark.size()));
    if (!bytes) part.fail_at("uri", "is not base64");
    return GltfBuffer(*std::move(bytes));
  }
  if (uri.starts_with("data:") || uri.find("://") != std::string::npos)
    part.fail_at("uri", "is neither base64 data nor the name of a file beside this one");
  const InputFile& file = gltf.beside.emplace_back(gltf.path.parent_path() / file_name_of_uri(uri));
  return GltfBuffer(file, 0, file.size());
}

void read_buffers(GltfFile& gltf, std::optional<GltfBuffer>&& binary) {
  for (const GltfPart& part : gltf.root().elements("buffers")) {
    if (part.has("uri")) {
      gltf.buffers.push_back(read_uri(part, gltf));
    } else {
      if (!gltf.buffers.empty() || !binary) require_not_compressed(part);
      if (!gltf.buffers.empty() || !binary) part.fail("has no uri, and the file no binary chunk for it");
      gltf.buffers.push_back(*std::exchange(binary, std::nullopt));
    }
    const std::uint64_t length = part.whole("byteLength");
    const std::size_t size = gltf.buffers.back().size();
    if (size < length) part.fail("has " + std::to_string(size) + " of " + std::to_string(length) + " bytes");
  }
  // A binary chunk that no buffer names.
  if (binary) gltf.chunks_behind.insert(0, words({binary->size(), binary_chunk}) + binary->content());
}

}  // namespace

bool GltfFile::has_binary_chunk() const {
  const std::vector<GltfPart> parts = root().elements("buffers");
  return is_binary && !parts.empty() && !parts.front().has("uri");
}

GltfFile read_gltf(const InputFile& file) {
  GltfFile gltf;
  gltf.path = file.path();
  gltf.is_binary = file.size() >= sizeof magic && word_at(file, 0) == magic;
  std::optional<GltfBuffer> binary;
  if (gltf.is_binary)
    read_chunks(file, gltf, binary);
  else
    gltf.text = read_bytes(file, 0, file.size());
  require_utf8(gltf.text, gltf.path);
  gltf.json = parse_gltf_json(gltf.text, gltf.path);
  require_known_extensions(gltf.root());
  read_buffers(gltf, std::move(binary));
  return gltf;
}

void write_gltf(const GltfFile& file, std::string_view text, const GltfBuffer& binary, OutputFile& output) {
  if (!file.is_binary) return output.write(text);
  const std::string blanks(aligned(text.size()) - text.size(), ' ');
  const std::string zeros(aligned(binary.size()) - binary.size(), '\0');
  const bool has_binary = file.has_binary_chunk();
  const std::size_t size = glb_header_size + chunk_header_size + text.size() + blanks.size() +
                           (has_binary ? chunk_header_size + binary.size() + zeros.size() : 0) +
                           file.chunks_behind.size();
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput(output.name().string() + ": would have more than the 4 GB that a .glb can have");
  output.write(words({magic, 2, size, text.size() + blanks.size(), json_chunk}));
  output.write(text);
  output.write(blanks);
  if (has_binary) {
    output.write(words({binary.size() + zeros.size(), binary_chunk}));
    binary.write(output);
    output.write(zeros);
  }
  output.write(file.chunks_behind);
}

bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:") && uri.find(base64_mark) != std::string_view::npos;
}

std::string data_uri_of(std::string_view uri, std::string_view bytes) {
  return std::string(uri.substr(0, uri.find(base64_mark) + base64_mark.size())) + base64(bytes);
}

std::string file_name_of_uri(std::string_view uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const char* const digits = uri.data() + i + 1;
    const bool is_escape = uri[i] == '%' && i + 2 < uri.size() &&
                           std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
    name += is_escape ? static_cast<char>(value) : uri[i];
    if (is_escape) i += 2;
  }
  return name;
}

std::string uri_of_file_name(std::string_view name) {
  constexpr std::string_view unreserved = "-._~";
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string uri;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 128 && (std::isalnum(byte) || unreserved.find(c) != std::string_view::npos))
      uri += c;
    else
      uri.append({'%', digits[byte / 16], digits[byte % 16]});
  }
  return uri;
}

}  // namespace bespoke

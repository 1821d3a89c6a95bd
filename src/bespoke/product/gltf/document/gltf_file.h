#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/carry/product_file.h"
#include "bespoke/product/gltf/document/gltf_buffer.h"
#include "bespoke/product/gltf/document/gltf_json.h"

namespace bespoke {

/// A glTF file, .gltf or .glb, and where the bytes of its buffers are.
struct GltfFile {
  std::filesystem::path path;
  bool is_binary = false;
  std::string text;  ///< the JSON, as it stands in the file
  GltfJson json;
  std::deque<InputFile> beside;  ///< the files that are buffers
  std::vector<GltfBuffer> buffers;
  std::string chunks_behind;  ///< of a .glb, behind its JSON and the first buffer

  GltfPart root() const { return {path, json, ""}; }
  /// Whether the first buffer is the .glb's second chunk.
  bool has_binary_chunk() const;
};

/// `file` must outlive the result, whose buffers read it. Throws FileError, also for a buffer beside the
/// file, FormatError naming the byte or the JSON pointer, and InvalidInput for extensions that are not known.
GltfFile read_gltf(const InputFile& file);

/// Writes the file with this JSON text and these bytes of its binary chunk, if it has one.
void write_gltf(const GltfFile& file, std::string_view text, const GltfBuffer& binary, OutputFile& output);

/// Whether a buffer's uri holds its bytes.
bool is_data_uri(std::string_view uri);
/// The uri of the same kind of data with these bytes.
std::string data_uri_of(std::string_view uri, std::string_view bytes);

/// A relative uri as a file's name, and the other way: a blank is "%20".
std::string file_name_of_uri(std::string_view uri);
std::string uri_of_file_name(std::string_view name);

}  // namespace bespoke

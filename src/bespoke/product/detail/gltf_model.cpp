#include "bespoke/product/detail/gltf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/detail/gltf_text.h"

namespace bespoke {
namespace {

constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
constexpr std::size_t vectors_at_a_time = std::size_t{1} << 16;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void append_word(std::string& bytes, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

/// A whole number of an object, or what it is when left out.
std::uint64_t whole(const GltfModel& model, const GltfJson& object, const char* key,
                    const std::string& pointer, std::optional<std::uint64_t> otherwise = std::nullopt) {
  const auto at = object.find(key);
  if (at == object.end() && otherwise) return *otherwise;
  if (at == object.end()) model.fail(pointer, std::string("has no ") + key);
  if (!at->is_number_unsigned()) model.fail(pointer + "/" + key, "is no whole number");
  return at->get<std::uint64_t>();
}

/// The array under a key of the top level; empty when there is none.
const GltfJson& array(const GltfModel& model, const char* key) {
  static const GltfJson none = GltfJson::array();
  const auto at = model.json.find(key);
  if (at == model.json.end()) return none;
  if (!at->is_array()) model.fail(std::string("/") + key, "is no array");
  for (std::size_t i = 0; i < at->size(); ++i)
    if (!(*at)[i].is_object()) model.fail("/" + std::string(key) + "/" + std::to_string(i), "is no object");
  return *at;
}

void split_chunks(GltfModel& model, std::string&& content, std::string& binary, bool& has_binary) {
  const std::string name = model.path.string();
  if (content.size() < 20) throw FormatError(name + ": the file ends within its header");
  if (word_at(content, 4) != 2)
    throw FormatError(name + ": byte 4: version " + std::to_string(word_at(content, 4)) + ", only 2 is read");
  if (word_at(content, 8) != content.size())
    throw FormatError(name + ": byte 8: a length of " + std::to_string(word_at(content, 8)) +
                      " bytes, but the file has " + std::to_string(content.size()));
  std::size_t at = 12;
  for (int chunk = 0; at < content.size(); ++chunk) {
    const std::size_t length = content.size() - at < 8 ? 0 : word_at(content, at);
    if (content.size() - at < 8 || content.size() - at - 8 < length)
      throw FormatError(name + ": byte " + std::to_string(at) + ": the file ends within a chunk");
    const std::uint32_t type = word_at(content, at + 4);
    if (chunk == 0 && type != json_chunk)
      throw FormatError(name + ": byte " + std::to_string(at) + ": the first chunk is no JSON");
    if (chunk == 0) {
      model.text = content.substr(at + 8, length);
    } else if (chunk == 1 && type == binary_chunk) {
      binary = content.substr(at + 8, length);
      has_binary = true;
    } else {
      model.chunks_behind = content.substr(at);
      break;
    }
    at += 8 + length;
  }
}

void read_buffers(GltfModel& model, std::string&& binary, bool has_binary) {
  const GltfJson& buffers = array(model, "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string pointer = "/buffers/" + std::to_string(i);
    const std::uint64_t length = whole(model, buffers[i], "byteLength", pointer);
    std::string bytes;
    const auto uri = buffers[i].find("uri");
    if (uri == buffers[i].end()) {
      if (i > 0 || !has_binary) model.fail(pointer, "has no uri, and the file no binary chunk for it");
      bytes = std::move(binary);
    } else if (!uri->is_string()) {
      model.fail(pointer + "/uri", "is no text");
    } else if (const std::string text = uri->get<std::string>(); text.rfind("data:", 0) == 0) {
      const std::size_t comma = text.find(";base64,");
      if (comma == std::string::npos || !decode_base64(std::string_view(text).substr(comma + 8), bytes))
        model.fail(pointer + "/uri", "is no base64 data");
    } else {
      const InputFile file(model.path.parent_path() / decoded_uri(text));
      bytes.resize(file.size());
      file.read(0, bytes.data(), bytes.size());
    }
    if (bytes.size() < length)
      model.fail(pointer, "has " + std::to_string(bytes.size()) + " of " + std::to_string(length) + " bytes");
    model.buffers.push_back(std::move(bytes));
  }
}

int component_count(const GltfModel& model, const GltfJson& accessor, const std::string& pointer) {
  constexpr std::array<std::pair<const char*, int>, 7> types{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  const auto type = accessor.find("type");
  if (type != accessor.end() && type->is_string())
    for (const auto& [name, count] : types)
      if (*type == name) return count;
  model.fail(pointer, "has an unknown type");
}

/// The bytes of a view that values of this size and stride lie in; sets the place of the first.
void place_in_view(const GltfModel& model, const GltfJson& object, const std::string& pointer,
                   std::uint64_t value_size, std::uint64_t count, GltfAccessor& accessor) {
  const GltfJson& views = array(model, "bufferViews");
  const std::uint64_t index = whole(model, object, "bufferView", pointer);
  if (index >= views.size()) model.fail(pointer + "/bufferView", "there is no such view");
  const GltfJson& view = views[index];
  const std::string view_pointer = "/bufferViews/" + std::to_string(index);
  if (view.contains("extensions") && view["extensions"].contains("EXT_meshopt_compression"))
    throw InvalidInput(model.path.string() + ": " + view_pointer + " is compressed; decompress it first");
  accessor.buffer = whole(model, view, "buffer", view_pointer);
  if (accessor.buffer >= model.buffers.size())
    model.fail(view_pointer + "/buffer", "there is no such buffer");
  const std::uint64_t begin = whole(model, view, "byteOffset", view_pointer, 0);
  const std::uint64_t length = whole(model, view, "byteLength", view_pointer);
  const std::uint64_t size = model.buffers[accessor.buffer].size();
  if (begin > size || length > size - begin) model.fail(view_pointer, "ends behind its buffer");
  const std::uint64_t offset = whole(model, object, "byteOffset", pointer, 0);
  accessor.stride = whole(model, view, "byteStride", view_pointer, value_size);
  if (accessor.stride < value_size || accessor.stride > 65535)
    model.fail(view_pointer + "/byteStride", "does not fit the values");
  const bool fits = count == 0 || (offset <= length && value_size <= length - offset &&
                                   count - 1 <= (length - offset - value_size) / accessor.stride);
  if (!fits) model.fail(pointer, "ends behind its buffer view");
  accessor.offset = begin + offset;
}

GltfAccessor read_accessor(const GltfModel& model, const GltfJson& json, std::size_t index) {
  const std::string pointer = "/accessors/" + std::to_string(index);
  GltfAccessor accessor;
  accessor.index = index;
  accessor.component_type =
      static_cast<int>(std::min<std::uint64_t>(whole(model, json, "componentType", pointer), 9999));
  accessor.components = component_count(model, json, pointer);
  accessor.count = whole(model, json, "count", pointer);
  accessor.is_normalized = json.value("normalized", false);
  const std::size_t size = component_size(accessor.component_type);
  if (size == 0) model.fail(pointer + "/componentType", "is unknown");
  accessor.is_sparse = json.contains("sparse");
  accessor.has_view = json.contains("bufferView");
  if (accessor.has_view)
    place_in_view(model, json, pointer, size * static_cast<std::size_t>(accessor.components), accessor.count,
                  accessor);
  // Zeros need no bytes, so nothing else bounds how many there are.
  if (!accessor.has_view && accessor.count > (std::uint64_t{1} << 28))
    model.fail(pointer + "/count", "is more than can be");
  return accessor;
}

double component(const char* bytes, int type) {
  const auto load = [&]<class Value>(Value value) {
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case 5120:
      return load(std::int8_t{});
    case 5121:
      return load(std::uint8_t{});
    case 5122:
      return load(std::int16_t{});
    case 5123:
      return load(std::uint16_t{});
    case 5125:
      return load(std::uint32_t{});
    default:
      return load(float{});
  }
}

double as_real(double value, const GltfAccessor& accessor) {
  const double limit = accessor.is_normalized ? component_limit(accessor.component_type) : 0;
  return limit > 0 ? std::max(value / limit, -1.0) : value;
}

void load_values(const GltfAccessor& accessor, const std::string& buffer, Eigen::MatrixXd& values) {
  const std::size_t size = component_size(accessor.component_type);
  parallel_for(accessor.count, vectors_at_a_time, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const char* const bytes = buffer.data() + accessor.offset + i * accessor.stride;
      for (int k = 0; k < accessor.components; ++k)
        values(k, static_cast<Eigen::Index>(i)) =
            as_real(component(bytes + static_cast<std::size_t>(k) * size, accessor.component_type), accessor);
    }
  });
}

void load_sparse(const GltfModel& model, const GltfAccessor& accessor, Eigen::MatrixXd& values) {
  const std::string pointer = "/accessors/" + std::to_string(accessor.index) + "/sparse";
  const GltfJson& sparse = model.json["accessors"][accessor.index]["sparse"];
  if (!sparse.is_object() || !sparse.contains("indices") || !sparse.contains("values"))
    model.fail(pointer, "has no indices and values");
  GltfAccessor indices, replaced = accessor;
  const std::uint64_t count = whole(model, sparse, "count", pointer);
  indices.component_type = static_cast<int>(
      std::min<std::uint64_t>(whole(model, sparse["indices"], "componentType", pointer + "/indices"), 9999));
  const std::size_t index_size = component_size(indices.component_type);
  if (index_size == 0 || indices.component_type == 5126)
    model.fail(pointer + "/indices/componentType", "is no whole-number type");
  if (count > accessor.count) model.fail(pointer + "/count", "is more than the accessor's");
  indices.components = 1;
  indices.count = replaced.count = count;
  place_in_view(model, sparse["indices"], pointer + "/indices", index_size, count, indices);
  place_in_view(model, sparse["values"], pointer + "/values",
                component_size(accessor.component_type) * static_cast<std::size_t>(accessor.components),
                count, replaced);
  Eigen::MatrixXd at(1, static_cast<Eigen::Index>(count));
  Eigen::MatrixXd with(accessor.components, static_cast<Eigen::Index>(count));
  load_values(indices, model.buffers[indices.buffer], at);
  load_values(replaced, model.buffers[replaced.buffer], with);
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    if (!(at(i) >= 0 && at(i) < static_cast<double>(accessor.count)))
      model.fail(pointer + "/indices", "name vector " + std::to_string(static_cast<long long>(at(i))));
    values.col(static_cast<Eigen::Index>(at(i))) = with.col(i);
  }
}

void refuse_compression(const GltfModel& model) {
  const auto required = model.json.find("extensionsRequired");
  if (required == model.json.end() || !required->is_array()) return;
  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
    if (std::find(required->begin(), required->end(), name) != required->end())
      throw InvalidInput(model.path.string() + ": needs " + name +
                         ", which is not read; decompress it first");
}

}  // namespace

void GltfModel::fail(const std::string& pointer, const std::string& what) const {
  throw FormatError(path.string() + ": " + pointer + ": " + what);
}

std::size_t component_size(int component_type) {
  constexpr std::array<std::size_t, 7> sizes{1, 1, 2, 2, 0, 4, 4};
  return component_type < 5120 || component_type > 5126
             ? 0
             : sizes[static_cast<std::size_t>(component_type - 5120)];
}

double component_limit(int component_type) {
  constexpr std::array<double, 7> limits{127, 255, 32767, 65535, 0, 4294967295, 0};
  return limits[static_cast<std::size_t>(component_type - 5120)];
}

Eigen::MatrixXd GltfModel::values(std::size_t index) const {
  const GltfAccessor& accessor = accessors[index];
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(accessor.components, static_cast<Eigen::Index>(accessor.count));
  if (accessor.has_view) load_values(accessor, buffers[accessor.buffer], result);
  if (accessor.is_sparse) load_sparse(*this, accessor, result);
  if (!result.allFinite()) fail("/accessors/" + std::to_string(index), "has a value that is not finite");
  return result;
}

void store_values(const GltfAccessor& accessor, const Eigen::MatrixXd& values, std::string& buffer) {
  const std::size_t size = component_size(accessor.component_type);
  const double limit = component_limit(accessor.component_type);
  const double least = accessor.component_type == 5120 || accessor.component_type == 5122 ? -limit : 0;
  parallel_for(accessor.count, vectors_at_a_time, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (int k = 0; k < accessor.components; ++k) {
        char* const bytes =
            buffer.data() + accessor.offset + i * accessor.stride + static_cast<std::size_t>(k) * size;
        const double value = values(k, static_cast<Eigen::Index>(i));
        if (limit == 0) {
          const auto real = static_cast<float>(value);
          std::memcpy(bytes, &real, sizeof real);
          continue;
        }
        // Little-endian, so the low bytes are those of the smaller types.
        const auto stored = static_cast<long long>(
            std::nearbyint(std::clamp(accessor.is_normalized ? value * limit : value, least, limit)));
        std::memcpy(bytes, &stored, size);
      }
  });
}

GltfModel read_gltf(const InputFile& file) {
  GltfModel model;
  model.path = file.path();
  std::string content(file.size(), '\0'), binary;
  file.read(0, content.data(), content.size());
  bool has_binary = false;
  model.is_binary = content.size() >= 4 && word_at(content, 0) == glb_magic;
  if (model.is_binary)
    split_chunks(model, std::move(content), binary, has_binary);
  else
    model.text = std::move(content);
  try {
    model.json = GltfJson::parse(model.text);
  } catch (const nlohmann::json::parse_error& error) {
    throw FormatError(model.path.string() + ": byte " + std::to_string(error.byte) +
                      " of the JSON: not valid");
  }
  if (!model.json.is_object()) model.fail("", "is no JSON object");
  refuse_compression(model);
  read_buffers(model, std::move(binary), has_binary);
  const GltfJson& accessors = array(model, "accessors");
  for (std::size_t i = 0; i < accessors.size(); ++i)
    model.accessors.push_back(read_accessor(model, accessors[i], i));
  for (const char* key : {"nodes", "meshes", "bufferViews"}) array(model, key);
  return model;
}

std::string glb_bytes(const GltfModel& model, const std::string& text, const std::string& buffer) {
  if (!model.is_binary) return text;
  std::string json = text;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const bool has_buffer = !model.buffers.empty() && !model.json["buffers"][0].contains("uri");
  const std::size_t padding = (4 - buffer.size() % 4) % 4;
  std::string bytes;
  bytes.reserve(28 + json.size() + buffer.size() + padding + model.chunks_behind.size());
  append_word(bytes, glb_magic);
  append_word(bytes, 2);
  append_word(bytes, 12 + 8 + json.size() + (has_buffer ? 8 + buffer.size() + padding : 0) +
                         model.chunks_behind.size());
  append_word(bytes, json.size());
  append_word(bytes, json_chunk);
  bytes += json;
  if (has_buffer) {
    append_word(bytes, buffer.size() + padding);
    append_word(bytes, binary_chunk);
    bytes.append(buffer).append(padding, '\0');
  }
  return bytes + model.chunks_behind;
}

}  // namespace bespoke

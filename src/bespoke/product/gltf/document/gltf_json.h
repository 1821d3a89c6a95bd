#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bespoke {

using GltfJson = nlohmann::ordered_json;

/// Parses the JSON object of a glTF file. Throws FormatError naming the byte at fault.
GltfJson parse_gltf_json(std::string_view text, const std::filesystem::path& path);

/// `text`, which says `before`, with the values replaced in which `now` differs, and new elements and
/// members behind the old ones; all else keeps its characters.
std::string edited_json(std::string_view text, const GltfJson& before, const GltfJson& now);

/// An object of a glTF file's JSON, and its JSON pointer. Every function throws FormatError "path: pointer:
/// what" for a value that is not of the kind that is requested. File and JSON must outlive it.
class GltfPart {
 public:
  GltfPart(const std::filesystem::path& path, const GltfJson& json, std::string pointer);

  const std::filesystem::path& path() const { return *path_; }
  const std::string& pointer() const { return pointer_; }
  [[noreturn]] void fail(const std::string& what) const;
  /// The same of the value under a key.
  [[noreturn]] void fail_at(const char* key, const std::string& what) const;

  bool has(const char* key) const { return json_->contains(key); }
  std::vector<std::string> names() const;  ///< all keys
  GltfPart member(const char* key) const;
  std::string text(const char* key) const;
  std::vector<std::string> texts(const char* key) const;  ///< of an array; none without the key
  bool flag(const char* key) const;                       ///< false without the key
  std::uint64_t whole(const char* key) const;
  std::uint64_t whole_or(const char* key, std::uint64_t otherwise) const;

  /// A reference to one of `count` elements; none without the key.
  std::optional<std::size_t> index(const char* key, std::size_t count) const;
  std::vector<std::size_t> indices(const char* key, std::size_t count) const;

  /// As many finite numbers as `otherwise` has, which is what they are without the key.
  Eigen::VectorXd numbers(const char* key, const Eigen::VectorXd& otherwise) const;

  /// The objects of an array; none without the key.
  std::vector<GltfPart> elements(const char* key) const;

 private:
  const GltfJson& at(const char* key) const;
  const GltfJson& array(const char* key) const;

  const std::filesystem::path* path_;
  const GltfJson* json_;
  std::string pointer_;
};

}  // namespace bespoke

#include "bespoke/product/gltf/document/gltf_json.h"

#include <cmath>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// The parser, copies and printing of nested values take stack; glTF itself nests a dozen deep.
constexpr int deepest_nesting = 200;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Behind the string that begins at `at`.
std::size_t skip_string(std::string_view text, std::size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at)
    if (text[at] == '\\') ++at;
  return std::min(at + 1, text.size());
}

/// Byte at which values nest too deeply; none where they do not.
std::optional<std::size_t> too_deep(std::string_view text) {
  int depth = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"') {
      at = skip_string(text, at);
      continue;
    }
    if ((c == '{' || c == '[') && ++depth > deepest_nesting) return at;
    if (c == '}' || c == ']') --depth;
    ++at;
  }
  return std::nullopt;
}

/// Walks through JSON text that is known to be valid beside the values before and after.
class JsonEditor {
 public:
  explicit JsonEditor(std::string_view text) : text_(text), at_(text.find('{')) {}

  std::string run(const GltfJson& before, const GltfJson& now) {
    value(before, now);
    return result_.append(text_.substr(kept_));
  }

 private:
  void value(const GltfJson& before, const GltfJson& now) {
    if (before == now)
      skip_value();
    else if (before.is_array() && now.is_array() && !before.empty() && before.size() <= now.size())
      array(before, now);
    else if (!before.is_object() || !now.is_object() || !object(before, now))
      replace(now.dump());
  }

  /// The same keys with other values, and new ones behind them; false, with nothing done, where it had
  /// others.
  bool object(const GltfJson& before, const GltfJson& now) {
    if (before.empty()) return false;
    for (const auto& [key, unused] : before.items())
      if (!now.contains(key)) return false;
    // A text may give a key twice, of which the last holds.
    const std::size_t begin = at_;
    std::size_t members = 0;
    for (bool more = enter('}'); more; more = next('}'), ++members) skip_member();
    at_ = begin;
    if (members != before.size()) return false;
    for (bool more = enter('}'); more; more = next('}')) {
      const std::size_t key_begin = at_;
      at_ = skip_string(text_, at_);
      const std::string key = GltfJson::parse(text_.substr(key_begin, at_ - key_begin)).get<std::string>();
      skip_blanks();
      ++at_;  // the colon
      skip_blanks();
      value(before[key], now[key]);
      if (--members == 0) insert(new_members(before, now));
    }
    return true;
  }

  static std::string new_members(const GltfJson& before, const GltfJson& now) {
    std::string members;
    for (const auto& [key, value] : now.items())
      if (!before.contains(key))
        members.append(",").append(GltfJson(key).dump()).append(":").append(value.dump());
    return members;
  }

  /// New elements stand behind the old ones.
  void array(const GltfJson& before, const GltfJson& now) {
    std::size_t i = 0;
    for (bool more = enter(']'); more; more = next(']'), ++i) {
      value(before[i], now[i]);
      if (i + 1 < before.size()) continue;
      std::string behind;
      for (std::size_t k = before.size(); k < now.size(); ++k) behind.append(",").append(now[k].dump());
      insert(behind);
    }
  }

  void insert(const std::string& text) {
    result_.append(text_.substr(kept_, at_ - kept_)).append(text);
    kept_ = at_;
  }

  void replace(const std::string& with) {
    result_.append(text_.substr(kept_, at_ - kept_)).append(with);
    skip_value();
    kept_ = at_;
  }

  void skip_blanks() {
    while (is_blank(text_[at_])) ++at_;
  }
  /// Goes behind the bracket at hand; whether there is an element.
  bool enter(char bracket) {
    ++at_;
    skip_blanks();
    if (text_[at_] != bracket) return true;
    ++at_;
    return false;
  }
  /// Goes from behind an element to the next one, or behind the bracket.
  bool next(char bracket) {
    skip_blanks();
    const bool more = text_[at_++] != bracket;
    if (more) skip_blanks();
    return more;
  }
  void skip_member() {
    at_ = skip_string(text_, at_);
    skip_blanks();
    ++at_;  // the colon
    skip_blanks();
    skip_value();
  }
  void skip_value() {
    for (int depth = 0; at_ < text_.size();) {
      const char c = text_[at_];
      if (depth == 0 && (c == ',' || c == '}' || c == ']' || is_blank(c))) return;
      depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
      at_ = c == '"' ? skip_string(text_, at_) : at_ + 1;
      if (depth == 0 && (c == '"' || c == '}' || c == ']')) return;
    }
  }

  std::string_view text_;
  std::size_t at_;
  std::size_t kept_ = 0;  ///< up to here the result has what the text has
  std::string result_;
};

}  // namespace

GltfJson parse_gltf_json(std::string_view text, const std::filesystem::path& path) {
  const auto fail = [&](std::size_t byte, const char* what) {
    throw FormatError(path.string() + ": byte " + std::to_string(byte) + " of the JSON: " + what);
  };
  if (const auto byte = too_deep(text)) fail(*byte, "values are nested too deeply");
  GltfJson json;
  try {
    json = GltfJson::parse(text);
  } catch (const nlohmann::json::exception& error) {
    const auto* const syntax = dynamic_cast<const nlohmann::json::parse_error*>(&error);
    fail(syntax ? syntax->byte : 0, "is not valid");
  }
  if (!json.is_object()) fail(0, "is no object");
  return json;
}

std::string edited_json(std::string_view text, const GltfJson& before, const GltfJson& now) {
  return JsonEditor(text).run(before, now);
}

GltfPart::GltfPart(const std::filesystem::path& path, const GltfJson& json, std::string pointer)
    : path_(&path), json_(&json), pointer_(std::move(pointer)) {
  if (!json.is_object()) fail("is no object");
}

void GltfPart::fail(const std::string& what) const {
  throw FormatError(path_->string() + ": " + (pointer_.empty() ? "/" : pointer_) + ": " + what);
}

void GltfPart::fail_at(const char* key, const std::string& what) const {
  throw FormatError(path_->string() + ": " + pointer_ + "/" + key + ": " + what);
}

const GltfJson& GltfPart::at(const char* key) const {
  const auto found = json_->find(key);
  if (found == json_->end()) fail(std::string("has no ") + key);
  return *found;
}

const GltfJson& GltfPart::array(const char* key) const {
  static const GltfJson none = GltfJson::array();
  if (!has(key)) return none;
  if (!at(key).is_array()) fail_at(key, "is no array");
  return at(key);
}

std::vector<std::string> GltfPart::names() const {
  std::vector<std::string> result;
  for (const auto& [name, value] : json_->items()) result.push_back(name);
  return result;
}

GltfPart GltfPart::member(const char* key) const { return {*path_, at(key), pointer_ + "/" + key}; }

std::string GltfPart::text(const char* key) const {
  if (!at(key).is_string()) fail_at(key, "is no text");
  return at(key).get<std::string>();
}

std::vector<std::string> GltfPart::texts(const char* key) const {
  std::vector<std::string> result;
  for (const GltfJson& value : array(key)) {
    if (!value.is_string()) fail_at(key, "holds what is no text");
    result.push_back(value.get<std::string>());
  }
  return result;
}

bool GltfPart::flag(const char* key) const {
  if (!has(key)) return false;
  if (!at(key).is_boolean()) fail_at(key, "is neither true nor false");
  return at(key).get<bool>();
}

std::uint64_t GltfPart::whole(const char* key) const {
  if (!at(key).is_number_unsigned()) fail_at(key, "is no whole number");
  return at(key).get<std::uint64_t>();
}

std::uint64_t GltfPart::whole_or(const char* key, std::uint64_t otherwise) const {
  return has(key) ? whole(key) : otherwise;
}

std::optional<std::size_t> GltfPart::index(const char* key, std::size_t count) const {
  if (!has(key)) return std::nullopt;
  const std::uint64_t value = whole(key);
  if (value >= count) fail_at(key, "names element " + std::to_string(value) + " of " + std::to_string(count));
  return static_cast<std::size_t>(value);
}

std::vector<std::size_t> GltfPart::indices(const char* key, std::size_t count) const {
  std::vector<std::size_t> result;
  for (const GltfJson& value : array(key)) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
      fail_at(key, "holds what is no number of one of " + std::to_string(count) + " elements");
    result.push_back(value.get<std::size_t>());
  }
  return result;
}

Eigen::VectorXd GltfPart::numbers(const char* key, const Eigen::VectorXd& otherwise) const {
  if (!has(key)) return otherwise;
  Eigen::VectorXd result(otherwise.size());
  const GltfJson& values = at(key);
  bool fits = values.is_array() && values.size() == static_cast<std::size_t>(otherwise.size());
  for (Eigen::Index i = 0; fits && i < result.size(); ++i) {
    const GltfJson& value = values[static_cast<std::size_t>(i)];
    fits = value.is_number();
    if (fits) result[i] = value.get<double>();
  }
  if (!fits || !result.allFinite())
    fail_at(key, "must be " + std::to_string(otherwise.size()) + " finite numbers");
  return result;
}

std::vector<GltfPart> GltfPart::elements(const char* key) const {
  std::vector<GltfPart> result;
  const GltfJson& values = array(key);
  result.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    result.emplace_back(*path_, values[i], pointer_ + "/" + key + "/" + std::to_string(i));
  return result;
}

}  // namespace bespoke

#include "bespoke/mesh/detail/mesh_file_formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "bespoke/mesh/detail/text_lines.h"

namespace bespoke {
namespace {

static_assert(std::endian::native == std::endian::little);

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Scalar type;
  std::optional<Scalar> count;  ///< of a list
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;
};

struct Header {
  enum class Encoding { ascii, little, big } encoding = Encoding::ascii;
  std::vector<Element> elements;
};

Scalar scalar(TextLines& lines) {
  const std::string_view word = lines.word();
  if (word == "char" || word == "int8") return Scalar::int8;
  if (word == "uchar" || word == "uint8") return Scalar::uint8;
  if (word == "short" || word == "int16") return Scalar::int16;
  if (word == "ushort" || word == "uint16") return Scalar::uint16;
  if (word == "int" || word == "int32") return Scalar::int32;
  if (word == "uint" || word == "uint32") return Scalar::uint32;
  if (word == "float" || word == "float32") return Scalar::float32;
  if (word == "double" || word == "float64") return Scalar::float64;
  lines.fail("unknown type '" + std::string(word.substr(0, 40)) + "'");
}

std::size_t size(Scalar type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

Header::Encoding read_encoding(TextLines& lines) {
  const std::string_view word = lines.word();
  if (word == "ascii") return Header::Encoding::ascii;
  if (word == "binary_little_endian") return Header::Encoding::little;
  if (word == "binary_big_endian") return Header::Encoding::big;
  lines.fail("unknown format '" + std::string(word.substr(0, 40)) + "'");
}

Header read_header(TextLines& lines) {
  if (!lines.next() || lines.word() != "ply") lines.fail("a PLY file begins with ply");
  Header header;
  bool has_format = false;
  while (true) {
    if (!lines.next()) lines.fail("the file ends before end_header");
    const std::string_view keyword = lines.word();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.encoding = read_encoding(lines);
      has_format = true;
    } else if (keyword == "element") {
      Element element;
      element.name = lines.word();
      element.count = lines.integer("number of elements");
      if (!(element.count >= 0 && element.count <= std::numeric_limits<int>::max()))
        lines.fail("cannot hold " + std::to_string(element.count) + " elements");
      header.elements.push_back(element);
    } else if (keyword == "property") {
      if (header.elements.empty()) lines.fail("a property before the first element");
      Property property;
      TextLines ahead = lines;
      if (ahead.word() == "list") {
        lines.word();
        property.count = scalar(lines);
        if (*property.count >= Scalar::float32) lines.fail("the length of a list must be a whole number");
      }
      property.type = scalar(lines);
      property.name = lines.word();
      header.elements.back().properties.push_back(property);
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      lines.fail("unknown word '" + std::string(keyword.substr(0, 40)) + "' in the header");
    }
  }
  if (!has_format) lines.fail("the header names no format");
  return header;
}

/// The values of the body, one after the other, whatever they are stored as.
class Body {
 public:
  Body(const std::filesystem::path& path, std::string_view bytes, const TextLines& lines,
       Header::Encoding encoding)
      : path_(path), bytes_(bytes), at_(lines.offset()), lines_(lines), encoding_(encoding) {}

  void begin_element(const Element& element, long long index) {
    element_ = &element;
    index_ = index;
    if (encoding_ == Header::Encoding::ascii && !element.properties.empty() && !lines_.next_with_words())
      fail("the file ends here");
  }

  double value(Scalar type, const char* what) {
    if (encoding_ == Header::Encoding::ascii)
      return type >= Scalar::float32 ? lines_.number(what) : static_cast<double>(lines_.integer(what));
    switch (type) {
      case Scalar::int8:
        return bits<std::int8_t>();
      case Scalar::uint8:
        return bits<std::uint8_t>();
      case Scalar::int16:
        return bits<std::int16_t>();
      case Scalar::uint16:
        return bits<std::uint16_t>();
      case Scalar::int32:
        return bits<std::int32_t>();
      case Scalar::uint32:
        return bits<std::uint32_t>();
      case Scalar::float32:
        return bits<float>();
      case Scalar::float64:
        break;
    }
    return bits<double>();
  }

  long long length(Scalar type) {
    const auto result = static_cast<long long>(value(type, "length of a list"));
    if (!(result >= 0)) fail("a list of negative length");
    return result;
  }

  // Values that nobody asks for may be anything, "nan" included.
  void skip(const Property& property) {
    const long long values = property.count ? length(*property.count) : 1;
    if (encoding_ != Header::Encoding::ascii) {
      if (static_cast<std::size_t>(values) > (bytes_.size() - at_) / size(property.type))
        fail("the file ends here");
      at_ += static_cast<std::size_t>(values) * size(property.type);
      return;
    }
    for (long long i = 0; i < values; ++i)
      if (lines_.word().empty()) lines_.fail("missing " + property.name);
  }

  [[noreturn]] void fail(const std::string& what) const {
    if (encoding_ == Header::Encoding::ascii) lines_.fail(what);
    throw FormatError(path_.string() + ": " + element_->name + " " + std::to_string(index_) + " of " +
                      std::to_string(element_->count) + ": " + what);
  }

 private:
  template <class Value>
  double bits() {
    if (bytes_.size() - at_ < sizeof(Value)) fail("the file ends here");
    std::array<char, sizeof(Value)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(Value));
    at_ += sizeof(Value);
    if (encoding_ == Header::Encoding::big) std::reverse(raw.begin(), raw.end());
    return static_cast<double>(std::bit_cast<Value>(raw));
  }

  std::filesystem::path path_;
  std::string_view bytes_;
  std::size_t at_;
  TextLines lines_;
  Header::Encoding encoding_;
  const Element* element_ = nullptr;
  long long index_ = 0;
};

template <class Value>
void append(std::string& content, double value) {
  const auto stored = static_cast<Value>(value);
  content.append(reinterpret_cast<const char*>(&stored), sizeof stored);
}

// Slots of what OpenMesh is told of a vertex; the names are those of several programs.
int slot(std::string_view name) {
  if (name == "x") return 0;
  if (name == "y") return 1;
  if (name == "z") return 2;
  if (name == "u" || name == "s" || name == "texture_u") return 3;
  if (name == "v" || name == "t" || name == "texture_v") return 4;
  return -1;
}

class PlyCheck {
 public:
  PlyCheck(const std::filesystem::path& path, const std::string& content)
      : path_(path),
        lines_(path, content),
        header_(read_header(lines_)),
        body_(path, content, lines_, header_.encoding) {}

  MeshFile run() {
    const Element* vertex = find("vertex");
    if (!vertex || vertex->count == 0) throw FormatError(path_.string() + ": the file has no vertices");
    for (const char* axis : {"x", "y", "z"})
      if (std::none_of(vertex->properties.begin(), vertex->properties.end(),
                       [&](const Property& p) { return p.name == axis && !p.count; }))
        throw FormatError(path_.string() + ": vertices have no " + axis);
    for (const Property& property : vertex->properties) {
      textured_ = textured_ || slot(property.name) == 4;
      file_.normals = file_.normals || property.name == "nx";
    }
    vertices_ = vertex->count;
    for (const Element& element : header_.elements) {
      for (long long i = 0; i < element.count; ++i) {
        body_.begin_element(element, i);
        if (&element == vertex) {
          read_vertex(element);
        } else if (element.name == "face") {
          read_face(element);
        } else {
          for (const Property& property : element.properties) body_.skip(property);
        }
      }
    }
    return finish();
  }

 private:
  const Element* find(std::string_view name) const {
    const auto at = std::find_if(header_.elements.begin(), header_.elements.end(),
                                 [&](const Element& e) { return e.name == name; });
    return at == header_.elements.end() ? nullptr : &*at;
  }

  void read_vertex(const Element& element) {
    std::array<double, 5> values{};
    for (const Property& property : element.properties) {
      const int at = property.count ? -1 : slot(property.name);
      if (at < 0) {
        body_.skip(property);
        continue;
      }
      const double value = body_.value(property.type, property.name.c_str());
      if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max())))
        body_.fail(property.name + " is not finite in single precision");
      values[static_cast<std::size_t>(at)] = value;
    }
    for (std::size_t i = 0; i < (textured_ ? 5u : 3u); ++i) append<float>(vertex_bytes_, values[i]);
  }

  void read_face(const Element& element) {
    for (const Property& property : element.properties) {
      if (!property.count || (property.name != "vertex_indices" && property.name != "vertex_index")) {
        body_.skip(property);
        continue;
      }
      const long long corners = body_.length(*property.count);
      polygon_.clear();
      for (long long i = 0; i < corners; ++i)
        polygon_.push_back(static_cast<long long>(body_.value(property.type, "corner")));
      const std::string fault = polygon_fault(polygon_, 0, vertices_);
      if (!fault.empty()) body_.fail(fault);
      append<std::int32_t>(face_bytes_, static_cast<double>(corners));
      for (const long long corner : polygon_) append<std::int32_t>(face_bytes_, static_cast<double>(corner));
      ++file_.polygons;
    }
  }

  MeshFile finish() {
    file_.content = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices_) +
                    "\nproperty float x\nproperty float y\nproperty float z\n";
    if (textured_) file_.content += "property float u\nproperty float v\n";
    file_.content += "element face " + std::to_string(file_.polygons) +
                     "\nproperty list int int vertex_indices\nend_header\n" + vertex_bytes_ + face_bytes_;
    file_.binary = true;
    file_.vertices = static_cast<std::size_t>(vertices_);
    return std::move(file_);
  }

  std::filesystem::path path_;
  TextLines lines_;
  Header header_;
  Body body_;
  MeshFile file_;
  bool textured_ = false;
  long long vertices_ = 0;
  std::vector<long long> polygon_;
  std::string vertex_bytes_, face_bytes_;
};

}  // namespace

MeshFile check_ply(const std::filesystem::path& path, const std::string& content) {
  return PlyCheck(path, content).run();
}

}  // namespace bespoke

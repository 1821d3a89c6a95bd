#include <zlib.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <new>
#include <ostream>
#include <string>
#include <string_view>

#include "bespoke/error.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/threemf/threemf_model.h"

namespace bespoke {
namespace {

constexpr std::string_view content_types =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
    "</Types>\n";
constexpr std::string_view relationships =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Id=\"rel0\" Target=\"/3D/3dmodel.model\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

void require_short(std::size_t size) {
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("a 3MF file would have more than the 4 GB that it can have");
}

void append_little_endian(std::string& bytes, std::size_t value, int count) {
  require_short(value);
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
}

std::string deflated(std::string_view text) {
  require_short(text.size());
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string result(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

/// A ZIP archive of files without dates, so that the same model has the same bytes.
class ZipWriter {
 public:
  void add(std::string_view name, std::string_view text) {
    constexpr std::size_t first_day = 0x21;  // 1 January 1980: there is no earlier one
    const std::string stored = deflated(text);
    std::string common;
    append_little_endian(common, 20, 2);  // version 2.0 reads it
    append_little_endian(common, 0, 2);
    append_little_endian(common, Z_DEFLATED, 2);
    append_little_endian(common, first_day << 16, 4);
    append_little_endian(
        common, crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())), 4);
    append_little_endian(common, stored.size(), 4);
    append_little_endian(common, text.size(), 4);
    append_little_endian(common, name.size(), 2);
    append_little_endian(common, 0, 2);
    directory_ += "PK\1\2";
    append_little_endian(directory_, 20, 2);
    directory_ += common;
    directory_.append(10, '\0');
    append_little_endian(directory_, archive_.size(), 4);
    directory_ += name;
    archive_ += "PK\3\4" + common;
    archive_ += name;
    archive_ += stored;
    ++files_;
  }

  std::string content() const {
    std::string end = "PK\5\6";
    append_little_endian(end, 0, 4);
    append_little_endian(end, files_, 2);
    append_little_endian(end, files_, 2);
    append_little_endian(end, directory_.size(), 4);
    append_little_endian(end, archive_.size(), 4);
    append_little_endian(end, 0, 2);
    return archive_ + directory_ + end;
  }

 private:
  std::string archive_, directory_;
  std::size_t files_ = 0;
};

template <class Number>
void append_attribute(std::string& text, const char* name, Number value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(" ").append(name).append("=\"").append(digits.data(), end.ptr).append("\"");
}

std::string model_of(const WrittenFaces& faces) {
  constexpr std::array axes{"x", "y", "z"};
  constexpr std::array corners{"v1", "v2", "v3"};
  const Product& product = faces.product;
  const std::string unit = product.unit.empty() ? "millimeter" : threemf_name_of_unit(product.unit);
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"" + unit +
                     "\" xml:lang=\"en-US\" "
                     "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
                     "<resources>\n<object id=\"1\" type=\"model\">\n<mesh>\n<vertices>\n";
  for (const auto& vertex : product.vertices.colwise()) {
    text += "<vertex";
    for (std::size_t k = 0; k < 3; ++k)
      if (const double value = vertex[static_cast<Eigen::Index>(k)]; faces.as_doubles)
        append_attribute(text, axes[k], value);
      else
        append_attribute(text, axes[k], static_cast<float>(value));
    text += "/>\n";
  }
  text += "</vertices>\n<triangles>\n";
  const Faces triangles = triangulated(product);
  for (const auto& triangle : triangles.colwise()) {
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
    text += "<triangle";
    for (std::size_t k = 0; k < 3; ++k)
      append_attribute(text, corners[k], triangle[static_cast<Eigen::Index>(k)]);
    text += "/>\n";
  }
  return text +
         "</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"1\"/>\n</build>\n"
         "</model>\n";
}

}  // namespace

void write_3mf_faces(std::ostream& out, const WrittenFaces& faces) {
  ZipWriter archive;
  archive.add("[Content_Types].xml", content_types);
  archive.add("_rels/.rels", relationships);
  archive.add("3D/3dmodel.model", model_of(faces));
  out << archive.content();
}

}  // namespace bespoke

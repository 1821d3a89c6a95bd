#include <zip.h>

#include <array>
#include <charconv>
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

/// A ZIP archive of files without dates, so that the same model has the same bytes.
class ZipWriter {
 public:
  ZipWriter() {
    memory_ = zip_source_buffer_create(nullptr, 0, 0, nullptr);
    require(memory_ != nullptr);
    zip_source_keep(memory_);  // the archive takes one reference
    archive_ = zip_open_from_source(memory_, ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    require(archive_ != nullptr);
  }
  ~ZipWriter() {
    if (archive_) zip_discard(archive_);
    zip_source_free(memory_);
  }
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// `text` must stay until `content`.
  void add(const char* name, std::string_view text) {
    zip_source_t* const source = zip_source_buffer(archive_, text.data(), text.size(), 0);
    const zip_int64_t index = zip_file_add(archive_, name, source, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(source);
    require(index >= 0);
    constexpr zip_uint16_t first_day = 0x21;  // 1 January 1980: there is no earlier one
    require(zip_file_set_dostime(archive_, static_cast<zip_uint64_t>(index), 0, first_day, 0) == 0);
  }

  std::string content() {
    require(zip_close(archive_) == 0);
    archive_ = nullptr;
    zip_stat_t stat;
    require(zip_source_stat(memory_, &stat) == 0 && zip_source_open(memory_) == 0);
    std::string bytes(stat.size, '\0');
    require(zip_source_read(memory_, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size()));
    zip_source_close(memory_);
    return bytes;
  }

 private:
  /// All is in memory: nothing else can go wrong.
  static void require(bool succeeded) {
    if (!succeeded) throw MemoryLimitError("no memory to write a 3MF file");
  }

  zip_source_t* memory_ = nullptr;
  zip_t* archive_ = nullptr;
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
  const std::string model = model_of(faces);
  archive.add("3D/3dmodel.model", model);
  out << archive.content();
}

}  // namespace bespoke

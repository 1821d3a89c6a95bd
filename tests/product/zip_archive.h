#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace bespoke::test {

inline std::string little_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 0xff);
  return text;
}

inline std::string deflated(const std::string& text) {
  std::string result(compressBound(text.size()) + 16, '\0');
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  deflateEnd(&stream);
  return result.substr(0, stream.total_out);
}

struct ZipStyle {
  bool deflate = true;
  bool wide = false;  ///< sizes in 64 bits, as some programs write them always
};

/// An archive of named texts.
inline std::string zip_archive(const std::vector<std::pair<std::string, std::string>>& files,
                               const ZipStyle& style = {}) {
  std::string archive, directory;
  for (const auto& [name, text] : files) {
    const std::string stored = style.deflate ? deflated(text) : text;
    const auto checksum =
        crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
    const std::string wide = little_endian(1, 2) + little_endian(24, 2) + little_endian(text.size(), 8) +
                             little_endian(stored.size(), 8) + little_endian(archive.size(), 8);
    const auto narrow = [&](std::size_t value) { return little_endian(style.wide ? 0xffffffffu : value, 4); };
    const std::string common = little_endian(style.wide ? 45 : 20, 2) + little_endian(0, 2) +
                               little_endian(style.deflate ? 8 : 0, 2) + little_endian(0, 4) +
                               little_endian(checksum, 4);
    directory += "PK\1\2" + little_endian(45, 2) + common + narrow(stored.size()) + narrow(text.size()) +
                 little_endian(name.size(), 2) + little_endian(style.wide ? wide.size() : 0, 2) +
                 little_endian(0, 8) + little_endian(0, 2) + narrow(archive.size()) + name +
                 (style.wide ? wide : "");
    archive += "PK\3\4" + common + little_endian(stored.size(), 4) + little_endian(text.size(), 4) +
               little_endian(name.size(), 2) + little_endian(0, 2) + name + stored;
  }
  const std::size_t offset = archive.size();
  archive += directory;
  if (style.wide) {
    const std::size_t end = archive.size();
    archive += "PK\6\6" + little_endian(44, 8) + little_endian(45, 2) + little_endian(45, 2) +
               little_endian(0, 8) + little_endian(files.size(), 8) + little_endian(files.size(), 8) +
               little_endian(directory.size(), 8) + little_endian(offset, 8);
    archive += "PK\6\7" + little_endian(0, 4) + little_endian(end, 8) + little_endian(1, 4);
  }
  return archive + "PK\5\6" + little_endian(0, 4) + little_endian(files.size(), 2) +
         little_endian(files.size(), 2) + little_endian(directory.size(), 4) +
         little_endian(style.wide ? 0xffffffffu : offset, 4) + little_endian(0, 2);
}

/// A 3MF package with this model as its root.
inline std::vector<std::pair<std::string, std::string>> package_of(const std::string& model) {
  return {{"_rels/.rels",
           "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
           "<Relationship Id=\"r0\" Target=\"/3D/3dmodel.model\" "
           "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"},
          {"3D/3dmodel.model", model}};
}

inline std::string model_text(const std::string& resources, const std::string& build,
                              const std::string& attributes = "") {
  return "<?xml version=\"1.0\"?>\n<model "
         "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" " +
         attributes + ">\n<resources>\n" + resources + "\n</resources>\n<build>" + build +
         "</build>\n</model>\n";
}

/// A tetrahedron with its right angle at the origin, edges 1, 2 and 3 along the axes.
inline std::string tetrahedron(int id = 1) {
  return "<object id=\"" + std::to_string(id) +
         "\"><mesh><vertices>\n<vertex x=\"0\" y=\"0\" z=\"0\"/>\n<vertex x=\"1\" y=\"0\" z=\"0\"/>\n"
         "<vertex x=\"0\" y=\"2\" z=\"0\"/>\n<vertex x=\"0\" y=\"0\" z=\"3\"/>\n</vertices>\n<triangles>\n"
         "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/>\n<triangle v1=\"0\" v2=\"1\" v3=\"3\"/>\n"
         "<triangle v1=\"0\" v2=\"3\" v3=\"2\"/>\n<triangle v1=\"1\" v2=\"2\" v3=\"3\"/>\n"
         "</triangles></mesh></object>";
}

inline const std::string shown_once = "<item objectid=\"1\"/>";

}  // namespace bespoke::test

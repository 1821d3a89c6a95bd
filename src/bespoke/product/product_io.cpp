#include "bespoke/product/product_io.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/strings.h"
#include "bespoke/unknown_ending.h"

namespace bespoke {
namespace {

struct FaceFormat {
  std::string_view ending;
  Product (*read)(const InputFile&);
  void (*write)(std::ostream&, const WrittenFaces&) = nullptr;  ///< where the format is written
};

constexpr std::array face_formats{FaceFormat{".obj", read_obj_faces, write_obj_faces},
                                  FaceFormat{".ply", read_ply_faces, write_ply_faces},
                                  FaceFormat{".stl", read_stl_faces, write_stl_faces},
                                  FaceFormat{".off", read_off_faces, write_off_faces},
                                  FaceFormat{".gltf", read_gltf_faces},
                                  FaceFormat{".glb", read_gltf_faces},
                                  FaceFormat{".3mf", read_3mf_faces, write_3mf_faces}};

const FaceFormat* find_face_format(const std::filesystem::path& path) {
  const auto at = std::find_if(
      face_formats.begin(), face_formats.end(),
      [ending = lower_ending(path)](const FaceFormat& format) { return format.ending == ending; });
  return at == face_formats.end() ? nullptr : &*at;
}

std::string endings(bool written) {
  std::vector<std::string> known;
  for (const FaceFormat& format : face_formats)
    if (!written || format.write) known.emplace_back(format.ending);
  return alternatives(known);
}

void require_writable(const std::filesystem::path& path, const Product& product) {
  const double* const values = product.vertices.data();
  if (!std::all_of(values, values + product.vertices.size(), fits_float))
    throw InvalidInput("cannot write " + path.string() + ": a coordinate is not finite in single precision");
  const std::string_view ending = find_face_format(path)->ending;
  if ((ending == ".stl" || ending == ".3mf") && product.corners.empty())
    throw InvalidInput("cannot write " + path.string() + ": " + (ending == ".stl" ? "STL" : "3MF") +
                       " holds triangles only, and there are none");
}

/// Whether rounding to floats would move a vertex by more than the resolution that carried products keep.
bool needs_doubles(const Points& vertices) {
  constexpr double resolution = 1e-7;  // of the diagonal
  const Points lost = vertices - vertices.cast<float>().cast<double>();
  return lost.size() > 0 && lost.cwiseAbs().maxCoeff() > resolution * diagonal(vertices);
}

}  // namespace

bool can_read_product(const std::filesystem::path& path) { return find_face_format(path) != nullptr; }

bool can_write_product(const std::filesystem::path& path) {
  const FaceFormat* const format = find_face_format(path);
  return format && format->write;
}

std::string read_product_endings() { return endings(false); }
std::string written_product_endings() { return endings(true); }

std::string conversion_advice(const std::filesystem::path& path) {
  constexpr std::array usd_endings{".usd", ".usda", ".usdc", ".usdz"};
  if (std::find(usd_endings.begin(), usd_endings.end(), lower_ending(path)) == usd_endings.end()) return "";
  return "; USD is not read: convert it to .glb, for instance with Blender from blender.org";
}

Product read_product(const std::filesystem::path& path) {
  const FaceFormat* const format = find_face_format(path);
  if (!format)
    throw UnknownEnding(path.string() + ": the name must end in " + read_product_endings() +
                        conversion_advice(path));
  Product product = format->read(InputFile(path));
  product.unit = unit_of_format(path);
  return product;
}

void write_product(const std::filesystem::path& path, const Product& product) {
  if (!can_write_product(path))
    throw UnknownEnding(path.string() + ": the name must end in " + written_product_endings());
  require_writable(path, product);
  WrittenFaces faces{product, {}, needs_doubles(product.vertices)};
  if (product.has_normals) faces.normals = vertex_normals({product.vertices, triangulated(product)});
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream stream(temporary, std::ios::binary);
    find_face_format(path)->write(stream, faces);
    stream.close();
    if (!stream) throw FileError("cannot write " + path.string() + ": " + std::strerror(errno));
  });
}

namespace {

std::string counted(const DegenerateFaces& faces, const std::string& fate) {
  return std::to_string(faces.count) +
         (faces.count == 1 ? " degenerate face, which was " : " degenerate faces, which were ") + fate +
         " (" + faces.first + ")";
}

}  // namespace

std::string to_string(const DegenerateFaces& faces) { return counted(faces, "kept"); }

std::string left_out_text(const DegenerateFaces& faces) { return counted(faces, "left out"); }

Faces triangulated(const Product& product) {
  std::vector<int> triangles;
  for (std::size_t polygon = 0; polygon + 1 < product.polygon_start.size(); ++polygon) {
    const int* corner = product.corners.data() + product.polygon_start[polygon];
    const int corners = product.polygon_start[polygon + 1] - product.polygon_start[polygon];
    for (int k = 2; k < corners; ++k)
      if (corner[0] != corner[k - 1] && corner[k - 1] != corner[k] && corner[k] != corner[0])
        triangles.insert(triangles.end(), {corner[0], corner[k - 1], corner[k]});
  }
  return Eigen::Map<const Faces>(triangles.data(), 3, static_cast<Eigen::Index>(triangles.size() / 3));
}

}  // namespace bespoke

#include "bespoke/mesh/product_io.h"

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/exporter/BaseExporter.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <mutex>
#include <sstream>
#include <string>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/mesh/detail/mesh_file.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {
namespace {

namespace om = OpenMesh;

/// OpenMesh's readers and writers are global objects with state, and print to the terminal.
class OpenMeshSession {
 public:
  OpenMeshSession() : lock_(mutex()) {
    ::omlog().disable();
    ::omerr().disable();
    ::omout().disable();
  }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
};

/// Takes what a reader found as it is, without half-edges, so that any surface will do.
class Importer : public om::IO::BaseImporter {
 public:
  std::vector<Vector3> vertices;
  std::vector<int> polygon_start{0};
  std::vector<int> corners;
  std::vector<om::Vec2f> corner_texture;  ///< as long as the last face that has some
  std::vector<om::Vec2f> vertex_texture;
  bool has_normals = false;

  om::VertexHandle add_vertex(const om::Vec3f& point) override {
    vertices.emplace_back(point[0], point[1], point[2]);
    return om::VertexHandle(static_cast<int>(vertices.size()) - 1);
  }
  om::VertexHandle add_vertex(const om::Vec3d& point) override {
    vertices.emplace_back(point[0], point[1], point[2]);
    return om::VertexHandle(static_cast<int>(vertices.size()) - 1);
  }
  om::VertexHandle add_vertex() override { return add_vertex(om::Vec3f(0, 0, 0)); }
  void set_point(om::VertexHandle vertex, const om::Vec3f& point) override {
    vertices[static_cast<std::size_t>(vertex.idx())] = Vector3(point[0], point[1], point[2]);
  }
  om::FaceHandle add_face(const VHandles& polygon) override {
    for (const om::VertexHandle vertex : polygon) corners.push_back(vertex.idx());
    polygon_start.push_back(static_cast<int>(corners.size()));
    return om::FaceHandle(static_cast<int>(polygon_start.size()) - 2);
  }
  void add_face_texcoords(om::FaceHandle face, om::VertexHandle,
                          const std::vector<om::Vec2f>& texture) override {
    if (texture.empty()) return;
    const auto begin = static_cast<std::size_t>(polygon_start[static_cast<std::size_t>(face.idx())]);
    corner_texture.resize(corners.size(), om::Vec2f(0, 0));
    std::copy(texture.begin(),
              texture.begin() + static_cast<std::ptrdiff_t>(std::min(texture.size(), corners.size() - begin)),
              corner_texture.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  void set_texcoord(om::VertexHandle vertex, const om::Vec2f& texture) override {
    vertex_texture.resize(std::max(vertex_texture.size(), vertices.size()), om::Vec2f(0, 0));
    vertex_texture[static_cast<std::size_t>(vertex.idx())] = texture;
  }
  void set_normal(om::VertexHandle, const om::Vec3f&) override { has_normals = true; }
  void set_normal(om::VertexHandle, const om::Vec3d&) override { has_normals = true; }
  std::size_t n_vertices() const override { return vertices.size(); }
  std::size_t n_faces() const override { return polygon_start.size() - 1; }
  std::size_t n_edges() const override { return 0; }

  // What a product does not carry.
  om::HalfedgeHandle add_edge(om::VertexHandle, om::VertexHandle) override { return om::HalfedgeHandle(); }
  om::FaceHandle add_face(om::HalfedgeHandle) override { return om::FaceHandle(); }
  void add_face_texcoords(om::FaceHandle, om::VertexHandle, const std::vector<om::Vec3f>&) override {}
  void set_face_texindex(om::FaceHandle, int) override {}
  void set_halfedge(om::VertexHandle, om::HalfedgeHandle) override {}
  void set_color(om::VertexHandle, const om::Vec3uc&) override {}
  void set_color(om::VertexHandle, const om::Vec4uc&) override {}
  void set_color(om::VertexHandle, const om::Vec3f&) override {}
  void set_color(om::VertexHandle, const om::Vec4f&) override {}
  void set_status(om::VertexHandle, const om::Attributes::StatusInfo&) override {}
  void set_next(om::HalfedgeHandle, om::HalfedgeHandle) override {}
  void set_face(om::HalfedgeHandle, om::FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec2f&) override {}
  void set_texcoord(om::VertexHandle, const om::Vec3f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec3f&) override {}
  void set_status(om::HalfedgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_color(om::EdgeHandle, const om::Vec3uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec4uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec3f&) override {}
  void set_color(om::EdgeHandle, const om::Vec4f&) override {}
  void set_status(om::EdgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_normal(om::FaceHandle, const om::Vec3f&) override {}
  void set_normal(om::FaceHandle, const om::Vec3d&) override {}
  void set_color(om::FaceHandle, const om::Vec3uc&) override {}
  void set_color(om::FaceHandle, const om::Vec4uc&) override {}
  void set_color(om::FaceHandle, const om::Vec3f&) override {}
  void set_color(om::FaceHandle, const om::Vec4f&) override {}
  void set_status(om::FaceHandle, const om::Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}
};

om::Vec3f rounded(const auto& vector) {
  return {static_cast<float>(vector(0)), static_cast<float>(vector(1)), static_cast<float>(vector(2))};
}

/// Shows a product to a writer. A half-edge handle is the index of a corner.
class Exporter : public om::IO::BaseExporter {
 public:
  explicit Exporter(const Product& product) : product_(product) {
    if (product.has_normals) normals_ = vertex_normals({product.vertices, triangulated(product)});
  }

  om::Vec3f point(om::VertexHandle vertex) const override {
    return rounded(product_.vertices.col(vertex.idx()));
  }
  om::Vec3f normal(om::VertexHandle vertex) const override {
    return product_.has_normals ? rounded(normals_.col(vertex.idx())) : om::Vec3f(0, 0, 0);
  }
  om::Vec2f texcoord(om::HalfedgeHandle corner) const override {
    return {static_cast<float>(product_.texture(0, corner.idx())),
            static_cast<float>(product_.texture(1, corner.idx()))};
  }
  unsigned int get_vhandles(om::FaceHandle face, std::vector<om::VertexHandle>& vertices) const override {
    vertices.clear();
    for (int corner = begin(face); corner < end(face); ++corner) vertices.emplace_back(vertex_at(corner));
    return static_cast<unsigned int>(vertices.size());
  }
  om::HalfedgeHandle getHeh(om::FaceHandle face, om::VertexHandle vertex) const override {
    for (int corner = begin(face); corner < end(face); ++corner)
      if (vertex_at(corner) == vertex.idx()) return om::HalfedgeHandle(corner);
    return om::HalfedgeHandle();
  }
  unsigned int get_face_texcoords(std::vector<om::Vec2f>& texture) const override {
    for (int corner = 0; corner < product_.texture.cols(); ++corner)
      texture.push_back(texcoord(om::HalfedgeHandle(corner)));
    return static_cast<unsigned int>(texture.size());
  }
  std::size_t n_vertices() const override { return static_cast<std::size_t>(product_.vertices.cols()); }
  std::size_t n_faces() const override {
    return product_.polygon_start.empty() ? 0 : product_.polygon_start.size() - 1;
  }
  std::size_t n_edges() const override { return 0; }
  bool has_vertex_normals() const override { return product_.has_normals; }
  bool has_vertex_texcoords() const override { return product_.texture.cols() > 0; }
  const om::BaseKernel* kernel() override { return &kernel_; }  // the PLY writer follows it unasked

  // What a product does not carry.
  om::Vec3d pointd(om::VertexHandle vertex) const override { return om::Vec3d(point(vertex)); }
  bool is_point_double() const override { return false; }
  om::Vec3d normald(om::VertexHandle vertex) const override { return om::Vec3d(normal(vertex)); }
  bool is_normal_double() const override { return false; }
  om::Vec3uc color(om::VertexHandle) const override { return om::Vec3uc(0, 0, 0); }
  om::Vec4uc colorA(om::VertexHandle) const override { return om::Vec4uc(0, 0, 0, 0); }
  om::Vec3ui colori(om::VertexHandle) const override { return om::Vec3ui(0, 0, 0); }
  om::Vec4ui colorAi(om::VertexHandle) const override { return om::Vec4ui(0, 0, 0, 0); }
  om::Vec3f colorf(om::VertexHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec4f colorAf(om::VertexHandle) const override { return om::Vec4f(0, 0, 0, 0); }
  om::Vec2f texcoord(om::VertexHandle) const override { return om::Vec2f(0, 0); }
  om::Attributes::StatusInfo status(om::VertexHandle) const override { return {}; }
  om::Vec3f normal(om::FaceHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec3d normald(om::FaceHandle) const override { return om::Vec3d(0, 0, 0); }
  om::Vec3uc color(om::FaceHandle) const override { return om::Vec3uc(0, 0, 0); }
  om::Vec4uc colorA(om::FaceHandle) const override { return om::Vec4uc(0, 0, 0, 0); }
  om::Vec3ui colori(om::FaceHandle) const override { return om::Vec3ui(0, 0, 0); }
  om::Vec4ui colorAi(om::FaceHandle) const override { return om::Vec4ui(0, 0, 0, 0); }
  om::Vec3f colorf(om::FaceHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec4f colorAf(om::FaceHandle) const override { return om::Vec4f(0, 0, 0, 0); }
  om::Attributes::StatusInfo status(om::FaceHandle) const override { return {}; }
  om::Vec3uc color(om::EdgeHandle) const override { return om::Vec3uc(0, 0, 0); }
  om::Vec4uc colorA(om::EdgeHandle) const override { return om::Vec4uc(0, 0, 0, 0); }
  om::Vec3ui colori(om::EdgeHandle) const override { return om::Vec3ui(0, 0, 0); }
  om::Vec4ui colorAi(om::EdgeHandle) const override { return om::Vec4ui(0, 0, 0, 0); }
  om::Vec3f colorf(om::EdgeHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec4f colorAf(om::EdgeHandle) const override { return om::Vec4f(0, 0, 0, 0); }
  om::Attributes::StatusInfo status(om::EdgeHandle) const override { return {}; }
  int get_halfedge_id(om::VertexHandle) override { return -1; }
  int get_halfedge_id(om::FaceHandle) override { return -1; }
  int get_next_halfedge_id(om::HalfedgeHandle) override { return -1; }
  int get_to_vertex_id(om::HalfedgeHandle) override { return -1; }
  int get_face_id(om::HalfedgeHandle) override { return -1; }
  om::Attributes::StatusInfo status(om::HalfedgeHandle) const override { return {}; }

 private:
  int begin(om::FaceHandle face) const {
    return product_.polygon_start[static_cast<std::size_t>(face.idx())];
  }
  int end(om::FaceHandle face) const {
    return product_.polygon_start[static_cast<std::size_t>(face.idx()) + 1];
  }
  int vertex_at(int corner) const { return product_.corners[static_cast<std::size_t>(corner)]; }

  const Product& product_;
  Points normals_;
  om::BaseKernel kernel_;
};

const char* openmesh_ending(MeshFormat format) {
  switch (format) {
    case MeshFormat::obj:
      return ".obj";
    case MeshFormat::ply:
      return ".ply";
    case MeshFormat::stl:
      return ".stl";
    case MeshFormat::off:
      break;
  }
  return ".off";
}

Product as_product(Importer&& mesh) {
  Product product;
  product.vertices.resize(3, static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    product.vertices.col(static_cast<Eigen::Index>(i)) = mesh.vertices[i];
  const bool by_corner = !mesh.corner_texture.empty();
  if (by_corner || !mesh.vertex_texture.empty()) {
    mesh.corner_texture.resize(mesh.corners.size(), om::Vec2f(0, 0));
    mesh.vertex_texture.resize(mesh.vertices.size(), om::Vec2f(0, 0));
    product.texture.resize(2, static_cast<Eigen::Index>(mesh.corners.size()));
    for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
      const om::Vec2f& texture =
          by_corner ? mesh.corner_texture[i] : mesh.vertex_texture[static_cast<std::size_t>(mesh.corners[i])];
      product.texture.col(static_cast<Eigen::Index>(i)) = Eigen::Vector2d(texture[0], texture[1]);
    }
  }
  product.has_normals = mesh.has_normals;
  product.polygon_start = std::move(mesh.polygon_start);
  product.corners = std::move(mesh.corners);
  return product;
}

Product as_triangles(const Product& product) {
  const Faces faces = triangulated(product);
  Product triangles;
  triangles.vertices = product.vertices;
  triangles.corners.assign(faces.data(), faces.data() + faces.size());
  for (int start = 0; start <= faces.size(); start += 3) triangles.polygon_start.push_back(start);
  return triangles;
}

void require_writable(const std::filesystem::path& path, const Product& product, MeshFormat format) {
  const bool fits =
      product.vertices.size() == 0 ||
      product.vertices.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= std::numeric_limits<float>::max();
  if (!fits)
    throw InvalidInput("cannot write " + path.string() + ": a coordinate is not finite in single precision");
  if (format == MeshFormat::stl && product.corners.empty())
    throw InvalidInput("cannot write " + path.string() + ": STL holds triangles only, and there are none");
}

}  // namespace

Product read_product(const std::filesystem::path& path) {
  MeshFile file = read_mesh_file(path);
  Importer mesh;
  mesh.has_normals = file.normals;
  om::IO::Options options =
      om::IO::Options::VertexNormal | om::IO::Options::VertexTexCoord | om::IO::Options::FaceTexCoord;
  if (file.binary) options += om::IO::Options::Binary;
  std::istringstream stream(std::move(file.content));
  const OpenMeshSession session;
  const bool read = om::IO::IOManager().read(stream, openmesh_ending(mesh_format(path)), mesh, options);
  const bool complete = mesh_format(path) == MeshFormat::stl ||
                        (mesh.n_vertices() == file.vertices && mesh.n_faces() == file.polygons);
  if (!read || !complete)
    throw FormatError(path.string() + ": OpenMesh read " + std::to_string(mesh.n_vertices()) + " of " +
                      std::to_string(file.vertices) + " vertices and " + std::to_string(mesh.n_faces()) +
                      " of " + std::to_string(file.polygons) + " faces");
  return as_product(std::move(mesh));
}

void write_product(const std::filesystem::path& path, const Product& product) {
  const MeshFormat format = mesh_format(path);
  require_writable(path, product, format);
  om::IO::Options options;
  if (product.has_normals && format != MeshFormat::stl) options += om::IO::Options::VertexNormal;
  if (product.texture.cols() > 0 && format == MeshFormat::obj) options += om::IO::Options::FaceTexCoord;
  if (format == MeshFormat::ply || format == MeshFormat::stl) options += om::IO::Options::Binary;
  const Product triangles = format == MeshFormat::stl ? as_triangles(product) : Product();
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream stream(temporary, std::ios::binary);
    Exporter exporter(format == MeshFormat::stl ? triangles : product);
    const OpenMeshSession session;
    constexpr int digits = std::numeric_limits<float>::max_digits10;
    const bool written =
        stream && om::IO::IOManager().write(stream, openmesh_ending(format), exporter, options, digits);
    stream.close();
    if (!written || !stream) throw FileError("cannot write " + path.string() + ": " + std::strerror(errno));
  });
}

Faces triangulated(const Product& product) {
  std::vector<int> triangles;
  for (std::size_t polygon = 0; polygon + 1 < product.polygon_start.size(); ++polygon) {
    const int* corner = product.corners.data() + product.polygon_start[polygon];
    const int corners = product.polygon_start[polygon + 1] - product.polygon_start[polygon];
    for (int k = 2; k < corners; ++k)
      triangles.insert(triangles.end(), {corner[0], corner[k - 1], corner[k]});
  }
  return Eigen::Map<const Faces>(triangles.data(), 3, static_cast<Eigen::Index>(triangles.size() / 3));
}

}  // namespace bespoke

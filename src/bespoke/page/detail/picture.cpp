#include "bespoke/page/detail/picture.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {
namespace {

// Samples along each edge of a pixel: four a pixel smooth the outlines.
constexpr int oversampling = 2;
constexpr double margin = 0.04;  // of the picture, around what is drawn

struct Sample {
  double depth = -std::numeric_limits<double>::infinity();  ///< towards the eye
  Vector3 colour = Vector3::Ones();
};

/// What the eye sees: right, up, towards it.
Points seen(const Points& x, DrawnFrom from) {
  if (from == DrawnFrom::front) return x;
  Points turned(3, x.cols());
  turned << -x.row(2), x.row(1), x.row(0);
  return turned;
}

class Canvas {
 public:
  Canvas(const Box& box, int size)
      : size_(size * oversampling),
        samples_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {
    const double extent = std::max({box.sizes().x(), box.sizes().y(), std::numeric_limits<double>::min()});
    scale_ = size_ * (1 - 2 * margin) / extent;
    centre_ = box.center();
  }

  /// Right and down in samples, towards the eye in mesh units.
  Vector3 place(const Vector3& x) const {
    const Vector3 d = x - centre_;
    return {0.5 * size_ + scale_ * d.x(), 0.5 * size_ - scale_ * d.y(), d.z()};
  }

  void triangle(const std::array<Vector3, 3>& corners, const std::array<Vector3, 3>& colours) {
    std::array<Vector3, 3> p;
    std::transform(corners.begin(), corners.end(), p.begin(), [&](const Vector3& x) { return place(x); });
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    if (!(std::abs(area) > 0)) return;
    const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    const double light = 0.38 + 0.62 * std::abs(normal.z());  // as the page's
    const auto first = [&](double a, double b, double c) {
      return std::max(0, static_cast<int>(std::ceil(std::min({a, b, c}) - 0.5)));
    };
    const auto last = [&](double a, double b, double c) {
      return std::min(size_ - 1, static_cast<int>(std::floor(std::max({a, b, c}) - 0.5)));
    };
    for (int row = first(p[0].y(), p[1].y(), p[2].y()); row <= last(p[0].y(), p[1].y(), p[2].y()); ++row)
      for (int column = first(p[0].x(), p[1].x(), p[2].x()); column <= last(p[0].x(), p[1].x(), p[2].x());
           ++column) {
        const Vector3 at(column + 0.5, row + 0.5, 0);
        const Vector3 weights(cross(p[1] - at, p[2] - at) / area, cross(p[2] - at, p[0] - at) / area,
                              cross(p[0] - at, p[1] - at) / area);
        if (weights.minCoeff() < 0) continue;
        const double depth = weights[0] * p[0].z() + weights[1] * p[1].z() + weights[2] * p[2].z();
        Sample& sample = samples_[static_cast<std::size_t>(row) * static_cast<std::size_t>(size_) +
                                  static_cast<std::size_t>(column)];
        if (!(depth > sample.depth)) continue;
        sample = {depth,
                  light * (weights[0] * colours[0] + weights[1] * colours[1] + weights[2] * colours[2])};
      }
  }

  Picture picture() const {
    Picture result{size_ / oversampling, size_ / oversampling, {}};
    for (int row = 0; row < result.height; ++row)
      for (int column = 0; column < result.width; ++column) {
        Vector3 sum = Vector3::Zero();
        for (int i = 0; i < oversampling; ++i)
          for (int j = 0; j < oversampling; ++j)
            sum +=
                samples_[static_cast<std::size_t>(row * oversampling + i) * static_cast<std::size_t>(size_) +
                         static_cast<std::size_t>(column * oversampling + j)]
                    .colour;
        for (const double channel : (sum / (oversampling * oversampling)).eval())
          result.pixels.push_back(
              static_cast<std::uint8_t>(std::lround(255 * std::clamp(channel, 0.0, 1.0))));
      }
    return result;
  }

 private:
  static double cross(const Vector3& a, const Vector3& b) { return a.x() * b.y() - a.y() * b.x(); }

  int size_;
  double scale_ = 1;
  Vector3 centre_ = Vector3::Zero();
  std::vector<Sample> samples_;
};

void require_drawable(const PaintedMesh& mesh) {
  require_valid(TriangleMesh{mesh.vertices, mesh.faces}, "a mesh to draw");
  if (mesh.colours.size() != 1 && mesh.colours.size() != static_cast<std::size_t>(mesh.vertices.cols()))
    throw InvalidInput("a mesh of " + std::to_string(mesh.vertices.cols()) + " vertices has " +
                       std::to_string(mesh.colours.size()) + " colours");
}

}  // namespace

std::string png(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  std::string file(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = file.size();
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, picture.pixels.data(), 0, nullptr))
    throw MemoryLimitError("a picture cannot be written: " + std::string(image.message));
  file.resize(size);
  return file;
}

Picture draw(const std::vector<PaintedMesh>& meshes, DrawnFrom from, int size) {
  if (meshes.empty() || size <= 0)
    throw InvalidInput("nothing to draw, or a picture of " + std::to_string(size) + " pixels");
  Box box;
  for (const PaintedMesh& mesh : meshes) {
    require_drawable(mesh);
    box.extend(bounding_box(seen(mesh.vertices, from)));
  }
  Canvas canvas(box, size);
  for (const PaintedMesh& mesh : meshes) {
    const Points x = seen(mesh.vertices, from);
    for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
      std::array<Vector3, 3> corners, colours;
      for (int k = 0; k < 3; ++k) {
        const auto slot = static_cast<std::size_t>(k);
        const int vertex = mesh.faces(k, f);
        corners[slot] = x.col(vertex);
        colours[slot] = mesh.colours[mesh.colours.size() == 1 ? 0 : static_cast<std::size_t>(vertex)];
      }
      canvas.triangle(corners, colours);
    }
  }
  return canvas.picture();
}

Vector3 colour_of(double value, double low, double high, bool is_diverging) {
  if (std::isnan(value)) return Vector3::Constant(0.6);
  // As src/pages/maths/colour_maps.ts: viridis, and vik.
  static const std::array<Vector3, 10> magnitude{
      Vector3(68, 1, 84), {72, 40, 120},  {62, 74, 137},  {49, 104, 142}, {38, 130, 142},
      {31, 158, 137},     {53, 183, 121}, {110, 206, 88}, {181, 222, 43}, {253, 231, 37}};
  static const std::array<Vector3, 9> diverging{Vector3(0, 18, 97), {3, 67, 128},    {55, 125, 168},
                                                {147, 185, 208},    {236, 229, 224}, {220, 172, 140},
                                                {193, 111, 65},     {138, 48, 8},    {89, 0, 8}};
  const std::span<const Vector3> stops = is_diverging ? std::span<const Vector3>(diverging) : magnitude;
  const double share = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) : 0.5;
  const double at = share * static_cast<double>(stops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return (stops[below] + (at - static_cast<double>(below)) * (stops[below + 1] - stops[below])) / 255;
}

}  // namespace bespoke

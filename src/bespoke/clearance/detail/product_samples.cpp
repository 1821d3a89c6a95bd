#include "bespoke/clearance/detail/product_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// 16 places a face, and of a face that spans many voxels as many as find what pokes through between them.
constexpr int min_divisions = 4, max_divisions = 16;
constexpr double spacings_a_division = 2;

constexpr std::size_t samples_per_range = 4096;

class SampleList {
 public:
  void add(const Eigen::Vector3i& vertices, const Vector3& weights) {
    vertices_.push_back(vertices);
    weights_.push_back(weights);
  }

  ProductSamples samples() const {
    const auto count = static_cast<Eigen::Index>(vertices_.size());
    ProductSamples samples{Faces(3, count), Points(3, count)};
    for (Eigen::Index i = 0; i < count; ++i) {
      samples.vertices.col(i) = vertices_[static_cast<std::size_t>(i)];
      samples.weights.col(i) = weights_[static_cast<std::size_t>(i)];
    }
    return samples;
  }

 private:
  std::vector<Eigen::Vector3i> vertices_;
  std::vector<Vector3> weights_;
};

/// The middles of the n² equal parts of a face.
void add_parts(const Eigen::Vector3i& face, int n, SampleList& list) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const Vector3 low((3 * i + 1) / (3.0 * n), (3 * j + 1) / (3.0 * n), 0);
      list.add(face, {low[0], low[1], 1 - low[0] - low[1]});
      if (i + j + 1 >= n) continue;
      const Vector3 high((3 * i + 2) / (3.0 * n), (3 * j + 2) / (3.0 * n), 0);
      list.add(face, {high[0], high[1], 1 - high[0] - high[1]});
    }
}

std::vector<int> all_columns(const ProductSamples& samples) {
  std::vector<int> columns(static_cast<std::size_t>(samples.count()));
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

double longest_edge(const TriangleMesh& product, Eigen::Index face) {
  double longest = 0;
  for (int k = 0; k < 3; ++k)
    longest = std::max(longest, (product.vertices.col(product.faces(k, face)) -
                                 product.vertices.col(product.faces((k + 1) % 3, face)))
                                    .norm());
  return longest;
}

}  // namespace

ProductSamples constraint_samples(const TriangleMesh& product, const Eigen::Matrix2Xi& lines,
                                  double spacing) {
  SampleList list;
  for (int v = 0; v < static_cast<int>(product.vertices.cols()); ++v) list.add({v, v, v}, {1, 0, 0});
  const auto add_middle = [&](int a, int b) {
    if ((product.vertices.col(a) - product.vertices.col(b)).norm() > spacing)
      list.add({a, b, b}, {0.5, 0.5, 0});
  };
  for (const MeshEdge& edge : mesh_edges(product).edges) add_middle(edge.a, edge.b);
  for (Eigen::Index i = 0; i < lines.cols(); ++i) add_middle(lines(0, i), lines(1, i));
  for (Eigen::Index face = 0; face < product.faces.cols(); ++face)
    if (longest_edge(product, face) > spacing) list.add(product.faces.col(face), Vector3::Constant(1.0 / 3));
  return list.samples();
}

ProductSamples check_samples(const TriangleMesh& product, const Eigen::Matrix2Xi& lines, double spacing) {
  SampleList list;
  for (const MeshEdge& edge : mesh_edges(product).edges) list.add({edge.a, edge.b, edge.b}, {0.5, 0.5, 0});
  for (Eigen::Index i = 0; i < lines.cols(); ++i)
    list.add({lines(0, i), lines(1, i), lines(1, i)}, {0.5, 0.5, 0});
  for (Eigen::Index face = 0; face < product.faces.cols(); ++face) {
    const double divisions = std::ceil(longest_edge(product, face) / (spacings_a_division * spacing));
    add_parts(
        product.faces.col(face),
        divisions < max_divisions ? std::max(min_divisions, static_cast<int>(divisions)) : max_divisions,
        list);
  }
  return list.samples();
}

ProductSamples nearest_samples(const TriangleMesh& product, const Points& points, double reach) {
  SampleList list;
  if (product.faces.cols() == 0) return list.samples();
  const ClosestPointTree tree(product);
  for (const auto& point : points.colwise())
    if (const auto near = tree.closest(point, {.max_distance = reach}))
      list.add(product.faces.col(near->face), near->barycentric);
  return list.samples();
}

Points places_of(const ProductSamples& samples, const Points& vertices) {
  return places_of(samples, all_columns(samples), vertices);
}

Points places_of(const ProductSamples& samples, const std::vector<int>& columns, const Points& vertices) {
  Points places(3, static_cast<Eigen::Index>(columns.size()));
  parallel_for(columns.size(), samples_per_range, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto place = static_cast<Eigen::Index>(i);
      const int sample = columns[i];
      places.col(place) = samples.weights(0, sample) * vertices.col(samples.vertices(0, sample));
      for (int k = 1; k < 3; ++k)
        if (samples.weights(k, sample) != 0)
          places.col(place) += samples.weights(k, sample) * vertices.col(samples.vertices(k, sample));
    }
  });
  return places;
}

void append(const ProductSamples& from, const std::vector<int>& columns, ProductSamples& to) {
  const Eigen::Index before = to.count(), more = static_cast<Eigen::Index>(columns.size());
  to.vertices.conservativeResize(3, before + more);
  to.weights.conservativeResize(3, before + more);
  for (Eigen::Index i = 0; i < more; ++i) {
    to.vertices.col(before + i) = from.vertices.col(columns[static_cast<std::size_t>(i)]);
    to.weights.col(before + i) = from.weights.col(columns[static_cast<std::size_t>(i)]);
  }
}

void append(const ProductSamples& from, ProductSamples& to) { append(from, all_columns(from), to); }

}  // namespace bespoke

#include "bespoke/clearance/corrected_map.h"

#include <Eigen/Dense>
#include <utility>

#include "bespoke/clearance/detail/prepared_data.h"
#include "bespoke/error.h"
#include "bespoke/mapping/reach.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t places_per_range = 512;

// Relative to the edges around a vertex: keeps the gradient zero in directions that no edge has.
constexpr double gradient_regularisation = 1e-6;

/// What moves vertices, at the product's places and between them.
class PlaceMoves {
 public:
  PlaceMoves(std::shared_ptr<const PreparedProduct> product, Points moves)
      : product_(std::move(product)), moves_(std::move(moves)) {
    set_gradients();
    const std::vector<int>& first = places().first();
    for (std::size_t v = 0; v < first.size(); ++v)
      gradients_.middleCols<3>(3 * static_cast<Eigen::Index>(v)) =
          gradients_.middleCols<3>(3 * Eigen::Index{first[v]}).eval();
  }

  Vector3 move(const Vector3& x) const {
    if (const auto vertex = places().vertex_at(x)) return moves_.col(*vertex);
    const auto near = places().nearest(x);
    Vector3 sum = Vector3::Zero();
    if (!near) return sum;
    for (int k = 0; k < 3; ++k) sum += near->barycentric[k] * moves_.col(mesh().faces(k, near->face));
    return sum;
  }

  /// By the coordinates of x.
  Matrix3 gradient(const Vector3& x) const {
    if (const auto vertex = places().vertex_at(x)) return gradients_.middleCols<3>(3 * *vertex);
    const auto near = places().nearest(x);
    Matrix3 sum = Matrix3::Zero();
    if (!near) return sum;
    for (int k = 0; k < 3; ++k)
      sum += near->barycentric[k] * gradients_.middleCols<3>(3 * Eigen::Index{mesh().faces(k, near->face)});
    return sum;
  }

 private:
  const ProductPlaces& places() const { return product_->data().places; }
  const TriangleMesh& mesh() const { return product_->mesh(); }

  void set_gradients() {
    const VertexAdjacency& around = places().around();
    const Points& vertices = mesh().vertices;
    gradients_ = Points::Zero(3, 3 * vertices.cols());
    for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
      Matrix3 edges = Matrix3::Zero(), changes = Matrix3::Zero();
      bool any = false;
      for (int i = around.start[static_cast<std::size_t>(v)];
           i < around.start[static_cast<std::size_t>(v) + 1]; ++i) {
        const int other = around.neighbours[static_cast<std::size_t>(i)];
        const Vector3 edge = vertices.col(other) - vertices.col(v);
        const Vector3 change = moves_.col(other) - moves_.col(v);
        any = any || !change.isZero(0);
        edges += edge * edge.transpose();
        changes += change * edge.transpose();
      }
      if (!any || !(edges.trace() > 0)) continue;
      edges += gradient_regularisation * edges.trace() * Matrix3::Identity();
      gradients_.middleCols<3>(3 * v) = edges.ldlt().solve(changes.transpose()).transpose();
    }
  }

  std::shared_ptr<const PreparedProduct> product_;
  Points moves_, gradients_;
};

class CorrectedMap : public ElasticMap, public HasOwnReach {
 public:
  CorrectedMap(std::shared_ptr<const ElasticMap> elastic, std::shared_ptr<const PreparedProduct> product,
               Points moves)
      : elastic_(std::move(elastic)), moves_(std::move(product), std::move(moves)) {}

  AffineMap affine() const override { return elastic_->affine(); }
  Support support() const override { return elastic_->support(); }
  std::size_t count_in_reach(const Points& x) const override {
    return bespoke::count_in_reach(*elastic_, x, elastic_->displacement(x));
  }

  Points displacement(const Points& x) const override {
    Points u = elastic_->displacement(x);
    parallel_for(static_cast<std::size_t>(x.cols()), places_per_range,
                 [&](std::size_t begin, std::size_t end) {
                   for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
                     if (const Vector3 move = moves_.move(x.col(i)); !move.isZero(0)) u.col(i) += move;
                 });
    return u;
  }

  Points displacement_gradient(const Points& x) const override {
    Points gradient = elastic_->displacement_gradient(x);
    parallel_for(static_cast<std::size_t>(x.cols()), places_per_range,
                 [&](std::size_t begin, std::size_t end) {
                   for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
                     if (const Matrix3 further = moves_.gradient(x.col(i)); !further.isZero(0))
                       gradient.middleCols<3>(3 * i) += further;
                 });
    return gradient;
  }

 private:
  std::shared_ptr<const ElasticMap> elastic_;
  PlaceMoves moves_;
};

}  // namespace

std::shared_ptr<const ElasticMap> corrected_map(std::shared_ptr<const ElasticMap> elastic,
                                                const RigidTransform& target_from_source,
                                                std::shared_ptr<const PreparedProduct> product,
                                                const Points& carried, const Points& corrected) {
  const Eigen::Index vertices = product->mesh().vertices.cols();
  if (carried.cols() != vertices || corrected.cols() != carried.cols())
    throw InvalidInput("corrected_map got " + std::to_string(corrected.cols()) + " corrected and " +
                       std::to_string(carried.cols()) + " carried vertices of " + std::to_string(vertices));
  return std::make_shared<CorrectedMap>(std::move(elastic), std::move(product),
                                        target_from_source.rotation.transpose() * (corrected - carried));
}

}  // namespace bespoke

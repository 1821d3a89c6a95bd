#include "bespoke/pipeline/detail/unusable_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/error.h"
#include "bespoke/median.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

constexpr std::size_t sampled_vertices = 500;
constexpr std::size_t one_in = 20;

// Nodes are stored as floats, of 24 bits: what is shrunk below that is lost, and so is the inverse.
constexpr double min_determinant = 6e-8;

constexpr const char* advice =
    "; are the anchors right, in the models' unit and pose, and does the target have all that the source "
    "has? "
    "(bespoke anchors audit)";

/// Largest by smallest singular value of the linear map that takes one triangle's edges to another's.
double shear_of(const Matrix3& before, const Matrix3& after) {
  using Edges = Eigen::Matrix<double, 3, 2>;
  const auto edges = [](const Matrix3& corners) {
    return Edges(corners.rightCols<2>().colwise() - corners.col(0));
  };
  const Eigen::HouseholderQR<Edges> frame(edges(before));
  const Eigen::Matrix2d own = frame.matrixQR().topRows<2>().triangularView<Eigen::Upper>();
  const Edges map = edges(after) * own.inverse();
  const Eigen::Vector2d squared =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(map.transpose() * map).eigenvalues();
  return squared[0] > 0 ? std::sqrt(squared[1] / squared[0]) : std::numeric_limits<double>::infinity();
}

/// Exceeded on one part in `one_in` of the area; areas: of the source's faces.
double shear_against(const Points& from, const TriangleMesh& source, const Points& fitted) {
  std::vector<std::pair<double, double>> shears;  // and areas
  double area = 0;
  for (const auto& face : source.faces.colwise()) {
    const Matrix3 corners = source.vertices(Eigen::all, face);
    const double own = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
    if (!(own > 0)) continue;
    shears.emplace_back(shear_of(from(Eigen::all, face), fitted(Eigen::all, face)), own);
    area += own;
  }
  std::sort(shears.begin(), shears.end(), std::greater<>());
  double above = 0;
  for (const auto& [shear, own] : shears)
    if ((above += own) * one_in >= area) return shear;
  return 1;
}

Points affine_image(const Points& from, const Points& to) {
  Eigen::MatrixXd rows(from.cols(), 4);
  rows << from.transpose(), Eigen::VectorXd::Ones(from.cols());
  return (rows * rows.colPivHouseholderQr().solve(to.transpose())).transpose();
}

}  // namespace

double surface_shear(const TriangleMesh& source, const Points& fitted) {
  return std::min(shear_against(source.vertices, source, fitted),
                  shear_against(affine_image(source.vertices, fitted), source, fitted));
}

void require_usable_surface(const TriangleMesh& source, const Points& fitted, const FitOptions& options) {
  const SurfaceFitOptions& fit = options.surface_fit;
  if (options.steps || fit.method != SurfaceFitMethod::deformation_graph ||
      !elastic_method(options.elastic).keeps_orientation)
    return;
  const double shear = surface_shear(source, fitted);
  if (!(shear > fit.max_stretch)) return;
  throw SolverError(
      "no useful map follows from this fit: one place in twenty on the registered source is "
      "stretched by a factor of " +
      format_number(shear, 2) + " in one direction against the other, more than --max-stretch " +
      format_number(fit.max_stretch, 3) + advice);
}

bool MapHealth::is_unusable() const { return steps > max_useful_steps || !(low > min_determinant); }

void require_useful_steps(std::size_t steps, const FitOptions& options) {
  if (options.steps || steps <= max_useful_steps) return;
  throw SolverError(
      "no useful map follows from this fit: parts of the source turn and stretch so much that " +
      std::to_string(steps) + " steps would be needed" + advice);
}

MapHealth map_health(const ElasticChain& elastic, const TriangleMesh& source, const Points& fitted) {
  const Points x = source.vertices(Eigen::all, spread_vertices(source, sampled_vertices));
  const Points gradients = elastic.displacement_gradient(x);
  const Matrix3 linear = elastic.affine().linear;
  const double size = growth(source, fitted);
  std::vector<double> determinants;
  for (Eigen::Index k = 0; k < x.cols(); ++k)
    determinants.push_back(Matrix3((linear + gradients.middleCols<3>(3 * k)) / size).determinant());
  std::sort(determinants.begin(), determinants.end());
  return {elastic.steps().size(), determinants[determinants.size() / one_in]};
}

void require_usable(const ElasticChain& elastic, const TriangleMesh& source, const Points& fitted,
                    const FitOptions& options) {
  if (options.steps || !elastic_method(options.elastic).keeps_orientation) return;
  const MapHealth health = map_health(elastic, source, fitted);
  if (!health.is_unusable()) return;
  throw SolverError("no useful map follows from this fit: it takes " + std::to_string(health.steps) +
                    " steps so far, and one place in twenty on the source is shrunk to " +
                    format_number(health.low, 2) + " of its volume or less" + advice);
}

void require_met_anchors(const Anchors& anchors, const std::vector<double>& residuals,
                         const FitOptions& options) {
  constexpr std::size_t min_pairs = 4;
  // Of what the anchors span. Proportions of bodies differ by 4 %, and a fit meets these within that.
  constexpr double far = 0.1;
  if (options.steps) return;
  std::vector<double> own;
  for (std::size_t k = 0; k < anchors.pairs.size(); ++k) {
    const AnchorPair& pair = anchors.pairs[k];
    if (!(pair.sigma.value_or(0) > 0) && !std::isfinite(pair.weight)) own.push_back(residuals[k]);
  }
  if (own.size() < min_pairs) return;
  const double missed = median(own);
  if (!(missed > far * diagonal(target_points(anchors)))) return;
  throw SolverError("no useful map follows from this fit: half of the anchors are missed by " +
                    format_number(missed, 3) + " or more" + advice);
}

}  // namespace bespoke

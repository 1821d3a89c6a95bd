#include "bespoke/pipeline/hopeless_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

constexpr std::size_t sampled_vertices = 500;
constexpr std::size_t one_in = 20;

// Nodes are stored as floats, of 24 bits: what is shrunk below that is lost, and so is the inverse.
constexpr double min_determinant = 6e-8;

// Of the whole surface: a source scaled against its anchors grows beyond any use.
constexpr std::size_t max_steps = 24;

}  // namespace

bool MapHealth::is_hopeless() const { return steps > max_steps || !(low > min_determinant); }

MapHealth map_health(const FittedMapping& fitted, const TriangleMesh& source) {
  const Points x = source.vertices(Eigen::all, spread_vertices(source, sampled_vertices));
  const Points gradients = fitted.elastic->displacement_gradient(x);
  const Matrix3 linear = fitted.elastic->affine().linear;
  const double size = growth(source, fitted.fitted_vertices);
  std::vector<double> determinants;
  for (Eigen::Index k = 0; k < x.cols(); ++k)
    determinants.push_back(Matrix3((linear + gradients.middleCols<3>(3 * k)) / size).determinant());
  std::sort(determinants.begin(), determinants.end());
  return {fitted.elastic->steps().size(), determinants[determinants.size() / one_in], determinants.front()};
}

void require_hopeful(const FittedMapping& fitted, const TriangleMesh& source, const FitOptions& options) {
  if (options.steps || !elastic_method(options.elastic).keeps_orientation) return;
  const MapHealth health = map_health(fitted, source);
  if (!health.is_hopeless()) return;
  throw SolverError(
      "no useful map follows from this fit: it takes " + std::to_string(health.steps) +
      " steps so far, and one place in twenty on the source is shrunk to " + format_number(health.low, 2) +
      " of its volume or less; are the anchors right, in the models' unit and pose, and does the "
      "target have all that the source has? (bespoke anchors audit)");
}

}  // namespace bespoke

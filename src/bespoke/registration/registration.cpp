#include "bespoke/registration/registration.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bespoke/anchors/anchor_placement.h"
#include "bespoke/anchors/anchor_scale.h"
#include "bespoke/anchors/size_ratio.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/registration/detail/decimated_source.h"
#include "bespoke/registration/detail/register_source.h"
#include "bespoke/registration/elastic_pairs.h"
#include "bespoke/registration/renumbered.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/stopwatch.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

void require_usable(const TriangleMesh& source, const Anchors& anchors, const FitOptions& options) {
  require_valid(source, "source");
  if (!(options.lambda > 0 && std::isfinite(options.lambda)))
    throw InvalidInput("lambda is " + std::to_string(options.lambda) + ", but must be finite and above 0");
  if (options.steps && *options.steps < 1)
    throw InvalidInput("a map of " + std::to_string(*options.steps) + " steps; there must be one at least");
  for (const AnchorPair& pair : anchors.pairs)
    if (!(pair.a.allFinite() && pair.b.allFinite() && pair.weight > 0 && pair.sigma.value_or(0) >= 0))
      throw InvalidInput("anchor \"" + pair.name +
                         "\" is not finite, its weight is not above 0, or its sigma below 0");
}

/// ratio: of the models' sizes, by what they were measured.
void require_one_unit(double ratio, const std::string& what) {
  if (!tells_two_units(ratio)) return;
  throw InvalidInput("the target is " + format_number(ratio, 3) + " times as large as the source by " + what +
                     ", as if they were in two units; bring one of them, and its anchors, to the unit of the "
                     "other, or allow any size (--any-size), and the map goes from one unit to the other");
}

/// Anchors that may lie off their models know the sizes once they are multiplied to lie on them.
void require_one_unit(const Problem& problem, const FitOptions& options) {
  const Anchors& anchors = problem.anchors;
  const double ratio = size_ratio(anchors, problem.source, problem.target);
  require_one_unit(ratio, measured_by(anchors));
  if (!options.any_anchors) return;
  const double off = anchor_scale(problem.target, target_points(anchors)).value_or(1) /
                     anchor_scale(problem.source, source_points(anchors)).value_or(1);
  require_one_unit(off * ratio, "their anchors, if these lay on both");
}

/// Two anchors at one place of the source say the same, or contradict each other.
void require_distinct(const Anchors& anchors) {
  std::vector<std::size_t> order(anchors.pairs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](std::size_t k) {
    const Vector3& a = anchors.pairs[k].a;
    return std::tuple(a.x(), a.y(), a.z(), k);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return place(i) < place(j); });
  if (order.empty() || anchors.pairs[order.front()].a == anchors.pairs[order.back()].a) return;  // told later
  for (std::size_t k = 1; k < order.size(); ++k)
    if (anchors.pairs[order[k]].a == anchors.pairs[order[k - 1]].a)
      throw InvalidInput(label(anchors, order[k - 1]) + " and " + label(anchors, order[k]) +
                         " have the same place on the source; remove one");
}

void require_models(const Problem& problem, const FitOptions& options) {
  const Anchors& anchors = problem.anchors;
  require_usable(problem.source, anchors, options);
  require_distinct(anchors);
  require_valid(problem.target, "target");
  if (const std::string mistake = exchanged_sides(anchors, problem.source, problem.target); !mistake.empty())
    throw InvalidInput(mistake);
  // Anchors off their model say nothing of the models' sizes.
  if (!options.any_anchors) require_anchors_at_scale(anchors, problem.source, problem.target);
  if (!options.any_size) require_one_unit(problem, options);
}

/// Where the target touches itself no homeomorphism exists: the parts of the fitted source are separated.
Registration separated(Registration registration, const TriangleMesh& source, const FitOptions& options,
                       const Progress& progress) {
  // Parts that pass through each other more deeply are not due to a target's contact.
  constexpr double reach = 20;  // of the gap
  progress.step("contact", 0, 0);
  ContactFit apart =
      separate_contacts(source, registration.fitted_vertices,
                        {.gap = options.contact_offset, .reach = reach * options.contact_offset}, progress);
  if (apart.summary.touching == 0) return registration;
  registration.fitted_vertices = std::move(apart.vertices);
  registration.summary.contact = std::move(apart.summary);
  return registration;
}

/// Triangles of the least spacing that the finest layers of the surface fit resolve. Thin models take more.
double enough_faces(const TriangleMesh& source) {
  constexpr double spacing = 0.004;  // of the diagonal: the last λ is 0.47 % (DetailSettings)
  constexpr double min_faces = 20'000;
  const double edge = spacing * diagonal(source.vertices);
  return std::max(min_faces, vertex_areas(source).sum() / (std::sqrt(3.0) / 4 * edge * edge));
}

/// Patches name faces of the source.
bool is_dense(const Problem& problem, const SurfaceFitOptions& options) {
  constexpr double worth = 1.5;
  return options.method == SurfaceFitMethod::deformation_graph && problem.anchors.patches.empty() &&
         static_cast<double>(problem.source.faces.cols()) > worth * enough_faces(problem.source);
}

/// The whole's vertices that were parted, where those that they follow were.
std::vector<ReleasedVertex> released_followers(const DecimatedSource& source, Points fitted,
                                               const std::vector<ReleasedVertex>& released) {
  std::vector<int> leading;
  for (const ReleasedVertex& vertex : released) {
    leading.push_back(vertex.vertex);
    fitted.col(vertex.vertex) = vertex.place;
  }
  const Points before = source.followed(fitted);
  std::vector<ReleasedVertex> result;
  for (const int vertex : source.followers(leading)) result.push_back({vertex, before.col(vertex)});
  return result;
}

/// The models as they are registered: joined at their seams, along which no surface ends, and a dense source
/// by some of its vertices, which the others follow.
class PreparedModels {
 public:
  PreparedModels(const Problem& problem, const FitOptions& options, const Progress& progress)
      : anchors_(problem.anchors) {
    const auto join = options.surface_fit.repair_models ? joined_at_seams : left_open;
    source_ = join(problem.source);
    target_ = join(problem.target);
    if (!is_dense(this->problem(), options.surface_fit)) return;
    progress.step("decimate", 0, 0);
    decimated_.emplace(source_.mesh, static_cast<std::size_t>(enough_faces(source_.mesh)));
  }

  Problem problem() const { return {decimated_ ? decimated_->mesh() : source_.mesh, target_.mesh, anchors_}; }

  /// Of all vertices of the source.
  Registration restored(Registration registration) const {
    if (decimated_) registration = with_followers(std::move(registration), *decimated_);
    registration.fitted_vertices = registration.fitted_vertices(Eigen::all, source_.of_vertex).eval();
    if (!registration.confidence.empty()) {
      std::vector<double> confidence;
      for (const int vertex : source_.of_vertex)
        confidence.push_back(registration.confidence[static_cast<std::size_t>(vertex)]);
      registration.confidence = std::move(confidence);
    }
    registration.summary = renumbered(std::move(registration.summary), source_.first);
    registration.summary.seams = {source_.joined(), target_.joined()};
    return registration;
  }

 private:
  static Registration with_followers(Registration registration, const DecimatedSource& source) {
    std::vector<ReleasedVertex> released;
    if (const std::optional<ContactSummary>& contact = registration.summary.contact)
      released = released_followers(source, registration.fitted_vertices, contact->released);
    registration.fitted_vertices = source.followed(registration.fitted_vertices);
    if (!registration.confidence.empty())
      registration.confidence = source.interpolated(registration.confidence);
    registration.summary = renumbered(std::move(registration.summary), source.vertices());
    if (registration.summary.contact) registration.summary.contact->released = std::move(released);
    registration.summary.leading_vertices = source.vertices().size();
    return registration;
  }

  const Anchors& anchors_;
  JoinedMesh source_, target_;
  std::optional<DecimatedSource> decimated_;
};

/// Empty where all of the source is registered. Patches may name any of its parts.
std::optional<RegisteredParts> separable_parts(const Problem& problem, const FitOptions& options) {
  const SurfaceFitOptions& fit = options.surface_fit;
  if (fit.method != SurfaceFitMethod::deformation_graph || !fit.repair_models ||
      !problem.anchors.patches.empty())
    return std::nullopt;
  RegisteredParts parts = parts_to_register(problem.source, problem.target, problem.anchors);
  if (parts.is_whole()) return std::nullopt;
  return parts;
}

void require_fitted(const Problem& problem, const FitOptions& options) {
  const TriangleMesh& fitted = *problem.fitted;
  require_usable(problem.source, problem.anchors, options);
  require_valid(fitted, "fitted source");
  require_same_connectivity(problem.source, fitted, "the fitted mesh");
  if (!options.any_size)
    require_one_unit(diagonal(fitted.vertices) / diagonal(problem.source.vertices), "their vertices");
  if (!problem.anchors.curves.empty())
    throw InvalidInput("curves lead the surface fitting, but the fitted source is given; leave them out");
  if (!problem.anchors.patches.empty())
    throw InvalidInput("patches lead the surface fitting, but the fitted source is given; leave them out");
}

/// Γ of a source that is fitted already, by its anchors or else by its vertices.
Registration align_fitted(const Problem& problem, const FitOptions& options, const Progress& progress) {
  require_fitted(problem, options);
  const Stopwatch watch;
  progress.step("rigid", 0, 0);
  const bool by_vertices = problem.anchors.pairs.empty();
  Points sources = source_points(problem.anchors), targets = target_points(problem.anchors);
  Eigen::VectorXd weights = spline_weights(problem.anchors);
  if (by_vertices) {
    const std::vector<int> used = elastic_pairs(problem.source, problem.fitted->vertices).referenced;
    sources = problem.source.vertices(Eigen::all, used);
    targets = problem.fitted->vertices(Eigen::all, used);
    weights = Eigen::VectorXd::Ones(sources.cols());
  }
  Registration registration;
  registration.target_from_source = align_rigidly(sources, targets, weights);
  RigidSummary& rigid = registration.summary.rigid;
  rigid = rigid_summary(registration.target_from_source, sources, targets);
  rigid.by_vertices = by_vertices;
  rigid.seconds = watch.seconds();
  registration.fitted_vertices = inverse(registration.target_from_source) * problem.fitted->vertices;
  registration.anchors = problem.anchors;
  return separated(std::move(registration), problem.source, options, progress);
}

}  // namespace

const TriangleMesh& registered_mesh(const Registration& registration, const TriangleMesh& source) {
  return registration.part ? registration.part->mesh : source;
}

Points registered_vertices(const Registration& registration) {
  return registration.target_from_source * registration.fitted_vertices;
}

void require_same_connectivity(const TriangleMesh& source, const TriangleMesh& fitted,
                               const std::string& what) {
  if (fitted.vertices.cols() != source.vertices.cols() || fitted.faces.cols() != source.faces.cols())
    throw InvalidInput(what + " has " + std::to_string(fitted.vertices.cols()) + " vertices and " +
                       std::to_string(fitted.faces.cols()) + " faces, but the source has " +
                       std::to_string(source.vertices.cols()) + " and " +
                       std::to_string(source.faces.cols()) + "; both must have the same connectivity");
  for (Eigen::Index face = 0; face < source.faces.cols(); ++face)
    if (source.faces.col(face) != fitted.faces.col(face))
      throw InvalidInput("face " + std::to_string(face) + " of " + what +
                         " has other vertices than the source's; both must have the same connectivity");
}

Registration register_models(const Problem& problem, const FitOptions& options, const Progress& progress) {
  if (problem.fitted) return align_fitted(problem, options, progress);
  require_models(problem, options);
  std::optional<RegisteredParts> parts = separable_parts(problem, options);
  for (;;) {
    std::shared_ptr<const PartialMesh> part;
    if (parts) part = std::make_shared<const PartialMesh>(parts->mesh(problem.source));
    const PreparedModels models({part ? part->mesh : problem.source, problem.target, problem.anchors},
                                options, progress);
    const Problem prepared = models.problem();
    Registration registration = models.restored(
        separated(register_source(prepared, options, progress), prepared.source, options, progress));
    if (!parts) return registration;
    registration.part = part;
    // Parts that turn out to have a counterpart come along.
    if (keep_uncovered(*parts, problem.source, problem.target, registered_vertices(registration))) continue;
    if (!parts->is_whole()) registration.summary.parts = {parts->components.count(), loose_parts(*parts)};
    return registration;
  }
}

Registration fit_source_surface(const Problem& problem, const FitOptions& options, const Progress& progress) {
  require_models(problem, options);
  const PreparedModels models(problem, options, progress);
  return models.restored(register_source(models.problem(), options, progress));
}

}  // namespace bespoke

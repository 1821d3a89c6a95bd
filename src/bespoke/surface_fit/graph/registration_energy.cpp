#include "bespoke/surface_fit/graph/registration_energy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/median.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

Vector3 edge(const Points& places, int node, int other) { return places.col(other) - places.col(node); }

Vector3 edge_now(const DeformationNodes& nodes, const Points& displacements, int node, int other) {
  return edge(nodes.rest, node, other) + edge(displacements, node, other);
}

/// |form^(1/2) (Σ w d − goal)|² at a combination of nodes.
template <class Nodes>
double quadratic(const Nodes& combination, const Matrix3& form, const Vector3& goal,
                 const Points& displacements) {
  Vector3 off = -goal;
  for (const auto& [node, weight] : combination) off += weight * displacements.col(node);
  return off.dot(form * off);
}

template <class Nodes>
void add_quadratic(const Nodes& combination, const Matrix3& form, const Vector3& goal, BlockSystem& system) {
  const Vector3 pull = form * goal;
  for (const NodeWeight& a : combination) {
    system.add_right_side(a.node, a.weight * pull);
    for (const NodeWeight& b : combination)
      if (a.node >= b.node) system.add(a.node, b.node, (a.weight * b.weight) * form);
  }
}

double distance(const PlanePair& plane, const NodeGoals& goals) {
  return (plane.point - goals.vertices.col(plane.vertex)).norm();
}

/// How many times larger than the median a node's scale is, within [1 / most, most].
double growth(double scale, double usual, double most) {
  return usual > 0 ? std::clamp(scale / usual, 1 / most, most) : 1;
}

}  // namespace

LocalSimilarity local_similarity(const DeformationNodes& nodes, const Points& shape,
                                 const Points& displacements, int node) {
  Matrix3 covariance = Matrix3::Zero();
  double spread = 0;
  for (const int other : nodes.neighbours[static_cast<std::size_t>(node)]) {
    const Vector3 kept = edge(shape, node, other);
    covariance += edge_now(nodes, displacements, node, other) * kept.transpose();
    spread += kept.squaredNorm();
  }
  if (!(spread > 0)) return {};
  const Matrix3 rotation = nearest_rotation(covariance).rotation;
  return {rotation, (rotation.transpose() * covariance).trace() / spread};
}

RegistrationEnergy::RegistrationEnergy(const EnergyInput& input, const NodeGoals& goals, const Points& now)
    : input_(input),
      goals_(goals),
      smoothing_(goals.smoothing / input.nodes.spacing),
      stencils_(bending_stencils(input.nodes, input.nodes.rest + now, input.settings.bending)) {
  const NodeFitSettings& settings = input_.settings;
  std::vector<double> scales, distances;
  for (int node = 0; node < input_.nodes.size(); ++node) {
    similarities_.push_back(local_similarity(input_.nodes, input_.shape, now, node));
    scales.push_back(similarities_.back().scale);
  }
  const double usual = median(std::move(scales));
  const double bending = std::pow(smoothing_, 4) / std::pow(goals.rigidity, 2);
  for (int node = 0; node < input_.nodes.size(); ++node) {
    double& scale = similarities_[static_cast<std::size_t>(node)].scale;
    const double grown = growth(scale, usual, settings.bending.max_growth);
    bending_weights_.push_back(bending * grown * grown * input_.nodes.areas[node]);
    if (usual > 0 && scale > 0) scale = usual * std::pow(scale / usual, settings.shape.scale_freedom);
  }
  for (const PlanePair& plane : goals.planes) distances.push_back(distance(plane, goals));
  if (!distances.empty())
    outlier_scale_ = settings.outlier_medians * median(std::move(distances)) + settings.outlier_floor;
}

template <class Visitor>
void RegistrationEnergy::for_each_plane(const Visitor& visit) const {
  for (const PlanePair& plane : goals_.planes) {
    const double scale =
        outlier_scale_ + input_.settings.outlier_scale_gain * goals_.smoothing * plane.outlier_scale_gain;
    const double outlier = distance(plane, goals_) / scale;
    const double weight = plane.weight / input_.surface.area / (1 + outlier * outlier);
    visit(input_.nodes.at_vertex(plane.vertex), Matrix3(weight * plane.normal * plane.normal.transpose()),
          Vector3(plane.point - input_.surface.rest.vertices.col(plane.vertex)));
  }
}

template <class Visitor>
void RegistrationEnergy::for_each_cut(const Visitor& visit) const {
  for (const BoundaryMatch& match : goals_.boundary) {
    // Like a strip of surface, one node spacing wide; free to slide along the cut.
    const double weight = match.length * input_.nodes.spacing / input_.surface.area;
    visit(input_.nodes.at_vertex(match.vertex),
          Matrix3(weight * (Matrix3::Identity() - match.tangent * match.tangent.transpose())),
          Vector3(match.point - input_.surface.rest.vertices.col(match.vertex)));
  }
}

double RegistrationEnergy::anchor_weight(std::size_t anchor) const {
  const double given = input_.anchors[anchor].weight;
  if (!std::isinf(given)) return given / input_.settings.whole_surface_weight;
  double weight = goals_.exact_anchor_weight / double(input_.anchors.size());
  if (!goals_.anchor_limits.empty()) weight = std::min(weight, goals_.anchor_limits[anchor]);
  return goals_.anchor_inliers.empty() ? weight : goals_.anchor_inliers[anchor] * weight;
}

template <class Visitor>
void RegistrationEnergy::for_each_anchor(const Visitor& visit) const {
  for (std::size_t k = 0; k < input_.anchors.size(); ++k)
    visit(input_.anchors[k].foot, Matrix3(anchor_weight(k) * Matrix3::Identity()),
          input_.anchors[k].displacement);
}

template <class Visitor>
void RegistrationEnergy::for_each_place(EnergyTerm term, const Visitor& visit) const {
  if (term == EnergyTerm::data) for_each_plane(visit);
  if (term == EnergyTerm::cuts) for_each_cut(visit);
  if (term == EnergyTerm::anchors) for_each_anchor(visit);
}

double RegistrationEnergy::value(EnergyTerm term, const Points& displacements) const {
  if (term == EnergyTerm::bending) return bending(displacements);
  if (term == EnergyTerm::shape) return shape(displacements);
  double sum = 0;
  for_each_place(term, [&](const auto& combination, const Matrix3& form, const Vector3& goal) {
    sum += quadratic(combination, form, goal, displacements);
  });
  return sum;
}

void RegistrationEnergy::add_step(EnergyTerm term, BlockSystem& system) const {
  if (term == EnergyTerm::bending) return add_bending(system);
  if (term == EnergyTerm::shape) return add_shape(system);
  for_each_place(term, [&](const auto& combination, const Matrix3& form, const Vector3& goal) {
    add_quadratic(combination, form, goal, system);
  });
}

double RegistrationEnergy::bending(const Points& displacements) const {
  double sum = 0;
  for (std::size_t node = 0; node < stencils_.size(); ++node) {
    const BendingStencil& stencil = stencils_[node];
    const Points around = displacements(Eigen::all, stencil.ids);
    sum += bending_weights_[node] * (around * stencil.quadratic).cwiseProduct(around).sum();
  }
  return sum;
}

void RegistrationEnergy::add_bending(BlockSystem& system) const {
  for (std::size_t node = 0; node < stencils_.size(); ++node) {
    const auto& [ids, quadratic] = stencils_[node];
    for (std::size_t a = 0; a < ids.size(); ++a)
      for (std::size_t b = 0; b < ids.size(); ++b)
        system.add(ids[a], ids[b],
                   bending_weights_[node] *
                       quadratic(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
                       Matrix3::Identity());
  }
}

double RegistrationEnergy::shape_weight(int node) const {
  return std::pow(goals_.rigidity * input_.settings.shape.share * smoothing_, 2) * input_.nodes.areas[node] /
         double(input_.nodes.neighbours[static_cast<std::size_t>(node)].size());
}

/// With the scales of `now`, and the best rotations for the displacements.
double RegistrationEnergy::shape(const Points& displacements) const {
  double sum = 0;
  for (int node = 0; node < input_.nodes.size(); ++node) {
    const auto at = static_cast<std::size_t>(node);
    const Matrix3 rotation = local_similarity(input_.nodes, input_.shape, displacements, node).rotation;
    for (const int other : input_.nodes.neighbours[at])
      sum += shape_weight(node) * (edge_now(input_.nodes, displacements, node, other) -
                                   similarities_[at].scale * (rotation * edge(input_.shape, node, other)))
                                      .squaredNorm();
  }
  return sum;
}

void RegistrationEnergy::add_shape(BlockSystem& system) const {
  for (int node = 0; node < input_.nodes.size(); ++node) {
    const auto at = static_cast<std::size_t>(node);
    const auto& [rotation, scale] = similarities_[at];
    const double weight = shape_weight(node);
    const Matrix3 form = weight * Matrix3::Identity();
    for (const int other : input_.nodes.neighbours[at]) {
      const Vector3 pull = weight * (scale * (rotation * edge(input_.shape, node, other)) -
                                     edge(input_.nodes.rest, node, other));
      system.add(node, node, form);
      system.add(other, other, form);
      system.add(std::max(node, other), std::min(node, other), -form);
      system.add_right_side(other, pull);
      system.add_right_side(node, -pull);
    }
  }
}

}  // namespace bespoke

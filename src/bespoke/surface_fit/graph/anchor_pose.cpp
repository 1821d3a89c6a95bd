#include "bespoke/surface_fit/graph/anchor_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"
#include "bespoke/rigid/as_similar_as_possible.h"
#include "bespoke/rigid/nearest_rotation.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"

namespace bespoke {
namespace {

/// A point that moves with nodes near it: Σ w (x'ₖ + Mₖ (x − xₖ)).
struct Follower {
  std::vector<NodeWeight> nodes;
  Vector3 rest;
};

GraphEdges edges_of(const DeformationNodes& nodes) {
  GraphEdges edges(nodes.neighbours.size());
  for (std::size_t node = 0; node < edges.size(); ++node)
    for (const int other : nodes.neighbours[node])
      edges[node].push_back({other, nodes.rest.col(other) - nodes.rest.col(static_cast<Eigen::Index>(node))});
  return edges;
}

}  // namespace

/// AsSimilarAsPossible over nodes of the surface, constrained by the anchors. Similarities stand on its
/// right-hand side only, so one factorisation serves all iterations.
class PosingByAnchors::Nodes {
 public:
  Nodes(const AnchorPoseInput& input, const PoseSettings& settings, int count)
      : sweeps_(settings.sweeps),
        nodes_(make_deformation_nodes(
            input.rest, node_spacing(vertex_areas(input.rest).sum(), count, settings.node_settings),
            settings.node_settings)),
        graph_(edges_of(nodes_)),
        places_(nodes_.rest),
        targets_(input.anchor_targets) {
    const ClosestPointTree tree(input.rest);
    const double edge_sigma = settings.edge_misfit * nodes_.spacing;
    std::vector<SoftConstraint> constraints;
    for (Eigen::Index k = 0; k < input.anchor_sources.cols(); ++k) {
      const Vector3 anchor = input.anchor_sources.col(k);
      anchors_.push_back({nodes_.at_point(*tree.closest(anchor), input.rest.faces), anchor});
      SoftConstraint& constraint = constraints.emplace_back();
      constraint.weight = std::pow(edge_sigma / std::hypot(input.sigmas[k], settings.min_sigma), 2);
      for (const auto& [node, share] : anchors_.back().nodes) constraint.shares.emplace_back(node, share);
    }
    graph_.set_constraints(std::move(constraints), 1);
  }

  /// As fewer nodes have bent the surface.
  void start_from(const Nodes& few) {
    for (int node = 0; node < nodes_.size(); ++node) {
      const int vertex = nodes_.vertices[static_cast<std::size_t>(node)];
      places_.col(node) = few.carried(nodes_.rest.col(node), vertex);
      Matrix3& similarity = graph_.similarities[static_cast<std::size_t>(node)];
      similarity.setZero();
      for (const NodeWeight& followed : few.nodes_.at_vertex(vertex))
        similarity += followed.weight * few.graph_.similarities[static_cast<std::size_t>(followed.node)];
    }
  }

  /// smoothness: β / h².
  void iterate(double smoothness) {
    graph_.fit_similarities(places_, smoothness * nodes_.spacing * nodes_.spacing, sweeps_);
    Points targets = targets_;
    for (std::size_t k = 0; k < anchors_.size(); ++k)
      for (const auto& [node, share] : anchors_[k].nodes)
        targets.col(static_cast<Eigen::Index>(k)) -= share * turned_arm(anchors_[k].rest, node);
    places_ = graph_.places(targets);
  }

  Points carried_anchors() const {
    Points carried = Points::Zero(3, static_cast<Eigen::Index>(anchors_.size()));
    for (std::size_t k = 0; k < anchors_.size(); ++k)
      carried.col(static_cast<Eigen::Index>(k)) = carried_by(anchors_[k].nodes, anchors_[k].rest);
    return carried;
  }

  Vector3 carried(const Vector3& rest, Eigen::Index vertex) const {
    return carried_by(nodes_.at_vertex(static_cast<int>(vertex)), rest);
  }

  double spacing() const { return nodes_.spacing; }

  double rotation_spread() const {
    Matrix3 sum = Matrix3::Zero();
    for (const Matrix3& similarity : graph_.similarities) sum += similarity;
    const Matrix3 mean = nearest_rotation(sum).rotation;
    double largest = 0;
    for (const Matrix3& similarity : graph_.similarities)
      largest = std::max(
          largest,
          Eigen::AngleAxisd(Matrix3(mean.transpose() * nearest_rotation(similarity).rotation)).angle());
    return largest;
  }

 private:
  Vector3 turned_arm(const Vector3& rest, int node) const {
    return graph_.similarities[static_cast<std::size_t>(node)] * (rest - nodes_.rest.col(node));
  }

  template <class NodeWeights>
  Vector3 carried_by(const NodeWeights& followed, const Vector3& rest) const {
    Vector3 sum = Vector3::Zero();
    for (const auto& [node, weight] : followed) sum += weight * (places_.col(node) + turned_arm(rest, node));
    return sum;
  }

  int sweeps_;
  DeformationNodes nodes_;
  AsSimilarAsPossible graph_;
  Points places_;
  Points targets_;
  std::vector<Follower> anchors_;
};

PosingByAnchors::PosingByAnchors(const AnchorPoseInput& input, const PoseSettings& settings)
    : input_(input), settings_(settings) {
  if (input.anchor_sources.cols() == 0) return;
  coarse_ = std::make_unique<Nodes>(input, settings, settings.nodes[0]);
  for (int iteration = 0; iteration < settings_.iterations[0]; ++iteration) {
    // A large β first spreads a rotation over a whole limb; a small one later lets it gather at the joint.
    const double share = double(iteration) / std::max(1, settings_.iterations[0] - 1);
    coarse_->iterate(settings_.first_smoothness *
                     std::pow(settings_.last_smoothness / settings_.first_smoothness, share));
  }
}

PosingByAnchors::~PosingByAnchors() = default;

double PosingByAnchors::rotation_spread() const { return coarse_ ? coarse_->rotation_spread() : 0; }

AnchorPose PosingByAnchors::bent() const {
  AnchorPose result{input_.rest.vertices, input_.anchor_sources};
  if (!coarse_) return result;
  Nodes many(input_, settings_, settings_.nodes[1]);
  many.start_from(*coarse_);
  // A surface resists bending by β h².
  const double smoothness = settings_.last_smoothness * std::pow(coarse_->spacing() / many.spacing(), 2);
  for (int iteration = 0; iteration < settings_.iterations[1]; ++iteration) many.iterate(smoothness);
  constexpr std::size_t grain = 256;
  parallel_for(static_cast<std::size_t>(result.vertices.cols()), grain,
               [&](std::size_t begin, std::size_t end) {
                 for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
                   result.vertices.col(i) = many.carried(input_.rest.vertices.col(i), i);
               });
  result.anchor_sources = many.carried_anchors();
  return result;
}

}  // namespace bespoke

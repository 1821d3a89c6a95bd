#include "bespoke/surface_fit/graph/anchor_pose.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"
#include "bespoke/rigid/nearest_rotation.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // n×3, the layout of the solver

/// Both directions are listed: each end has its own similarity.
struct Edge {
  int from = 0, to = 0;
};

/// A point that moves with nodes near it: Σ w (x'ₖ + Mₖ (x − xₖ)).
struct Follower {
  std::vector<int> nodes;
  Eigen::VectorXd weights;
  Vector3 rest;
};

}  // namespace

/// As similar as possible (after Sorkine, Alexa 2007): places x' and similarities M of nodes that minimise
///   Σ |x'ⱼ − x'ᵢ − Mᵢ (xⱼ − xᵢ)|² + β Σ |Mᵢ − Mⱼ|² + Σ wₖ |carried anchor k − its target|²
/// over edges (i, j) and anchors k, in alternation: similarities with fixed places, then places with fixed
/// similarities.
class PosingByAnchors::Nodes {
 public:
  Nodes(const AnchorPoseInput& input, const PoseSettings& settings, int count)
      : sweeps_(settings.sweeps),
        nodes_(make_deformation_nodes(
            input.rest, node_spacing(vertex_areas(input.rest).sum(), count, settings.node_settings),
            settings.node_settings)),
        edges_(edges()),
        places_(nodes_.rest),
        shapes_(static_cast<std::size_t>(nodes_.size()), Matrix3::Identity()) {
    const ClosestPointTree tree(input.rest);
    for (const auto& anchor : input.anchor_sources.colwise())
      anchors_.push_back(follower(input.rest, *tree.closest(anchor), anchor));
    targets_ = input.anchor_targets.transpose();
    const double edge_sigma = settings.edge_misfit * nodes_.spacing;
    for (const double sigma : input.sigmas)
      anchor_weights_.push_back(std::pow(edge_sigma / std::hypot(sigma, settings.min_sigma), 2));
    factorise();
  }

  /// As fewer nodes have bent the surface.
  void start_from(const Nodes& few) {
    for (int node = 0; node < nodes_.size(); ++node) {
      const int vertex = nodes_.vertices[static_cast<std::size_t>(node)];
      places_.col(node) = few.carried(nodes_.rest.col(node), vertex);
      Matrix3& shape = shapes_[static_cast<std::size_t>(node)];
      shape.setZero();
      for (const NodeWeight& followed : few.nodes_.at_vertex(vertex))
        shape += followed.weight * few.shapes_[static_cast<std::size_t>(followed.node)];
    }
  }

  /// smoothness: β.
  void iterate(double smoothness) {
    update_shapes(smoothness);
    update_places();
  }

  Vector3 carried(const Follower& point) const {
    Vector3 sum = Vector3::Zero();
    for (std::size_t k = 0; k < point.nodes.size(); ++k)
      sum +=
          point.weights[static_cast<Eigen::Index>(k)] * (places_.col(point.nodes[k]) + turned_arm(point, k));
    return sum;
  }

  Vector3 carried(const Vector3& rest, Eigen::Index vertex) const {
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < DeformationNodes::per_vertex; ++k) {
      const int node = nodes_.vertex_nodes(k, vertex);
      sum += nodes_.vertex_weights(k, vertex) *
             (places_.col(node) + shapes_[static_cast<std::size_t>(node)] * (rest - nodes_.rest.col(node)));
    }
    return sum;
  }

  const std::vector<Follower>& anchors() const { return anchors_; }
  double spacing() const { return nodes_.spacing; }

  double rotation_spread() const {
    Matrix3 sum = Matrix3::Zero();
    for (const Matrix3& shape : shapes_) sum += shape;
    const Matrix3 mean = nearest_rotation(sum).rotation;
    double largest = 0;
    for (const Matrix3& shape : shapes_)
      largest = std::max(
          largest, Eigen::AngleAxisd(Matrix3(mean.transpose() * nearest_rotation(shape).rotation)).angle());
    return largest;
  }

 private:
  Vector3 arm(const Edge& edge) const { return nodes_.rest.col(edge.to) - nodes_.rest.col(edge.from); }
  Vector3 now(const Edge& edge) const { return places_.col(edge.to) - places_.col(edge.from); }

  Vector3 turned_arm(const Follower& point, std::size_t k) const {
    const auto node = static_cast<std::size_t>(point.nodes[k]);
    return shapes_[node] * (point.rest - nodes_.rest.col(point.nodes[k]));
  }

  std::vector<Edge> edges() const {
    std::vector<Edge> all;
    for (int node = 0; node < nodes_.size(); ++node)
      for (const int other : nodes_.neighbours[static_cast<std::size_t>(node)]) all.push_back({node, other});
    return all;
  }

  Follower follower(const TriangleMesh& rest, const SurfacePoint& foot, const Vector3& point) const {
    const std::vector<NodeWeight> followed = nodes_.at_point(foot, rest.faces);
    Follower result;
    result.rest = point;
    result.weights.resize(static_cast<Eigen::Index>(followed.size()));
    for (std::size_t k = 0; k < followed.size(); ++k) {
      result.nodes.push_back(followed[k].node);
      result.weights[static_cast<Eigen::Index>(k)] = followed[k].weight;
    }
    return result;
  }

  /// The normal matrix of the places: graph Laplacian and anchors. Similarities stand on the right-hand side
  /// only, so one factorisation serves all iterations.
  void factorise() {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Edge& edge : edges_) {
      entries.emplace_back(edge.from, edge.from, 1);
      entries.emplace_back(edge.to, edge.to, 1);
      entries.emplace_back(edge.from, edge.to, -1);
      entries.emplace_back(edge.to, edge.from, -1);
    }
    for (std::size_t i = 0; i < anchors_.size(); ++i)
      for (std::size_t a = 0; a < anchors_[i].nodes.size(); ++a)
        for (std::size_t b = 0; b < anchors_[i].nodes.size(); ++b)
          entries.emplace_back(anchors_[i].nodes[a], anchors_[i].nodes[b],
                               anchor_weights_[i] * anchors_[i].weights[static_cast<Eigen::Index>(a)] *
                                   anchors_[i].weights[static_cast<Eigen::Index>(b)]);
    Eigen::SparseMatrix<double> matrix(nodes_.size(), nodes_.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(matrix);
    if (factor_.info() != Eigen::Success)
      throw SolverError("the system of " + std::to_string(nodes_.size()) +
                        " nodes that follow the anchors is not positive definite");
  }

  /// Every similarity in turn, with those of its neighbours as they are.
  void update_shapes(double smoothness) {
    const double beta = smoothness * nodes_.spacing * nodes_.spacing;
    std::vector<Matrix3> covariance(shapes_.size(), Matrix3::Zero());
    std::vector<double> spread(shapes_.size(), 0.0);
    for (const Edge& edge : edges_) {
      covariance[static_cast<std::size_t>(edge.from)] += now(edge) * arm(edge).transpose();
      spread[static_cast<std::size_t>(edge.from)] += arm(edge).squaredNorm();
    }
    for (int sweep = 0; sweep < sweeps_; ++sweep)
      for (std::size_t node = 0; node < shapes_.size(); ++node) {
        Matrix3 wanted = covariance[node];
        const auto& neighbours = nodes_.neighbours[node];
        for (const int other : neighbours) wanted += 2 * beta * shapes_[static_cast<std::size_t>(other)];
        const auto [rotation, trace] = nearest_rotation(wanted);
        // Each pair of neighbours counts from both ends; a rotation's squared norm is 3.
        shapes_[node] =
            (trace / (spread[node] + 6 * beta * static_cast<double>(neighbours.size()))) * rotation;
      }
  }

  void update_places() {
    Columns right = Columns::Zero(nodes_.size(), 3);
    for (const Edge& edge : edges_) {
      const Vector3 wanted = shapes_[static_cast<std::size_t>(edge.from)] * arm(edge);
      right.row(edge.to) += wanted.transpose();
      right.row(edge.from) -= wanted.transpose();
    }
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
      Vector3 goal = targets_.row(static_cast<Eigen::Index>(i)).transpose();
      for (std::size_t k = 0; k < anchors_[i].nodes.size(); ++k)
        goal -= anchors_[i].weights[static_cast<Eigen::Index>(k)] * turned_arm(anchors_[i], k);
      for (std::size_t k = 0; k < anchors_[i].nodes.size(); ++k)
        right.row(anchors_[i].nodes[k]) +=
            anchor_weights_[i] * anchors_[i].weights[static_cast<Eigen::Index>(k)] * goal.transpose();
    }
    places_ = factor_.solve(right).transpose();
  }

  int sweeps_;
  DeformationNodes nodes_;
  std::vector<Edge> edges_;
  Points places_;
  std::vector<Matrix3> shapes_;
  std::vector<Follower> anchors_;
  Columns targets_;
  std::vector<double> anchor_weights_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
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
  for (std::size_t k = 0; k < many.anchors().size(); ++k)
    result.anchor_sources.col(static_cast<Eigen::Index>(k)) = many.carried(many.anchors()[k]);
  return result;
}

}  // namespace bespoke

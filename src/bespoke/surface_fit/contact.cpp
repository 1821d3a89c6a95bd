#include "bespoke/surface_fit/contact.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Of the smooth displacement: weight of an edge and of staying in place against that of a vertex in contact.
// A displacement fades over about √(stiffness / rest) = 3 edges.
constexpr double stiffness = 0.05, rest = 0.005;
constexpr int affected_rings = 20;  // of edges around contacts; farther ones keep their place
constexpr int patience = 5;         // steps without fewer contacts: folded parts push each other to and fro
constexpr double overshoot = 0.25;  // of the gap: contacts that are solved together then settle in few steps

/// What a vertex is too near to.
struct Contact {
  int vertex = 0;
  SurfacePoint foot;       ///< on the fitted surface
  Vector3 direction;       ///< in which the vertex should leave, unit
  double shortage = 0;     ///< of the distance along it, > 0, mesh units
  double penetration = 0;  ///< ≥ 0, mesh units
};

class ContactSearch {
 public:
  /// fitted_size: how many times as large the fitted surface is.
  ContactSearch(const TriangleMesh& source, double fitted_size, const ContactOptions& options)
      : source_(source),
        options_(options),
        fitted_size_(fitted_size),
        source_vertex_normals_(vertex_normals(source)),
        source_face_normals_(face_normals(source)) {}

  /// In the order of the vertices.
  std::vector<Contact> operator()(const TriangleMesh& fitted) {
    tree_.emplace(tree_ ? tree_->moved(fitted) : ClosestPointTree(fitted));
    const ClosestPointTree& tree = *tree_;
    const Points facing = face_normals(fitted), normals = vertex_normals(fitted, facing);
    std::vector<std::optional<Contact>> found(static_cast<std::size_t>(fitted.vertices.cols()));
    constexpr std::size_t grain = 256;
    parallel_for(found.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        found[i] = contact_of(static_cast<int>(i), fitted, tree, normals, facing);
    });
    std::vector<Contact> contacts;
    for (const std::optional<Contact>& contact : found)
      if (contact) contacts.push_back(*contact);
    return contacts;
  }

 private:
  std::optional<Contact> contact_of(int vertex, const TriangleMesh& fitted, const ClosestPointTree& tree,
                                    const Points& normals, const Points& facing) const {
    const Vector3 x = fitted.vertices.col(vertex), normal = normals.col(vertex);
    if (!(normal.squaredNorm() > 0)) return std::nullopt;
    ClosestPointQuery query;
    query.max_distance = options_.reach;
    query.normal = Vector3(-normal);
    const std::optional<SurfacePoint> foot = tree.closest(x, query);
    if (!foot) return std::nullopt;
    // Of a folded neighbourhood, which no distance could part.
    if ((source_.faces.col(foot->face).array() == vertex).any()) return std::nullopt;
    const Vector3 there = facing.col(foot->face);
    const double distance = (x - foot->point).dot(there);
    const double wanted = std::min(options_.gap, options_.compression * source_distance(vertex, *foot));
    const bool compressed =
        std::sqrt(foot->squared_distance) < options_.compression * source_distance(vertex, *foot);
    if (!compressed || distance >= wanted || (distance < 0 && back_to_back(vertex, *foot)))
      return std::nullopt;
    return Contact{vertex, *foot, there, (1 + overshoot) * wanted - distance, std::max(0.0, -distance)};
  }

  /// On a source as large as the fitted surface.
  Vector3 apart_on_source(int vertex, const SurfacePoint& foot) const {
    return fitted_size_ * (source_.vertices.col(vertex) - carried(foot, source_.faces, source_.vertices));
  }
  double source_distance(int vertex, const SurfacePoint& foot) const {
    return apart_on_source(vertex, foot).norm();
  }

  /// Two sides of one thin part: near each other on the source, each behind the other.
  bool back_to_back(int vertex, const SurfacePoint& foot) const {
    const Vector3 apart = apart_on_source(vertex, foot);
    return apart.norm() < options_.reach / options_.compression &&
           apart.dot(source_face_normals_.col(foot.face)) < 0 &&
           apart.dot(source_vertex_normals_.col(vertex)) > 0;
  }

  const TriangleMesh& source_;
  const ContactOptions& options_;
  double fitted_size_;
  Points source_vertex_normals_, source_face_normals_;
  std::optional<ClosestPointTree> tree_;  ///< of the last fitted surface
};

/// Displacements that separate the vertices in contact and fade along the edges around (screened Laplacian):
/// the minimum of Σ wᵢ|δᵢ − dᵢ|² + stiffness Σ |δᵢ − δⱼ|² over edges + rest Σ |δᵢ|², factored anew for every
/// set of contacts, over the vertices around them.
class SmoothDisplacement {
 public:
  explicit SmoothDisplacement(const TriangleMesh& mesh) : adjacency_(vertex_adjacency(mesh)) {}

  /// weights: n, ≥ 0; wanted: n×3, the sum of weight × displacement. 3×n.
  Points operator()(const Eigen::VectorXd& weights, const Eigen::MatrixX3d& wanted) const {
    const std::vector<int> affected = around(weights);
    const auto count = static_cast<int>(affected.size());
    std::vector<int> number(static_cast<std::size_t>(weights.size()), none);
    for (int k = 0; k < count; ++k)
      number[static_cast<std::size_t>(affected[static_cast<std::size_t>(k)])] = k;
    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < count; ++k) {
      const int vertex = affected[static_cast<std::size_t>(k)];
      const std::span<const int> neighbours = neighbours_of(vertex);
      entries.emplace_back(k, k, weights[vertex] + rest + stiffness * static_cast<double>(neighbours.size()));
      for (const int neighbour : neighbours)
        if (const int column = number[static_cast<std::size_t>(neighbour)]; column != none)
          entries.emplace_back(k, column, -stiffness);
    }
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
    if (factor.info() != Eigen::Success)
      throw SolverError("the separation of " + std::to_string(count) +
                        " vertices around contacts was not solved");
    Points displacements = Points::Zero(3, weights.size());
    displacements(Eigen::all, affected) =
        Eigen::MatrixX3d(factor.solve(Eigen::MatrixX3d(wanted(affected, Eigen::all)))).transpose();
    return displacements;
  }

 private:
  static constexpr int none = -1;

  std::span<const int> neighbours_of(int vertex) const {
    const auto at = static_cast<std::size_t>(vertex);
    return {adjacency_.neighbours.data() + adjacency_.start[at],
            adjacency_.neighbours.data() + adjacency_.start[at + 1]};
  }

  /// The vertices of a weight and those within a number of edges, rising.
  std::vector<int> around(const Eigen::VectorXd& weights) const {
    std::vector<char> found(static_cast<std::size_t>(weights.size()), 0);
    std::vector<int> all, ring, next;
    for (int i = 0; i < weights.size(); ++i)
      if (weights[i] > 0 && !std::exchange(found[static_cast<std::size_t>(i)], 1)) ring.push_back(i);
    for (int rings = 0;; ++rings) {
      all.insert(all.end(), ring.begin(), ring.end());
      if (rings == affected_rings || ring.empty()) break;
      next.clear();
      for (const int vertex : ring)
        for (const int neighbour : neighbours_of(vertex))
          if (!std::exchange(found[static_cast<std::size_t>(neighbour)], 1)) next.push_back(neighbour);
      ring.swap(next);
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  VertexAdjacency adjacency_;
};

/// Half of each contact's shortage to the vertex, half to the corners of the face that it meets.
Points separation(const TriangleMesh& fitted, const std::vector<Contact>& contacts,
                  const SmoothDisplacement& smooth) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(fitted.vertices.cols());
  Eigen::MatrixX3d wanted = Eigen::MatrixX3d::Zero(fitted.vertices.cols(), 3);
  const auto ask = [&](int vertex, double weight, const Vector3& displacement) {
    weights[vertex] += weight;
    wanted.row(vertex) += weight * displacement.transpose();
  };
  for (const Contact& contact : contacts) {
    const Vector3 half = (0.5 * contact.shortage) * contact.direction;
    ask(contact.vertex, 1, half);
    for (int k = 0; k < 3; ++k) ask(fitted.faces(k, contact.foot.face), contact.foot.barycentric[k], -half);
  }
  return smooth(weights, wanted);
}

void require_usable(const TriangleMesh& source, const Points& fitted, const ContactOptions& options) {
  if (source.vertices.cols() != fitted.cols())
    throw InvalidInput("the fitted surface has " + std::to_string(fitted.cols()) + " vertices, the source " +
                       std::to_string(source.vertices.cols()) + "; the numbers must be equal");
  if (!(options.gap >= 0 && options.reach >= options.gap && options.compression > 0 &&
        options.compression < 1))
    throw InvalidInput("a contact offset of " + std::to_string(options.gap) + " with a reach of " +
                       std::to_string(options.reach) + " and a compression of " +
                       std::to_string(options.compression) +
                       "; offset ≥ 0, reach ≥ offset and 0 < compression < 1 must hold");
}

/// Beyond a tenth of the gap a vertex is elsewhere; what fades out below it is not worth naming.
std::vector<ReleasedVertex> released_vertices(const Points& before, const Points& after, double gap) {
  const double least = 0.1 * gap;
  std::vector<ReleasedVertex> released;
  for (Eigen::Index i = 0; i < before.cols(); ++i)
    if ((after.col(i) - before.col(i)).norm() > least)
      released.push_back({static_cast<int>(i), before.col(i)});
  return released;
}

}  // namespace

std::string to_string(const ContactSummary& summary) {
  char line[200];
  std::snprintf(line, sizeof line,
                "%zu vertices in contact (deepest %.4g), %zu released in %d steps, %zu left",
                summary.touching, summary.deepest, summary.released.size(), summary.iterations, summary.left);
  return line;
}

ContactFit separate_contacts(const TriangleMesh& source, const Points& fitted, const ContactOptions& options,
                             const Progress& progress) {
  const Stopwatch watch;
  require_usable(source, fitted, options);
  ContactFit fit{fitted, {}};
  if (options.gap == 0) return fit;
  ContactSummary& summary = fit.summary;
  ContactSearch search(source, growth(source, fitted), options);
  TriangleMesh surface{fitted, source.faces};
  std::vector<Contact> contacts = search(surface);
  summary.touching = summary.left = contacts.size();
  for (const Contact& contact : contacts) summary.deepest = std::max(summary.deepest, contact.penetration);

  const SmoothDisplacement smooth(source);
  for (int stalled = 0; summary.left > 0 && stalled < patience && summary.iterations < options.max_iterations;
       ++summary.iterations) {
    progress.check();
    surface.vertices += separation(surface, contacts, smooth);
    contacts = search(surface);
    ++stalled;
    if (contacts.size() >= summary.left) continue;
    summary.left = contacts.size();
    fit.vertices = surface.vertices;
    stalled = 0;
  }
  summary.released = released_vertices(fitted, fit.vertices, options.gap);
  summary.seconds = watch.seconds();
  return fit;
}

}  // namespace bespoke

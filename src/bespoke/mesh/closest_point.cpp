#include "bespoke/mesh/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/box_tree.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// The tree's boxes are rounded outwards to float, the query to an interval of floats, and distances compared
// with this slack: four times the rounding of the float operations between. So a box is never passed over
// that holds a point as near as the nearest, and ties stay complete.
constexpr double slack = 1 + 1e-6;

/// Corners are sorted by position and edges run upwards, so that faces that share an edge or a corner compute
/// bitwise the same closest point there, and the tie goes to the least face.
struct Triangle {
  Vector3 a, b, c;
  Vector3 dual_b, dual_c;  ///< their products with x − a are the barycentric weights of b and c
  double inverse_ab, inverse_ac, inverse_bc;  ///< reciprocal squared lengths, 0 for no length
  int face;
  std::array<signed char, 3> corner;  ///< of the face, for a, b, c
  bool sliver;                        ///< too thin to trust the weights: the edges are queried as well
};

struct Hit {
  Vector3 point = Vector3::Zero();
  Vector3 weights = Vector3::Zero();  ///< of a, b, c; exactly 0 off an edge's or corner's own
  double squared_distance = std::numeric_limits<double>::infinity();
};

double reciprocal(double x) { return x > 0 ? 1 / x : 0; }

Triangle prepare(const TriangleMesh& mesh, int face) {
  Triangle t;
  t.face = face;
  t.corner = {0, 1, 2};
  const auto position = [&](int k) { return mesh.vertices.col(mesh.faces(k, face)); };
  std::sort(t.corner.begin(), t.corner.end(), [&](int i, int j) {
    return std::lexicographical_compare(position(i).begin(), position(i).end(), position(j).begin(),
                                        position(j).end());
  });
  t.a = position(t.corner[0]);
  t.b = position(t.corner[1]);
  t.c = position(t.corner[2]);
  const Vector3 ab = t.b - t.a, ac = t.c - t.a;
  const double bb = ab.squaredNorm(), cc = ac.squaredNorm(), bc = ab.dot(ac);
  const double det = ab.cross(ac).squaredNorm();
  t.dual_b = (cc * ab - bc * ac) / det;  // not finite without area, and then never inside
  t.dual_c = (bb * ac - bc * ab) / det;
  t.sliver = !(det > 1e-12 * bb * cc);
  t.inverse_ab = reciprocal(bb);
  t.inverse_ac = reciprocal(cc);
  t.inverse_bc = reciprocal((t.c - t.b).squaredNorm());
  return t;
}

struct EdgePoint {
  Vector3 point = Vector3::Zero();
  double share;  ///< of the edge's end
};

[[gnu::always_inline]] inline EdgePoint closest_on_edge(const Vector3& from, const Vector3& to,
                                                        double inverse, const Vector3& x) {
  const Vector3 along = to - from;
  const double share = along.dot(x - from) * inverse;
  if (!(share > 0)) return {from, 0};
  if (!(share < 1)) return {to, 1};
  return {from + share * along, share};
}

// Outside of the triangle its closest point lies on an edge that the projection of x is beyond.
Hit closest_on(const Triangle& t, const Vector3& x) {
  const Vector3 p = x - t.a;
  const double b = t.dual_b.dot(p), c = t.dual_c.dot(p);
  const bool below_ab = !(c >= 0), below_ac = !(b >= 0), beyond_bc = !(1 - b - c >= 0);
  Hit best;
  const auto offer = [&](const Vector3& point, double at_a, double at_b, double at_c) {
    const double squared_distance = (x - point).squaredNorm();
    if (squared_distance < best.squared_distance) best = {point, {at_a, at_b, at_c}, squared_distance};
  };
  if (!below_ab && !below_ac && !beyond_bc) offer(t.a + (b * (t.b - t.a) + c * (t.c - t.a)), 1 - b - c, b, c);
  if (below_ab || t.sliver) {
    const EdgePoint at = closest_on_edge(t.a, t.b, t.inverse_ab, x);
    offer(at.point, 1 - at.share, at.share, 0);
  }
  if (below_ac || t.sliver) {
    const EdgePoint at = closest_on_edge(t.a, t.c, t.inverse_ac, x);
    offer(at.point, 1 - at.share, 0, at.share);
  }
  if (beyond_bc || t.sliver) {
    const EdgePoint at = closest_on_edge(t.b, t.c, t.inverse_bc, x);
    offer(at.point, 0, 1 - at.share, at.share);
  }
  return best;
}

}  // namespace

struct ClosestPointTree::Tree {
  BoxTree boxes;
  std::vector<Triangle> triangles;  ///< in the order of the leaves
  std::vector<Vector3> normals;     ///< of the triangles; NaN without area, so that no condition holds
};

namespace {

std::vector<Box> valid_face_boxes(const TriangleMesh& mesh) {
  require_valid(mesh, "the mesh of a closest-point tree");
  return face_boxes(mesh);
}

}  // namespace

ClosestPointTree::ClosestPointTree(BoxTree boxes, const TriangleMesh& mesh, const Points& normals) {
  constexpr std::size_t grain = 1024;
  auto tree = std::make_unique<Tree>();
  tree->triangles.resize(boxes.order.size());
  tree->normals.resize(boxes.order.size());
  parallel_for(boxes.order.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const int face = boxes.order[k];
      tree->triangles[k] = prepare(mesh, face);
      tree->normals[k] = normals.col(face);
      if (normals.col(face).isZero(0)) tree->normals[k].setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  });
  tree->boxes = std::move(boxes);
  tree_ = std::move(tree);
}

ClosestPointTree::ClosestPointTree(const TriangleMesh& mesh)
    : ClosestPointTree(build_box_tree(valid_face_boxes(mesh)), mesh, face_normals(mesh)) {}

ClosestPointTree ClosestPointTree::moved(const TriangleMesh& mesh) const {
  return moved(mesh, face_normals(mesh));
}

ClosestPointTree ClosestPointTree::moved(const TriangleMesh& mesh, const Points& of_faces) const {
  const std::vector<Box> places = valid_face_boxes(mesh);
  if (places.size() != tree_->boxes.order.size())
    throw InvalidInput("a closest-point tree over " + std::to_string(tree_->boxes.order.size()) +
                       " faces cannot move to a mesh of " + std::to_string(places.size()));
  BoxTree boxes = tree_->boxes;
  refit(boxes, places);
  return ClosestPointTree(std::move(boxes), mesh, of_faces);
}

ClosestPointTree::~ClosestPointTree() = default;
ClosestPointTree::ClosestPointTree(ClosestPointTree&&) noexcept = default;
ClosestPointTree& ClosestPointTree::operator=(ClosestPointTree&&) noexcept = default;

namespace {

using Distances = Eigen::Array<float, BoxTree::width, 1>;

/// Squared distances, at most the true ones, of a point between `low` and `high` from a node's boxes.
Distances measure_boxes(const BoxTree::Node& node, const float (&low)[3], const float (&high)[3]) {
  Distances squared = Distances::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto lows = Distances::MapAligned(node.low[axis]), highs = Distances::MapAligned(node.high[axis]);
    const Distances outside = (lows - high[axis]).max(low[axis] - highs).max(0.0f);
    squared += outside * outside;
  }
  return squared;
}

/// The closest point on the triangles visited so far.
class Nearest {
 public:
  Nearest(const Vector3& x, const ClosestPointQuery& query) : x_(x), query_(query) {
    best_.squared_distance = query.max_distance * query.max_distance;
    reach_ = round_up(best_.squared_distance * slack);
  }

  /// Squared distance; nodes farther away hold no closer point.
  float reach() const { return reach_; }

  void offer(const Triangle& triangle, const Vector3& normal) {
    double turned = 0;
    if (query_.normal) {
      if (!(normal.dot(*query_.normal) > query_.min_cosine)) return;
      turned = query_.normal_length * query_.normal_length * (normal - *query_.normal).squaredNorm();
      if (turned > best_.squared_distance) return;
    }
    Hit hit = closest_on(triangle, x_);
    hit.squared_distance += turned;
    const bool better = hit.squared_distance < best_.squared_distance;
    const bool tie =
        hit.squared_distance == best_.squared_distance && (!triangle_ || triangle.face < triangle_->face);
    if (!better && !tie) return;
    best_ = hit;
    triangle_ = &triangle;
    reach_ = round_up(best_.squared_distance * slack);
  }

  std::optional<SurfacePoint> found() const {
    if (!triangle_) return std::nullopt;
    SurfacePoint result;
    result.point = best_.point;
    result.face = triangle_->face;
    result.squared_distance = best_.squared_distance;
    for (std::size_t k = 0; k < 3; ++k)
      result.barycentric(triangle_->corner[k]) = best_.weights(static_cast<Eigen::Index>(k));
    return result;
  }

 private:
  const Vector3& x_;
  const ClosestPointQuery& query_;
  Hit best_;
  float reach_;
  const Triangle* triangle_ = nullptr;
};

}  // namespace

std::optional<SurfacePoint> ClosestPointTree::closest(const Vector3& x,
                                                      const ClosestPointQuery& query) const {
  if (!x.allFinite()) throw InvalidInput("closest point to a point that is not finite");
  if (!(query.max_distance >= 0)) throw InvalidInput("max_distance must be at least 0");
  struct Entry {
    float squared_distance;
    int node;
  };
  std::array<Entry, BoxTree::stack_size> stack;
  int top = 0;
  stack[static_cast<std::size_t>(top++)] = {0, 0};
  float low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = round_down(x(axis));
    high[axis] = round_up(x(axis));
  }
  Nearest nearest(x, query);
  while (top > 0) {
    const Entry entry = stack[static_cast<std::size_t>(--top)];
    if (entry.squared_distance > nearest.reach()) continue;
    const BoxTree::Node& node = tree_->boxes.nodes[static_cast<std::size_t>(entry.node)];
    const Distances squared = measure_boxes(node, low, high);
    // Leaves at once, since they shorten the reach; nodes onto the stack, the nearest on top.
    const int base = top;
    for (int i = 0; i < BoxTree::width; ++i) {
      if (node.count[i] < 0 || squared[i] > nearest.reach()) continue;
      if (node.count[i] > 0) {
        const auto first = static_cast<std::size_t>(node.child[i]);
        for (std::size_t k = first; k < first + static_cast<std::size_t>(node.count[i]); ++k)
          nearest.offer(tree_->triangles[k], tree_->normals[k]);
        continue;
      }
      int at = top++;
      for (; at > base && stack[static_cast<std::size_t>(at - 1)].squared_distance < squared[i]; --at)
        stack[static_cast<std::size_t>(at)] = stack[static_cast<std::size_t>(at - 1)];
      stack[static_cast<std::size_t>(at)] = {squared[i], node.child[i]};
    }
  }
  return nearest.found();
}

Vector3 carried(const SurfacePoint& point, const Faces& faces, const Points& vertices) {
  Vector3 place = Vector3::Zero();
  for (int corner = 0; corner < 3; ++corner)
    place += point.barycentric[corner] * vertices.col(faces(corner, point.face));
  return place;
}

std::vector<double> distances_from_vertices(const TriangleMesh& mesh, const Points& points) {
  constexpr Eigen::Index quicker_than_a_tree = 100;
  if (points.cols() > quicker_than_a_tree || mesh.faces.cols() == 0) return {};
  std::vector<double> distances(static_cast<std::size_t>(points.cols()));
  parallel_for(distances.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      distances[i] = std::sqrt((mesh.vertices.colwise() - points.col(static_cast<Eigen::Index>(i)))
                                   .colwise()
                                   .squaredNorm()
                                   .minCoeff());
  });
  return distances;
}

}  // namespace bespoke

#include "bespoke/mesh/visibility.h"

#include <algorithm>
#include <array>

namespace bespoke {
namespace {

constexpr double weight_rounding = 1e-9;  // of barycentric weights: a ray through an edge meets a face
constexpr double slab_rounding = 1e-15;   // of t: a way along a box's side crosses it
constexpr double at_the_eye = 1e-10;      // of the mesh's diagonal

/// A way from t = 0 to t = reach that is queried against boxes.
struct Way {
  Vector3 from, direction, inverse;
  double reach;

  bool crosses(const BoxTree::Node& node, int child) const {
    double begin = 0, end = reach;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = double(node.low[axis][child]) - from[axis];
      const double high = double(node.high[axis][child]) - from[axis];
      if (direction[axis] == 0) {
        if (low > 0 || high < 0) return false;
        continue;
      }
      const double a = low * inverse[axis], b = high * inverse[axis];
      begin = std::max(begin, std::min(a, b));
      end = std::min(end, std::max(a, b) * (1 + slab_rounding));
    }
    return begin <= end;
  }
};

}  // namespace

VisibilityQuery::VisibilityQuery(const TriangleMesh& mesh)
    : mesh_(mesh), tree_(build_box_tree(face_boxes(mesh))), least_(at_the_eye * diagonal(mesh.vertices)) {}

bool VisibilityQuery::is_blocked(const Vector3& x, const Vector3& direction, FaceSides sides,
                                 double reach) const {
  // u (b − a) + v (c − a) − t direction = x − a, by Cramer's rule.
  const auto meets = [&](int face) {
    const Vector3 a = mesh_.vertices.col(mesh_.faces(0, face));
    const Vector3 first = mesh_.vertices.col(mesh_.faces(1, face)) - a;
    const Vector3 second = mesh_.vertices.col(mesh_.faces(2, face)) - a;
    const Vector3 arm = x - a, normal = first.cross(second);
    const double determinant = -normal.dot(direction);
    if (sides == FaceSides::front ? !(determinant > 0) : determinant == 0) return false;
    const double t = normal.dot(arm) / determinant;
    if (!(t > least_ && t <= reach)) return false;
    const double u = -arm.cross(second).dot(direction) / determinant;
    const double v = -first.cross(arm).dot(direction) / determinant;
    return u >= -weight_rounding && v >= -weight_rounding && u + v <= 1 + weight_rounding;
  };
  const Way way{x, direction, direction.cwiseInverse(), reach};
  std::array<int, BoxTree::stack_size> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const BoxTree::Node& node = tree_.nodes[static_cast<std::size_t>(stack[--top])];
    for (int i = 0; i < BoxTree::width; ++i) {
      if (node.count[i] < 0 || !way.crosses(node, i)) continue;
      if (node.count[i] == 0) stack[top++] = node.child[i];
      for (int k = node.child[i]; k < node.child[i] + node.count[i]; ++k)
        if (meets(tree_.order[static_cast<std::size_t>(k)])) return true;
    }
  }
  return false;
}

}  // namespace bespoke

#include <algorithm>
#include <cmath>

#include "accessories.h"
#include "tessellate.h"

namespace bespoke {
namespace {

constexpr double rim_thickness = 0.24;  // cm
constexpr double full_turn = 2 * 3.14159265358979323846;

// Where the left lens sits, and its half measures.
struct Lens {
  double x, y, half_width, half_height;
};

Lens lens_of(const HeadBuild& build) { return {3.45 * build.width, 0.15, 2.6 * build.width, 2.05}; }

// The front of the frame bends back towards the temples.
double front_depth(const HeadBuild& build, double x) {
  const double bend = x / (6.3 * build.width);
  return 8.0 + 1.55 * build.nose - 1.0 * bend * bend;
}

// 1 on the lens's outline, a rounded trapezium.
double lens_level(const Lens& lens, double x, double y) {
  const double v = (y - lens.y) / lens.half_height;
  const double u = (x - lens.x - 0.12 * v) / (lens.half_width * (1 + 0.07 * v));
  const double exponent = 2.9;
  return std::pow(std::pow(std::abs(u), exponent) + std::pow(std::abs(v), exponent), 1 / exponent);
}

double rim_distance(const Lens& lens, const Vector3& p, double depth) {
  const double reach = std::hypot(p.x() - lens.x, p.y() - lens.y);
  const double level = std::max(lens_level(lens, p.x(), p.y()), 0.05);
  const double across = std::abs((level - 1) * reach / level) - rim_thickness;
  const double along = std::abs(p.z() - depth) - 0.2;
  return smooth_max(across, along, 0.25);
}

double bridge_distance(const HeadBuild& build, const Lens& lens, const Vector3& p) {
  const double half = lens.x - lens.half_width;
  const double arch = lens.y + 0.95 - 0.25 * (p.x() / half) * (p.x() / half);
  const double across = std::abs(p.y() - arch) - 0.24;
  const double along = std::abs(p.z() - front_depth(build, p.x()) - 0.12) - 0.2;
  return std::max(smooth_max(across, along, 0.25), std::abs(p.x()) - half - 0.1);
}

// A cardinal spline through the points, each kept at least `gap` off the head.
std::vector<Vector3> beside(const Field& head, const std::vector<Vector3>& keys, double gap) {
  std::vector<Vector3> path;
  const int steps = 8;
  const int last = static_cast<int>(keys.size()) - 1;
  for (int i = 0; i < last; ++i) {
    const Vector3 before = 0.5 * (keys[i + 1] - keys[std::max(i - 1, 0)]);
    const Vector3 after = 0.5 * (keys[std::min(i + 2, last)] - keys[i]);
    for (int step = 0; step < steps; ++step) {
      const double s = static_cast<double>(step) / steps;
      const double t = s * s * (3 - 2 * s);
      path.push_back((1 - t) * keys[i] + t * keys[i + 1] + s * (1 - s) * ((1 - s) * before - s * after));
    }
  }
  path.push_back(keys.back());
  for (Vector3& point : path) {
    for (int round = 0; round < 6 && head(point) < gap; ++round) {
      const Vector3 away = gradient(head, point);
      point += (gap - head(point)) * away / std::max(away.squaredNorm(), 0.3);
    }
  }
  return path;
}

// Wider upwards than sideways, slimmer towards the end.
double temple_distance(const std::vector<Vector3>& path, const Vector3& p) {
  const Vector3 squash(1, 0.55, 1);
  double nearest = 1e3;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vector3 from = path[i].cwiseProduct(squash);
    const Vector3 along = path[i + 1].cwiseProduct(squash) - from;
    const Vector3 offset = p.cwiseProduct(squash) - from;
    const double s = std::clamp(offset.dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (offset - s * along).norm());
  }
  return (nearest - 0.2) * 1.2;
}

std::vector<Vector3> temple_path(const HeadBuild& build, const Anatomy& head) {
  const Lens lens = lens_of(build);
  const double w = build.width;
  const double hinge = lens.x + lens.half_width;
  return beside(head.field,
                {{hinge + 0.2, 1.25, front_depth(build, hinge) - 0.1},
                 {hinge + 0.75, 1.35, front_depth(build, hinge) - 0.9},
                 {7.35 * w, 1.7, 4.0},
                 {7.75 * w, 2.1, 0.2},
                 {7.9 * w, 2.3, -2.0},
                 {7.75 * w, 1.0, -3.9},
                 {7.3 * w, -1.6, -4.9}},
                0.42);
}

}  // namespace

TriangleMesh glasses_frame(const HeadBuild& build, const Anatomy& head) {
  const Lens lens = lens_of(build);
  const std::vector<Vector3> temple = temple_path(build, head);
  Anatomy frame;
  frame.field = [build, lens, temple](const Vector3& p) {
    const Vector3 q(std::abs(p.x()), p.y(), p.z());
    const double rim = rim_distance(lens, q, front_depth(build, q.x()));
    const double front = smooth_min(rim, bridge_distance(build, lens, q), 0.25);
    return smooth_min(front, temple_distance(temple, q), 0.3);
  };
  const double top = lens.y + lens.half_height;
  const double x = lens.x + 0.12;
  frame.inside = Vector3(x, top, front_depth(build, x));
  frame.box = Box(Vector3(-11, -4, -7), Vector3(11, 5, 13));
  Tessellation how;
  how.lattice_spacing = 0.13;
  how.lattice_rotation = oblique_rotation(8);
  how.edges = {0.16, 0.45, 0.012, 8};
  return tessellate(frame, std::nullopt, how);
}

TriangleMesh glasses_lenses(const HeadBuild& build) {
  const Lens lens = lens_of(build);
  const int rings = 8;
  const int spokes = 48;
  const auto point = [&](int ring, int spoke, double side) {
    const double angle = full_turn * spoke / spokes;
    const Vector3 direction(std::cos(angle) * lens.half_width, std::sin(angle) * lens.half_height, 0);
    const double level = lens_level(lens, lens.x + direction.x(), lens.y + direction.y());
    const double share = static_cast<double>(ring) / rings;
    const Vector3 flat = Vector3(lens.x, lens.y, 0) + share / level * direction;
    return Vector3(side * flat.x(), flat.y(), front_depth(build, flat.x()) + 0.12 * (1 - share * share));
  };
  std::vector<Vector3> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const double side : {1.0, -1.0}) {
    const int start = static_cast<int>(vertices.size());
    const auto index = [&](int ring, int spoke) {
      return ring == 0 ? start : start + 1 + (ring - 1) * spokes + spoke % spokes;
    };
    const auto add = [&](int a, int b, int c) {
      side > 0 ? faces.emplace_back(a, b, c) : faces.emplace_back(a, c, b);
    };
    vertices.push_back(point(0, 0, side));
    for (int ring = 1; ring <= rings; ++ring) {
      for (int spoke = 0; spoke < spokes; ++spoke) {
        vertices.push_back(point(ring, spoke, side));
        add(index(ring - 1, spoke), index(ring, spoke), index(ring, spoke + 1));
        if (ring > 1) add(index(ring - 1, spoke), index(ring, spoke + 1), index(ring - 1, spoke + 1));
      }
    }
  }
  TriangleMesh mesh;
  mesh.vertices = Eigen::Map<const Points>(vertices[0].data(), 3, static_cast<Eigen::Index>(vertices.size()));
  mesh.faces = Eigen::Map<const Faces>(faces[0].data(), 3, static_cast<Eigen::Index>(faces.size()));
  return mesh;
}

}  // namespace bespoke

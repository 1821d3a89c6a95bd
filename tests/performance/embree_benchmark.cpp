// The queries of closest_point_benchmark put to Embree's point query. Embree walks its tree in float and
// leaves the triangles to a callback, which measures them in double here, as an exact result needs.
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "bespoke/mesh/closest_point.h"
#include "performance/closest_point_scene.h"

namespace bespoke {
namespace {

using closest_points::Scene;
using closest_points::scene;

/// Ericson, Real-Time Collision Detection, 5.1.5.
Vector3 closest_on_triangle(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& x) {
  const Vector3 ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax), d3 = ab.dot(bx), d4 = ac.dot(bx), d5 = ab.dot(cx),
               d6 = ac.dot(cx);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

class EmbreeTree {
 public:
  explicit EmbreeTree(const TriangleMesh& mesh)
      : mesh_(mesh),
        normals_(face_normals(mesh)),
        device_(rtcNewDevice("threads=1")),
        scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                    3 * sizeof(float), std::size_t(mesh.vertices.cols())));
    auto* faces =
        static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                       3 * sizeof(unsigned), std::size_t(mesh.faces.cols())));
    for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i) vertices[i] = float(mesh.vertices.data()[i]);
    for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) faces[i] = unsigned(mesh.faces.data()[i]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree refused the mesh");
  }
  ~EmbreeTree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeTree(const EmbreeTree&) = delete;
  EmbreeTree& operator=(const EmbreeTree&) = delete;

  /// Squared distance of the closest point; with a normal, of those within 90° of it.
  double closest(const Vector3& x, const Vector3* normal) const {
    Search search{*this, x, normal};
    RTCPointQuery query{float(x.x()), float(x.y()), float(x.z()), 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &query, &context, visit, &search);
    return search.squared_distance;
  }

 private:
  struct Search {
    const EmbreeTree& tree;
    const Vector3& x;
    const Vector3* normal;
    double squared_distance = std::numeric_limits<double>::infinity();
  };

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const TriangleMesh& mesh = search.tree.mesh_;
    const auto face = Eigen::Index(arguments->primID);
    if (search.normal && !(search.tree.normals_.col(face).dot(*search.normal) > 0)) return false;
    const Vector3 point =
        closest_on_triangle(mesh.vertices.col(mesh.faces(0, face)), mesh.vertices.col(mesh.faces(1, face)),
                            mesh.vertices.col(mesh.faces(2, face)), search.x);
    const double squared_distance = (point - search.x).squaredNorm();
    if (!(squared_distance < search.squared_distance)) return false;
    search.squared_distance = squared_distance;
    // Wider by the rounding of the tree's floats, so that no nearer triangle is passed over.
    arguments->query->radius = float(std::sqrt(squared_distance)) * (1 + 1e-6f);
    return true;
  }

  const TriangleMesh& mesh_;
  Points normals_;
  RTCDevice device_;
  RTCScene scene_;
};

void embree_closest(benchmark::State& state, double distance, bool compatible) {
  const Scene input = scene(distance);
  const EmbreeTree tree(input.target);
  const ClosestPointTree ours(input.target);
  const double tolerance = 1e-6 * diagonal(input.target.vertices);
  for (auto _ : state)
    for (Eigen::Index i = 0; i < input.queries.cols(); ++i) {
      const Vector3 normal = input.normals.col(i);
      benchmark::DoNotOptimize(tree.closest(input.queries.col(i), compatible ? &normal : nullptr));
    }
  state.SetItemsProcessed(state.iterations() * input.queries.cols());
  // Both must have done the same work.
  for (Eigen::Index i = 0; i < input.queries.cols(); ++i) {
    ClosestPointQuery query;
    const Vector3 normal = input.normals.col(i);
    if (compatible) query.normal = normal;
    const double expected = std::sqrt(ours.closest(input.queries.col(i), query)->squared_distance);
    const double found = std::sqrt(tree.closest(input.queries.col(i), compatible ? &normal : nullptr));
    if (!(std::abs(found - expected) <= tolerance)) return state.SkipWithError("other results than ours");
  }
}

void embree_build(benchmark::State& state) {
  const Scene input = scene(0);
  for (auto _ : state) benchmark::DoNotOptimize(EmbreeTree(input.target));
  state.SetItemsProcessed(state.iterations() * input.target.faces.cols());
}

BENCHMARK(embree_build)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(embree_closest, near, 0.002, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(embree_closest, near_compatible, 0.002, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(embree_closest, middle, 0.02, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(embree_closest, middle_compatible, 0.02, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(embree_closest, far, 0.5, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(embree_closest, far_compatible, 0.5, true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace bespoke

// What OpenMesh's topology costs beside the flat arrays, on a sphere of 327,680 faces:
//   half_edge_benchmark --benchmark_time_unit=ms
#include <benchmark/benchmark.h>

#include "bespoke/mesh/half_edge_mesh.h"
#include "bespoke/mesh/mesh_edges.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const TriangleMesh& ball() {
  static const TriangleMesh mesh = shapes::icosphere(7);
  return mesh;
}

void ArraysAdjacency(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(vertex_adjacency(ball()));
}
BENCHMARK(ArraysAdjacency);

void OpenMeshConversion(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(half_edge_mesh(ball()));
}
BENCHMARK(OpenMeshConversion);

void ArraysOneRings(benchmark::State& state) {
  const VertexAdjacency adjacency = vertex_adjacency(ball());
  for (auto _ : state) {
    Vector3 sum = Vector3::Zero();
    for (const int neighbour : adjacency.neighbours) sum += ball().vertices.col(neighbour);
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(ArraysOneRings);

void OpenMeshOneRings(benchmark::State& state) {
  const HalfEdgeMesh mesh = half_edge_mesh(ball());
  for (auto _ : state) {
    OpenMesh::Vec3d sum(0, 0, 0);
    for (const auto vertex : mesh.vertices())
      for (const auto neighbour : mesh.vv_range(vertex)) sum += mesh.point(neighbour);
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(OpenMeshOneRings);

}  // namespace
}  // namespace bespoke

// What OpenMesh's topology costs beside the flat arrays, on a sphere of 327,680 faces, its boundary on a
// sheet of as many:
//   half_edge_benchmark --benchmark_time_unit=ms
#include <benchmark/benchmark.h>

#include <utility>
#include <vector>

#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/topology/edge_refinement.h"
#include "bespoke/topology/half_edge_mesh.h"
#include "bespoke/topology/mesh_components.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const TriangleMesh& ball() {
  static const TriangleMesh mesh = shapes::icosphere(7);
  return mesh;
}

const TriangleMesh& sheet() {
  static const TriangleMesh mesh = shapes::square_grid(405);
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

void ArraysBoundary(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(boundary_edges(sheet(), mesh_edges(sheet())));
}
BENCHMARK(ArraysBoundary);

void OpenMeshBoundary(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(boundary_loops(half_edge_mesh(sheet())));
}
BENCHMARK(OpenMeshBoundary);

void ArraysComponents(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(mesh_components(ball()));
}
BENCHMARK(ArraysComponents);

void OpenMeshComponents(benchmark::State& state) {
  const HalfEdgeMesh mesh = half_edge_mesh(ball());
  for (auto _ : state) {
    std::vector<char> is_seen(mesh.n_vertices(), 0);
    int components = 0;
    for (const auto start : mesh.vertices()) {
      if (is_seen[static_cast<std::size_t>(start.idx())]) continue;
      ++components;
      std::vector<OpenMesh::VertexHandle> open{start};
      is_seen[static_cast<std::size_t>(start.idx())] = 1;
      while (!open.empty()) {
        const OpenMesh::VertexHandle at = open.back();
        open.pop_back();
        for (const auto next : mesh.vv_range(at))
          if (!std::exchange(is_seen[static_cast<std::size_t>(next.idx())], 1)) open.push_back(next);
      }
    }
    benchmark::DoNotOptimize(components);
  }
}
BENCHMARK(OpenMeshComponents);

// Every edge once: four faces of each.
void ArraysSplits(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(refine_long_edges(ball(), 1e-9, 1));
}
BENCHMARK(ArraysSplits);

void OpenMeshSplits(benchmark::State& state) {
  for (auto _ : state) {
    HalfEdgeMesh mesh = half_edge_mesh(ball());
    const auto edges = static_cast<int>(mesh.n_edges());
    for (int edge = 0; edge < edges; ++edge) {
      const OpenMesh::EdgeHandle handle(edge);
      mesh.split(handle, mesh.add_vertex(mesh.calc_edge_midpoint(handle)));
    }
    benchmark::DoNotOptimize(triangle_mesh(mesh));
  }
}
BENCHMARK(OpenMeshSplits);

}  // namespace
}  // namespace bespoke

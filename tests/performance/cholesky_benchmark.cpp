// The sparse Cholesky factorisations that csrbf could use, on its own systems: ordering, factor, and the
// solves of one fit. Seconds of the CPU stand beside those of the clock, because the three use different
// numbers of threads. peak_MB is the growth of the process's resident memory.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <Eigen/SparseCholesky>
#ifdef BESPOKE_HAS_CHOLMOD
#include <Eigen/CholmodSupport>
#endif
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/parallel.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/rbf/front_cholesky.h"
#include "bespoke/rbf/kernels.h"
#include "samples.h"

namespace bespoke {
namespace {

constexpr int solves_of_a_fit = 6;  // tail, displacements, refinements

/// Kilobytes that the kernel reports under this name.
double process_status(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == name + ":") {
      double kilobytes = 0;
      status >> kilobytes;
      return kilobytes;
    }
  throw std::runtime_error("no " + name + " in /proc/self/status");
}

/// How far the resident memory rises above what it was at the start.
class PeakMemory {
 public:
  PeakMemory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";
    start_ = process_status("VmRSS");
  }
  double megabytes() const { return (process_status("VmHWM") - start_) / 1024; }

 private:
  double start_;
};

struct System {
  Points centers;
  double lambda = 0;
  RadiusGraph graph;
  std::vector<double> values;
};

const std::filesystem::path shared_body =
    std::filesystem::path(BESPOKE_SHARED_DIR) / "cases" / "d01_body_dress" / "reference_a.obj";
const std::string shared_name = "body d01";

/// The five samples, and a shared case where it is present.
std::vector<std::string> models() {
  std::vector<std::string> names = sample_names();
  if (std::filesystem::exists(shared_body)) names.push_back(shared_name);
  return names;
}

/// Made once: that takes longer than most factorisations.
const Points& centers_of(const std::string& name) {
  static std::map<std::string, Points> made;
  const auto found = made.find(name);
  if (found != made.end()) return found->second;
  return made[name] = name == shared_name ? read_triangle_mesh(shared_body).vertices
                                          : make_sample(name).source.vertices;
}

System system_of(const std::string& name, double lambda) {
  System system;
  system.centers = centers_of(name);
  system.lambda = lambda;
  system.graph = radius_graph(system.centers, system.lambda);
  for (const double distance : system.graph.distances)
    system.values.push_back(WendlandC4::value(distance / system.lambda));
  return system;
}

Eigen::SparseMatrix<double> lower_triangle(const System& system) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < system.centers.cols(); ++i)
    for (std::size_t k = system.graph.start[std::size_t(i)]; k < system.graph.start[std::size_t(i) + 1]; ++k)
      if (system.graph.neighbours[k] <= i)
        entries.emplace_back(i, system.graph.neighbours[k], system.values[k]);
  Eigen::SparseMatrix<double> matrix(system.centers.cols(), system.centers.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

struct Fronts {
  explicit Fronts(const System& system)
      : tree(system.centers, system.graph, system.lambda), factor(tree, system.graph, system.values) {}
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right_side) const { return factor.solve(right_side); }

  EliminationTree tree;
  FrontCholesky factor;
};

/// One of Eigen's classes or wrappers.
template <class Factor>
struct Sparse {
  explicit Sparse(const System& system) : factor(lower_triangle(system)) {
    if (factor.info() != Eigen::Success) throw std::runtime_error("not positive definite");
  }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right_side) const { return factor.solve(right_side); }

  Factor factor;
};

template <class Solver>
void solve(benchmark::State& state) {
  const std::string name = models()[std::size_t(state.range(0))];
  state.SetLabel(name);
  CsrbfOptions options;
  options.lambda = double(state.range(1)) / 100 * diagonal(centers_of(name));
  if (!estimate_csrbf(centers_of(name), options).within_limits)
    return state.SkipWithError("csrbf refuses so large a λ");
  const System system = system_of(name, options.lambda);
  const Eigen::MatrixXd right_side = system.centers.transpose();
  for (auto _ : state) {
    run_alone([&] {
      const PeakMemory memory;
      const Solver solver(system);
      Eigen::MatrixXd solution;
      for (int pass = 0; pass < solves_of_a_fit; ++pass) solution = solver.solve(right_side);
      state.counters["peak_MB"] = memory.megabytes();
      benchmark::DoNotOptimize(solution);
    });
  }
  state.counters["centers"] = double(system.centers.cols());
  state.counters["entries_per_row"] = double(system.values.size()) / double(system.centers.cols());
}

using Matrix = Eigen::SparseMatrix<double>;

void systems(benchmark::internal::Benchmark* family) {
  family->Unit(benchmark::kMillisecond)->Iterations(1);
  family->ArgNames({"model", "percent"})
      ->ArgsProduct({benchmark::CreateDenseRange(0, std::int64_t(models().size()) - 1, 1), {3, 5, 10}});
}

BENCHMARK_TEMPLATE(solve, Fronts)->Apply(systems);
BENCHMARK_TEMPLATE(solve, Sparse<Eigen::SimplicialLLT<Matrix>>)->Apply(systems);
#ifdef BESPOKE_HAS_CHOLMOD
BENCHMARK_TEMPLATE(solve, Sparse<Eigen::CholmodSupernodalLLT<Matrix>>)->Apply(systems);
#endif

}  // namespace
}  // namespace bespoke

#include "bespoke/elastic/finite_elements.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "bespoke/elastic/detail/element_objective.h"
#include "bespoke/elastic/detail/element_weights.h"
#include "bespoke/elastic/detail/exact_map_bytes.h"
#include "bespoke/elastic/detail/nested_elements.h"
#include "bespoke/elastic/detail/preconditioned_bfgs.h"
#include "bespoke/elastic/detail/upright_affine.h"
#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Of the fit tolerance: how far a vertex gives way under unit stress, and what halves the cells around it.
constexpr double compliance = 0.1, refined_beyond = 3;
// Of λ: the coarsest voxel.
constexpr double coarsest_voxel = 0.25;
// Of a finer voxel, along each axis: nodes around a vertex that is missed.
constexpr double refined_reach = 2;
// Of the mean size of the sources' displacement: how soft data are at first; their stiffness then grows
// fourfold.
constexpr double softest = 0.25, stiffening = 4;
// Of the energy, per iteration: while data are soft, and on the finest level; half of that on the one before,
// …
constexpr double min_relative_decrease = 1e-2;
constexpr int max_iterations = 60, max_evaluations = 3 * max_iterations;
// Of the bounds on squeeze: where the barriers are. Nearer ones trap the minimiser on its way.
constexpr double barrier_beyond = 100, length_barrier_beyond = 10;
// Of the weight of a place at a cell beyond the bounds; and how often on the finest level, where the bounds
// hold. On those before it once does.
constexpr double loosening = 0.03;
constexpr int max_loosenings = 3;
// Evaluations of the energy an iteration on the coarsest level: a minimiser that takes more is blocked.
constexpr std::size_t blocked_beyond = 2;
// Of the bounds on squeeze: those on levels that are yet to be refined.
constexpr double unrefined_beyond = 10;
// Of a vertex's weight: that of a point farther from the surface than a share of λ, which stands alone.
constexpr double share_of_a_lone_point = 300, lone_beyond = 0.01;
// Of the barriers, fourfold each.
constexpr int max_widenings = 20;

/// The nodes within lambda of the surface, which is in the box.
std::vector<LatticeCoordinates> band_nodes(const ClosestPointTree& surface, const Box& box,
                                           const Lattice& lattice, double lambda) {
  const LatticeCoordinates low = lattice.cell_of(box.min() - Vector3::Constant(lambda)),
                           high = lattice.cell_of(box.max() + Vector3::Constant(lambda));
  std::vector<std::vector<LatticeCoordinates>> slabs(static_cast<std::size_t>(high[0] - low[0] + 2));
  parallel_for(slabs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slab = begin; slab < end; ++slab)
      for (int j = low[1]; j <= high[1] + 1; ++j)
        for (int k = low[2]; k <= high[2] + 1; ++k) {
          const LatticeCoordinates node{low[0] + static_cast<int>(slab), j, k};
          if (surface.closest(lattice(node), {.max_distance = lambda})) slabs[slab].push_back(node);
        }
  });
  std::vector<LatticeCoordinates> nodes;
  for (const auto& slab : slabs) nodes.insert(nodes.end(), slab.begin(), slab.end());
  return nodes;
}

/// Those within lambda of a point.
void add_nodes_within(const Lattice& lattice, const Vector3& x, double lambda,
                      std::vector<LatticeCoordinates>& nodes) {
  const LatticeCoordinates low = lattice.cell_of(x - Vector3::Constant(lambda)),
                           high = lattice.cell_of(x + Vector3::Constant(lambda));
  for (int i = low[0]; i <= high[0] + 1; ++i)
    for (int j = low[1]; j <= high[1] + 1; ++j)
      for (int k = low[2]; k <= high[2] + 1; ++k)
        if ((lattice({i, j, k}) - x).norm() <= lambda) nodes.push_back({i, j, k});
}

void add_nodes_around(const Lattice& lattice, const Vector3& x, std::vector<LatticeCoordinates>& nodes) {
  const Vector3 at = (x - lattice.origin) / lattice.voxel_size;
  const Eigen::Vector3i low = (at.array() - refined_reach).ceil().cast<int>(),
                        high = (at.array() + refined_reach).floor().cast<int>();
  for (int i = low[0]; i <= high[0]; ++i)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int k = low[2]; k <= high[2]; ++k) nodes.push_back({i, j, k});
}

void require_usable(const Points& sources, const Points& targets, const FiniteElementOptions& options) {
  if (sources.cols() != targets.cols() || sources.cols() == 0)
    throw InvalidInput("finite elements: " + std::to_string(sources.cols()) + " sources and " +
                       std::to_string(targets.cols()) + " targets; there must be as many, and one at least");
  if (!sources.allFinite() || !targets.allFinite())
    throw InvalidInput("finite elements: a source or target has a coordinate that is not finite");
  const auto require = [](double value, double above, const char* what) {
    if (!(value > above && std::isfinite(value)))
      throw InvalidInput(std::string("finite elements: ") + what + " is " + std::to_string(value) +
                         ", but must be finite and above " + std::to_string(above));
  };
  require(options.lambda, 0, "the effective distance");
  require(options.fit_tolerance, 0, "the fit tolerance");
  require(options.max_squeeze, 1, "the largest squeeze of a volume");
  require(options.max_length_squeeze, 1, "the largest squeeze of a length");
  if (options.max_nodes < 1) throw InvalidInput("finite elements: there must be one node at least");
  if (options.max_levels < 1) throw InvalidInput("finite elements: there must be one level at least");
}

/// Least symmetric Dirichlet energy (Smith, Schaefer 2015) on one level, then on finer ones where vertices
/// are missed.
class Solver {
 public:
  /// The first `vertices` of the sources are met, the others are guides.
  Solver(Points sources, Points wanted, std::size_t vertices, const TriangleMesh& source, double tolerance,
         const FiniteElementOptions& options, const Progress& progress)
      : sources_(std::move(sources)),
        wanted_(std::move(wanted)),
        vertices_(vertices),
        tolerance_(tolerance),
        options_(options),
        barriers_{1 / (barrier_beyond * options.max_squeeze),
                  std::pow(length_barrier_beyond * options.max_length_squeeze, 2)},
        shares_(static_cast<std::size_t>(sources_.cols()), 1.0),
        source_(source),
        progress_(progress),
        coarsest_{bounding_box(source.vertices).min(), coarsest_voxel * options.lambda} {
    weighted_area_ = vertex_areas(source).sum() / static_cast<double>(vertices);
    std::vector<LatticeCoordinates> nodes =
        band_nodes(source_, bounding_box(source.vertices), coarsest_, options.lambda);
    for (std::size_t i = 0; i < vertices; ++i) {
      const Vector3 x = sources_.col(static_cast<Eigen::Index>(i));
      if (source_.closest(x, {.max_distance = lone_beyond * options.lambda})) continue;
      shares_[i] = share_of_a_lone_point;
      add_nodes_within(coarsest_, x, options.lambda, nodes);
    }
    elements_ = std::make_unique<NestedElements>(
        coarsest_, std::vector<std::vector<LatticeCoordinates>>{unique_leaves(std::move(nodes))});
    elements_->weigh(element_weights(*elements_, source_, options.lambda));
    coefficients_ = Points::Zero(3, static_cast<Eigen::Index>(elements_->unknowns()));
  }

  void solve() {
    for (int level = 1;; ++level) {
      progress_.step("elastic", static_cast<std::size_t>(level - 1),
                     static_cast<std::size_t>(options_.max_levels));
      std::vector<double> residuals = minimised(level);
      if (summary_.blocked && options_.give_up_blocked) break;
      if (loosen(unrefined_beyond)) residuals = minimised(level);
      if (level == options_.max_levels || !refine(residuals)) break;
    }
    const int rounds = summary_.blocked && options_.give_up_blocked ? 0 : max_loosenings;
    for (int round = 0; round < rounds && loosen(1); ++round) minimised(options_.max_levels);
    for (const ElementLevel& level : elements_->levels()) {
      summary_.voxel_sizes.push_back(level.voxel_size);
      summary_.nodes.push_back(level.nodes.size());
      summary_.cells.push_back(level.finest.size());
    }
  }

  const NestedElements& elements() const { return *elements_; }
  const Points& coefficients() const { return coefficients_; }
  FiniteElementSummary summary() const { return summary_; }

 private:
  /// |u(vᵢ) − uᵢ| at the minimum.
  std::vector<double> minimised(int level) {
    if (!objective_)
      objective_ =
          std::make_unique<ElementObjective>(*elements_, ElementData{sources_, wanted_, shares_}, barriers_);
    ElementObjective& objective = *objective_;
    std::size_t iterations = 0, evaluations = 0;
    const Objective of_coefficients{[&](const Points& x, Points& gradient) {
                                      progress_.check();
                                      ++evaluations;
                                      return objective(x, gradient);
                                    },
                                    [&] { return objective.inverse_diagonal(); },
                                    [&](Points& step) { objective.damp(step); }};
    Points unused;
    // Inside a cell that was split a length may be beyond its barrier.
    for (int wider = 0; !std::isfinite(objective(coefficients_, unused)); ++wider) {
      if (wider == max_widenings) throw SolverError("finite elements: a split cell is flipped");
      barriers_.max_inverse_squared *= 4;
      barriers_.min_determinant /= 4;
      objective.set_bounds(barriers_);
    }
    const auto run = [&](double soft, double decrease) {
      objective.set_weight(weighted_area_ / soft);
      iterations += static_cast<std::size_t>(
          minimise(of_coefficients, {max_iterations, max_evaluations, decrease}, coefficients_));
    };
    // From the identity stiff data would push single cells to their bounds, which stops all.
    const double stiff = compliance * tolerance_;
    if (level == 1)
      for (double soft = softest * wanted_.colwise().norm().mean(); soft > stiff; soft /= stiffening)
        run(soft, min_relative_decrease);
    run(stiff, std::ldexp(min_relative_decrease, level - options_.max_levels));
    if (summary_.iterations.empty()) summary_.blocked = evaluations > blocked_beyond * iterations;
    const double volume = weighted_volume();
    objective(coefficients_, unused);
    summary_.iterations.push_back(iterations);
    summary_.distortion = volume > 0 ? objective.distortion().energy / volume : 0;
    summary_.min_determinant = elements_->unknowns() > 0 ? objective.distortion().min_determinant : 1;
    summary_.outside = objective.outside();
    return objective.residuals(coefficients_);
  }

  /// Where cells are so many times beyond the bounds their places count less. Whether there are any.
  bool loosen(double times) {
    const std::vector<std::size_t> squeezed = objective_->squeezed(
        coefficients_, {1 / (times * options_.max_squeeze),
                        std::pow(std::cbrt(times) * options_.max_length_squeeze, 2) + 2});
    for (const std::size_t place : squeezed) {
      summary_.loosened += place < vertices_ && shares_[place] >= 1;
      shares_[place] *= loosening;
    }
    objective_->set_shares(shares_);
    return !squeezed.empty();
  }

  /// Before `added` nodes come to those that there are.
  void require_memory(std::size_t added) const {
    constexpr std::size_t bytes_of_a_node =
        1500;  // vectors of the minimiser, and gradients of the cells around it
    const std::size_t bytes = bytes_of_a_node * (elements_->unknowns() + added);
    if (bytes > options_.max_memory)
      throw MemoryLimitError("finite elements: another level takes about " + std::to_string(bytes >> 20) +
                             " MiB, more than the limit of " + std::to_string(options_.max_memory >> 20) +
                             " MiB; a larger --fit-tolerance needs fewer");
  }

  double weighted_volume() const {
    double volume = 0;
    for (const ElementLevel& level : elements_->levels())
      volume +=
          std::accumulate(level.weights.begin(), level.weights.end(), 0.0) * std::pow(level.voxel_size, 3);
    return volume;
  }

  /// Nodes of a finer level around the vertices that are missed by more than a distance and did not give way.
  std::vector<LatticeCoordinates> nodes_around_missed(const Lattice& finer,
                                                      const std::vector<double>& residuals,
                                                      double distance) const {
    std::vector<LatticeCoordinates> nodes;
    for (std::size_t i = 0; i < vertices_; ++i) {
      const Vector3 x = sources_.col(static_cast<Eigen::Index>(i));
      if (shares_[i] >= 1 && residuals[i] > distance && !elements_->places(x).empty())
        add_nodes_around(finer, x, nodes);
    }
    return unique_leaves(std::move(nodes));
  }

  /// Whether any vertex asks for it; those that are missed most come first where nodes are scarce.
  bool refine(const std::vector<double>& residuals) {
    std::vector<std::vector<LatticeCoordinates>> nodes;
    for (const ElementLevel& level : elements_->levels()) nodes.push_back(level.nodes);
    const Lattice finer{coarsest_.origin, elements_->levels().back().voxel_size / 2};
    std::vector<LatticeCoordinates> added;
    double distance = refined_beyond * tolerance_;
    do {
      added = nodes_around_missed(finer, residuals, distance);
      distance *= 2;
    } while (added.size() + elements_->unknowns() > options_.max_nodes && !added.empty());
    if (added.empty()) return false;
    require_memory(added.size());
    nodes.push_back(std::move(added));
    auto refined = std::make_unique<NestedElements>(coarsest_, std::move(nodes));
    coefficients_ = transferred(*elements_, coefficients_, *refined);
    refined->weigh(element_weights(*refined, source_, options_.lambda, elements_.get()));
    objective_.reset();  // refers to the elements
    elements_ = std::move(refined);
    return true;
  }

  Points sources_;
  Points wanted_;
  std::size_t vertices_;
  double tolerance_;
  FiniteElementOptions options_;
  DistortionBounds barriers_;
  std::vector<double> shares_;  ///< of a place's weight
  ClosestPointTree source_;
  const Progress& progress_;
  Lattice coarsest_;
  double weighted_area_ = 0;  ///< of a place
  std::unique_ptr<NestedElements> elements_;
  std::unique_ptr<ElementObjective> objective_;  ///< on these
  Points coefficients_;
  FiniteElementSummary summary_;
};

}  // namespace

std::string to_string(const FiniteElementSummary& summary) {
  std::size_t nodes = 0;
  for (const std::size_t count : summary.nodes) nodes += count;
  char text[320];
  std::snprintf(text, sizeof text,
                "%zu nodes on %zu levels, mean distortion %.3g, least determinant %.3g of the affine part's, "
                "residual %s, %.2f s",
                nodes, summary.nodes.size(), summary.distortion, summary.min_determinant,
                to_string(summary.residuals).c_str(), summary.seconds);
  return text;
}

std::vector<Figure> figures(const FiniteElementSummary& summary) {
  return {{"voxel_sizes", summary.voxel_sizes},
          {"nodes", summary.nodes},
          {"cells", summary.cells},
          {"iterations", summary.iterations},
          {"distortion", summary.distortion},
          {"min_determinant", summary.min_determinant},
          {"loosened", summary.loosened},
          {"blocked", std::size_t{summary.blocked}},
          {"outside", summary.outside}};
}

FiniteElementFit fit_finite_elements(const Points& sources, const Points& targets, const TriangleMesh& source,
                                     const FiniteElementOptions& options, const Progress& progress) {
  require_usable(sources, targets, options);
  const Stopwatch watch;
  const AffineMap affine = upright_affine(sources, targets, options.affine_part);
  const double scale = std::cbrt(affine.linear.determinant());
  Points places(3, sources.cols() + options.guides.sources.cols()), images(3, places.cols());
  places << sources, options.guides.sources;
  images << targets, options.guides.targets;
  Points wanted = affine.linear.inverse() * (images.colwise() - affine.offset) - places;
  Solver solver(std::move(places), std::move(wanted), static_cast<std::size_t>(sources.cols()), source,
                options.fit_tolerance / scale, options, progress);
  solver.solve();

  Pyramid pyramid = pyramid_of(solver.elements(), solver.coefficients(), affine.linear);
  for (PyramidLevel& level : pyramid.levels)
    round_values(level.values, options.fit_tolerance, ValuePrecision::single);
  FiniteElementFit fit{std::make_shared<BakedMap>(affine, std::move(pyramid)), solver.summary()};
  fit.summary.residuals = summarize(distances((*fit.map)(sources), targets));
  fit.summary.seconds = watch.seconds();
  return fit;
}

void write_exact(const BakedMap& map, ExactMapWriter& writer) {
  writer.affine(map.affine());
  const Pyramid& pyramid = map.pyramid();
  writer.numbers(pyramid.origin);
  writer.integer(static_cast<std::uint64_t>(pyramid.levels.size()));
  for (const PyramidLevel& level : pyramid.levels) {
    writer.number(level.voxel_size);
    writer.integer(static_cast<std::uint64_t>(level.leaves.size()));
    for (const LeafCoordinates& leaf : level.leaves)
      for (const int coordinate : leaf) writer.integer(static_cast<std::uint32_t>(coordinate));
    for (const float value : level.values) writer.number(value);
  }
}

std::shared_ptr<const BakedMap> read_baked(ExactMapReader& reader) {
  const AffineMap affine = reader.affine();
  Pyramid pyramid;
  reader.numbers(pyramid.origin, "an origin");
  const Eigen::Index levels = reader.count(2 * sizeof(double), "levels");
  for (Eigen::Index k = 0; k < levels; ++k) {
    PyramidLevel level;
    level.voxel_size = reader.positive("a voxel size");
    const Eigen::Index leaves = reader.count(sizeof(double) * leaf_floats, "leaves");
    for (Eigen::Index leaf = 0; leaf < leaves; ++leaf) {
      LeafCoordinates coordinates;
      for (int& coordinate : coordinates) coordinate = static_cast<int>(reader.integer<std::uint32_t>());
      level.leaves.push_back(coordinates);
    }
    level.values.resize(leaf_floats * level.leaves.size());
    for (float& value : level.values) value = static_cast<float>(reader.number("a node"));
    pyramid.levels.push_back(std::move(level));
  }
  reader.end();
  try {
    return std::make_shared<const BakedMap>(affine, std::move(pyramid));
  } catch (const InvalidInput& invalid) {
    reject_exact_map(invalid.what());
  }
}

}  // namespace bespoke

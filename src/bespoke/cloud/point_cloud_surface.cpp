#include "bespoke/cloud/point_cloud_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <vector>

#include "bespoke/cloud/detail/moving_surface.h"
#include "bespoke/cloud/detail/neighbour_distance.h"
#include "bespoke/cloud/detail/surface_net.h"
#include "bespoke/error.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/median.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/parallel.h"
#include "bespoke/quality/surface_distance.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

struct CloudSettings {
  /// Whose mean a place of the surface is. Weighted they count as half as many, which reduces noise to a
  /// third; more reduce it as their root, and blur what is smaller than they reach.
  std::size_t neighbours = 20;
  /// Points whose neighbours are farther than this many medians are left out: one such is no surface.
  double max_sparse = 4;
  /// A surface ends where the mean of the points lies aside by this share of their reach h: 1.5 standard
  /// deviations h/√8 of the weight. Inside of randomly spread points that happens once in 10⁷ places, …
  double off_centre = 0.53;
  /// … and where no point lies within this share, two spacings, so that holes are not filled from all sides:
  /// once in 3 · 10⁵ places.
  double emptiest = 0.8;
  double max_contradicting = 0.05;  ///< of the points: thin parts have some, normals without an order half
  int max_steps = 10;               ///< towards the surface; three are usual
  double step_tolerance = 0.0001;   ///< of a cell: far below the noise of any scan
  double steepest = 2;  ///< slope of the distance along the normal, or its inverse; 1 without noise
};
constexpr CloudSettings settings;

constexpr std::size_t point_grain = 512;
constexpr std::size_t leaf_grain = 4;

/// The cloud's points in an order of their own.
struct PreparedCloud {
  Points points;
  std::vector<SurfaceElement> elements;
};

/// One for all points at a place.
PreparedCloud sorted_cloud(const OrientedPoints& cloud) {
  const EqualPositions equal = equal_positions(cloud.points);
  PreparedCloud sorted;
  sorted.points.resize(3, static_cast<Eigen::Index>(equal.groups()));
  sorted.elements.reserve(equal.groups());
  for (std::size_t group = 0; group < equal.groups(); ++group) {
    Vector3 normal = Vector3::Zero();
    for (const int i : equal.group(group)) normal += cloud.normals.col(i).stableNormalized();
    const int first = equal.group(group).front();
    // Two that cancel say nothing together; the first then speaks, and is counted if it contradicts others.
    if (normal.norm() == 0) normal = cloud.normals.col(first);
    sorted.points.col(static_cast<Eigen::Index>(group)) = cloud.points.col(first);
    sorted.elements.push_back({cloud.points.col(first), normal.stableNormalized(), 0});
  }
  return sorted;
}

/// Leaves out the isolated points and gives every other one its reach: as far as its neighbours, or the
/// median of these distances where they are closer. Returns the median.
double set_reaches(PreparedCloud& cloud) {
  const std::vector<double> distances = neighbour_distances(cloud.points, settings.neighbours);
  const double usual = median(distances);
  std::vector<int> kept;
  std::vector<SurfaceElement> elements;
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i] <= settings.max_sparse * usual) {
      kept.push_back(static_cast<int>(i));
      elements.push_back({cloud.elements[i].point, cloud.elements[i].normal, std::max(distances[i], usual)});
    }
  cloud.points = Points(cloud.points(Eigen::all, kept));
  cloud.elements = std::move(elements);
  return usual;
}

/// Points that face against what the others around them say.
std::size_t contradicting_points(const PreparedCloud& cloud, const MovingSurface& surface) {
  return parallel_reduce(
      cloud.elements.size(), point_grain, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::vector<int> near;
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i) {
          const SurfaceElement& element = cloud.elements[i];
          surface.gather(element.point, 0, near);
          std::erase(near, static_cast<int>(i));
          const std::optional<SurfaceEstimate> others = surface.estimate(element.point, near);
          count += others && others->normal.dot(element.normal) < 0;
        }
        return count;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

void require_agreement(const PointCloudSummary& summary, const std::string& what) {
  const auto kept = static_cast<double>(summary.points - summary.duplicates - summary.isolated);
  const auto against = static_cast<double>(summary.contradicting);
  if (against <= settings.max_contradicting * kept) return;
  char share[32];
  std::snprintf(share, sizeof share, "%.0f %%", 100 * against / kept);
  throw InvalidInput(what + ": " + share +
                     " of the normals face against their neighbours; orient them consistently, all outwards");
}

/// The leaves that a point's reach meets.
std::vector<LeafCoordinates> leaves_near(const PreparedCloud& cloud, const SparseField& field) {
  std::vector<LeafCoordinates> leaves;
  for (const SurfaceElement& element : cloud.elements) {
    const auto leaf_at = [&](double side) {
      const Eigen::Array3d node =
          ((element.point - field.origin).array() + side * element.reach) / field.cell;
      const Eigen::Array3i floor = node.floor().cast<int>();
      return leaf_of({floor[0], floor[1], floor[2]});
    };
    const LeafCoordinates low = leaf_at(-1), high = leaf_at(1);
    for (int i = low[0]; i <= high[0]; ++i)
      for (int j = low[1]; j <= high[1]; ++j)
        for (int k = low[2]; k <= high[2]; ++k) leaves.push_back({i, j, k});
  }
  return unique_leaves(std::move(leaves));
}

void fill_octant(const MovingSurface& surface, const LatticeCoordinates& first, SparseField& field,
                 float* values, std::vector<int>& near) {
  constexpr int edge = leaf_edge / 2;
  const Vector3 half_diagonal = Vector3::Constant(field.cell * (edge - 1) / 2);
  surface.gather(field.place(first) + half_diagonal, half_diagonal.norm(), near);
  if (near.empty()) return;
  for (int number = 0; number < edge * edge * edge; ++number) {
    const LatticeCoordinates node =
        moved(first, {number / (edge * edge), number / edge % edge, number % edge});
    const std::optional<SurfaceEstimate> estimate = surface.estimate(field.place(node), near);
    if (estimate) values[number_of_place(place_in_leaf(node))] = static_cast<float>(estimate->distance);
  }
}

SparseField sampled(const MovingSurface& surface, const PreparedCloud& cloud, double cell,
                    const std::string& what) {
  // Beyond that many cells along an axis a node has no number.
  constexpr double max_cells = 1 << 28;
  const Box box = bounding_box(cloud.points);
  if (!(box.sizes().maxCoeff() < max_cells * cell))
    throw InvalidInput(what + ": the points lie in heaps too far apart for their spacing");
  SparseField field{box.min(), cell, {}, {}};
  field.leaves = leaves_near(cloud, field);
  field.values.assign(field.leaves.size() * leaf_nodes, SparseField::unknown);
  parallel_for(field.leaves.size(), leaf_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<int> near;
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      for (int octant = 0; octant < 8; ++octant)
        fill_octant(surface, moved(first_node(field.leaves[leaf]), first_place_of_octant(octant)), field,
                    field.values.data() + leaf * leaf_nodes, near);
  });
  return field;
}

bool is_inside_of_the_cloud(const SurfaceEstimate& estimate) {
  return estimate.off_centre <= settings.off_centre && estimate.nearest <= settings.emptiest;
}

/// The surface's point near a place, by the secant method along the normals; empty where there is none, and
/// where the cloud has ended.
std::optional<Vector3> placed_vertex(const MovingSurface& surface, const Vector3& start, double cell) {
  const double max_moved = cell;  // beyond, another cell is in charge
  std::vector<int> near;
  surface.gather(start, max_moved, near);
  Vector3 x = start;
  double slope = 1;
  std::optional<double> last;
  for (int step = 0; step < settings.max_steps; ++step) {
    const std::optional<SurfaceEstimate> estimate = surface.estimate(x, near);
    if (!estimate || !((x - start).norm() <= max_moved)) return std::nullopt;
    const double distance = estimate->distance;
    if (std::abs(distance) <= settings.step_tolerance * cell)
      return is_inside_of_the_cloud(*estimate) ? std::optional(x) : std::nullopt;
    if (last) slope = std::clamp(slope * (1 - distance / *last), 1 / settings.steepest, settings.steepest);
    last = distance;
    x -= distance / slope * estimate->normal;
  }
  return std::nullopt;
}

}  // namespace

PointCloudSurface point_cloud_surface(const OrientedPoints& cloud, const std::string& what) {
  const Stopwatch watch;
  require_valid(cloud, what);
  PointCloudSurface made;
  PointCloudSummary& summary = made.summary;
  PreparedCloud prepared = sorted_cloud(cloud);
  summary.hash = content_hash(cloud);
  summary.points = static_cast<std::size_t>(cloud.points.cols());
  summary.duplicates = summary.points - prepared.elements.size();
  if (prepared.elements.size() <= settings.neighbours)
    throw InvalidInput(what + ": its points lie at only " + std::to_string(prepared.elements.size()) +
                       " places");
  const double reach = set_reaches(prepared);
  summary.isolated = summary.points - summary.duplicates - prepared.elements.size();
  // A disk of this radius holds that many points.
  summary.spacing = reach * std::sqrt(std::numbers::pi / static_cast<double>(settings.neighbours));
  const MovingSurface surface(prepared.elements, prepared.points);
  summary.contradicting = contradicting_points(prepared, surface);
  require_agreement(summary, what);
  const SparseField field = sampled(surface, prepared, summary.spacing, what);
  made.mesh = surface_net(
      field, [&](const Vector3& start) { return placed_vertex(surface, start, summary.spacing); });
  if (made.mesh.faces.cols() == 0)
    throw InvalidInput(what + ": its points and normals show no surface; are they points of one?");
  summary.vertices = static_cast<std::size_t>(made.mesh.vertices.cols());
  summary.faces = static_cast<std::size_t>(made.mesh.faces.cols());
  summary.distances = summarize(distances(prepared.points, ClosestPointTree(made.mesh)));
  summary.seconds = watch.seconds();
  return made;
}

std::string to_string(const PointCloudSummary& summary) {
  char text[300];
  std::snprintf(text, sizeof text, "cloud of %zu points, %.4g apart", summary.points, summary.spacing);
  std::string line = text;
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) line += ", " + std::to_string(count) + (count == 1 ? one : many);
  };
  add(summary.duplicates, " of them twice", " of them twice");
  add(summary.isolated, " isolated left out", " isolated left out");
  add(summary.contradicting, " facing against its neighbours", " facing against their neighbours");
  std::snprintf(text, sizeof text,
                "; surface of %zu vertices, %zu faces; points p50 %.4g p95 %.4g max %.4g from it",
                summary.vertices, summary.faces, summary.distances.median, summary.distances.p95,
                summary.distances.max);
  return line + text;
}

}  // namespace bespoke

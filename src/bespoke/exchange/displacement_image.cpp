#include "bespoke/exchange/displacement_image.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// Enough for a call to keep all threads busy, few enough for the caches.
constexpr std::size_t points_per_call = std::size_t{1} << 16;

constexpr std::uint64_t seed = 17;

// One place in so many is looked around in for a larger error.
constexpr std::size_t share_of_worst = 100;

std::size_t node_count(const DisplacementImage& image) {
  return image.size[0] * image.size[1] * image.size[2];
}

Vector3 node_place(const DisplacementImage& image, std::size_t index) {
  const std::size_t i = index % image.size[0], j = index / image.size[0] % image.size[1],
                    k = index / (image.size[0] * image.size[1]);
  return image.origin + image.spacing * Vector3(double(i), double(j), double(k));
}

/// The lower node of the cell that holds a coordinate, and how far into the cell it lies, 0 to 1.
std::pair<std::size_t, double> cell_along(const DisplacementImage& image, Eigen::Index axis,
                                          double coordinate) {
  const double place = (coordinate - image.origin(axis)) / image.spacing;
  const double last = double(image.size[std::size_t(axis)]) - 2;
  const double low = std::clamp(std::floor(place), 0.0, last);
  return {std::size_t(low), place - low};
}

/// A grid around the box, still without values.
DisplacementImage empty_image(const Box& box, double spacing, std::size_t max_memory) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw InvalidInput("voxel size " + std::to_string(spacing) + " must be positive and finite");
  if (box.isEmpty()) throw InvalidInput("an empty box has no grid");
  const Vector3 extent = box.sizes();
  const Eigen::Array3d cells = (extent.array() / spacing).ceil().max(1);
  const double bytes = (cells + 1).prod() * 3 * sizeof(float);
  if (bytes > double(max_memory)) {
    // A little coarser than the cube root says, for the nodes at the ends.
    const double fitting = 1.05 * spacing * std::cbrt(bytes / double(max_memory));
    throw MemoryLimitError("a grid of voxels of " + std::to_string(spacing) + " takes " +
                           std::to_string(std::size_t(bytes / (1 << 20)) + 1) + " MiB; voxels of " +
                           std::to_string(fitting) + " fit");
  }
  DisplacementImage image;
  image.origin = box.min();
  image.spacing = spacing;
  for (std::size_t axis = 0; axis < 3; ++axis) image.size[axis] = std::size_t(cells(Eigen::Index(axis))) + 1;
  return image;
}

/// |sampled − image| at each column of x, mesh units.
std::vector<double> errors_at(const DisplacementImage& sampled, const PointFunction& image, const Points& x,
                              const Progress& progress) {
  const auto count = static_cast<std::size_t>(x.cols());
  std::vector<double> errors;
  while (errors.size() < count) {
    progress.step("measure", errors.size(), count);
    const Points part =
        x.middleCols(static_cast<Eigen::Index>(errors.size()),
                     static_cast<Eigen::Index>(std::min(points_per_call, count - errors.size())));
    const Points difference = part + sampled(part) - image(part);
    for (const auto& column : difference.colwise()) errors.push_back(column.norm());
  }
  progress.step("measure", count, count);
  return errors;
}

/// The columns of x with the largest errors, as many as there are at most.
Points worst_places(const Points& x, const std::vector<double>& errors, std::size_t count) {
  std::vector<Eigen::Index> order(errors.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::partial_sort(order.begin(), end, order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::pair(-errors[static_cast<std::size_t>(a)], a) <
           std::pair(-errors[static_cast<std::size_t>(b)], b);
  });
  order.erase(end, order.end());
  return x(Eigen::all, order);
}

}  // namespace

Points DisplacementImage::operator()(const Points& x) const {
  Points result(3, x.cols());
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    const auto [i, s] = cell_along(*this, 0, x(0, column));
    const auto [j, t] = cell_along(*this, 1, x(1, column));
    const auto [k, u] = cell_along(*this, 2, x(2, column));
    Vector3 sum = Vector3::Zero();
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t a = corner % 2, b = corner / 2 % 2, c = corner / 4;
      const double weight = (a ? s : 1 - s) * (b ? t : 1 - t) * (c ? u : 1 - u);
      const std::size_t node = ((k + c) * size[1] + j + b) * size[0] + i + a;
      sum += weight * Eigen::Map<const Eigen::Vector3f>(&values[3 * node]).cast<double>();
    }
    result.col(column) = sum;
  }
  return result;
}

DisplacementImage sample_displacements(const PointFunction& image, const Box& box, double spacing,
                                       std::size_t max_memory, const Progress& progress) {
  DisplacementImage sampled = empty_image(box, spacing, max_memory);
  const std::size_t count = node_count(sampled);
  sampled.values.resize(3 * count);
  for (std::size_t first = 0; first < count; first += points_per_call) {
    progress.step("sample", first, count);
    Points x(3, static_cast<Eigen::Index>(std::min(points_per_call, count - first)));
    for (Eigen::Index column = 0; column < x.cols(); ++column)
      x.col(column) = node_place(sampled, first + static_cast<std::size_t>(column));
    Eigen::Map<Eigen::Matrix3Xf>(&sampled.values[3 * first], 3, x.cols()) = (image(x) - x).cast<float>();
  }
  progress.step("sample", count, count);
  return sampled;
}

Statistics sampling_error(const DisplacementImage& sampled, const PointFunction& image, const Box& box,
                          std::size_t points, const Progress& progress) {
  std::mt19937_64 engine(seed);
  const auto fraction = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  Points places(3, static_cast<Eigen::Index>(points));
  for (auto&& x : places.colwise())
    for (Eigen::Index axis = 0; axis < 3; ++axis) x(axis) = box.min()[axis] + fraction() * box.sizes()[axis];
  const std::vector<double> errors = errors_at(sampled, image, places, progress);
  Statistics statistics = summarize(errors);

  // What is narrow, as the space beside the model, is missed by places of the whole box.
  const Points worst = worst_places(places, errors, points / share_of_worst + 1);
  for (Eigen::Index column = 0; column < places.cols(); ++column)
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double near = worst(axis, column % worst.cols()) + (fraction() - 0.5) * sampled.spacing;
      places(axis, column) = std::clamp(near, box.min()[axis], box.max()[axis]);
    }
  for (const double error : errors_at(sampled, image, places, progress))
    statistics.max = std::max(statistics.max, error);
  return statistics;
}

}  // namespace bespoke

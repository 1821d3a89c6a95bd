#include "bespoke/product/carry/part_motion.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>

#include "bespoke/error.h"
#include "bespoke/rigid/rigid_alignment.h"

namespace bespoke {
namespace {

constexpr std::size_t max_names = 100;  // that a message lists

using Place = std::array<double, 3>;

struct PlaceHash {
  // Multiplication by an odd number with well-spread bits (2⁶⁴ over the golden ratio) mixes upwards, the
  // shift back down.
  std::size_t operator()(const Place& place) const {
    std::uint64_t hash = 0;
    for (const double coordinate : place) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(coordinate)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

/// Both zeros are one place.
Place place_of(const Vector3& x) { return {x[0] + 0.0, x[1] + 0.0, x[2] + 0.0}; }

/// Which part has a place.
using PartTable = std::unordered_map<Place, std::size_t, PlaceHash>;

PartTable part_table(const std::vector<PartPoints>& parts, const std::filesystem::path& file) {
  PartTable table;
  const auto add = [&](const Points& points, std::size_t i) {
    for (const auto& point : points.colwise()) {
      const std::size_t owner = table.emplace(place_of(point), i).first->second;
      if (owner != i)
        throw InvalidInput(
            file.string() + ": the parts '" + parts[owner].part.name + "' and '" + parts[i].part.name +
            "' have a point in common, so they cannot both keep their shape: (" + std::to_string(point[0]) +
            ", " + std::to_string(point[1]) + ", " + std::to_string(point[2]) + ")");
    }
  };
  for (std::size_t i = 0; i < parts.size(); ++i) add(parts[i].points, i);
  for (std::size_t i = 0; i < parts.size(); ++i) add(parts[i].more, i);
  return table;
}

/// Least squares: R and T of the rigid alignment, and for a similarity s = Σ y · R x / Σ |x|² of what is
/// centred.
AffineMap fit_frame(const PartPoints& part, const Points& images) {
  if (images == part.points) return {};
  const Vector3 mean = part.points.rowwise().mean(), image_mean = images.rowwise().mean();
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(images.cols());
  const Matrix3 rotation = align_rigidly(part.points, images, weights).rotation;
  double scale = 1;
  if (part.part.motion == PartMotion::similar) {
    const Points turned = rotation * (part.points.colwise() - mean);
    scale = (images.colwise() - image_mean).cwiseProduct(turned).sum() / turned.squaredNorm();
  }
  AffineMap map{scale * rotation, Vector3::Zero()};
  map.offset = image_mean - map.linear * mean;
  return map;
}

}  // namespace

std::string to_string(const PartSummary& summary) {
  std::string text = summary.name + ": " + std::to_string(summary.points) + " points kept their shape";
  if (summary.motion == PartMotion::similar) text += ", scaled by " + std::to_string(summary.scale);
  return text + "; from where the map takes them: " + to_string(summary.distances);
}

std::vector<PartPoints> parts_of(const std::vector<RigidPart>& parts,
                                 const std::vector<std::vector<double>>& coordinates) {
  std::vector<PartPoints> result;
  for (std::size_t i = 0; i < parts.size(); ++i)
    result.push_back({parts[i],
                      Eigen::Map<const Points>(coordinates[i].data(), 3,
                                               static_cast<Eigen::Index>(coordinates[i].size() / 3)),
                      Points(3, 0)});
  return result;
}

FittedPart fit_part(const PartPoints& part, const PointMotion& motion, const std::filesystem::path& file) {
  FittedPart fitted;
  const std::vector<Points> images = motion.at_other_points(part.points);
  for (const Points& frame : images) {
    try {
      fitted.frames.push_back(fit_frame(part, frame));
    } catch (const InvalidInput&) {
      throw InvalidInput(file.string() + ": the " + std::to_string(part.points.cols()) +
                         " points of the part '" + part.part.name +
                         "' lie on a line, or their images do, so its turn is not determined");
    }
  }
  const Points differences = fitted.frames.back() * part.points - images.back();
  const Eigen::VectorXd distances = differences.colwise().norm();
  fitted.summary = {part.part.name, part.part.motion, static_cast<std::size_t>(distances.size()),
                    std::cbrt(fitted.frames.back().linear.determinant()),
                    summarize({distances.begin(), distances.end()})};
  return fitted;
}

void refuse_part(const std::string& name, const std::string& known, const std::filesystem::path& file) {
  throw UnknownPart(file.string() + ": has no part '" + name + "'; " + known);
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), max_names); ++i)
    text.append(i > 0 ? ", " : "").append(names[i]);
  if (names.size() > max_names)
    text.append(" and ").append(std::to_string(names.size() - max_names)).append(" more");
  return text;
}

std::vector<int> parts_at(const Points& points, const std::vector<PartPoints>& parts,
                          const std::filesystem::path& file) {
  const PartTable table = part_table(parts, file);
  std::vector<int> result;
  for (const auto& point : points.colwise()) {
    const auto found = table.find(place_of(point));
    result.push_back(found == table.end() ? -1 : static_cast<int>(found->second));
  }
  return result;
}

MotionWithParts with_rigid_parts(const PointMotion& motion, const std::vector<PartPoints>& parts,
                                 const std::vector<PartPoints>& places, const std::filesystem::path& file) {
  struct Parts {
    PartTable table;
    std::vector<std::vector<AffineMap>> maps;
  };
  const auto own = std::make_shared<Parts>();
  MotionWithParts result{motion, {}};
  own->table = part_table(places, file);
  for (const PartPoints& part : parts) {
    FittedPart fitted = fit_part(part, motion, file);
    own->maps.push_back(std::move(fitted.frames));
    result.parts.push_back(std::move(fitted.summary));
  }
  const auto for_points_of_parts = [own](const Points& x, const auto& body) {
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const auto found = own->table.find(place_of(x.col(i)));
      if (found != own->table.end()) body(i, own->maps[found->second]);
    }
  };
  const auto with_parts = [=](const auto& images_of) {
    return [=](const Points& x) {
      std::vector<Points> images = images_of(x);
      for_points_of_parts(x, [&](Eigen::Index i, const std::vector<AffineMap>& maps) {
        for (std::size_t frame = 0; frame < maps.size(); ++frame)
          images[frame].col(i) = maps[frame] * Vector3(x.col(i));
      });
      return images;
    };
  };
  result.motion.images = with_parts(motion.images);
  if (motion.images_elsewhere) result.motion.images_elsewhere = with_parts(motion.images_elsewhere);
  result.motion.jacobians = [=](const Points& x) {
    std::vector<Points> jacobians = motion.jacobians(x);
    for_points_of_parts(x, [&](Eigen::Index i, const std::vector<AffineMap>& maps) {
      for (std::size_t frame = 0; frame < maps.size(); ++frame)
        jacobians[frame].middleCols<3>(3 * i) = maps[frame].linear;
    });
    return jacobians;
  };
  return result;
}

}  // namespace bespoke

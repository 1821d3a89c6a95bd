#include "bespoke/registration/unmet_vertices.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bespoke/mesh/equal_positions.h"

namespace bespoke {
namespace {

constexpr std::array reasons = {UnmetReason::shared_place, UnmetReason::touching, UnmetReason::folded,
                                UnmetReason::steep};

std::vector<char> at_folded_faces(const TriangleMesh& images, const TriangleMesh& fitted) {
  const Points image_normals = face_normals(images), fitted_normals = face_normals(fitted);
  std::vector<char> result(static_cast<std::size_t>(images.vertices.cols()), 0);
  for (Eigen::Index face = 0; face < fitted.faces.cols(); ++face)
    if (!(image_normals.col(face).dot(fitted_normals.col(face)) > 0))
      for (const int vertex : fitted.faces.col(face)) result[static_cast<std::size_t>(vertex)] = 1;
  return result;
}

/// 1 where another vertex of some face has the same place, but not the same fitted position.
std::vector<char> at_shared_places(const TriangleMesh& source, const std::vector<char>& used,
                                   const Points& fitted) {
  std::vector<int> referenced;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) referenced.push_back(static_cast<int>(i));
  const EqualPositions equal = equal_positions(source.vertices, std::move(referenced));
  std::vector<char> result(used.size(), 0);
  for (std::size_t index = 0; index < equal.groups(); ++index) {
    const std::span<const int> group = equal.group(index);
    const bool parted = std::any_of(group.begin(), group.end(), [&](int vertex) {
      return fitted.col(vertex) != fitted.col(group.front());
    });
    for (const int vertex : group) result[static_cast<std::size_t>(vertex)] = parted;
  }
  return result;
}

}  // namespace

const char* to_string(UnmetReason reason) {
  switch (reason) {
    case UnmetReason::shared_place:
      return "shared place";
    case UnmetReason::touching:
      return "the target touches itself";
    case UnmetReason::folded:
      return "fitted faces folded";
    case UnmetReason::steep:
      return "too steep";
  }
  return "";
}

std::vector<UnmetVertex> unmet_vertices(const TriangleMesh& source, const Points& images,
                                        const Points& fitted, double tolerance,
                                        const std::vector<ReleasedVertex>& released) {
  std::vector<char> used(static_cast<std::size_t>(source.vertices.cols()), 0);
  for (const int vertex : source.faces.reshaped()) used[static_cast<std::size_t>(vertex)] = 1;
  const std::vector<char> folded = at_folded_faces({images, source.faces}, {fitted, source.faces});
  const std::vector<char> shared = at_shared_places(source, used, fitted);
  Points wanted = fitted;
  std::vector<char> touching(used.size(), 0);
  for (const ReleasedVertex& vertex : released) {
    wanted.col(vertex.vertex) = vertex.place;
    touching[static_cast<std::size_t>(vertex.vertex)] = 1;
  }
  std::vector<UnmetVertex> unmet;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double residual = (images.col(column) - wanted.col(column)).norm();
    if (!used[i] || residual <= tolerance) continue;
    const UnmetReason reason = shared[i]     ? UnmetReason::shared_place
                               : touching[i] ? UnmetReason::touching
                               : folded[i]   ? UnmetReason::folded
                                             : UnmetReason::steep;
    unmet.push_back({static_cast<int>(i), residual, reason});
  }
  return unmet;
}

std::string to_string(const std::vector<UnmetVertex>& unmet) {
  if (unmet.empty()) return {};
  std::string line = std::to_string(unmet.size()) + " vertices unmet";
  const char* separator = ": ";
  for (const UnmetReason reason : reasons) {
    const auto count = std::count_if(unmet.begin(), unmet.end(),
                                     [&](const UnmetVertex& vertex) { return vertex.reason == reason; });
    if (count == 0) continue;
    line += separator + std::to_string(count) + " " + to_string(reason);
    separator = ", ";
  }
  return line;
}

}  // namespace bespoke

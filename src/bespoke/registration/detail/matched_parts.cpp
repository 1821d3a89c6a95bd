#include "bespoke/registration/detail/matched_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/principal_widths.h"

namespace bespoke {
namespace {

constexpr double half = 0.5;

struct Part {
  std::size_t faces = 0;
  Vector3 centre, widths;  // of the faces' centres; widths are standard deviations, the largest first
};

/// The part of each face, numbered as their first faces come.
std::vector<int> part_of_faces(const TriangleMesh& mesh) {
  DisjointSets sets(static_cast<int>(mesh.vertices.cols()));
  for (const auto& face : mesh.faces.colwise()) {
    sets.join(face[0], face[1]);
    sets.join(face[0], face[2]);
  }
  std::map<int, int> numbers;
  std::vector<int> parts;
  for (const auto& face : mesh.faces.colwise())
    parts.push_back(numbers.try_emplace(sets.least(face[0]), static_cast<int>(numbers.size())).first->second);
  return parts;
}

std::vector<Part> parts_of(const TriangleMesh& mesh, const std::vector<int>& of_face, int count) {
  std::vector<std::vector<Eigen::Index>> faces(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < of_face.size(); ++k)
    faces[static_cast<std::size_t>(of_face[k])].push_back(static_cast<Eigen::Index>(k));
  std::vector<Part> parts;
  for (const std::vector<Eigen::Index>& own : faces) {
    Points centres(3, static_cast<Eigen::Index>(own.size()));
    for (std::size_t k = 0; k < own.size(); ++k)
      centres.col(static_cast<Eigen::Index>(k)) =
          (mesh.vertices.col(mesh.faces(0, own[k])) + mesh.vertices.col(mesh.faces(1, own[k])) +
           mesh.vertices.col(mesh.faces(2, own[k]))) /
          3;
    parts.push_back({own.size(), centres.rowwise().mean(),
                     principal_widths(centres).widths / std::sqrt(double(own.size()))});
  }
  return parts;
}

/// 0 for equal parts at one place; centres as far apart as the parts are wide, or widths of twice the size,
/// count about one.
double unlikeness(const Part& a, const Part& b) {
  constexpr double flat = 0.05;  // of the widest: thinner parts are as thin as each other
  const double width = half * (a.widths[0] + b.widths[0]);
  if (!(width > 0)) return (a.centre - b.centre).norm() > 0 ? std::numeric_limits<double>::infinity() : 0;
  const auto stretched = [&](int k) {
    return std::log2((a.widths[k] + flat * width) / (b.widths[k] + flat * width));
  };
  return std::sqrt((a.centre - b.centre).squaredNorm() / (width * width) + stretched(0) * stretched(0) +
                   stretched(1) * stretched(1) + stretched(2) * stretched(2));
}

/// For each part of the source its counterpart; empty unless all have one that is each other's best.
std::vector<int> counterparts(const std::vector<Part>& source, const std::vector<Part>& target) {
  constexpr double most = 1;  // of unlikeness
  const std::size_t count = source.size();
  const auto best = [&](const auto& cost) {
    std::size_t least = 0;
    for (std::size_t j = 1; j < count; ++j)
      if (cost(j) < cost(least)) least = j;
    return least;
  };
  std::vector<int> found;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = best([&](std::size_t k) { return unlikeness(source[i], target[k]); });
    const std::size_t back = best([&](std::size_t k) { return unlikeness(source[k], target[j]); });
    if (back != i || !(unlikeness(source[i], target[j]) <= most)) return {};
    found.push_back(static_cast<int>(j));
  }
  return found;
}

int count_of(const std::vector<int>& of_face) {
  return of_face.empty() ? 0 : *std::max_element(of_face.begin(), of_face.end()) + 1;
}

}  // namespace

std::size_t part_count(const TriangleMesh& mesh) {
  return static_cast<std::size_t>(count_of(part_of_faces(mesh)));
}

MatchedParts match_parts(const TriangleMesh& source, const Points& placed, const TriangleMesh& target) {
  std::vector<int> source_of = part_of_faces(source), target_of = part_of_faces(target);
  const int count = count_of(source_of), target_count = count_of(target_of);
  MatchedParts result;
  result.source_parts = static_cast<std::size_t>(count);
  result.target_parts = static_cast<std::size_t>(target_count);
  if (count < 2 || count != target_count) return result;
  const std::vector<Part> source_parts = parts_of({placed, source.faces}, source_of, count);
  const std::vector<Part> target_parts = parts_of(target, target_of, count);
  const std::vector<int> counterpart = counterparts(source_parts, target_parts);
  if (counterpart.empty()) return result;
  std::vector<int> number(counterpart.size());
  for (std::size_t i = 0; i < counterpart.size(); ++i)
    number[static_cast<std::size_t>(counterpart[i])] = static_cast<int>(i);
  for (int& part : target_of) part = number[static_cast<std::size_t>(part)];
  result.source.of_face = std::move(source_of);
  result.target.of_face = std::move(target_of);
  for (std::size_t i = 0; i < counterpart.size(); ++i) {
    result.source.sizes.push_back(source_parts[i].faces);
    result.target.sizes.push_back(target_parts[static_cast<std::size_t>(counterpart[i])].faces);
  }
  return result;
}

std::string to_string(const MatchedParts& parts) {
  const std::string counts = "the source has " + std::to_string(parts.source_parts) +
                             " loose parts, the target " + std::to_string(parts.target_parts);
  return counts + (parts.correspond()
                       ? ": each goes onto its counterpart"
                       : "; they do not correspond one to one, so each part goes onto whatever "
                         "is nearest; where some do, say so by patches");
}

}  // namespace bespoke

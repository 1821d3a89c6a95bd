#include "bespoke/product/detail/obj_normals.h"

#include <algorithm>
#include <numeric>

#include "bespoke/product/detail/directions.h"
#include "bespoke/product/detail/obj_statements.h"

namespace bespoke {
namespace {

constexpr double direction_resolution = 1e-7;  // of a unit vector

struct PositionsAndNormals {
  Points positions, normals;
};

PositionsAndNormals read_all(const InputFile& file, const ObjContent& content, const Progress& progress) {
  PositionsAndNormals all;
  all.positions.resize(3, static_cast<Eigen::Index>(content.counts[0]));
  if (!content.more_uses.empty()) all.normals.resize(3, static_cast<Eigen::Index>(content.counts[2]));
  TextCutter cutter(file.path(), 1, count_obj);
  const auto read = [&](const TextBlock& block) {
    auto position = static_cast<Eigen::Index>(block.before[0]);
    auto normal = static_cast<Eigen::Index>(block.before[2]);
    TextWords words(block, file.path(), obj_syntax);
    while (words.next_line()) {
      if (*words.line_begin() != 'v') continue;
      const ObjStatement statement = obj_statement(words.word());
      const bool is_position = statement == ObjStatement::position;
      if (!is_position && (statement != ObjStatement::normal || all.normals.cols() == 0)) continue;
      const NumberTriple triple = read_triple(words);
      (is_position ? all.positions.col(position++) : all.normals.col(normal++)) =
          Vector3(triple[0].value, triple[1].value, triple[2].value);
    }
    return true;
  };
  walk_blocks(
      file, 0, [&](const Window& window) { return cutter(window); }, read, [](const TextBlock&, bool) {},
      progress);
  return all;
}

}  // namespace

ObjNormals::ObjNormals(const InputFile& file, const ObjContent& content, const PointMotion& motion,
                       const Progress& progress)
    : content_(content),
      motion_(motion),
      frames_(motion.frames),
      decimals_(std::max(content.normal_decimals.decimals(), decimals_for(direction_resolution))) {
  if (content.first_use.empty()) return;
  PositionsAndNormals all = read_all(file, content, progress);
  positions_ = std::move(all.positions);
  more_start_.assign(content.first_use.size() + 1, 0);
  for (const auto& [normal, position] : content.more_uses) ++more_start_[normal + 1];
  std::partial_sum(more_start_.begin(), more_start_.end(), more_start_.begin());
  if (!content.more_uses.empty()) decide(all.normals, progress);
}

Points ObjNormals::use_positions(std::uint32_t normal) const {
  const std::size_t begin = more_start_[normal], end = more_start_[normal + 1];
  Points x(3, static_cast<Eigen::Index>(1 + end - begin));
  x.col(0) = positions_.col(content_.first_use[normal]);
  for (std::size_t use = begin; use < end; ++use)
    x.col(static_cast<Eigen::Index>(1 + use - begin)) = positions_.col(content_.more_uses[use].second);
  return x;
}

// A use goes with the first earlier one whose normal would be written as the same number.
void ObjNormals::decide(const Points& normals, const Progress& progress) {
  constexpr std::size_t uses_at_a_time = std::size_t{1} << 17;
  const auto count = static_cast<std::uint32_t>(content_.first_use.size());
  const double tolerance = 0.5 * std::pow(10.0, -decimals_);
  for (Frame& frame : frames_) frame.rank.assign(content_.more_uses.size(), 0);
  std::vector<std::vector<std::uint32_t>> lines(motion_.frames, std::vector<std::uint32_t>(count, 1));
  for (std::uint32_t begin = 0; begin < count;) {
    progress.check();
    std::vector<std::uint32_t> several;
    std::vector<Vector3> x, n;
    for (; begin < count && x.size() < uses_at_a_time; ++begin) {
      if (more_start_[begin] == more_start_[begin + 1]) continue;
      several.push_back(begin);
      const Points places = use_positions(begin);
      for (Eigen::Index i = 0; i < places.cols(); ++i) {
        x.push_back(places.col(i));
        n.push_back(normals.col(begin));
      }
    }
    if (several.empty()) continue;
    const auto points = static_cast<Eigen::Index>(x.size());
    const std::vector<Points> jacobians =
        motion_.jacobians(Eigen::Map<const Points>(x.front().data(), 3, points));
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      const Points moved = moved_normals(Eigen::Map<const Points>(n.front().data(), 3, points), jacobians[f]);
      Eigen::Index at = 0;
      for (const std::uint32_t normal : several) {
        std::vector<Eigen::Index> first_of{at};
        for (std::size_t use = more_start_[normal]; use < more_start_[normal + 1]; ++use) {
          ++at;
          const auto same = std::find_if(first_of.begin(), first_of.end(), [&](Eigen::Index other) {
            return (moved.col(at) - moved.col(other)).cwiseAbs().maxCoeff() <= tolerance;
          });
          frames_[f].rank[use] = static_cast<std::uint32_t>(same - first_of.begin());
          if (same == first_of.end()) first_of.push_back(at);
        }
        ++at;
        lines[f][normal] = static_cast<std::uint32_t>(first_of.size());
      }
    }
  }
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    if (std::all_of(lines[f].begin(), lines[f].end(), [](std::uint32_t n) { return n == 1; })) continue;
    frames_[f].first_line.assign(count + 1, 0);
    std::partial_sum(lines[f].begin(), lines[f].end(), frames_[f].first_line.begin() + 1);
  }
}

std::uint32_t ObjNormals::line(std::size_t frame, std::uint32_t normal, std::uint32_t position) const {
  if (!renumbers(frame)) return normal;
  const std::uint32_t first = frames_[frame].first_line[normal];
  if (content_.first_use[normal] == position) return first;
  const auto use =
      std::lower_bound(content_.more_uses.begin() + static_cast<std::ptrdiff_t>(more_start_[normal]),
                       content_.more_uses.begin() + static_cast<std::ptrdiff_t>(more_start_[normal + 1]),
                       std::pair(normal, position));
  return first + frames_[frame].rank[static_cast<std::size_t>(use - content_.more_uses.begin())];
}

std::uint32_t ObjNormals::lines_before(std::size_t frame, std::uint32_t normals) const {
  return renumbers(frame) ? frames_[frame].first_line[normals] : normals;
}

std::vector<std::vector<Points>> ObjNormals::moved(std::uint32_t first, const Points& normals) const {
  const auto count = static_cast<std::uint32_t>(normals.cols());
  std::vector<Vector3> x, n;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (content_.first_use[first + i] == ObjContent::unused) continue;
    const Points places = use_positions(first + i);
    for (Eigen::Index k = 0; k < places.cols(); ++k) {
      x.push_back(places.col(k));
      n.push_back(normals.col(i));
    }
  }
  std::vector<std::vector<Points>> result(frames_.size(), std::vector<Points>(count, Points(3, 0)));
  if (x.empty()) return result;
  const auto points = static_cast<Eigen::Index>(x.size());
  const std::vector<Points> jacobians =
      motion_.jacobians(Eigen::Map<const Points>(x.front().data(), 3, points));
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    const Points moved = moved_normals(Eigen::Map<const Points>(n.front().data(), 3, points), jacobians[f]);
    Eigen::Index at = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t normal = first + i;
      if (content_.first_use[normal] == ObjContent::unused) continue;
      std::vector<Vector3> lines{moved.col(at++)};
      for (std::size_t use = more_start_[normal]; use < more_start_[normal + 1]; ++use, ++at)
        if (frames_[f].rank[use] == lines.size()) lines.push_back(moved.col(at));
      result[f][i] =
          Eigen::Map<const Points>(lines.front().data(), 3, static_cast<Eigen::Index>(lines.size()));
    }
  }
  return result;
}

}  // namespace bespoke

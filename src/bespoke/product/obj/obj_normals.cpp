#include "bespoke/product/obj/obj_normals.h"

#include <algorithm>
#include <numeric>

#include "bespoke/product/carry/directions.h"
#include "bespoke/product/obj/obj_statements.h"

namespace bespoke {
namespace {

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
      {file, 0}, [&](const Window& window) { return cutter(window); }, read, [](const TextBlock&, bool) {},
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

void ObjNormals::add_uses(std::uint32_t normal, const Vector3& direction, Uses& uses) const {
  uses.positions.push_back(positions_.col(content_.first_use[normal]));
  for (std::size_t use = more_start_[normal]; use < more_start_[normal + 1]; ++use)
    uses.positions.push_back(positions_.col(content_.more_uses[use].second));
  uses.normals.resize(uses.positions.size(), direction);
}

/// For every frame one column a use.
std::vector<Points> ObjNormals::images(const Uses& uses) const {
  const auto count = static_cast<Eigen::Index>(uses.positions.size());
  if (count == 0) return std::vector<Points>(frames_.size(), Points(3, 0));
  const Eigen::Map<const Points> normals(uses.normals.front().data(), 3, count);
  std::vector<Points> images =
      motion_.jacobians(Eigen::Map<const Points>(uses.positions.front().data(), 3, count));
  for (Points& image : images) image = moved_normals(normals, image);
  return images;
}

/// A use goes with the first earlier one whose normal would be written as the same number. moved: 3×k, the
/// images of all uses of these normals.
void ObjNormals::rank_uses(const std::vector<std::uint32_t>& normals, const Points& moved, Frame& frame,
                           std::vector<std::uint32_t>& lines) const {
  const double tolerance = 0.5 * std::pow(10.0, -decimals_);
  Eigen::Index at = 0;
  for (const std::uint32_t normal : normals) {
    std::vector<Eigen::Index> first_of{at++};
    for (std::size_t use = more_start_[normal]; use < more_start_[normal + 1]; ++use, ++at) {
      const auto same = std::find_if(first_of.begin(), first_of.end(), [&](Eigen::Index other) {
        return (moved.col(at) - moved.col(other)).cwiseAbs().maxCoeff() <= tolerance;
      });
      frame.rank[use] = static_cast<std::uint32_t>(same - first_of.begin());
      if (same == first_of.end()) first_of.push_back(at);
    }
    lines[normal] = static_cast<std::uint32_t>(first_of.size());
  }
}

void ObjNormals::decide(const Points& normals, const Progress& progress) {
  constexpr std::size_t uses_at_a_time = std::size_t{1} << 17;
  const auto count = static_cast<std::uint32_t>(content_.first_use.size());
  for (Frame& frame : frames_) frame.rank.assign(content_.more_uses.size(), 0);
  std::vector<std::vector<std::uint32_t>> lines(motion_.frames, std::vector<std::uint32_t>(count, 1));
  for (std::uint32_t normal = 0; normal < count;) {
    progress.check();
    std::vector<std::uint32_t> several;
    Uses uses;
    for (; normal < count && uses.positions.size() < uses_at_a_time; ++normal) {
      if (!is_of_several(normal)) continue;
      several.push_back(normal);
      add_uses(normal, normals.col(normal), uses);
    }
    const std::vector<Points> moved = images(uses);
    for (std::size_t f = 0; f < frames_.size(); ++f) rank_uses(several, moved[f], frames_[f], lines[f]);
  }
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    // Without a normal that becomes several no number changes.
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
  const auto is_used = [&](std::uint32_t i) { return content_.first_use[first + i] != ObjContent::unused; };
  Uses uses;
  for (std::uint32_t i = 0; i < count; ++i)
    if (is_used(i)) add_uses(first + i, normals.col(i), uses);
  const std::vector<Points> moved = images(uses);
  std::vector<std::vector<Points>> result(frames_.size(), std::vector<Points>(count, Points(3, 0)));
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    Eigen::Index at = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!is_used(i)) continue;
      std::vector<Vector3> lines{moved[f].col(at++)};
      for (std::size_t use = more_start_[first + i]; use < more_start_[first + i + 1]; ++use, ++at)
        if (frames_[f].rank[use] == lines.size()) lines.push_back(moved[f].col(at));
      result[f][i] =
          Eigen::Map<const Points>(lines.front().data(), 3, static_cast<Eigen::Index>(lines.size()));
    }
  }
  return result;
}

}  // namespace bespoke

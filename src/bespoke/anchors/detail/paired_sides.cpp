#include "bespoke/anchors/detail/paired_sides.h"

#include <algorithm>
#include <set>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

/// Whether both sides have the same names in perhaps another order, each once.
template <typename Named>
bool are_named_alike(const std::vector<Named>& a, const std::vector<Named>& b) {
  std::set<std::string> first, second;
  for (const Named& each : a) first.insert(each.name);
  for (const Named& each : b) second.insert(each.name);
  return first == second && first.size() == a.size() && first.size() == b.size() && !first.contains("");
}

/// What of b belongs to a[0], a[1] and so on.
template <typename Named>
std::vector<Named> counterparts(const std::vector<Named>& a, const std::vector<Named>& b, const char* what,
                                const std::vector<std::filesystem::path>& paths) {
  if (a.size() != b.size())
    throw FormatError(paths[0].string() + " has " + std::to_string(a.size()) + " " + what + ", " +
                      paths[1].string() + " has " + std::to_string(b.size()));
  if (!are_named_alike(a, b)) return b;
  std::vector<Named> found;
  for (const Named& each : a)
    found.push_back(
        *std::find_if(b.begin(), b.end(), [&](const Named& other) { return other.name == each.name; }));
  return found;
}

}  // namespace

Anchors paired(const FileSide& a, const FileSide& b, const std::vector<std::filesystem::path>& paths) {
  Anchors anchors;
  const std::vector<NamedPoint> points = counterparts(a.points, b.points, "points", paths);
  std::set<std::string> taken;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Where the names of the sides differ the first one's stand, but no name twice.
    const bool is_free = taken.insert(a.points[i].name).second;
    anchors.pairs.push_back({is_free ? a.points[i].name : "", a.points[i].x, points[i].x});
  }
  const std::vector<NamedLine> lines = counterparts(a.lines, b.lines, "curves", paths);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const NamedLine &on_a = a.lines[i], &on_b = lines[i];
    if (on_a.closed != on_b.closed)
      throw FormatError("curve " + std::to_string(i) + " (\"" + on_a.name + "\") is closed in " +
                        paths[on_a.closed ? 0 : 1].string() + " and open in " +
                        paths[on_a.closed ? 1 : 0].string());
    anchors.curves.push_back({on_a.name, on_a.points, on_b.points, on_a.closed});
  }
  return anchors;
}

}  // namespace bespoke

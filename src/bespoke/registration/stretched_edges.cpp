#include "bespoke/registration/stretched_edges.h"

#include <algorithm>

#include "bespoke/median.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

constexpr double explained = 1e-3;  // of the images' diagonal: what remeshing leaves, as of anchors
constexpr std::size_t max_places = 3;
constexpr double apart = 0.1;  // of the source's diagonal: places nearer to each other are told as one

struct Stretch {
  double factor;
  Vector3 place;
};

/// The worst first, none near a worse one.
std::vector<Vector3> places_of(std::vector<Stretch> found, double distance) {
  std::stable_sort(found.begin(), found.end(),
                   [](const Stretch& a, const Stretch& b) { return a.factor > b.factor; });
  std::vector<Vector3> places;
  for (const Stretch& stretch : found) {
    if (places.size() == max_places) break;
    if (std::none_of(places.begin(), places.end(),
                     [&](const Vector3& place) { return (place - stretch.place).norm() < distance; }))
      places.push_back(stretch.place);
  }
  return places;
}

std::string text_of(const Vector3& place) {
  return "(" + format_number(place.x(), 3) + ", " + format_number(place.y(), 3) + ", " +
         format_number(place.z(), 3) + ")";
}

}  // namespace

StretchedEdges stretched_edges(const TriangleMesh& source, const Points& images, double max_stretch) {
  struct Lengths {
    double before, after;
    Vector3 middle;
  };
  std::vector<Lengths> lengths;
  std::vector<double> ratios;
  for (const MeshEdge& edge : mesh_edges(source).edges) {
    const Vector3 from = source.vertices.col(edge.a), to = source.vertices.col(edge.b);
    const double before = (to - from).norm(), after = (images.col(edge.b) - images.col(edge.a)).norm();
    if (!(before > 0)) continue;
    lengths.push_back({before, after, (from + to) / 2});
    ratios.push_back(after / before);
  }
  StretchedEdges result;
  if (ratios.empty()) return result;
  const double size = median(ratios), noise = explained * diagonal(images);
  if (!(size > 0)) return result;
  std::vector<Stretch> found;
  for (const Lengths& edge : lengths) {
    const double shorter = std::min(size * edge.before, edge.after),
                 longer = std::max(size * edge.before, edge.after);
    if (longer > max_stretch * shorter + noise)
      found.push_back({longer / std::max(shorter, noise), edge.middle});
  }
  result.count = found.size();
  for (const Stretch& stretch : found) result.max_factor = std::max(result.max_factor, stretch.factor);
  result.places = places_of(std::move(found), apart * diagonal(source.vertices));
  return result;
}

std::string to_string(const StretchedEdges& stretched) {
  if (stretched.count == 0) return {};
  std::string line = std::to_string(stretched.count) +
                     (stretched.count == 1 ? " edge of the source changes" : " edges of the source change") +
                     " in length by more than --max-stretch, up to " +
                     format_number(stretched.max_factor, 3) + " times, around ";
  for (std::size_t i = 0; i < stretched.places.size(); ++i)
    line += (i == 0 ? "" : ", ") + text_of(stretched.places[i]);
  return line;
}

}  // namespace bespoke

#include "bespoke/page/detail/places.h"

#include <algorithm>
#include <map>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

constexpr std::size_t max_places = 100;  // of a kind: a person visits no more
constexpr double group_radius = 0.03;    // of the diagonal: about what a flight to a place shows

template <class Figure>
std::string figure(const Figure& value) {
  return format_number(value, 4);
}

Vector3 nearest_column(const Points& points, const Points& values, const Vector3& x) {
  Eigen::Index nearest = 0;
  (points.colwise() - x).colwise().squaredNorm().minCoeff(&nearest);
  return values.col(nearest);
}

void add_folds(const Asset& asset, const TriangleMesh& source, std::vector<Place>& places) {
  Points at_step = source.vertices;
  const ElasticChain chain = baked_chain(asset.steps);
  for (std::size_t k = 0; k < asset.steps.size(); ++k) {
    std::vector<FoldedCell> cells = asset.steps[k].certificate.places;
    std::sort(cells.begin(), cells.end(),
              [](const FoldedCell& a, const FoldedCell& b) { return a.determinant < b.determinant; });
    cells.resize(std::min(cells.size(), max_places));
    for (const FoldedCell& cell : cells)
      places.push_back({"folded cells", "det " + figure(cell.determinant) + " at " + figure(cell.center),
                        k == 0 ? cell.center : nearest_column(at_step, source.vertices, cell.center)});
    if (k + 1 < asset.steps.size()) at_step = (*chain.steps()[k])(at_step);
  }
}

Vector3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

void add_relaxed(const Json& bake, std::vector<Place>& places) {
  std::vector<std::pair<double, Vector3>> regions;
  const auto collect = [&](const Json& summary) {
    for (const Json& region : summary.value("relaxed", Json::array()))
      regions.emplace_back(region.at("error").get<double>(), 0.5 * (vector_of(region.at("box").at("min")) +
                                                                    vector_of(region.at("box").at("max"))));
  };
  collect(bake);
  for (const Json& step : bake.value("steps", Json::array())) collect(step);
  std::sort(regions.begin(), regions.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  regions.resize(std::min(regions.size(), max_places));
  for (const auto& [error, centre] : regions)
    places.push_back(
        {"regions that miss the tolerance", "error " + figure(error) + " around " + figure(centre), centre});
}

struct RankedVertex {
  int vertex = 0;
  double value = 0;
};

/// Vertices near each other as one place, at the one of the largest value.
void add_vertices(const std::string& kind, std::vector<RankedVertex> vertices, const TriangleMesh& source,
                  bool says_value, std::vector<Place>& places) {
  std::stable_sort(vertices.begin(), vertices.end(),
                   [](const RankedVertex& a, const RankedVertex& b) { return a.value > b.value; });
  const double radius = group_radius * diagonal(source.vertices);
  std::vector<std::pair<RankedVertex, int>> groups;  // and how many vertices
  for (const RankedVertex& vertex : vertices) {
    if (vertex.vertex < 0 || vertex.vertex >= source.vertices.cols())
      throw InvalidInput(kind + ": vertex " + std::to_string(vertex.vertex) + " is not one of the source's " +
                         std::to_string(source.vertices.cols()));
    const Vector3 x = source.vertices.col(vertex.vertex);
    const auto near = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return (source.vertices.col(group.first.vertex) - x).norm() < radius;
    });
    if (near != groups.end())
      ++near->second;
    else if (groups.size() < max_places)
      groups.push_back({vertex, 1});
  }
  for (const auto& [first, count] : groups) {
    const Vector3 x = source.vertices.col(first.vertex);
    places.push_back({kind,
                      std::to_string(count) + (count == 1 ? " vertex" : " vertices") +
                          (says_value ? ", up to " + figure(first.value) : "") + " around " + figure(x),
                      x});
  }
}

void add_listed(const Json& stage, const char* key, const std::string& kind, const TriangleMesh& source,
                std::vector<Place>& places) {
  std::vector<RankedVertex> vertices;
  for (const Json& vertex : stage.value(key, Json::array())) vertices.push_back({vertex.get<int>(), 0});
  add_vertices(kind, std::move(vertices), source, false, places);
}

}  // namespace

std::vector<Place> places_to_see(const Asset& asset, const TriangleMesh& source,
                                 const FitFindings& findings) {
  std::vector<Place> places;
  add_folds(asset, source, places);
  const std::string& text = asset.record.stages_json;
  const Json stages = text.empty() ? Json::array() : Json::parse(text);
  for (const Json& stage : stages) {
    const std::string name = stage.value("name", "");
    if (name == "bake") add_relaxed(stage, places);
    if (name != "surface-fit") continue;
    add_listed(stage, "cavity_vertices", "in a cavity that the target lacks", source, places);
    add_listed(stage, "excluded_vertices", "without counterpart: excluded by a patch", source, places);
    add_listed(stage, "stretched_vertices", "stretched too far, following their neighbours", source, places);
  }
  std::map<std::string, std::vector<RankedVertex>> unmet;
  if (findings.unmet)
    for (const FitFindings::Unmet& vertex : *findings.unmet)
      unmet[vertex.reason].push_back({vertex.vertex, vertex.residual});
  for (auto& [reason, vertices] : unmet)
    add_vertices("not met: " + reason, std::move(vertices), source, true, places);
  return places;
}

}  // namespace bespoke

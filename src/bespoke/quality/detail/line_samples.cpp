#include "bespoke/quality/detail/line_samples.h"

namespace bespoke {

LineSamples sample_lines(const Points& vertices, const std::vector<int>& line_edges, std::size_t count) {
  const auto length = [&](std::size_t edge) {
    return (vertices.col(line_edges[2 * edge]) - vertices.col(line_edges[2 * edge + 1])).norm();
  };
  const std::size_t edges = line_edges.size() / 2;
  double whole = 0;
  for (std::size_t edge = 0; edge < edges; ++edge) whole += length(edge);
  LineSamples samples;
  if (!(whole > 0)) return samples;
  const double spacing = whole / static_cast<double>(count);
  double before = 0, next = spacing / 2;  // along the lines
  for (std::size_t edge = 0; edge < edges; ++edge) {
    const double own = length(edge);
    for (; next < before + own && samples.places.size() < count; next += spacing) {
      samples.ends.insert(samples.ends.end(), {line_edges[2 * edge], line_edges[2 * edge + 1]});
      samples.places.push_back((next - before) / own);
    }
    before += own;
  }
  return samples;
}

Points positions(const LineSamples& samples, const Points& vertices) {
  Points places(3, static_cast<Eigen::Index>(samples.places.size()));
  for (std::size_t i = 0; i < samples.places.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) = (1 - samples.places[i]) * vertices.col(samples.ends[2 * i]) +
                                               samples.places[i] * vertices.col(samples.ends[2 * i + 1]);
  return places;
}

}  // namespace bespoke

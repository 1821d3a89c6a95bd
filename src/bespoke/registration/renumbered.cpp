#include "bespoke/registration/renumbered.h"

namespace bespoke {

RegistrationSummary renumbered(RegistrationSummary summary, const std::vector<int>& numbers) {
  const auto number = [&](int vertex) { return numbers[static_cast<std::size_t>(vertex)]; };
  if (std::optional<SurfaceFitSummary>& surface = summary.surface)
    for (std::vector<int>* vertices :
         {&surface->cavity_vertices, &surface->excluded_vertices, &surface->stretched_vertices})
      for (int& vertex : *vertices) vertex = number(vertex);
  if (summary.contact)
    for (ReleasedVertex& released : summary.contact->released) released.vertex = number(released.vertex);
  return summary;
}

ElasticSummary renumbered(ElasticSummary summary, const std::vector<int>& numbers) {
  for (UnmetVertex& unmet : summary.unmet) unmet.vertex = numbers[static_cast<std::size_t>(unmet.vertex)];
  return summary;
}

}  // namespace bespoke

#include "bespoke/report/fit_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/number_format.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/report/chain_determinant.h"

namespace bespoke {
namespace {

/// Vertices that are joined by edges between them.
struct VertexCluster {
  std::size_t count = 0;
  Vector3 center = Vector3::Zero();  ///< mean of the vertices, mesh units
};

/// Of the marked vertices, the largest first.
std::vector<VertexCluster> vertex_clusters(const TriangleMesh& mesh, const std::vector<char>& is_marked) {
  DisjointSets sets(static_cast<int>(is_marked.size()));
  for (const auto& face : mesh.faces.colwise())
    for (int corner = 0; corner < 3; ++corner) {
      const int a = face[corner], b = face[(corner + 1) % 3];
      if (is_marked[static_cast<std::size_t>(a)] && is_marked[static_cast<std::size_t>(b)]) sets.join(a, b);
    }
  std::map<int, VertexCluster> by_least;
  for (std::size_t i = 0; i < is_marked.size(); ++i) {
    if (!is_marked[i]) continue;
    VertexCluster& cluster = by_least[sets.least(static_cast<int>(i))];
    ++cluster.count;
    cluster.center += mesh.vertices.col(static_cast<Eigen::Index>(i));
  }
  std::vector<VertexCluster> clusters;
  for (auto& [least, cluster] : by_least) {
    cluster.center /= static_cast<double>(cluster.count);
    clusters.push_back(cluster);
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const VertexCluster& a, const VertexCluster& b) { return a.count > b.count; });
  return clusters;
}

/// Lengths with the name of their unit. What is below a millionth of the model is told as the power of ten
/// that is not: nobody measures 5e-15 cm.
class Lengths {
 public:
  Lengths(const std::string& unit, double diagonal)
      : unit_(unit.empty() || unit == "unknown" ? "mesh units" : unit),
        least_(std::pow(10, std::ceil(std::log10(1e-6 * diagonal)))) {}
  /// An upper bound.
  std::string operator()(double length) const {
    return format_number(std::max(length, least_), 3) + " " + unit_;
  }
  std::string operator()(const Vector3& place) const {
    return format_number(Vector3((place.array().abs() < least_).select(0, place)), 3);
  }

 private:
  std::string unit_;
  double least_;
};

std::string counted(std::size_t count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

std::string vertices_of(const TriangleMesh& mesh) {
  return " (" + std::to_string(mesh.vertices.cols()) + " vertices)";
}

/// Of the pairs given, those that were not left out.
std::vector<std::size_t> used_pairs(const AnchorAccuracy& accuracy, std::size_t count) {
  std::vector<char> is_used(count, 1);
  for (const SwappedAnchors& swapped : accuracy.swapped) is_used[swapped.first] = is_used[swapped.second] = 0;
  for (const RejectedAnchor& rejected : accuracy.left_out) is_used[rejected.index] = 0;
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < count; ++i)
    if (is_used[i]) used.push_back(i);
  return used;
}

std::string registration(const FitOutcome& outcome) {
  const Anchors& anchors = outcome.input.anchors;
  const FittedMapping& fit = *outcome.made.fit;
  std::string text = outcome.source + vertices_of(outcome.input.source) + " to " + outcome.target +
                     vertices_of(outcome.input.target);
  if (fit.summary.surface && fit.summary.surface->target_flipped)
    text += ", whose faces are flipped to match the source's";
  if (!outcome.fitted.empty()) return text + ", as given by " + outcome.fitted;
  if (anchors.pairs.empty() && anchors.curves.empty()) return text + ", by their surfaces, without anchors";
  const std::size_t used = used_pairs(fit.summary.accuracy, anchors.pairs.size()).size();
  text += ", by " + counted(used, "anchor");
  if (used < anchors.pairs.size()) text += " of " + std::to_string(anchors.pairs.size());
  if (!anchors.curves.empty()) text += ", " + counted(anchors.curves.size(), "curve");
  if (!anchors.patches.empty())
    text += ", " + (anchors.patches.size() == 1 ? std::string("1 patch")
                                                : std::to_string(anchors.patches.size()) + " patches");
  return text;
}

/// leading: vertices that the others follow, 0 for none.
std::string distances(const Statistics& found, std::size_t leading, const Lengths& lengths) {
  const std::string what = leading > 0 ? std::to_string(leading) + " vertices that the others follow lie"
                                       : "registered source lies";
  return "half of the " + what + " within " + lengths(found.median) + " of the target, 95 % within " +
         lengths(found.p95) + ", all within " + lengths(found.max);
}

std::string counterparts(const TriangleMesh& source, const std::vector<double>& confidence,
                         const Lengths& lengths) {
  std::vector<char> lacks(confidence.size());
  if (confidence.empty()) return "every vertex has one on the target";
  for (const int vertex : source.faces.reshaped()) {  // what is in no face has none to have
    const auto i = static_cast<std::size_t>(vertex);
    lacks[i] = !(confidence[i] > 0);
  }
  const std::vector<VertexCluster> clusters = vertex_clusters(source, lacks);
  if (clusters.empty()) return "every vertex has one on the target";
  const auto count = static_cast<std::size_t>(std::count(lacks.begin(), lacks.end(), 1));
  std::string text = std::to_string(count) + " of " + std::to_string(lacks.size()) +
                     " vertices have none and follow their surroundings";
  constexpr std::size_t max_named = 3;
  for (std::size_t i = 0; i < std::min(max_named, clusters.size()); ++i)
    text +=
        (i == 0 ? ": " : ", ") + std::to_string(clusters[i].count) + " around " + lengths(clusters[i].center);
  if (clusters.size() > max_named) text += " and at " + counted(clusters.size() - max_named, "other place");
  return text;
}

std::string anchor_text(const FitOutcome& outcome, const Lengths& lengths) {
  const FittedMapping& fit = *outcome.made.fit;
  const Anchors& anchors = outcome.input.anchors;
  const std::vector<std::size_t> used = used_pairs(fit.summary.accuracy, anchors.pairs.size());
  std::string text = "none is used";
  if (!used.empty()) {
    std::vector<double> residuals;
    for (const std::size_t index : used) residuals.push_back(fit.anchor_residual[index]);
    const Statistics found = summarize(residuals);
    text = "half are met within " + lengths(found.median) + ", all within " + lengths(found.max);
    const std::size_t worst = used[static_cast<std::size_t>(
        std::max_element(residuals.begin(), residuals.end()) - residuals.begin())];
    if (!anchors.pairs[worst].name.empty()) text += " (\"" + anchors.pairs[worst].name + "\")";
  }
  const std::string accuracy = to_string(fit.summary.accuracy, anchors);
  return text + (accuracy.empty() ? "" : "; " + accuracy);
}

std::string unproved(const Certificate& certificate) {
  std::string text = "the map is not one-to-one everywhere, or that could not be shown: ";
  text += counted(certificate.folded, "cell") + " fold";
  if (certificate.undecided > 0) text += ", " + std::to_string(certificate.undecided) + " are undecided";
  if (!(certificate.affine_determinant > 0)) text += ", the affine part turns space inside out";
  if (!certificate.places.empty())
    text += ", the first at " + format_number(certificate.places.front().center, 3);
  return text;
}

std::string bake_text(const FitOutcome& outcome, const Lengths& lengths) {
  const BakeSummary& bake = *outcome.made.fit->summary.bake;
  const std::string stored =
      bake.error.max > 0
          ? "the stored map is within " + lengths(bake.error.max) + " of the exact one; tolerance " +
                lengths(outcome.made.asset.record.tolerance) + (bake.tolerance_met ? "" : " MISSED")
          : std::string("the stored map is the fitted one") +
                (outcome.names_tolerance ? ", so that --tolerance changes nothing" : "");
  const Statistics& vertices = outcome.made.fit->summary.elastic.vertex_residuals;
  return stored + "; 99 % of the vertices are taken to their places within " + lengths(vertices.p99) +
         ", all within " + lengths(vertices.max);
}

std::string proved_text(const Asset& asset, const Certificate& certificate) {
  constexpr double notable = 0.01;  // of the affine part's determinant
  const bool is_chain = asset.steps.size() > 1;
  const double least = is_chain ? sampled_min_determinant(asset) : certificate.min_determinant;
  const double ratio = least / certificate.affine_determinant;
  const std::string text = "the map is one-to-one in all of space: it folds nowhere";
  if (ratio >= notable) return text;
  return text + "; where it is tightest volumes shrink " + (is_chain ? "about " : "") +
         std::to_string(std::llround(1 / ratio)) + " times";
}

std::string file_text(const FitOutcome& outcome) {
  constexpr double megabyte = 1e6;
  char size[40] = "", seconds[40];
  if (outcome.bytes)
    std::snprintf(size, sizeof size, ", %.1f MB", static_cast<double>(*outcome.bytes) / megabyte);
  std::snprintf(seconds, sizeof seconds, ", in %.1f s", outcome.seconds);
  return outcome.map + size + seconds;
}

}  // namespace

std::string fit_text(const FitOutcome& outcome) {
  std::string lines;
  const auto add = [&](std::string name, const std::string& text) {
    name.resize(13, ' ');
    lines += name + text + '\n';
  };
  const FitSummary& summary = outcome.made.fit->summary;
  const Lengths lengths(outcome.made.asset.record.unit, diagonal(outcome.input.source.vertices));
  const Certificate certificate = whole_certificate(outcome.made.asset);
  if (!certificate.is_bijection()) add("NOT PROVED", unproved(certificate));
  add("registered", registration(outcome));
  if (summary.surface) {
    add("surfaces", distances(summary.surface->after, summary.leading_vertices, lengths));
    add("counterparts", counterparts(outcome.input.source, outcome.made.fit->confidence, lengths));
  }
  if (summary.uncovered && summary.uncovered->is_notable()) add("uncovered", to_string(*summary.uncovered));
  if (!outcome.input.anchors.pairs.empty()) add("anchors", anchor_text(outcome, lengths));
  if (certificate.is_bijection()) add("proved", proved_text(outcome.made.asset, certificate));
  if (summary.bake) add("error", bake_text(outcome, lengths));
  add("written", file_text(outcome));
  add("next", outcome.next);
  return lines;
}

}  // namespace bespoke

// The paper's Table I beside the same examples here: the printed figures, our samples with the paper's
// numbers of nodes, and our samples as they are. Seconds are the least of three runs.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/bake/bake.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/map_request.h"
#include "bespoke/stopwatch.h"
#include "resampled.h"
#include "samples.h"

namespace bespoke {
namespace {

constexpr int runs = 3;

/// A row as printed: AMD Athlon XP-M 2400+, 1.6 GHz, 512 MB.
struct PrintedRow {
  const char* example;
  const char* figures;
  const char* sample;
  const char* target;  ///< of the sample; empty where it has one
  Eigen::Index source_nodes, source_faces;
  Eigen::Index target_nodes, target_faces;
  Eigen::Index product_nodes, product_faces;
  std::optional<double> lambda;         ///< of CSRBF; the paper names no unit, here centimetres
  std::optional<double> csrbf_seconds;  ///< E
  double fitting_seconds;               ///< F
  std::optional<double> pffd_seconds;
};

const std::vector<PrintedRow> printed_rows = {
    {"I", "3, 6a", "dress", "", 2000, 3936, 11072, 11040, 1900, 3643, 10, 17.0, 22.0, 0.3},
    {"II", "6b", "girths", "100", 1960, 3916, 2232, 4460, 1986, 3771, 10, 19.0, 7.8, 0.2},
    {"II", "7", "girths", "112", 1960, 3913, 11520, 11488, 1986, 3771, 10, 19.0, 24.3, {}},
    {"III", "8", "glasses", "", 1399, 2794, 6093, 12182, 608, 1224, 5, 8.5, 22.7, {}},
    {"IV", "9", "glove", "", 1982, 3960, 2169, 4334, 1457, 2780, 8, 6.1, 8.0, {}},
    {"V", "10", "shoe", "", 7026, 14044, 1610, 3216, 2171, 3636, {}, {}, 14.3, 1.3},
};

/// What one row works on.
struct Models {
  TriangleMesh source;
  TriangleMesh target;
  Anchors anchors;
  Points product;
};

Models models_of(const PrintedRow& row) {
  const Sample sample = make_sample(row.sample);
  const auto target = std::find_if(sample.targets.begin(), sample.targets.end(),
                                   [&](const SampleTarget& each) { return each.name == row.target; });
  Models models{sample.source, target->mesh, {"cm", target->anchors}, Points(3, 0)};
  for (const SampleProduct& product : sample.products) {
    const Eigen::Index before = models.product.cols();
    models.product.conservativeResize(3, before + product.mesh.vertices.cols());
    models.product.rightCols(product.mesh.vertices.cols()) = product.mesh.vertices;
  }
  return models;
}

/// `count` columns, spread evenly.
Points some_of(const Points& points, Eigen::Index count) {
  Points some(3, count);
  for (Eigen::Index i = 0; i < count; ++i) some.col(i) = points.col(i * points.cols() / count);
  return some;
}

Models with_printed_nodes(const Models& models, const PrintedRow& row) {
  return {resampled(models.source, row.source_nodes), resampled(models.target, row.target_nodes),
          models.anchors, some_of(models.product, row.product_nodes)};
}

struct Seconds {
  double fitting = std::numeric_limits<double>::infinity();
  double elastic = std::numeric_limits<double>::infinity();
  double bake = std::numeric_limits<double>::infinity();
  double apply = std::numeric_limits<double>::infinity();  ///< look-up of the product in the baked map
  double exact = std::numeric_limits<double>::infinity();  ///< the product through the exact map
};

enum class Baking { none, baked };

Seconds measure(const Models& models, const MakeMapOptions& options, Baking baking) {
  Seconds least;
  for (int run = 0; run < runs; ++run) {
    const FittedMapping fit = fit_mapping({models.source, models.target, models.anchors}, options.fit);
    least.fitting = std::min(least.fitting, fit.summary.surface->seconds);
    least.elastic = std::min(least.elastic, fit.summary.elastic.seconds);
    const Stopwatch exact;
    apply_mapping(*fit.elastic, fit.target_from_source, models.product, {1.0});
    least.exact = std::min(least.exact, exact.seconds());
    if (baking == Baking::none) continue;
    const Bake baked = bake(*fit.elastic, options.bake);
    least.bake = std::min(least.bake, baked.summary.seconds);
    const BakedMap map(fit.elastic->affine(), baked.pyramid);
    const AppliedPoints applied = apply_mapping(map, fit.target_from_source, models.product, {1.0});
    least.apply = std::min(least.apply, applied.summary.seconds);
  }
  return least;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 0.095 ? "%.3f" : "%.2f", value);
  return text;
}

std::string number(std::optional<double> value) { return value ? number(*value) : "-"; }

std::string nodes(Eigen::Index vertices, Eigen::Index faces) {
  return std::to_string(vertices) + "/" + std::to_string(faces);
}

void print_row(const std::string& example, const std::string& what, const std::string& models,
               const std::string& seconds) {
  std::printf("%-12s %-30s %-38s %s\n", example.c_str(), what.c_str(), models.c_str(), seconds.c_str());
  std::fflush(stdout);
}

std::string columns(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells)
    line += std::string(cell.size() < 9 ? 9 - cell.size() : 1, ' ') + cell;
  return line;
}

std::string sizes(const Models& models) {
  return nodes(models.source.vertices.cols(), models.source.faces.cols()) + "  " +
         nodes(models.target.vertices.cols(), models.target.faces.cols()) + "  " +
         std::to_string(models.product.cols());
}

/// The printed method at the printed λ; where that is refused the reason takes the place of the figures.
void print_paper_way(Models models, const PrintedRow& row) {
  MapRequest request;
  request.paper = true;
  const double source_diagonal = diagonal(models.source.vertices);
  estimate_anchor_sigmas(models.anchors, request, source_diagonal);
  MakeMapOptions options = make_options(request, source_diagonal);
  if (row.lambda) options.fit.lambda = *row.lambda;
  std::string seconds;
  std::string what = "--paper, lambda " + number(options.fit.lambda) + " cm";
  MakeMapOptions pffd = options;
  pffd.fit.elastic = ElasticMethod::pffd;
  const Seconds by_faces = measure(models, pffd, Baking::none);
  std::string refusal;
  try {
    const Seconds ours = measure(models, options, Baking::baked);
    seconds = columns({number(ours.fitting), number(ours.elastic), number(by_faces.elastic + by_faces.exact),
                       number(ours.bake), number(1e3 * ours.apply)});
  } catch (const Error& error) {
    seconds =
        columns({number(by_faces.fitting), "refused", number(by_faces.elastic + by_faces.exact), "-", "-"});
    refusal = error.what();
  }
  print_row("", what, sizes(models), seconds);
  if (!refusal.empty()) std::printf("%-12s   %s\n", "", refusal.c_str());
}

void print_default(const Models& models) {
  const Seconds ours = measure(models, default_options(diagonal(models.source.vertices)), Baking::baked);
  print_row("", "default", sizes(models),
            columns({number(ours.fitting), number(ours.elastic), "-", number(ours.bake),
                     number(1e3 * ours.apply)}));
}

void print_example(const PrintedRow& row) {
  print_row(
      std::string(row.example) + ", Fig. " + row.figures,
      row.lambda ? "paper, CSRBF lambda " + number(*row.lambda) : std::string("paper, p-FFD"),
      nodes(row.source_nodes, row.source_faces) + "  " + nodes(row.target_nodes, row.target_faces) + "  " +
          nodes(row.product_nodes, row.product_faces),
      columns({number(row.fitting_seconds), number(row.csrbf_seconds), number(row.pffd_seconds), "-", "-"}));
  const Models models = models_of(row);
  const Models like = with_printed_nodes(models, row);
  print_paper_way(like, row);
  print_default(like);
  print_paper_way(models, row);
  print_default(models);
}

}  // namespace
}  // namespace bespoke

int main() try {
  using namespace bespoke;
  std::printf(
      "Table I. The paper's machine: AMD Athlon XP-M 2400+, 1.6 GHz, 512 MB; this one: %u threads.\n"
      "F: surface fitting; E: elastic map; p-FFD: E and the product by p-FFD; bake: into nested "
      "lattices.\n\n",
      std::thread::hardware_concurrency());
  print_row("example", "method", "source  target  product (nodes/faces)",
            columns({"F s", "E s", "p-FFD s", "bake s", "apply ms"}));
  for (const PrintedRow& row : printed_rows) print_example(row);
} catch (const bespoke::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

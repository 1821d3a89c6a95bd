#include "bespoke/pipeline/fit_mapping.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <variant>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/product/mesh_io.h"
#include "support/bent_tube.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

/// A smooth change of shape of what lies near the unit ball.
Points bent(const Points& x) {
  Points result = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    result(0, i) *= 1 + 0.15 * x(2, i);
    result(1, i) += 0.1 * x(0, i) * x(0, i);
    result(2, i) *= 1.2;
  }
  return result;
}

const RigidTransform moved_away{test::random_rotation(3), Vector3(5, -2, 1)};

/// A sphere and a bent one of other connectivity, at another place.
struct Pair {
  TriangleMesh source = shapes::icosphere(3);
  TriangleMesh target = shapes::icosphere(4);
  Anchors anchors;
  FitOptions options;

  Pair() {
    const Points sphere = test::random_rotation(9) * target.vertices;
    target.vertices = moved_away * bent(sphere);
    const Points q = shapes::icosphere(0).vertices;
    const Points image = moved_away * bent(q);
    const ClosestPointTree on_target(target);
    for (Eigen::Index i = 0; i < q.cols(); ++i)
      anchors.pairs.push_back(
          {"anchor " + std::to_string(i), q.col(i), on_target.closest(image.col(i))->point});
    options.lambda = 0.4;
    options.elastic = ElasticMethod::csrbf;
  }

  FittedMapping fit() const { return fit_mapping({source, target, anchors}, options); }

  std::string message() const {
    try {
      fit();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  }
};

double distance_from(const TriangleMesh& mesh, const Points& x) {
  const ClosestPointTree tree(mesh);
  double largest = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    largest = std::max(largest, std::sqrt(tree.closest(x.col(i))->squared_distance));
  return largest;
}

TEST(FitMapping, CarriesTheSourceOntoTheTarget) {
  for (const ElasticMethod method : {ElasticMethod::csrbf, ElasticMethod::pffd_smooth}) {
    Pair pair;
    pair.options.elastic = method;
    const FittedMapping fit = pair.fit();
    const Points image = fit.target_from_source * (*fit.elastic)(pair.source.vertices);
    EXPECT_LT(distance_from(pair.target, image), 1e-7);
    EXPECT_LT(fit.summary.elastic.vertex_residuals.max, 1e-7);
    EXPECT_EQ(fit.anchor_residual.size(), pair.anchors.pairs.size());
    EXPECT_LT(fit.summary.elastic.anchor_residuals.max, 1e-7);
    EXPECT_LT((fit.target_from_source * fit.fitted_vertices - image).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(FitMapping, MeetsTheFitToleranceByTheMultiscaleMaps) {
  for (const ElasticMethod method : {ElasticMethod::multiscale, ElasticMethod::diffeomorphic}) {
    Pair pair;
    pair.options.elastic = method;
    pair.options.fit_tolerance = 1e-3;
    const FittedMapping fit = pair.fit();
    EXPECT_LT(fit.summary.elastic.vertex_residuals.p95, 1e-3);
    const auto& found = std::get<MultiscaleSummary>(fit.summary.elastic.found);
    EXPECT_EQ(fit.summary.elastic.method, method);
    EXPECT_EQ(found.gradient_bounds.empty(), method == ElasticMethod::multiscale);
    EXPECT_GE(double(found.within_tolerance), 0.95 * 642);
  }
}

TEST(FitMapping, RecoversARigidMotionExactly) {
  Pair pair;
  pair.target = pair.source;
  pair.target.vertices = moved_away * pair.source.vertices;
  for (AnchorPair& anchor : pair.anchors.pairs) anchor.b = moved_away * anchor.a;
  const FittedMapping fit = pair.fit();
  EXPECT_LT((fit.target_from_source.rotation - moved_away.rotation).norm(), 1e-12);
  const Points x = 3 * test::random_points(100, 1);
  EXPECT_LT(((*fit.elastic)(x)-x).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(FitMapping, FitsAsIfSwappedAnchorsWereNotThere) {
  Pair without, swapped;
  without.anchors.pairs.erase(without.anchors.pairs.begin() + 7);
  without.anchors.pairs.erase(without.anchors.pairs.begin() + 2);
  std::swap(swapped.anchors.pairs[2].b, swapped.anchors.pairs[7].b);
  const FittedMapping fit = swapped.fit();
  EXPECT_EQ(fit.fitted_vertices, without.fit().fitted_vertices);
  ASSERT_EQ(fit.summary.accuracy.swapped.size(), 1u);
  EXPECT_EQ(fit.anchor_residual.size(), swapped.anchors.pairs.size());
  EXPECT_GT(fit.anchor_residual[2], 0.5);
  EXPECT_THAT(stage_lines(fit.summary, swapped.anchors).front().line,
              HasSubstr("\"anchor 2\" and \"anchor 7\" look swapped"));
}

TEST(FitMapping, FitsWithoutAnOutlierUnlessItsSigmaIsGiven) {
  Pair without, outlier;
  without.anchors.pairs.erase(without.anchors.pairs.begin() + 4);
  AnchorPair& wrong = outlier.anchors.pairs[4];
  wrong.b = ClosestPointTree(outlier.target)
                .closest(wrong.b + 0.7 * (outlier.anchors.pairs[9].b - wrong.b).normalized())
                ->point;
  const FittedMapping fit = outlier.fit();
  EXPECT_EQ(fit.fitted_vertices, without.fit().fitted_vertices);
  ASSERT_EQ(fit.summary.accuracy.left_out.size(), 1u);
  EXPECT_EQ(fit.summary.accuracy.left_out[0].index, 4u);
  EXPECT_NEAR(fit.anchor_residual[4], fit.summary.accuracy.left_out[0].distance, 0.05);
  EXPECT_THAT(stage_lines(fit.summary, outlier.anchors).front().line, HasSubstr("\"anchor 4\" lies"));
  wrong.sigma = 0;
  EXPECT_LT(outlier.fit().anchor_residual[4], 1e-3 * fit.anchor_residual[4]);
}

/// A tube onto the same tube bent at its elbow, with pairs along three of its lines.
struct BentTube {
  TriangleMesh source = shapes::tube();
  TriangleMesh target = source;
  Anchors anchors;

  BentTube() {
    for (auto vertex : target.vertices.colwise()) vertex = shapes::bent(vertex, 60);
    for (int ring = 0; ring <= 80; ring += 16)
      for (int side = 0; side < shapes::tube_sides; side += 4) {
        const int vertex = ring * shapes::tube_sides + side;
        anchors.pairs.push_back({"ring " + std::to_string(ring) + " side " + std::to_string(side),
                                 source.vertices.col(vertex), target.vertices.col(vertex)});
      }
  }

  Registration registered() const {
    FitOptions options;
    options.lambda = 0.5;
    return fit_source_surface({source, target, anchors}, options);
  }
};

TEST(FitMapping, RejectsAnOutlierThatABendHidesFromTheOthers) {
  BentTube tube;
  constexpr int outlier = 12;  // ring 64, side 0
  tube.anchors.pairs[outlier].b = tube.target.vertices.col(73 * shapes::tube_sides + 3);
  EXPECT_TRUE(audit_anchors(tube.anchors).suspicious.empty());
  const Registration fit = tube.registered();
  ASSERT_EQ(fit.summary.accuracy.left_out.size(), 1u);
  EXPECT_EQ(fit.summary.accuracy.left_out[0].index, std::size_t{outlier});
}

TEST(FitMapping, StepsTakeALooseSleeveAlongWithItsArm) {
  const BentTube tube;
  const auto lag = [&](GuidedMaps guides, int steps) {
    FitOptions options;
    options.lambda = 0.5;
    options.fit_tolerance = 1e-3;
    options.steps = steps;
    options.guides = guides;
    const FittedMapping fit = fit_mapping({tube.source, tube.target, tube.anchors}, options);
    double largest = 0;
    for (int k = 0; k < 12; ++k) {
      const Vector3 sleeve(3, 0.35 * std::cos(k / 2.0), 0.35 * std::sin(k / 2.0));
      const Points image = fit.target_from_source * (*fit.elastic)(Points(sleeve));
      largest = std::max(largest, (Vector3(image) - shapes::bent(sleeve, 60)).norm());
    }
    return largest;
  };
  EXPECT_LT(lag(GuidedMaps::steps, 2), 0.5 * lag(GuidedMaps::none, 2));
  EXPECT_EQ(lag(GuidedMaps::steps, 1), lag(GuidedMaps::none, 1));
  EXPECT_LT(lag(GuidedMaps::all, 1), 0.5 * lag(GuidedMaps::none, 1));
}

TEST(FitMapping, SaysWhatEveryStageFound) {
  const Pair pair;
  const FitSummary summary = pair.fit().summary;
  EXPECT_FALSE(summary.rigid.by_vertices);
  EXPECT_EQ(summary.rigid.residuals.count, pair.anchors.pairs.size());
  EXPECT_NEAR(summary.rigid.rotation, rotation_angle(moved_away), 0.2);
  ASSERT_TRUE(summary.coarse);
  EXPECT_LT(summary.coarse->residuals.max, 1e-9);
  ASSERT_TRUE(summary.surface);
  EXPECT_GT(summary.surface->iterations, 0);
  EXPECT_EQ(summary.surface->after.count, 642u);
  EXPECT_EQ(summary.elastic.method, ElasticMethod::csrbf);
  EXPECT_EQ(std::get<CsrbfSummary>(summary.elastic.found).estimate.centers, 642u);
  EXPECT_FALSE(summary.bake);
}

TEST(FitMapping, LeavesOutLooseAndMergesDuplicateVertices) {
  Pair pair;
  const Eigen::Index count = pair.source.vertices.cols();
  // The first face gets three vertices of its own, where the shared ones lie; one vertex belongs to nothing.
  pair.source.vertices.conservativeResize(3, count + 4);
  for (int corner = 0; corner < 3; ++corner) {
    pair.source.vertices.col(count + corner) = pair.source.vertices.col(pair.source.faces(corner, 0));
    pair.source.faces(corner, 0) = static_cast<int>(count) + corner;
  }
  pair.source.vertices.rightCols(1) = Vector3(0.1, 0.2, 0.3);
  const FittedMapping fit = pair.fit();
  EXPECT_EQ(fit.summary.elastic.unreferenced_vertices, 1u);
  EXPECT_EQ(fit.summary.elastic.duplicate_vertices, 3u);
  EXPECT_TRUE((*fit.elastic)(pair.source.vertices).allFinite());
}

/// The mesh with half of its faces cut off along a seam; `of_vertex` says whose place a vertex has.
TriangleMesh with_seam(const TriangleMesh& mesh, std::vector<int>& of_vertex) {
  TriangleMesh cut = mesh;
  of_vertex.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(of_vertex.begin(), of_vertex.end(), 0);
  const Eigen::Index half = mesh.faces.cols() / 2;
  const std::set<int> others(mesh.faces.leftCols(half).reshaped().begin(),
                             mesh.faces.leftCols(half).reshaped().end());
  std::map<int, int> copies;
  for (int& vertex : cut.faces.rightCols(half).reshaped()) {
    if (others.count(vertex) == 0) continue;
    const auto [copy, is_new] = copies.try_emplace(vertex, static_cast<int>(of_vertex.size()));
    if (is_new) of_vertex.push_back(vertex);
    vertex = copy->second;
  }
  cut.vertices = mesh.vertices(Eigen::all, of_vertex);
  return cut;
}

TEST(FitMapping, DoesNotSeeSeams) {
  Pair whole, cut;
  whole.options.elastic = cut.options.elastic = ElasticMethod::diffeomorphic;
  whole.options.fit_tolerance = cut.options.fit_tolerance = 1e-3;
  std::vector<int> of_source, of_target;
  cut.source = with_seam(whole.source, of_source);
  cut.target = with_seam(whole.target, of_target);
  const FittedMapping expected = whole.fit(), fit = cut.fit();
  EXPECT_TRUE(fit.fitted_vertices == expected.fitted_vertices(Eigen::all, of_source));
  const Points x = whole.source.vertices * 1.1;
  EXPECT_LT(((*fit.elastic)(x) - (*expected.elastic)(x)).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(fit.summary.seams.source, of_source.size() - 642);
  EXPECT_EQ(fit.summary.seams.target, of_target.size() - 2562);
  EXPECT_EQ(stage_lines(fit.summary, cut.anchors).front().name, "seams");
  EXPECT_FALSE(has_any(expected.summary.seams));
  cut.options.surface_fit.repair_models = false;
  EXPECT_FALSE(has_any(cut.fit().summary.seams));
}

TEST(FitMapping, NamesWhatTheAnchorsLack) {
  Pair pair;
  const std::vector<AnchorPair> all = pair.anchors.pairs;
  pair.anchors.pairs = {all[0], all[1]};
  EXPECT_THAT(pair.message(), HasSubstr("3"));
  pair.anchors.pairs = {all[0], all[1], all[2]};
  EXPECT_THAT(pair.message(), HasSubstr("4"));
}

TEST(FitMapping, BeginsNearASimilarityWhereAnchorsLieInOnePlane) {
  Pair pair;
  std::vector<AnchorPair>& pairs = pair.anchors.pairs;
  pairs.resize(3);
  pairs.push_back({"in their plane", (pairs[0].a + pairs[1].a) / 2, (pairs[0].b + pairs[1].b) / 2});
  const FittedMapping fit = pair.fit();
  EXPECT_TRUE(fit.summary.coarse->regularised);
  EXPECT_LT(fit.summary.surface->after.median, 1e-3 * diagonal(pair.target.vertices));
}

TEST(FitMapping, MatchesExactAnchorsWhereFacesWereRepairedToo) {
  const std::filesystem::path pair = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases" / "d04_hand_glove";
  if (!std::filesystem::is_directory(pair)) GTEST_SKIP() << "no shared cases here";
  const TriangleMesh source = read_triangle_mesh(pair / "reference_a.obj");
  FitOptions options;
  options.lambda = 0.1 * diagonal(source.vertices);
  options.fit_tolerance = 1e-4 * diagonal(source.vertices);
  options.elastic = ElasticMethod::diffeomorphic;  // meets every vertex, so that anchors tell of the surface
  const FittedMapping fit = fit_mapping(
      {source, read_triangle_mesh(pair / "reference_b.obj"), read_anchors(pair / "anchors.json")}, options);
  ASSERT_GT(fit.summary.surface.value().repaired_vertices, 0u);
  EXPECT_LE(fit.summary.elastic.anchor_residuals.max, options.fit_tolerance);
}

TEST(FitMapping, RejectsOptionsAndAnchorsOutOfRange) {
  Pair pair;
  for (const double lambda : {0.0, -1.0, std::nan("")}) {
    pair.options.lambda = lambda;
    EXPECT_THAT(pair.message(), HasSubstr("lambda"));
  }
  pair.options.lambda = 0.4;
  pair.anchors.pairs[2].a.x() = std::nan("");
  EXPECT_THAT(pair.message(), HasSubstr("anchor 2"));
  pair.anchors.pairs[2].a.x() = 0;
  pair.source.faces.resize(3, 0);
  EXPECT_THAT(pair.message(), HasSubstr("source"));
}

TEST(FitMapping, StopsWhenAsked) {
  const Pair pair;
  Progress progress;
  int calls = 0;
  progress.cancelled = [&] { return ++calls > 4; };
  EXPECT_THROW(fit_mapping({pair.source, pair.target, pair.anchors}, pair.options, progress), Interrupted);
}

TEST(FitMapping, RefusesModelsInTwoUnits) {
  for (const double unit : {0.01, 0.1, 10.0, 25.4, 1000.0}) {
    Pair pair;
    TriangleMesh fitted = pair.source;
    fitted.vertices *= unit;
    pair.target.vertices *= unit;
    for (AnchorPair& anchor : pair.anchors.pairs) anchor.b *= unit;
    const auto names_the_factor = testing::ThrowsMessage<InvalidInput>(testing::HasSubstr("two units"));
    const Anchors none;
    EXPECT_THAT(
        [&] {
          fit_mapping({pair.source, pair.target, pair.anchors}, pair.options);
        },
        names_the_factor);
    EXPECT_THAT([&] { fit_mapping({pair.source, pair.target, none}, pair.options); }, names_the_factor);
    EXPECT_THAT([&] { fit_mapping({pair.source, fitted, none, &fitted}, pair.options); }, names_the_factor);
  }
}

// A file whose axes are in another order fits nothing, but every anchor has some accuracy.
TEST(FitMapping, RefusesAnchorsOffTheTargetWithoutAGivenSigma) {
  Pair pair;
  for (AnchorPair& anchor : pair.anchors.pairs) std::swap(anchor.b.x(), anchor.b.z());
  EXPECT_THAT(pair.message(), HasSubstr("as points at random would"));
  for (AnchorPair& anchor : pair.anchors.pairs) anchor.sigma = 1;
  EXPECT_EQ(pair.message(), "accepted");
}

TEST(FitMapping, FitsAsIfAnAnchorFarAstrayWereNotThere) {
  Pair without, astray;
  without.anchors.pairs.erase(without.anchors.pairs.begin() + 4);
  astray.anchors.pairs[4].b += Vector3(0, 1000, 0);
  const FittedMapping fit = astray.fit();
  const double off = (fit.fitted_vertices - without.fit().fitted_vertices).cwiseAbs().maxCoeff();
  EXPECT_LT(off, 1e-3 * diagonal(without.source.vertices));  // the least σ that is estimated
  EXPECT_THAT(stage_lines(fit.summary, astray.anchors).front().line, HasSubstr("\"anchor 4\" lies"));
}

TEST(FitMappingToFitted, TakesTheFittedMeshAsItIs) {
  Pair pair;
  TriangleMesh fitted = pair.source;
  fitted.vertices = moved_away * bent(pair.source.vertices);
  for (const bool with_anchors : {true, false}) {
    const FittedMapping fit =
        fit_mapping({pair.source, fitted, with_anchors ? pair.anchors : Anchors{}, &fitted}, pair.options);
    const Points image = fit.target_from_source * (*fit.elastic)(pair.source.vertices);
    EXPECT_LT((image - fitted.vertices).cwiseAbs().maxCoeff(), 1e-7);
    EXPECT_EQ(fit.anchor_residual.size(), with_anchors ? pair.anchors.pairs.size() : 0);
    EXPECT_EQ(fit.summary.rigid.by_vertices, !with_anchors);
    EXPECT_FALSE(fit.summary.coarse);
    EXPECT_FALSE(fit.summary.surface);
  }
}

TEST(FitMappingToFitted, RejectsOtherConnectivity) {
  Pair pair;
  EXPECT_THROW(fit_mapping({pair.source, pair.target, pair.anchors, &pair.target}, pair.options),
               InvalidInput);
  TriangleMesh fitted = pair.source;
  fitted.faces.col(5).reverseInPlace();
  EXPECT_THROW(fit_mapping({pair.source, fitted, pair.anchors, &fitted}, pair.options), InvalidInput);
}

}  // namespace
}  // namespace bespoke

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <span>
#include <string>
#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/elastic/exact_map_io.h"
#include "bespoke/error.h"
#include "bespoke/instruction_set.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/mapping.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/statistics.h"
#include "pipeline/body_pair.h"
#include "samples.h"

namespace bespoke {
namespace {

using test::body_pair;
using test::BodyPair;
using test::distances_from;

/// All that are continuous: the printed p-FFD is tested by itself.
constexpr ElasticMethod all_methods[] = {ElasticMethod::csrbf, ElasticMethod::multiscale,
                                         ElasticMethod::diffeomorphic, ElasticMethod::pffd_smooth};

FitOptions fit_options(ElasticMethod method) {
  FitOptions options;
  options.elastic = method;
  options.lambda = 0.6;
  options.fit_tolerance = 1e-3;
  return options;
}

FittedMapping fit(const BodyPair& pair, ElasticMethod method) {
  return fit_mapping({pair.source, pair.target, pair.anchors}, fit_options(method));
}

/// One for each method; the surface is fitted once.
std::vector<FittedMapping> fit_by_all_methods(const BodyPair& pair) {
  std::vector<FittedMapping> all{fit(pair, all_methods[0])};
  const TriangleMesh fitted{all[0].target_from_source * all[0].fitted_vertices, pair.source.faces};
  for (const ElasticMethod method : std::span(all_methods).subspan(1))
    all.push_back(fit_mapping({pair.source, fitted, pair.anchors, &fitted}, fit_options(method)));
  return all;
}

Points psi(const FittedMapping& mapping, const Points& x, double t = 1) {
  return move_points(x, (*mapping.elastic)(x), mapping.target_from_source, t);
}

TEST(FitAndBake, BakedMapCarriesTheSourceOntoTheTarget) {
  const BodyPair pair = body_pair();
  for (const FittedMapping& mapping : fit_by_all_methods(pair)) {
    BakeOptions options;
    options.tolerance = 5e-3;
    options.error_points = 20'000;
    const Bake baked = bake(*mapping.elastic, options);
    EXPECT_TRUE(baked.summary.tolerance_met) << to_string(baked.summary);
    const BakedMap map(mapping.elastic->affine(), baked.pyramid);
    const Points image =
        move_points(pair.source.vertices, map(pair.source.vertices), mapping.target_from_source, 1);
    const Statistics off = summarize(distances_from(pair.target, image));
    EXPECT_LT(off.p95, options.tolerance + 1e-3);
    EXPECT_LT(off.max, options.tolerance + mapping.summary.elastic.vertex_residuals.max + 1e-6);
  }
}

TEST(FitAndBake, MotionBeginsAtTheSourceAndIsAffineFarAway) {
  const BodyPair pair = body_pair();
  const Points far_away = 20 * test::random_points(50, 2).colwise().normalized();
  for (const FittedMapping& mapping : fit_by_all_methods(pair)) {
    EXPECT_EQ(psi(mapping, pair.source.vertices, 0), pair.source.vertices);
    EXPECT_EQ((*mapping.elastic)(far_away), mapping.elastic->affine() * far_away);
  }
}

TEST(FitAndBake, SameBytesAtAnyNumberOfThreadsWithAnyInstructionSet) {
  const BodyPair pair = body_pair();
  const std::vector<InstructionSet> sets = supported_instruction_sets();
  std::size_t next_set = 0;
  std::string first;
  for (const std::size_t threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    use_instruction_set(sets[next_set++ % sets.size()]);
    std::string bytes;
    for (const FittedMapping& mapping : fit_by_all_methods(pair)) {
      bytes += serialize_exact_map(*mapping.elastic);
      for (const StageJson& stage : stages_json(mapping.summary, pair.anchors)) bytes += stage.json.dump();
    }
    if (first.empty()) first = bytes;
    EXPECT_TRUE(bytes == first) << threads << " threads, instruction set " << int(instruction_set());
  }
  use_instruction_set(sets.back());
}

TEST(FitAndBake, GivenFittedSourceNeedsNoTarget) {
  const BodyPair pair = body_pair();
  const TriangleMesh fitted{psi(fit(pair, ElasticMethod::csrbf), pair.source.vertices), pair.source.faces};
  for (const ElasticMethod method : all_methods) {
    const FittedMapping mapping =
        fit_mapping({pair.source, fitted, pair.anchors, &fitted}, fit_options(method));
    const Points image = psi(mapping, pair.source.vertices);
    EXPECT_NEAR((image - fitted.vertices).colwise().norm().maxCoeff(),
                mapping.summary.elastic.vertex_residuals.max, 1e-9);
  }
}

/// The generated pairs, as `bespoke fit` takes them.
class FitSample : public ::testing::TestWithParam<const char*> {};

TEST_P(FitSample, IsACertifiedBijectionWithinTheTolerance) {
  const Sample sample = make_sample(GetParam());
  for (const SampleTarget& target : sample.targets) {
    Anchors anchors;
    anchors.pairs = target.anchors;
    const MadeMap map =
        make_map({sample.source, target.mesh, anchors}, default_options(diagonal(sample.source.vertices)));
    EXPECT_TRUE(map.fit->summary.bake->tolerance_met) << to_string(*map.fit->summary.bake);
    for (const MapStep& step : map.asset.steps) EXPECT_TRUE(step.certificate.is_bijection());
  }
}

INSTANTIATE_TEST_SUITE_P(All, FitSample, ::testing::Values("dress", "glasses", "glove", "shoe"));

// ---- what scans bring with them

/// Most of the source must still arrive, and nothing may become infinite.
void expect_fits(const BodyPair& pair, const char* what) {
  for (const FittedMapping& mapping : fit_by_all_methods(pair)) {
    const Points image = psi(mapping, pair.source.vertices);
    ASSERT_TRUE(image.allFinite()) << what;
    EXPECT_LT(summarize(distances_from(pair.target, image)).median, 2e-3) << what;
  }
}

TEST(FitRealInput, OpenSourceAndTargetThatEndsEarlier) {
  BodyPair pair = body_pair();
  pair.source = test::cut(pair.source, [](const Vector3& centre) { return centre.z() < 1.5; });
  expect_fits(pair, "open source");
  const Vector3 top = pair.anchors.pairs[0].b;
  pair.target = test::cut(pair.target, [&](const Vector3& centre) { return (centre - top).norm() > 0.4; });
  expect_fits(pair, "open target");
}

TEST(FitRealInput, SeveralPiecesAndLooseAndDuplicateVertices) {
  BodyPair pair = body_pair();
  pair.source = shapes::joined(pair.source, pair.source);  // every vertex twice, in two pieces
  pair.source.vertices.conservativeResize(3, pair.source.vertices.cols() + 1);
  pair.source.vertices.rightCols(1) = Vector3(0.1, 0.2, 0.3);  // in no face
  expect_fits(pair, "doubled source");
  pair.target = shapes::joined(pair.target, pair.target);
  expect_fits(pair, "doubled target");
}

TEST(FitRealInput, NonManifoldEdgesAndFacesWithoutArea) {
  BodyPair pair = body_pair();
  for (TriangleMesh* mesh : {&pair.source, &pair.target}) {
    const Eigen::Index vertex = mesh->vertices.cols(), face = mesh->faces.cols();
    mesh->vertices.conservativeResize(3, vertex + 1);
    mesh->vertices.col(vertex) = 1.02 * mesh->vertices.col(mesh->faces(0, 0));
    mesh->faces.conservativeResize(3, face + 2);
    mesh->faces.col(face) << mesh->faces(0, 0), mesh->faces(1, 0), static_cast<int>(vertex);  // a fin
    mesh->faces.col(face + 1) << mesh->faces(0, 3), mesh->faces(0, 3), mesh->faces(1, 3);
  }
  expect_fits(pair, "non-manifold");
}

TEST(FitRealInput, SingleTriangleIsMapped) {
  BodyPair pair = body_pair();
  pair.source = shapes::triangle();
  // Three coplanar centres leave the affine part of the radial methods open; the anchors beside the triangle
  // determine it, and so do the faces' frames.
  EXPECT_TRUE(psi(fit(pair, ElasticMethod::csrbf), pair.source.vertices).allFinite());
  EXPECT_TRUE(psi(fit(pair, ElasticMethod::pffd_smooth), pair.source.vertices).allFinite());
}

}  // namespace
}  // namespace bespoke

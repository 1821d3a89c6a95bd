#include "bespoke/page/detail/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

std::vector<Place> of_kind(const std::vector<Place>& places, const std::string& kind) {
  std::vector<Place> found;
  std::copy_if(places.begin(), places.end(), std::back_inserter(found),
               [&](const Place& place) { return place.kind == kind; });
  return found;
}

TEST(PlacesToSee, ListTheWorstFoldFirst) {
  Asset asset;
  asset.steps.front().certificate.places = {{0, {0.1, 0, 0}, -0.1}, {0, {0.2, 0, 0}, -0.5}};
  const std::vector<Place> folds = of_kind(places_to_see(asset, shapes::icosphere(2), {}), "folded cells");
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_EQ(folds[0].at, Vector3(0.2, 0, 0));
  EXPECT_THAT(folds[0].text, HasSubstr("det -0.5"));
}

TEST(PlacesToSee, ReadRegionsAndVerticesOutOfTheRecord) {
  Asset asset;
  asset.record.stages_json =
      R"([{"name":"surface-fit","cavity_vertices":[3],"stretched_vertices":[]},)"
      R"({"name":"bake","relaxed":[{"box":{"min":[0,0,0],"max":[1,2,3]},"error":0.25}]}])";
  const TriangleMesh sphere = shapes::icosphere(2);
  const std::vector<Place> places = places_to_see(asset, sphere, {});
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].at, sphere.vertices.col(3));
  EXPECT_EQ(places[1].at, Vector3(0.5, 1, 1.5));
  EXPECT_THAT(places[1].text, HasSubstr("error 0.25"));
}

TEST(PlacesToSee, JoinUnmetVerticesThatLieTogether) {
  const TriangleMesh sphere = shapes::icosphere(4);
  // The vertex nearest to the first, and the one farthest off.
  Eigen::Index far = 0, near = 0;
  const Eigen::VectorXd away = (sphere.vertices.colwise() - sphere.vertices.col(0)).colwise().norm();
  away.maxCoeff(&far);
  away.tail(away.size() - 1).minCoeff(&near);
  FitFindings findings;
  findings.unmet = {
      {0, 0.1, "steep"}, {static_cast<int>(near) + 1, 0.4, "steep"}, {static_cast<int>(far), 0.2, "steep"}};
  const std::vector<Place> places = places_to_see(Asset{}, sphere, findings);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].at, sphere.vertices.col(near + 1));
  EXPECT_THAT(places[0].text, HasSubstr("2 vertices, up to 0.4"));
  EXPECT_EQ(places[1].at, sphere.vertices.col(far));
}

TEST(PlacesToSee, RefuseVerticesOfAnotherSource) {
  FitFindings findings;
  findings.unmet = {{12, 1, "steep"}};
  EXPECT_THROW(places_to_see(Asset{}, shapes::icosphere(0), findings), InvalidInput);
}

}  // namespace
}  // namespace bespoke

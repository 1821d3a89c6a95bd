#include "bespoke/surface_fit/graph/anchor_geodesics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/bent_tube.h"

namespace bespoke {
namespace {

constexpr double turned_degrees = 110;

/// Those of the tube, which lie in one plane, and as many a quarter turn farther.
std::vector<int> all_around() {
  std::vector<int> marks = shapes::tube_marks();
  for (const int mark : shapes::tube_marks()) marks.push_back(mark + shapes::tube_sides / 4);
  return marks;
}

/// A tube of diagonal 1 and the same one, bent.
struct DescribedTube {
  explicit DescribedTube(const std::vector<int>& marks = all_around())
      : anchors(source.vertices(Eigen::all, marks)) {
    for (auto&& x : target.vertices.colwise()) x = bent(x);
    anchor_targets = target.vertices(Eigen::all, marks);
  }

  double unit = 1 / diagonal(shapes::tube().vertices);
  TriangleMesh source = shapes::of_unit_diagonal(shapes::tube());
  TriangleMesh target = source;
  Points anchors, anchor_targets;
  GeodesicSettings settings;

  AnchorGeodesics geodesics() const { return {source, target, anchors, anchor_targets, settings}; }
  std::vector<double> all_right() const {
    return std::vector<double>(static_cast<std::size_t>(anchors.cols()), 1);
  }
  GeodesicPairs pairs() const { return geodesics().pairs(all_right()); }
  Vector3 bent(const Vector3& x) const { return unit * shapes::bent(x / unit, turned_degrees); }
};

TEST(AnchorGeodesics, PairPlacesOfABentTube) {
  const DescribedTube models;
  const GeodesicPairs pairs = models.pairs();
  ASSERT_GT(pairs.sources.cols(), models.settings.count / 4);
  Eigen::Index off = 0;
  for (Eigen::Index i = 0; i < pairs.sources.cols(); ++i)
    off += (models.bent(pairs.sources.col(i)) - pairs.targets.col(i)).norm() > 0.05;
  EXPECT_LT(off, pairs.sources.cols() / 20);
}

TEST(AnchorGeodesics, PairPlacesOfACopyWithThemselves) {
  DescribedTube models;
  models.target = models.source;
  models.anchor_targets = models.anchors;
  const GeodesicPairs pairs = models.pairs();
  ASSERT_GT(pairs.sources.cols(), models.settings.count / 4);
  EXPECT_LT((pairs.sources - pairs.targets).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(AnchorGeodesics, HaveNoPairsWhereTheTargetEnds) {
  DescribedTube models;
  models.target = models.source;
  models.anchor_targets = models.anchors;
  const double end = 0.6 * models.source.vertices.row(0).maxCoeff();
  const auto is_kept = [&](const auto& x) { return x[0] < end; };
  std::vector<Eigen::Index> faces, anchors;
  for (Eigen::Index f = 0; f < models.source.faces.cols(); ++f)
    if (is_kept(models.source.vertices.col(models.source.faces(0, f)))) faces.push_back(f);
  models.target.faces = models.source.faces(Eigen::all, faces).eval();
  for (Eigen::Index k = 0; k < models.anchors.cols(); ++k)
    if (is_kept(models.anchors.col(k))) anchors.push_back(k);
  ASSERT_GE(anchors.size(), static_cast<std::size_t>(models.settings.min_anchors));
  models.anchors = models.anchors(Eigen::all, anchors).eval();
  models.anchor_targets = models.anchors;
  const GeodesicPairs pairs = models.pairs();
  EXPECT_GT(pairs.sources.cols(), 0);
  for (Eigen::Index i = 0; i < pairs.sources.cols(); ++i) {
    EXPECT_LT(pairs.sources(0, i), end + 2 * models.settings.max_return);
  }
}

TEST(AnchorGeodesics, HaveNoPairsWhereAnchorsDoNotTellTwoSidesApart) {
  const DescribedTube models(shapes::tube_marks());  // of which all lie in the plane z = 0
  const GeodesicPairs pairs = models.pairs();
  for (Eigen::Index i = 0; i < pairs.sources.cols(); ++i) {
    EXPECT_LT(std::abs(pairs.sources(2, i)), models.settings.elsewhere);
  }
}

TEST(AnchorGeodesics, NeedFourAnchorsAndAComponentThatHasSome) {
  DescribedTube models;
  models.anchors = models.anchors.leftCols(3).eval();
  models.anchor_targets = models.anchor_targets.leftCols(3).eval();
  EXPECT_EQ(models.pairs().sources.cols(), 0);
  models.anchors = models.anchor_targets = Points(3, 0);
  EXPECT_EQ(models.pairs().sources.cols(), 0);
  EXPECT_EQ(models.geodesics().left_out({}).distances.size(), 0);
  DescribedTube two;
  const Eigen::Index count = two.source.vertices.cols(), faces = two.source.faces.cols();
  two.source.vertices.conservativeResize(3, 2 * count);
  two.source.vertices.rightCols(count) = two.source.vertices.leftCols(count).colwise() + Vector3(0, 100, 0);
  two.source.faces.conservativeResize(3, 2 * faces);
  two.source.faces.rightCols(faces) = two.source.faces.leftCols(faces).array() + static_cast<int>(count);
  const GeodesicPairs pairs = two.pairs();
  EXPECT_GT(pairs.sources.cols(), 0);
  for (Eigen::Index i = 0; i < pairs.sources.cols(); ++i) EXPECT_LT(pairs.sources(1, i), 50);
}

TEST(AnchorGeodesics, PutAnAnchorWhereItsTargetIsByTheOthers) {
  const DescribedTube models;
  const LeftOutAnchors left_out = models.geodesics().left_out(models.all_right());
  EXPECT_LT(left_out.distances.maxCoeff(), 0.05);
  EXPECT_GT(left_out.compliances.minCoeff(), 0);
}

TEST(AnchorGeodesics, PutAWrongAnchorFarFromItsTargetAndForgetIt) {
  DescribedTube models;
  const Points right = models.anchor_targets;
  models.anchor_targets.col(2) = right.col(14);  // from one side of the elbow to the other end
  const AnchorGeodesics geodesics = models.geodesics();
  std::vector<double> inliers = models.all_right();
  const double off = (right.col(14) - right.col(2)).norm();
  Eigen::Index worst = 0;
  EXPECT_GT(geodesics.left_out(inliers).distances.maxCoeff(&worst), off / 2);
  EXPECT_EQ(worst, 2);
  inliers[2] = 0;
  const LeftOutAnchors without = geodesics.left_out(inliers);
  EXPECT_NEAR(without.distances[2], off, 0.1);
  for (Eigen::Index k = 0; k < without.distances.size(); ++k)
    if (k != 2) {
      EXPECT_LT(without.distances[k], 0.05) << k;
    }
}

}  // namespace
}  // namespace bespoke

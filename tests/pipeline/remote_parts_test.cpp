#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

#include "bespoke/pipeline/fit_mapping.h"
#include "support/bent_tube.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double tube_bend = 110;  // degrees

/// A straight tube and one that is bent at its middle.
struct BentTubes {
  TriangleMesh source = shapes::tube();
  TriangleMesh target = source;
  Anchors anchors;
  FitOptions options;

  BentTubes() {
    for (auto&& x : target.vertices.colwise()) x = shapes::bent(x, tube_bend);
    options.lambda = 0.4;
  }

  void add_pairs(std::initializer_list<int> rings) {
    for (const int ring : rings)
      for (const int side : {0, 4, 8}) {
        const int vertex = ring * shapes::tube_sides + side;
        anchors.pairs.push_back({"", source.vertices.col(vertex), target.vertices.col(vertex)});
      }
  }

  FittedMapping lay() const { return fit_source_surface(source, target, anchors, options); }

  /// Of the vertices beyond the bend, from where they belong: the largest.
  double beyond_the_bend(const FittedMapping& laid) const {
    const Points places = laid.target_from_source * laid.fitted_vertices;
    double largest = 0;
    for (Eigen::Index i = 0; i < places.cols(); ++i)
      if (source.vertices(0, i) > 2.5)
        largest = std::max(largest, (places.col(i) - target.vertices.col(i)).norm());
    return largest;
  }
};

TEST(RemoteParts, FollowDistancesAlongTheSurfacesWhereNoAnchorIsNear) {
  BentTubes tubes;
  tubes.add_pairs({0, 15, 30});  // up to x = 1.5 of 4
  const FittedMapping laid = tubes.lay();
  ASSERT_TRUE(laid.summary.counterparts);
  EXPECT_TRUE(laid.summary.counterparts->taken);
  EXPECT_GE(laid.summary.counterparts->elsewhere, 2u);
  EXPECT_LT(tubes.beyond_the_bend(laid), 0.2);  // the tube's radius
  EXPECT_EQ(laid.summary.rigid.residuals.count, tubes.anchors.pairs.size());
  EXPECT_EQ(laid.summary.coarse->residuals.count, tubes.anchors.pairs.size());
}

TEST(RemoteParts, AreLaidByAnchorsAloneWhereThoseTell) {
  BentTubes tubes;
  tubes.add_pairs({0, 15, 30, 50, 65, 80});
  const FittedMapping laid = tubes.lay();
  EXPECT_FALSE(laid.summary.counterparts);
  EXPECT_LT(tubes.beyond_the_bend(laid), 0.2);
}

TEST(RemoteParts, AreLaidByAnchorsAloneInThePrintedMethod) {
  BentTubes tubes;
  tubes.add_pairs({0, 15, 30});
  tubes.options.surface_fit.method = SurfaceFitMethod::laplacian;
  EXPECT_FALSE(tubes.lay().summary.counterparts);
}

}  // namespace
}  // namespace bespoke

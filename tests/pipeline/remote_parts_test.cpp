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

  Registration register_models() const { return fit_source_surface({source, target, anchors}, options); }

  /// Of the vertices beyond the bend, from where they belong: the largest.
  double beyond_the_bend(const Registration& registered) const {
    const Points places = registered.target_from_source * registered.fitted_vertices;
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
  const Registration registered = tubes.register_models();
  ASSERT_TRUE(registered.summary.counterparts);
  EXPECT_TRUE(registered.summary.counterparts->taken);
  EXPECT_GE(registered.summary.counterparts->displaced, 2u);
  EXPECT_LT(tubes.beyond_the_bend(registered), 0.2);  // the tube's radius
  EXPECT_EQ(registered.summary.rigid.residuals.count, tubes.anchors.pairs.size());
  EXPECT_EQ(registered.summary.coarse->residuals.count, tubes.anchors.pairs.size());
}

TEST(RemoteParts, AreRegisteredByAnchorsAloneWhereThoseSuffice) {
  BentTubes tubes;
  tubes.add_pairs({0, 15, 30, 50, 65, 80});
  const Registration registered = tubes.register_models();
  EXPECT_FALSE(registered.summary.counterparts);
  EXPECT_LT(tubes.beyond_the_bend(registered), 0.2);
}

TEST(RemoteParts, AreRegisteredByAnchorsAloneInThePrintedMethod) {
  BentTubes tubes;
  tubes.add_pairs({0, 15, 30});
  tubes.options.surface_fit.method = SurfaceFitMethod::laplacian;
  EXPECT_FALSE(tubes.register_models().summary.counterparts);
}

}  // namespace
}  // namespace bespoke

#include "bespoke/surface_fit/surface_fit_methods.h"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

#include "bespoke/error.h"
#include "support/fitting_scene.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(SurfaceFits, HaveNamesValuesAndFunctionsOfTheirOwn) {
  std::set<std::string_view> names;
  std::set<SurfaceFitMethod> values;
  std::set<FitSurface*> functions;
  for (const SurfaceFitEntry& entry : surface_fits) {
    EXPECT_FALSE(entry.summary.empty());
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_TRUE(values.insert(entry.value).second) << entry.name;
    EXPECT_TRUE(functions.insert(entry.fit).second) << entry.name;
    EXPECT_EQ(&entry_of(entry.value), &entry);
  }
}

TEST(SurfaceFits, LeaveASourceThatLiesOnItsTargetWhereItIs) {
  const TriangleMesh sphere = shapes::icosphere(2);
  for (const SurfaceFitEntry& entry : surface_fits) {
    SurfaceFitOptions options;
    options.method = entry.value;
    const SurfaceFit fit = test::FittingScene{sphere, sphere}.fit(options);
    EXPECT_LT((fit.vertices - sphere.vertices).cwiseAbs().maxCoeff(), 1e-9) << entry.name;
  }
}

TEST(SurfaceFits, RefuseAMethodThatIsNotInTheTable) {
  SurfaceFitOptions options;
  options.method = static_cast<SurfaceFitMethod>(99);
  EXPECT_THROW(entry_of(options.method), InvalidInput);
  const TriangleMesh sphere = shapes::icosphere(1);
  EXPECT_THROW((test::FittingScene{sphere, sphere}.fit(options)), InvalidInput);
}

}  // namespace
}  // namespace bespoke

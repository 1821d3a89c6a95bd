#include "bespoke/elastic/elastic_methods.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "bespoke/elastic/exact_map_io.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const TriangleMesh unit_ball = shapes::icosphere(2);
const Points fitted_ball =
    1.1 * unit_ball.vertices + 0.02 * test::random_points(unit_ball.vertices.cols(), 1);

ElasticFit fit_by(const ElasticMethodRow& row) {
  return row.fit({unit_ball, fitted_ball, unit_ball.vertices, fitted_ball}, {0.5, 1e-3}, {});
}

TEST(ElasticMethods, HaveOneRowEachWithANameOfItsOwn) {
  std::set<std::string_view> names;
  std::set<ElasticMethod> values;
  for (const ElasticMethodRow& row : elastic_methods) {
    names.insert(row.name);
    values.insert(row.value);
    EXPECT_EQ(value_of(elastic_methods, row.name), row.value);
    EXPECT_EQ(name_of(elastic_methods, row.value), row.name);
    EXPECT_EQ(&elastic_method(row.value), &row);
  }
  EXPECT_EQ(names.size(), elastic_methods.size());
  EXPECT_EQ(values.size(), elastic_methods.size());
}

TEST(ElasticMethods, HaveNoNameForAnyOtherValue) {
  const auto other = static_cast<ElasticMethod>(99);
  EXPECT_THROW(elastic_method(other), InvalidInput);
  EXPECT_THROW(name_of(elastic_methods, other), InvalidInput);
  EXPECT_FALSE(value_of(elastic_methods, "unknown"));
}

TEST(ElasticMethods, FitPrintAndAreKept) {
  const Points x = 1.2 * test::random_points(100, 2);
  for (const ElasticMethodRow& row : elastic_methods) {
    const ElasticFit fit = fit_by(row);
    EXPECT_LT(((*fit.map)(unit_ball.vertices) - fitted_ball).norm() / fitted_ball.norm(), 0.05) << row.name;
    const std::string line = std::visit([](const auto& found) { return to_string(found); }, fit.found);
    EXPECT_FALSE(line.empty()) << row.name;
    EXPECT_EQ(line.find('\n'), std::string::npos) << row.name;
    EXPECT_TRUE(row.stored.holds(*fit.map)) << row.name;
    EXPECT_EQ((*parse_exact_map(serialize_exact_map(*fit.map)))(x), (*fit.map)(x)) << row.name;
  }
}

TEST(ElasticMethods, ThatMeetPointsMeetOnesOffTheSurface) {
  Points sources(3, unit_ball.vertices.cols() + 1), targets(3, fitted_ball.cols() + 1);
  sources << unit_ball.vertices, Vector3(0, 0, 1.3);
  targets << fitted_ball, Vector3(0.03, 0.02, 1.45);
  for (const ElasticMethodRow& row : elastic_methods) {
    if (!row.meets_points) continue;
    const ElasticFit fit = row.fit({unit_ball, fitted_ball, sources, targets}, {0.5, 1e-3}, {});
    EXPECT_LE(((*fit.map)(sources)-targets).colwise().norm().maxCoeff(), row.met_within * 1e-3) << row.name;
  }
}

}  // namespace
}  // namespace bespoke

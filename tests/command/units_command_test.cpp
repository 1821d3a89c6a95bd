#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "bespoke/product/mesh_io.h"
#include "bespoke/product/product_io.h"
#include "command/fit_command.h"

namespace bespoke::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The example pair, whose anchors are in cm, in other units too.
class UnitsCommand : public FitCommand {
 protected:
  /// `name` as a file in another unit, of which there are `factor` in a cm.
  std::string scaled(const std::string& name, double factor, const std::string& as,
                     const std::string& unit = "") const {
    Product product = read_product(pair_.file(name));
    product.vertices *= factor;
    product.unit = unit;
    write_product(pair_.file(as), product);
    return pair_.file(as);
  }
  Points vertices(const std::string& name) const { return read_product(pair_.file(name)).vertices; }

  ProgramResult apply(const std::string& product, const std::string& output,
                      const std::vector<std::string>& extra = {}) const {
    std::vector<std::string> arguments{"apply", pair_.file("map.vdb"), product, "-o", pair_.file(output)};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }
};

TEST_F(UnitsCommand, CarriesProductsInTheirOwnUnit) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  ASSERT_EQ(apply(pair_.file("product.obj"), "cm.obj").exit_code, 0);
  const Points expected = vertices("cm.obj");
  const auto expect_carried = [&](const std::string& name, double factor) {
    EXPECT_LT((vertices(name) / factor - expected).cwiseAbs().maxCoeff(), 1e-5) << name;
  };

  const ProgramResult millimetres = apply(scaled("product.obj", 10, "mm.3mf", "mm"), "carried.3mf");
  EXPECT_EQ(millimetres.exit_code, 0) << millimetres.err;
  EXPECT_THAT(millimetres.err, HasSubstr("mm.3mf: is in mm, the map in cm: carried times 0.1"));
  expect_carried("carried.3mf", 10);
  EXPECT_EQ(read_product(pair_.file("carried.3mf")).unit, "mm");
  EXPECT_EQ(apply(scaled("product.obj", 1 / 2.54, "in.3mf", "in"), "carried_in.obj").exit_code, 0);
  expect_carried("carried_in.obj", 1 / 2.54);

  EXPECT_EQ(apply(scaled("product.obj", 0.01, "m.obj"), "m_out.obj", {"--unit", "m"}).exit_code, 0);
  expect_carried("m_out.obj", 0.01);
  EXPECT_EQ(apply(pair_.file("mm.3mf"), "asis.3mf", {"--unit", "map"}).exit_code, 0);
  EXPECT_EQ(read_product(pair_.file("asis.3mf")).unit, "cm");
  EXPECT_GT((vertices("asis.3mf") / 10 - expected).cwiseAbs().maxCoeff(), 0.1);

  EXPECT_EQ(apply(pair_.file("product.obj"), "cm.3mf").exit_code, 0);
  expect_carried("cm.3mf", 1);
  EXPECT_EQ(read_product(pair_.file("cm.3mf")).unit, "cm");

  // What says no unit tells it by where it lies; nothing is written then, and what was there stays.
  const std::string metres = scaled("source.obj", 0.01, "source_m.obj");
  const std::string kept = read_text(pair_.file("m_out.obj"));
  const ProgramResult refused = apply(metres, "m_out.obj");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("source_m.obj"), HasSubstr("multiplied by 100")));
  EXPECT_EQ(read_text(pair_.file("m_out.obj")), kept);
  EXPECT_EQ(apply(metres, "asis.obj", {"--unit", "map"}).exit_code, 0);
  const std::vector<std::string> measure{
      "measure",  pair_.file("map.vdb"),    "--source", pair_.file("source.obj"),
      "--target", pair_.file("target.obj"), "--product"};
  auto with = [&](const std::string& product) {
    std::vector<std::string> arguments = measure;
    arguments.push_back(product);
    return bespoke(arguments);
  };
  EXPECT_EQ(with(metres).exit_code, 2);
  EXPECT_EQ(with(pair_.file("mm.3mf")).exit_code, 0);
  const ProgramResult unknown = apply(pair_.file("product.obj"), "x.obj", {"--unit", "ells"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("the unit \"ells\" is not known"));
}

TEST_F(UnitsCommand, FitsModelsOfSeveralUnitsToOneMap) {
  const std::string inches = scaled("source.obj", 1 / 2.54, "source_in.3mf", "in");
  const std::string millimetres = scaled("target.obj", 10, "target_mm.3mf", "mm");
  const auto fit = [&](const std::string& anchors, const std::vector<std::string>& extra) {
    std::vector<std::string> arguments{"fit",       inches,  millimetres,   "-o",  pair_.file("map.vdb"),
                                       "--anchors", anchors, "--tolerance", "0.5%"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  };
  expect_refusal(fit(pair_.file("anchors.json"), {}), 2,
                 "is in in, as its file says, but the anchors are in cm");
  const ProgramResult fitted = fit(pair_.file("anchors.json"), {"--unit", "cm"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  EXPECT_THAT(fitted.out, AllOf(HasSubstr("source_in.3mf is in in, converted to cm: times 2.54"),
                                HasSubstr("target_mm.3mf is in mm, converted to cm: times 0.1")));
  EXPECT_EQ(info("map.vdb")["unit"], "cm");
  ASSERT_EQ(apply(pair_.file("source.obj"), "on_target.obj").exit_code, 0);
  const Points radii = (vertices("on_target.obj").colwise() - Vector3(3, -1, 2));
  const Points target = (vertices("target.obj").colwise() - Vector3(3, -1, 2));
  EXPECT_NEAR(radii.colwise().norm().maxCoeff() / target.colwise().norm().maxCoeff(), 1, 0.02);
  const ProgramResult measured = bespoke(
      {"measure", pair_.file("map.vdb"), "--source", inches, "--target", millimetres, "--product", inches});
  EXPECT_EQ(measured.exit_code, 0) << measured.err;
}

TEST_F(UnitsCommand, FindsAMapByModelsThatWereConvertedForIt) {
  const std::string inches = scaled("source.obj", 1 / 2.54, "source_in.3mf", "in");
  const std::string millimetres = scaled("target.obj", 10, "target_mm.3mf", "mm");
  std::filesystem::create_directories(pair_.file("maps"));
  ASSERT_EQ(bespoke({"fit", inches, millimetres, "--anchors", pair_.file("anchors.json"), "--unit", "cm",
                     "--tolerance", "0.5%", "-o", pair_.file("maps/map.vdb"), "-q"})
                .exit_code,
            0);
  ASSERT_EQ(bespoke({"catalog", pair_.file("maps"), "-q"}).exit_code, 0);
  const ProgramResult found =
      bespoke({"apply", pair_.file("product.obj"), "--from", pair_.file("maps"), "--source", inches,
               "--target", millimetres, "-o", pair_.file("out.obj")});
  EXPECT_EQ(found.exit_code, 0) << found.err;
  // Products are checked against the converted models, in whatever unit they are.
  const ProgramResult checked =
      bespoke({"apply", pair_.file("maps/map.vdb"), scaled("product.obj", 10, "product_mm.3mf", "mm"),
               "--source", inches, "--target", millimetres, "-o", pair_.file("out.3mf")});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_THAT(checked.err, Not(HasSubstr("inside the target")));
}

TEST_F(UnitsCommand, OfModelsAndAnchorsAreBroughtTogetherByAuditSuggestAndPick) {
  const std::string inches = scaled("source.obj", 1 / 2.54, "source_in.3mf", "in");
  const std::string millimetres = scaled("target.obj", 10, "target_mm.3mf", "mm");
  const ProgramResult audit =
      bespoke({"anchors", "audit", pair_.file("anchors.json"), "--source", inches, "--target", millimetres});
  EXPECT_EQ(audit.exit_code, 0) << audit.err;
  EXPECT_THAT(audit.out, HasSubstr("nothing is suspicious"));
  const ProgramResult suggest =
      bespoke({"anchors", "suggest", inches, millimetres, "--anchors", pair_.file("anchors.json"),
               "--tolerance", "0.0001%", "--count", "1", "-o", pair_.file("more.json"), "-q"});
  ASSERT_EQ(suggest.exit_code, 0) << suggest.err;
  const json more = read_json("more.json");
  ASSERT_EQ(more["pairs"].size(), 15u);
  EXPECT_EQ(more["units"], "cm");
  for (int axis = 0; axis < 3; ++axis) EXPECT_LT(std::abs(more["pairs"][14]["a"][axis].get<double>()), 2);
  const ProgramResult pick = bespoke(
      {"pick", inches, millimetres, "--anchors", pair_.file("anchors.json"), "-o", pair_.file("pick.html")});
  if (pick.exit_code == 1 && pick.err.find("pages") != std::string::npos) GTEST_SKIP() << pick.err;
  EXPECT_EQ(pick.exit_code, 0) << pick.err;
}

TEST_F(UnitsCommand, RefinedFacesKeepTheUnitOfTheirFile) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  const std::string inches = scaled("product.obj", 1 / 2.54, "in.3mf", "in");
  ASSERT_EQ(apply(inches, "fine.3mf", {"--refine", "0.1%"}).exit_code, 0);
  EXPECT_EQ(read_product(pair_.file("fine.3mf")).unit, "in");
}

TEST_F(UnitsCommand, RefusesAModelThatWasScaledWhileItsAnchorsWereNot) {
  const std::string source = scaled("source.obj", 2.54, "source_in.obj");
  const std::string target = scaled("target.obj", 0.1, "target_mm.obj");
  const auto fit = [&](const std::string& from, const std::string& to) {
    return bespoke({"fit", from, to, "--anchors", pair_.file("anchors.json"), "-o", pair_.file("map.vdb")});
  };
  expect_refusal(fit(source, pair_.file("target.obj")), 2,
                 "do not lie on the source, but would if their \"a\"");
  expect_refusal(fit(source, pair_.file("target.obj")), 2, "multiplied by 2.54");
  expect_refusal(fit(pair_.file("source.obj"), target), 2, "do not lie on the target");
}

}  // namespace
}  // namespace bespoke::test

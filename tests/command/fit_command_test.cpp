#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/quality/distortion.h"
#include "command/fit_command.h"
#include "support/bent_tube.h"
#include "support/shapes.h"

namespace bespoke::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

TEST_F(FitCommand, MapsTheSourceOntoTheTarget) {
  const ProgramResult fit = pair_.fit("map.vdb");
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  for (const char* line : {"registered", "surfaces", "anchors", "error", "written", "next"})
    EXPECT_THAT("\n" + fit.out, HasSubstr("\n" + std::string(line) + " ")) << line;
  EXPECT_LE(std::count(fit.out.begin(), fit.out.end(), '\n'), 10);
  const ProgramResult apply =
      bespoke({"apply", pair_.file("map.vdb"), pair_.file("source.obj"), "-o", pair_.file("moved.obj")});
  ASSERT_EQ(apply.exit_code, 0) << apply.err;
  // The target is the ellipsoid with radii (1.1, 1.3, 0.95), turned and moved; a chord of its mesh lies at
  // most 1 % of the radius below it.
  const Matrix3 rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Points moved = read_obj_points(pair_.file("moved.obj"));
  const Points local = rotation.transpose() * (moved.colwise() - Vector3(3, -1, 2));
  const Eigen::ArrayXd height = (local.array().colwise() / Eigen::Array3d(1.1, 1.3, 0.95))
                                    .matrix()
                                    .colwise()
                                    .norm()
                                    .transpose()
                                    .array() -
                                1;
  EXPECT_LT(height.abs().maxCoeff(), 0.03);
}

TEST_F(FitCommand, OtherProgramsReadTheAsset) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  const ProgramResult result = run_program({"vdb_print", "-l", pair_.file("map.vdb")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* grid : {"displacement", "u_0", "source_distance", "jacobian"})
    EXPECT_THAT(result.out, HasSubstr(grid));
}

TEST_F(FitCommand, ChoosesTheMethods) {
  for (const std::string elastic : {"csrbf", "pffd-smooth"}) {
    ASSERT_EQ(pair_.fit("map.vdb", {"--surface-fit", "laplacian", "--elastic", elastic}).exit_code, 0);
    EXPECT_EQ(info("map.vdb")["elastic"], elastic);
    EXPECT_EQ(info("map.vdb")["surface_fit"], "laplacian");
  }
}

TEST_F(FitCommand, PaperIsThePrintedMethod) {
  ASSERT_EQ(
      pair_.fit("map.vdb", {"--paper", "--keep-exact", "--fitted-out", pair_.file("fitted.obj")}).exit_code,
      0);
  const json found = info("map.vdb");
  // Eq. 11-15 with nothing added: the printed weight 1, the printed stopping rule.
  EXPECT_EQ(found["surface_fit"], "laplacian");
  const json& additions = found["options"]["laplacian"];
  EXPECT_EQ(additions.size(), 6u);
  for (const auto& [name, on] : additions.items()) EXPECT_EQ(on, false) << name;
  EXPECT_EQ(found["options"]["mend_models"], false);
  ASSERT_EQ(pair_.fit("own.vdb", {"--surface-fit", "laplacian"}).exit_code, 0);
  const json own = info("own.vdb")["options"]["laplacian"];
  EXPECT_EQ(own.size(), 6u);
  for (const json& added : own) EXPECT_EQ(added, true);
  EXPECT_EQ(found["stages"][2]["name"], "surface-fit");
  EXPECT_EQ(found["stages"][2]["stiffness"], 1);

  // Eq. 16-17: E takes every source vertex exactly to its fitted place.
  const auto carried = [&](const std::vector<std::string>& extra) {
    std::vector<std::string> arguments{"apply", pair_.file("map.vdb"),   pair_.file("source.obj"),
                                       "-o",    pair_.file("moved.obj"), "--exact"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    EXPECT_EQ(bespoke(arguments).exit_code, 0);
    return read_obj_points(pair_.file("moved.obj"));
  };
  EXPECT_EQ(found["elastic"], "csrbf");
  const Points x = read_obj_points(pair_.file("source.obj")), arrived = carried({});
  const double rounding = 4 * float_rounding(arrived);
  EXPECT_LE((arrived - read_obj_points(pair_.file("fitted.obj"))).colwise().norm().maxCoeff(), rounding);

  // Eq. 1 half-way, each Euler angle halved.
  EXPECT_EQ(found["path"], "euler");
  Matrix3 rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = found["rotation"][i / 3][i % 3];
  const json& t = found["translation"];
  const Vector3 translation(t[0], t[1], t[2]);
  const Matrix3 half_turned =
      (Eigen::AngleAxisd(std::atan2(rotation(1, 0), rotation(0, 0)) / 2, Vector3::UnitZ()) *
       Eigen::AngleAxisd(std::asin(-rotation(2, 0)) / 2, Vector3::UnitY()) *
       Eigen::AngleAxisd(std::atan2(rotation(2, 1), rotation(2, 2)) / 2, Vector3::UnitX()))
          .toRotationMatrix();
  const Points elastic = rotation.transpose() * (arrived.colwise() - translation);
  const Points expected = (half_turned * (x + elastic) / 2).colwise() + translation / 2;
  EXPECT_LE((carried({"--t", "0.5"}) - expected).colwise().norm().maxCoeff(), rounding);
}

TEST_F(FitCommand, StoresTheRotationPath) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  EXPECT_EQ(info("map.vdb")["path"], "geodesic");
  ASSERT_EQ(pair_.fit("map.vdb", {"--path", "euler"}).exit_code, 0);
  EXPECT_EQ(info("map.vdb")["path"], "euler");
  EXPECT_EQ(pair_.fit("map.vdb", {"--path", "straight"}).exit_code, 1);
}

TEST_F(FitCommand, TakesLengthsInMeshUnitsAndPercent) {
  ASSERT_EQ(pair_.fit("percent.vdb", {"--lambda", "20%", "--voxel-size", "2%"}).exit_code, 0);
  const json percent = info("percent.vdb");
  const double diagonal = (Vector3(percent["source"]["box"]["max"][0], percent["source"]["box"]["max"][1],
                                   percent["source"]["box"]["max"][2]) -
                           Vector3(percent["source"]["box"]["min"][0], percent["source"]["box"]["min"][1],
                                   percent["source"]["box"]["min"][2]))
                              .norm();
  EXPECT_NEAR(percent["lambda"], 0.2 * diagonal, 1e-12);
  EXPECT_NEAR(percent["levels"][0]["voxel_size"], 0.02 * diagonal, 1e-12);

  std::ostringstream lambda;
  lambda.precision(17);
  lambda << percent["lambda"].get<double>();
  ASSERT_EQ(pair_.fit("units.vdb", {"--lambda", lambda.str(), "--voxel-size", "2%"}).exit_code, 0);
  EXPECT_EQ(info("units.vdb")["lambda"], percent["lambda"]);
}

TEST_F(FitCommand, MeetsTheTolerance) {
  ASSERT_EQ(pair_.fit("map.vdb", {"--strict", "--lambda", "20%", "--tolerance", "0.2%"}).exit_code, 0);
  const json found = info("map.vdb");
  EXPECT_LE(found["bake_error"]["max"], found["tolerance"]);
  EXPECT_GT(found["bake_error"]["count"], 0);
}

TEST_F(FitCommand, WarnsWhenTheVoxelSizeMissesTheTolerance) {
  const ProgramResult fit = pair_.fit("map.vdb", {"--voxel-size", "10%", "--tolerance", "0.001%", "--quiet"});
  EXPECT_EQ(fit.exit_code, 0);
  EXPECT_THAT(fit.err, HasSubstr("exceeds the tolerance"));
  EXPECT_THAT(fit.err, HasSubstr("--voxel-size"));
}

TEST_F(FitCommand, MultiscaleMapsMeetTheFitTolerance) {
  ASSERT_EQ(pair_
                .fit("map.vdb", {"--elastic", "multiscale", "--lambda", "30%", "--fit-tolerance", "0.1%",
                                 "--report", pair_.file("report.json")})
                .exit_code,
            0);
  const json report = read_json("report.json");
  EXPECT_LE(report["vertex_residuals"]["p95"], 0.001 * report["source"]["diagonal"].get<double>());
}

TEST_F(FitCommand, WritesTheFittedSourceAndTakesIt) {
  ASSERT_EQ(pair_.fit("map.vdb", {"--fitted-out", pair_.file("fitted.obj")}).exit_code, 0);
  const std::string source = read_text(pair_.file("source.obj"));
  const std::string fitted = read_text(pair_.file("fitted.obj"));
  EXPECT_EQ(read_obj_points(pair_.file("fitted.obj")).cols(),
            read_obj_points(pair_.file("source.obj")).cols());

  // Taken as given, it is met by the map, and no anchors are needed.
  const ProgramResult given = bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--fitted",
                                       pair_.file("fitted.obj"), "-o", pair_.file("given.vdb"), "--tolerance",
                                       "0.5%", "--elastic", "csrbf"});
  ASSERT_EQ(given.exit_code, 0) << given.err;
  EXPECT_EQ(info("given.vdb")["surface_fit"], "given");
  ASSERT_EQ(
      bespoke({"apply", pair_.file("given.vdb"), pair_.file("source.obj"), "-o", pair_.file("moved.obj")})
          .exit_code,
      0);
  const Points difference =
      read_obj_points(pair_.file("moved.obj")) - read_obj_points(pair_.file("fitted.obj"));
  EXPECT_LE(difference.colwise().norm().maxCoeff(),
            info("given.vdb")["tolerance"].get<double>() +
                2 * float_rounding(read_obj_points(pair_.file("fitted.obj"))));
}

TEST_F(FitCommand, KeepsTheExactMapOnRequest) {
  ASSERT_EQ(pair_.fit("plain.vdb").exit_code, 0);
  ASSERT_EQ(pair_.fit("exact.vdb", {"--keep-exact"}).exit_code, 0);
  EXPECT_EQ(info("plain.vdb")["exact_map_bytes"], 0);
  EXPECT_GT(info("exact.vdb")["exact_map_bytes"], 0);
}

TEST_F(FitCommand, StoresHalfFloatsOnRequest) {
  ASSERT_EQ(pair_.fit("single.vdb").exit_code, 0);
  ASSERT_EQ(pair_.fit("half.vdb", {"--half"}).exit_code, 0);
  EXPECT_EQ(info("single.vdb")["precision"], "single");
  const json half = info("half.vdb");
  EXPECT_EQ(half["precision"], "half");
  EXPECT_LE(half["bake_error"]["max"], half["tolerance"]);
  // What is proved is proved of the stored values.
  const ProgramResult check = bespoke({"check", pair_.file("half.vdb"), "--json"});
  EXPECT_EQ(json::parse(check.out)["certified"], half["certificate"]["certified"]);
  EXPECT_EQ(json::parse(check.out)["min_determinant"], half["certificate"]["min_determinant"]);
  EXPECT_EQ(bespoke({"invert", pair_.file("half.vdb"), "-o", pair_.file("back.vdb"), "--half"}).exit_code, 0);
  EXPECT_EQ(info("back.vdb")["precision"], "half");
}

TEST_F(FitCommand, AddsTheCornersOfTheBoxes) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  EXPECT_EQ(info("map.vdb")["anchors"].size(), 14u);
  ASSERT_EQ(pair_.fit("map.vdb", {"--paper", "--add-corners"}).exit_code, 0);
  EXPECT_EQ(info("map.vdb")["anchors"].size(), 22u);
  EXPECT_EQ(info("map.vdb")["anchors"][14]["name"], "corner_000");
}

TEST_F(FitCommand, TakesAnAccuracyForAnchorsWithoutOne) {
  ASSERT_EQ(pair_.fit("map.vdb", {"--anchor-sigma", "1%"}).exit_code, 0);
  const double diagonal = 2 * Vector3(1, 1.4, 0.8).norm();
  const json relative = info("map.vdb");
  for (const json& anchor : relative["anchors"]) {
    // A sphere's inscribed mesh is a little smaller than its box.
    EXPECT_NEAR(anchor["sigma"], 0.01 * diagonal, 0.0005 * diagonal);
  }
  ASSERT_EQ(pair_.fit("map.vdb", {"--anchor-sigma", "0"}).exit_code, 0);
  const json exact = info("map.vdb");
  for (const json& anchor : exact["anchors"]) EXPECT_FALSE(anchor.contains("sigma"));
  EXPECT_EQ(pair_.fit("map.vdb", {"--anchor-sigma=-1"}).exit_code, 1);
}

// Fig. 5: corners lie far off the surface, and the map meets them.
TEST_F(FitCommand, MeetsTheCornersOfTheBoxes) {
  ASSERT_EQ(pair_.fit("map.vdb", {"--add-corners", "--keep-exact"}).exit_code, 0);
  const json found = info("map.vdb");
  ASSERT_EQ(found["anchors"].size(), 22u);
  EXPECT_GE(found["stages"][3]["anchors_off_surface"], 8);
  // Finite elements list what they miss by more than ten tolerances.
  for (std::size_t i = 14; i < 22; ++i)
    EXPECT_LE(found["anchors"][i]["residual"].get<double>(),
              10 * found["options"]["fit_tolerance"].get<double>())
        << found["anchors"][i];
}

// The target is turned: corners of its box as it stands would tear the map apart.
TEST_F(FitCommand, CornersDoNotHarmTheDefaultMethods) {
  ASSERT_EQ(pair_.fit("plain.vdb").exit_code, 0);
  const ProgramResult fit = pair_.fit("map.vdb", {"--add-corners"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const json plain = info("plain.vdb"), corners = info("map.vdb");
  ASSERT_EQ(corners["anchors"].size(), 22u);
  EXPECT_TRUE(corners["certificate"]["bijection"]);
  const double diagonal = 2 * Vector3(1, 1.4, 0.8).norm();
  for (std::size_t i = 0; i < plain["anchors"].size(); ++i)
    EXPECT_LE(corners["anchors"][i]["residual"], 0.01 * diagonal);
}

TEST_F(FitCommand, ReportsEveryStage) {
  ASSERT_EQ(pair_.fit("map.vdb", {"--report", pair_.file("report.json")}).exit_code, 0);
  const json report = read_json("report.json");
  std::vector<std::string> names;
  for (const json& stage : report["stages"]) {
    names.push_back(stage["name"]);
    EXPECT_GE(stage["seconds"].get<double>(), 0) << stage;
  }
  EXPECT_THAT(names, IsSupersetOf({"rigid", "coarse", "surface-fit", "elastic", "bake", "certificate"}));
  for (const char* key : {"min", "median", "p95", "p99", "max"}) {
    EXPECT_TRUE(report["anchor_residuals"].contains(key));
    EXPECT_TRUE(report["vertex_residuals"].contains(key));
  }
  for (const json& stage : report["stages"])
    if (stage["name"] == "surface-fit") {
      EXPECT_TRUE(stage.contains("iterations")) << stage;
      EXPECT_TRUE(stage.contains("stop_reason")) << stage;
    }
  EXPECT_EQ(report["confidence"]["count"], 642);
  EXPECT_TRUE(report["unmet_vertices"].is_array());
  EXPECT_EQ(report["source"]["vertices"], 642);
  EXPECT_GT(report["voxels"], 0);
  EXPECT_GT(report["peak_memory"], 1000000);
}

TEST_F(FitCommand, ListsTheVerticesItMisses) {
  // Two vertices change places across the body: no straight way without folds takes them there.
  std::istringstream source(read_text(pair_.file("source.obj")));
  std::vector<std::string> lines;
  for (std::string line; std::getline(source, line);) lines.push_back(line);
  const auto vertex = [&](int index) {
    return std::find_if(lines.begin(), lines.end(),
                        [&](const std::string& line) { return line.rfind("v ", 0) == 0; }) +
           index;
  };
  std::iter_swap(vertex(0), vertex(3));
  std::ofstream fitted(pair_.file("swapped.obj"));
  for (const std::string& line : lines) fitted << line << '\n';
  fitted.close();
  ASSERT_EQ(bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--fitted",
                     pair_.file("swapped.obj"), "-o", pair_.file("map.vdb"), "--tolerance", "0.5%", "--steps",
                     "1", "--report", pair_.file("report.json")})
                .exit_code,
            0);
  const json report = read_json("report.json");
  EXPECT_FALSE(report.contains("confidence"));
  std::vector<int> listed;
  for (const json& unmet : report["unmet_vertices"]) {
    listed.push_back(unmet["vertex"]);
    EXPECT_GT(unmet["residual"], 1e-4 * report["source"]["diagonal"].get<double>());
    EXPECT_TRUE(unmet["reason"].is_string());
  }
  EXPECT_THAT(listed, IsSupersetOf({0, 3}));
}

TEST_F(FitCommand, WritesTheConfidenceOfEveryVertex) {
  ASSERT_EQ(pair_.fit("first.vdb", {"--confidence-out", pair_.file("confidence.txt")}).exit_code, 0);
  std::istringstream lines(read_text(pair_.file("confidence.txt")));
  int count = 0;
  for (double value; lines >> value; ++count) {
    EXPECT_GE(value, 0);
    EXPECT_LE(value, 1);
  }
  EXPECT_EQ(count, 642);
  expect_refusal(bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--fitted",
                          pair_.file("source.obj"), "-o", pair_.file("map.vdb"), "--confidence-out",
                          pair_.file("other.txt")}),
                 1, "--confidence-out");
}

TEST_F(FitCommand, TakesTheRuleForOpenBoundaries) {
  for (const std::string rule : {"auto", "free", "matched"}) {
    ASSERT_EQ(pair_.fit("map.vdb", {"--boundaries", rule}).exit_code, 0);
    EXPECT_EQ(info("map.vdb")["options"]["boundaries"], rule);
  }
  EXPECT_EQ(pair_.fit("map.vdb", {"--boundaries", "glued"}).exit_code, 1);
}

TEST_F(FitCommand, WritesTheSameBytesOnAnyNumberOfThreads) {
  for (const std::string threads : {"1", "2", "8"})
    ASSERT_EQ(pair_.fit("map" + threads + ".vdb", {"--threads", threads}).exit_code, 0);
  const std::string one = read_text(pair_.file("map1.vdb"));
  EXPECT_TRUE(one == read_text(pair_.file("map2.vdb")));
  EXPECT_TRUE(one == read_text(pair_.file("map8.vdb")));
  EXPECT_EQ(pair_.fit("map.vdb", {"--threads", "0"}).exit_code, 1);
}

TEST_F(FitCommand, SaysNothingWhenQuiet) {
  const ProgramResult fit = pair_.fit("map.vdb", {"--quiet"});
  EXPECT_EQ(fit.exit_code, 0);
  EXPECT_THAT(fit.out, IsEmpty());
  EXPECT_THAT(fit.err, IsEmpty());
}

// The fixture names one.
TEST_F(FitCommand, SaysThatFiniteElementsHaveNoUseForATolerance) {
  EXPECT_THAT(pair_.fit("map.vdb").out, HasSubstr("the fitted one, so that --tolerance changes nothing"));
  EXPECT_THAT(pair_.fit("map.vdb", {"--max-memory", "2GiB"}).out,
              Not(HasSubstr("--tolerance changes nothing")));
}

TEST_F(FitCommand, PrintsWhatEveryStageFoundWhenVerbose) {
  const ProgramResult fit = pair_.fit("map.vdb", {"--verbose"});
  for (const char* line : {"source", "target", "rigid", "coarse", "surface-fit", "elastic", "bake",
                           "certificate", "anchors", "vertices", "written"})
    EXPECT_THAT("\n" + fit.out, HasSubstr("\n" + std::string(line) + " ")) << line;
  EXPECT_EQ(pair_.fit("map.vdb", {"--verbose", "--quiet"}).exit_code, 1);
}

TEST_F(FitCommand, PrintsOneLineAStageWithoutATerminal) {
  const ProgramResult fit = pair_.fit("map.vdb", {"--strict"});
  EXPECT_THAT(fit.err, HasSubstr("bake: "));
  EXPECT_THAT(fit.err, Not(HasSubstr("\r")));
  EXPECT_THAT(fit.err, Not(HasSubstr("%")));
  std::istringstream lines(fit.err);
  std::set<std::string> stages;
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(stages.insert(line.substr(0, line.find(':'))).second) << line;
}

TEST_F(FitCommand, AsksWhetherAnchorsAreInTheModelsUnit) {
  EXPECT_THAT(pair_.fit("map.vdb").err, Not(HasSubstr("warning")));
  json anchors = read_json("anchors.json");
  for (json& anchor : anchors["pairs"])
    for (const char* side : {"a", "b"})
      for (json& coordinate : anchor[side]) coordinate = 10 * coordinate.get<double>();
  write_text(pair_.file("anchors.json"), anchors.dump());
  const ProgramResult refused = pair_.fit("other.vdb");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("would if their \"a\" were multiplied by 0.1,"));
  const ProgramResult fit =
      pair_.fit("map.vdb", {"--any-anchors", "--quiet", "--elastic", "pffd-smooth", "--voxel-size", "20%"});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  for (const char* role : {"source", "target"})
    EXPECT_THAT(fit.err, HasSubstr(std::string("bespoke: warning: ") + role + ": half of the anchors lie"));
  EXPECT_THAT(
      fit.err,
      HasSubstr("give the model and its anchors in one unit, cm (see troubleshooting.md#anchors-far-away)"));
}

TEST_F(FitCommand, RefusesADirectoryAsItsOutputBeforeAnyWork) {
  std::filesystem::create_directory(pair_.file("folder.vdb"));
  const ProgramResult fit = pair_.fit("folder.vdb");
  EXPECT_EQ(fit.exit_code, 4);
  EXPECT_THAT(fit.err, HasSubstr("folder.vdb: is a directory"));
  EXPECT_THAT(fit.out, IsEmpty());
  EXPECT_TRUE(std::filesystem::is_empty(pair_.file("folder.vdb")));
}

TEST_F(FitCommand, RefusesAnchorsOfTheOtherDirection) {
  json anchors = read_json("anchors.json");
  for (json& anchor : anchors["pairs"]) std::swap(anchor["a"], anchor["b"]);
  write_text(pair_.file("anchors.json"), anchors.dump());
  const ProgramResult fit = pair_.fit("map.vdb");
  EXPECT_EQ(fit.exit_code, 2);
  EXPECT_THAT(fit.err, HasSubstr("are exchanged"));
  EXPECT_FALSE(std::filesystem::exists(pair_.file("map.vdb")));
}

// A ball deep inside its neighbour: no bijection takes two balls there, and the one that is made says how far
// it stays away.
TEST_F(FitCommand, WarnsOfVerticesThatTheMapMisses) {
  const TriangleMesh ball = shapes::icosphere(2);
  const auto two_balls = [&](double apart) {
    return shapes::joined(ball, shapes::moved(ball, {Matrix3::Identity(), Vector3(apart, 0.1, 0)}));
  };
  write_triangle_mesh(pair_.file("source.obj"), two_balls(3));
  const auto fit_to = [&](double apart) {
    write_triangle_mesh(pair_.file("target.obj"), two_balls(apart));
    return bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--fitted",
                    pair_.file("target.obj"), "-o", pair_.file("map.vdb"), "--quiet", "--voxel-size", "20%"});
  };
  const ProgramResult apart = fit_to(2.5), inside = fit_to(0.5);
  EXPECT_EQ(apart.exit_code, 0) << apart.err;
  EXPECT_THAT(apart.err, Not(HasSubstr("vertices unmet")));
  EXPECT_EQ(inside.exit_code, 0) << inside.err;
  EXPECT_THAT(inside.err, HasSubstr("bespoke: warning: ")) << inside.err;
  EXPECT_THAT(inside.err, HasSubstr(" vertices unmet: "));
  EXPECT_THAT(inside.err,
              HasSubstr("% of the target's diagonal, and products there with them; bespoke view"));
}

TEST_F(FitCommand, WarnsOfASourceThatIsNotOnTheTarget) {
  std::vector<std::string> coarsely = {"--quiet", "--elastic", "pffd-smooth", "--voxel-size", "20%"};
  EXPECT_THAT(pair_.fit("map.vdb", coarsely).err, Not(HasSubstr("half of the registered source")));
  TriangleMesh piece = read_triangle_mesh(pair_.file("target.obj"));
  piece.faces = piece.faces.leftCols(piece.faces.cols() / 10).eval();
  write_triangle_mesh(pair_.file("target.obj"), piece);
  ProgramResult fit = pair_.fit("map.vdb", coarsely);
  EXPECT_EQ(fit.exit_code, 2);
  EXPECT_THAT(fit.err, HasSubstr("is it the right target, all of it"));
  coarsely.push_back("--anchor-sigma=0");
  fit = pair_.fit("map.vdb", coarsely);
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.err, HasSubstr("bespoke: warning: half of the registered source lies "));
  EXPECT_THAT(fit.err, HasSubstr("check that it is the right target, all of it, with anchors of its own"));
}

TEST_F(FitCommand, WarnsOfATargetThatTheSourceLeavesUncoveredUnlessAPatchExcludesIt) {
  const std::vector<std::string> quick = {"--quiet", "--elastic", "pffd-smooth", "--voxel-size", "20%"};
  EXPECT_THAT(pair_.fit("map.vdb", quick).err, Not(HasSubstr("uncovered")));
  const TriangleMesh target = read_triangle_mesh(pair_.file("target.obj"));
  const Vector3 beside = target.vertices.rowwise().maxCoeff() + Vector3(1, 0, 0);
  const TriangleMesh ball = shapes::moved(shapes::icosphere(2), {0.4 * Matrix3::Identity(), beside});
  write_triangle_mesh(pair_.file("target.obj"), shapes::joined(target, ball));
  ProgramResult fit = pair_.fit("map.vdb", quick);
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.err, HasSubstr(" % of the target is uncovered, at most "));
  EXPECT_THAT(fit.err, HasSubstr("bespoke anchors suggest"));

  json anchors = read_json("anchors.json");
  std::vector<int> faces(static_cast<std::size_t>(ball.faces.cols()));
  std::iota(faces.begin(), faces.end(), static_cast<int>(target.faces.cols()));
  anchors["patches"] = {{{"name", "ball"}, {"b", {{"faces", faces}}}, {"exclude", true}}};
  write_text(pair_.file("anchors.json"), anchors.dump());
  fit = pair_.fit("map.vdb", quick);
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.err, Not(HasSubstr("uncovered")));
}

TEST_F(FitCommand, WarnsWhereDistancesAlongTheSurfacesToldPartsFarFromAllAnchors) {
  const TriangleMesh straight = shapes::tube();
  TriangleMesh target = straight;
  for (auto&& x : target.vertices.colwise()) x = shapes::bent(x, 110);
  write_triangle_mesh(pair_.file("source.obj"), straight);
  write_triangle_mesh(pair_.file("target.obj"), target);
  const auto fit_by = [&](std::initializer_list<int> rings) {
    json anchors;
    for (const int ring : rings)
      for (const int side : {0, 4, 8}) {
        const int vertex = ring * shapes::tube_sides + side;
        const Vector3 a = straight.vertices.col(vertex), b = target.vertices.col(vertex);
        anchors["pairs"].push_back({{"a", {a[0], a[1], a[2]}}, {"b", {b[0], b[1], b[2]}}});
      }
    write_text(pair_.file("anchors.json"), anchors.dump());
    return pair_.fit("map.vdb", {"--verbose", "--elastic", "pffd-smooth", "--voxel-size", "20%"});
  };
  const ProgramResult few = fit_by({0, 15, 30});
  EXPECT_EQ(few.exit_code, 0) << few.err;
  EXPECT_THAT(few.out, HasSubstr("\ncounterparts "));
  EXPECT_THAT(few.err,
              HasSubstr(" places far from all anchors were registered elsewhere than geodesic distances put "
                        "them; these now count as well; give pairs on those parts"));
  const ProgramResult enough = fit_by({0, 15, 30, 50, 65, 80});
  EXPECT_EQ(enough.exit_code, 0) << enough.err;
  EXPECT_THAT(enough.out + enough.err, Not(HasSubstr("counterparts")));
}

TEST_F(FitCommand, NamesAnchorsThatContradictEachOther) {
  json anchors = read_json("anchors.json");
  json twin = anchors["pairs"][0];
  twin["name"] = "twin";
  twin["a"][0] = twin["a"][0].get<double>() + 0.1;
  twin["b"][1] = twin["b"][1].get<double>() + 0.5;
  anchors["pairs"].push_back(twin);
  for (const std::size_t pair : {std::size_t(0), anchors["pairs"].size() - 1})
    anchors["pairs"][pair]["sigma"] = 0;  // exact by the file, not by an estimate
  write_text(pair_.file("anchors.json"), anchors.dump());
  const std::vector<std::string> quick = {"--quiet", "--elastic", "pffd-smooth", "--voxel-size", "20%"};
  ProgramResult fit = pair_.fit("map.vdb", quick);
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.err, HasSubstr("and \"twin\" ("));
  EXPECT_THAT(fit.err, HasSubstr("contradict each other; give those that are not exact a sigma"));
  anchors["pairs"].back().erase("sigma");
  anchors["pairs"].back()["weight"] = 1;
  write_text(pair_.file("anchors.json"), anchors.dump());
  fit = pair_.fit("map.vdb", quick);
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.err, Not(HasSubstr("contradict")));
}

TEST_F(FitCommand, LeavesDegenerateFacesOfModelsOutAndTellsThemOnce) {
  const std::vector<std::string> quick = {"--quiet", "--elastic", "pffd-smooth", "--voxel-size", "20%"};
  ASSERT_EQ(pair_.fit("plain.vdb", quick).exit_code, 0);
  const std::string hash = info("plain.vdb")["source"]["hash"];
  write_text(pair_.file("source.obj"), read_text(pair_.file("source.obj")) + "f 5 5 7\nf 8 9 8\n");
  write_text(pair_.file("target.obj"), read_text(pair_.file("target.obj")) + "f 1 2 2\n");
  const ProgramResult fit = pair_.fit("map.vdb", quick);
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.err, HasSubstr("source.obj: 2 degenerate faces, which were left out ("));
  EXPECT_THAT(fit.err, HasSubstr("a face names vertex 5 twice"));
  EXPECT_THAT(fit.err, HasSubstr("target.obj: 1 degenerate face, which was left out ("));
  EXPECT_EQ(info("map.vdb")["source"]["hash"], hash) << "the same model as without them";
  const ProgramResult measured =
      bespoke({"measure", pair_.file("map.vdb"), "--source", pair_.file("source.obj"), "--target",
               pair_.file("target.obj"), "-q"});
  EXPECT_EQ(measured.exit_code, 0) << measured.err;
  EXPECT_EQ(measured.err, "");
}

TEST_F(FitCommand, LetsAPlaceThatWasClickedTwiceShareTheBlame) {
  json anchors = read_json("anchors.json");
  json twin = anchors["pairs"][0];
  twin["name"] = "twin";
  twin["a"][0] = twin["a"][0].get<double>() + 0.001;
  const Points target = read_obj_points(pair_.file("target.obj"));
  const Vector3 b(twin["b"][0], twin["b"][1], twin["b"][2]);
  Eigen::Index vertex = 0;
  ((target.colwise() - b).colwise().norm().array() - 0.3).abs().minCoeff(&vertex);
  twin["b"] = {target(0, vertex), target(1, vertex), target(2, vertex)};
  anchors["pairs"].push_back(twin);
  for (const char* given : {"estimated", "exact"}) {
    if (given == std::string("exact"))
      for (const std::size_t pair : {std::size_t(0), anchors["pairs"].size() - 1})
        anchors["pairs"][pair]["sigma"] = 0;
    write_text(pair_.file("anchors.json"), anchors.dump());
    const ProgramResult fit = pair_.fit("map.vdb", {"--quiet", "--fitted-out", pair_.file("fitted.obj")});
    EXPECT_EQ(fit.exit_code, 0) << given << fit.err;
    EXPECT_THAT(fit.err, HasSubstr("\"p0\" gave way (sigma 0.1"));
    EXPECT_THAT(fit.err, HasSubstr("\"twin\" gave way (sigma 0.1"));
    // --max-stretch, 10, holds for the result.
    const TriangleMesh source = read_triangle_mesh(pair_.file("source.obj")),
                       fitted = read_triangle_mesh(pair_.file("fitted.obj"));
    const MeshDistortion distortion = mesh_distortion(source, fitted.vertices);
    EXPECT_LT(distortion.edge_length.max, 10) << given;
    EXPECT_GT(distortion.edge_length.min, 0.1) << given;
  }
}

// The radii of the two models differ by up to a fifth from each other's median, more than this bound.
TEST_F(FitCommand, TellsWhereTheResultIsStretchedBeyondTheBound) {
  const ProgramResult bound =
      pair_.fit("map.vdb", {"--max-stretch", "1.05", "--steps", "1", "--report", pair_.file("report.json")});
  ASSERT_EQ(bound.exit_code, 0) << bound.err;
  EXPECT_THAT(bound.err,
              AllOf(HasSubstr("edges of the source change in length by more than --max-stretch"),
                    HasSubstr(" times, around ("), HasSubstr("troubleshooting.md#over-stretched")));
  std::size_t told = 0;
  const json report = read_json("report.json");
  for (const json& stage : report["stages"]) {
    if (stage["name"] != "stretched") continue;
    ++told;
    EXPECT_GT(stage["edges"], 0);
    EXPECT_GT(stage["max_factor"], 1.05);
    EXPECT_LT(stage["max_factor"], 1.4);
    EXPECT_FALSE(stage["places"].empty());
  }
  EXPECT_EQ(told, 1u);
  EXPECT_THAT(pair_.fit("map.vdb").err, Not(HasSubstr("--max-stretch")));
}

TEST_F(FitCommand, TakesAnchorsAsCsv) {
  std::string rows = "name,ax,ay,az,bx,by,bz\n";
  const json anchors = read_json("anchors.json");
  for (const json& p : anchors["pairs"]) {
    rows += p["name"].get<std::string>();
    for (const char* side : {"a", "b"})
      for (int axis = 0; axis < 3; ++axis) rows += "," + p[side][axis].dump();
    rows += "\n";
  }
  write_text(pair_.file("anchors.csv"), rows);
  const ProgramResult fit =
      bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors",
               pair_.file("anchors.csv"), "-o", pair_.file("map.vdb"), "--tolerance", "0.5%"});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_EQ(info("map.vdb")["anchors"].size(), 14u);
}

}  // namespace
}  // namespace bespoke::test

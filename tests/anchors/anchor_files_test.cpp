#include "bespoke/anchors/anchor_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "product/text_dialects.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::error_message;
using test::ScratchDirectory;
using test::write_text;
using testing::HasSubstr;

class AnchorFiles : public testing::Test {
 protected:
  std::vector<std::filesystem::path> paths(const std::vector<std::string>& names) const {
    std::vector<std::filesystem::path> found;
    for (const std::string& name : names) found.push_back(directory_ / name);
    return found;
  }
  std::vector<std::filesystem::path> write(const std::string& name, const std::string& text) const {
    write_text(directory_ / name, text);
    return paths({name});
  }
  std::vector<std::filesystem::path> write(const std::string& first, const std::string& a,
                                           const std::string& second, const std::string& b) const {
    write_text(directory_ / first, a);
    write_text(directory_ / second, b);
    return paths({first, second});
  }

  ScratchDirectory directory_;
  TriangleMesh source_ = shapes::icosphere(2);
  TriangleMesh target_ = shapes::moved(shapes::icosphere(2), {2 * Matrix3::Identity(), Vector3(1, 2, 3)});
  AnchorFileOptions models_{&source_, &target_};
};

/// Names without blanks, points on a vertex and within a face.
Anchors two_pairs(const TriangleMesh& source, const TriangleMesh& target) {
  const auto middle = [](const TriangleMesh& mesh) {
    return Vector3((mesh.vertices.col(mesh.faces(0, 5)) + mesh.vertices.col(mesh.faces(1, 5)) +
                    mesh.vertices.col(mesh.faces(2, 5))) /
                   3);
  };
  return {
      "",
      {{"chin", source.vertices.col(7), target.vertices.col(9)}, {"nose", middle(source), middle(target)}}};
}

TEST_F(AnchorFiles, KeepPointsThroughEveryFormatOfPoints) {
  const Anchors anchors = two_pairs(source_, target_);
  const std::vector<std::vector<std::string>> files{{"x.json"},
                                                    {"x.csv"},
                                                    {"a.pp", "b.pp"},
                                                    {"a.mrk.json", "b.mrk.json"},
                                                    {"a.fcsv", "b.fcsv"},
                                                    {"a.pts", "b.pts"},
                                                    {"a.wrap.json", "b.wrap.json"}};
  for (const std::vector<std::string>& names : files) {
    write_anchor_files(paths(names), anchors, models_);
    const Anchors found = read_anchor_files(paths(names), models_);
    ASSERT_EQ(found.pairs.size(), 2u) << names[0];
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_LT((found.pairs[i].a - anchors.pairs[i].a).norm(), 1e-14) << names[0];
      EXPECT_LT((found.pairs[i].b - anchors.pairs[i].b).norm(), 1e-14) << names[0];
      const bool has_names = names[0] != "a.wrap.json";
      EXPECT_EQ(found.pairs[i].name, has_names ? anchors.pairs[i].name : "") << names[0];
    }
  }
}

TEST_F(AnchorFiles, KeepAccuracyAndUnitInTheirOwnFormats) {
  Anchors anchors = two_pairs(source_, target_);
  anchors.unit = "cm";
  anchors.pairs[0].sigma = 0.25;
  anchors.pairs[1].weight = 3;
  anchors.pairs[1].name = "a \"quoted\", name";
  for (const std::string name : {"x.json", "x.csv"}) {
    write_anchor_files(paths({name}), anchors);
    const Anchors found = read_anchor_files(paths({name}));
    EXPECT_EQ(found.pairs[0].sigma, 0.25);
    EXPECT_EQ(found.pairs[1].weight, 3);
    EXPECT_EQ(found.pairs[1].name, anchors.pairs[1].name);
    EXPECT_EQ(found.pairs[1].a, anchors.pairs[1].a);
  }
}

TEST_F(AnchorFiles, VertexNumbersAreTheNearestVertices) {
  write_anchor_files(paths({"x.txt"}), two_pairs(source_, target_), models_);
  const Anchors found = read_anchor_files(paths({"x.txt"}), models_);
  EXPECT_EQ(found.pairs[0].a, source_.vertices.col(7));
  EXPECT_EQ(found.pairs[0].b, target_.vertices.col(9));
  EXPECT_THAT(
      error_message<FormatError>([&] { read_anchor_files(write("y.txt", "3 4\n\n7 999\n"), models_); }),
      HasSubstr("y.txt:3: vertex 999 of the target's 162"));
  EXPECT_THROW(read_anchor_files(write("z.txt", "3\n"), models_), FormatError);
}

TEST_F(AnchorFiles, MeshLabsPointsMayBeSwitchedOff) {
  const auto files =
      write("a.pp",
            "<!DOCTYPE PickedPoints>\n<PickedPoints>\n <DocumentData/>\n"
            " <point z=\"3\" x=\"1\" active=\"1\" y=\"-2e-1\" name=\"A &amp; B\"/>\n"
            " <point x=\"9\" y=\"9\" z=\"9\" active=\"0\" name=\"off\"/>\n</PickedPoints>\n",
            "b.pp", "<PickedPoints><point x='1'/><point x=\"4\" y=\"5\" z=\"6\" name=\"A\"/></PickedPoints>");
  EXPECT_THAT(error_message<FormatError>([&] { read_anchor_files(files); }),
              HasSubstr("b.pp: point 0 has not all of x"));
  write_text(files[1], "<PickedPoints>\n<point x=\"4\" y=\"5\" z=\"6\"></PickedPoints>");
  EXPECT_THAT(error_message<FormatError>([&] { read_anchor_files(files); }), HasSubstr("b.pp:2: is no XML"));
  write_text(files[1], "<Points><point x=\"4\" y=\"5\" z=\"6\"/></Points>");
  EXPECT_THAT(error_message<FormatError>([&] { read_anchor_files(files); }),
              HasSubstr("b.pp: no <PickedPoints>"));
  write_text(
      files[1],
      "<PickedPoints><!-- <point x=\"0\"/> -->\n<point x='4' y='5' z='6' name='other'/></PickedPoints>");
  const Anchors found = read_anchor_files(files);
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.pairs[0].name, "A & B");
  EXPECT_EQ(found.pairs[0].a, Vector3(1, -0.2, 3));
  EXPECT_EQ(found.pairs[0].b, Vector3(4, 5, 6));
}

TEST_F(AnchorFiles, SlicersCoordinatesAreTurnedIntoThoseOfTheModels) {
  const auto markup = [](const std::string& system) {
    return R"({"markups":[{"type":"Fiducial","coordinateSystem":")" + system +
           R"(","controlPoints":[{"label":"F-1","position":[1,2,3],"positionStatus":"defined"},)"
           R"({"label":"F-2","position":[9,9,9],"positionStatus":"undefined"}]}]})";
  };
  const Anchors found = read_anchor_files(write("a.mrk.json", markup("LPS"), "b.mrk.json", markup("RAS")));
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.pairs[0].a, Vector3(1, 2, 3));
  EXPECT_EQ(found.pairs[0].b, Vector3(-1, -2, 3));
  const Anchors in_ras =
      read_anchor_files(paths({"a.mrk.json", "b.mrk.json"}), {nullptr, nullptr, PatientSystem::ras});
  EXPECT_EQ(in_ras.pairs[0].a, Vector3(-1, -2, 3));
  EXPECT_EQ(in_ras.pairs[0].b, Vector3(1, 2, 3));
  EXPECT_THROW(read_anchor_files(write("a.mrk.json", markup("XYZ"), "b.mrk.json", markup("RAS"))),
               FormatError);
}

TEST_F(AnchorFiles, OldFiducialsAreRasUnlessTheySayOtherwise) {
  const std::string row = "vtkMRMLMarkupsFiducialNode_0,1,2,3,0,0,0,1,1,1,0,tip,,\n";
  const Anchors found =
      read_anchor_files(write("a.fcsv", row, "b.fcsv", "# CoordinateSystem = LPS\r\n" + row));
  EXPECT_EQ(found.pairs[0].name, "tip");
  EXPECT_EQ(found.pairs[0].a, Vector3(-1, -2, 3));
  EXPECT_EQ(found.pairs[0].b, Vector3(1, 2, 3));
  EXPECT_THAT(
      error_message<FormatError>([&] { read_anchor_files(write("a.fcsv", "a,1,x,3\n", "b.fcsv", row)); }),
      HasSubstr("a.fcsv:1: \"x\""));
}

TEST_F(AnchorFiles, AreReadInAllDialectsOfTexts) {
  const std::string list = R"([[0,0.25,0.5]])";
  const std::string markups =
      R"({"markups":[{"type":"Fiducial","coordinateSystem":"LPS","controlPoints":[{"label":"tip","position":[1,2,3]}]}]})";
  for (const test::TextDialect& dialect : test::line_dialects()) {
    SCOPED_TRACE(dialect.name);
    const auto read = [&](const std::string& ending, const std::string& text,
                          const AnchorFileOptions& options = {}) {
      const std::string odd = dialect.of(text);
      const Anchors found = read_anchor_files(write("a" + ending, odd, "b" + ending, odd), options);
      EXPECT_EQ(found.pairs.size(), 1u);
      return found.pairs.at(0);
    };
    const AnchorPair old = read(".fcsv", "# CoordinateSystem = LPS\n1,1,2,3,0,0,0,1,1,1,0,\"tip, left\",,\n");
    EXPECT_EQ(old.name, "tip, left");
    EXPECT_EQ(old.b, Vector3(1, 2, 3));
    EXPECT_EQ(read(".pts", "Version 1.0\n1\ntip 1 2 3\n").a, Vector3(1, 2, 3));
    EXPECT_EQ(read(".mrk.json", markups + "\n").a, Vector3(1, 2, 3));
    EXPECT_EQ(
        read(".pp", "<PickedPoints>\n<point x=\"1\" y=\"2\" z=\"3\" name=\"tip\"/>\n</PickedPoints>\n").a,
        Vector3(1, 2, 3));
  }
  write("list.json", test::bom + list + "\n", "plain.json", " {}");
  EXPECT_EQ(anchor_format_of(paths({"list.json"})[0]), AnchorFormat::wrap);
  EXPECT_EQ(anchor_format_of(paths({"plain.json"})[0]), AnchorFormat::json);
  const std::string wide = test::utf16("Version 1.0\n1\ntip 1 2 3\n", true, true);
  EXPECT_THAT(error_message<FormatError>([&] { read_anchor_files(write("a.pts", wide, "b.pts", wide)); }),
              HasSubstr(".pts: is UTF-16; save as UTF-8"));
}

TEST_F(AnchorFiles, ACommaInANameIsKept) {
  Anchors anchors;
  anchors.pairs.push_back({"chin, left", Vector3(1, 2, 3), Vector3(4, 5, 6)});
  anchors.pairs.push_back({"say \"x\"", Vector3(7, 8, 9), Vector3(4, 5, 6)});
  write_anchor_files(paths({"a.fcsv", "b.fcsv"}), anchors);
  const Anchors found = read_anchor_files(paths({"a.fcsv", "b.fcsv"}));
  ASSERT_EQ(found.pairs.size(), 2u);
  EXPECT_EQ(found.pairs[0].name, "chin, left");
  EXPECT_EQ(found.pairs[1].name, "say \"x\"");
  EXPECT_EQ(found.pairs[1].a, Vector3(7, 8, 9));
}

TEST_F(AnchorFiles, PointsOfOneNameArePairsInAnyOrder) {
  const auto files = write("a.pts", "Version 1.0\n2\nS000 1 2 3\nS001 4 5 6\n", "b.pts",
                           "Version 1.0\n2\nS001 40 50 60\nS000 10 20 30\n");
  const Anchors found = read_anchor_files(files);
  EXPECT_EQ(found.pairs[0].b, Vector3(10, 20, 30));
  EXPECT_EQ(found.pairs[1].b, Vector3(40, 50, 60));
  EXPECT_THROW(read_anchor_files(write("a.pts", "Version 1.0\n3\nS000 1 2 3\n", "b.pts", "")), FormatError);
}

TEST_F(AnchorFiles, RefuseMissingSidesModelsAndEndings) {
  const auto message = [&](const std::vector<std::string>& names, const AnchorFileOptions& options) {
    return error_message<InvalidInput>([&] { read_anchor_files(paths(names), options); });
  };
  EXPECT_THAT(message({"a.pp"}, {}), HasSubstr("one file a side"));
  EXPECT_THAT(message({"a.csv", "b.csv"}, {}), HasSubstr("both sides in one file"));
  EXPECT_THAT(message({"a.pp", "b.pts"}, {}), HasSubstr("another format"));
  EXPECT_THAT(message({"a.wrap.json", "b.wrap.json"}, {}), HasSubstr("give both"));
  EXPECT_THAT(message({"a.xml"}, {}), HasSubstr("unknown ending"));
  EXPECT_THROW(read_anchor_files(paths({"a.pp", "b.pp"})), FileError);
}

// ---- curves

/// One closed with fixed points, one open.
std::vector<AnchorCurve> two_curves() {
  const Points ring{{0, 1, 1, 0.1}, {0, 0, 1, 1}, {0, 0.5, 0, 0}};
  return {{"waist", ring, 2 * ring.rightCols(3), true, {{0, 0}, {2, 1}}},
          {"seam", ring.leftCols(2), 3 * ring, false}};
}

TEST_F(AnchorFiles, MarkupsKeepCurvesOfBothSystems) {
  Anchors anchors = two_pairs(source_, target_);
  anchors.curves = two_curves();
  for (const PatientSystem system : {PatientSystem::lps, PatientSystem::ras}) {
    const AnchorFileOptions options{nullptr, nullptr, system};
    write_anchor_files(paths({"a.mrk.json", "b.mrk.json"}), anchors, options);
    const Anchors found = read_anchor_files(paths({"a.mrk.json", "b.mrk.json"}), options);
    EXPECT_EQ(found.pairs.size(), anchors.pairs.size());
    ASSERT_EQ(found.curves.size(), anchors.curves.size());
    for (std::size_t k = 0; k < found.curves.size(); ++k) {
      EXPECT_EQ(found.curves[k].name, anchors.curves[k].name);
      EXPECT_EQ(found.curves[k].closed, anchors.curves[k].closed);
      EXPECT_EQ(found.curves[k].a, anchors.curves[k].a);
      EXPECT_EQ(found.curves[k].b, anchors.curves[k].b);
      EXPECT_TRUE(found.curves[k].fixed.empty());
    }
  }
}

/// Several lists, as 3D Slicer has them.
std::string markups(const std::string& lists) { return R"({"markups": [)" + lists + "]}"; }

std::string list_of(const std::string& type, const std::string& name, const std::string& controls) {
  return R"({"type": ")" + type + R"(", "name": ")" + name + R"(", "controlPoints": [)" + controls + "]}";
}

const std::string two_places = R"({"position": [0,0,0]}, {"position": [1,0,0]})";
const std::string three_places = R"({"position": [5,0,0]}, {"position": [6,0,0]}, {"position": [6,7,0]})";

TEST_F(AnchorFiles, CurvesOfOneNameBelongTogetherInAnyOrder) {
  const std::string a =
      markups(list_of("Fiducial", "F", two_places) + "," + list_of("Curve", "seam", two_places) + "," +
              list_of("ClosedCurve", "waist", three_places));
  const std::string b =
      markups(list_of("ClosedCurve", "waist", three_places) + "," + list_of("Curve", "seam", three_places) +
              "," + list_of("Fiducial", "F", two_places));
  const Anchors found = read_anchor_files(write("a.mrk.json", a, "b.mrk.json", b));
  EXPECT_EQ(found.pairs.size(), 2u);
  ASSERT_EQ(found.curves.size(), 2u);
  EXPECT_EQ(found.curves[0].name, "seam");
  EXPECT_EQ(found.curves[0].a.cols(), 2);
  EXPECT_EQ(found.curves[0].b.cols(), 3);
  EXPECT_TRUE(found.curves[1].closed);
}

TEST_F(AnchorFiles, MarkupsThatAreNoneNameTheirPlace) {
  const auto message = [&](const std::string& a, const std::string& b) {
    return error_message<FormatError>([&] { read_anchor_files(write("a.mrk.json", a, "b.mrk.json", b)); });
  };
  const std::string open = markups(list_of("Curve", "seam", two_places));
  const std::string closed = markups(list_of("ClosedCurve", "seam", three_places));
  EXPECT_THAT(message(open, closed), testing::AllOf(HasSubstr("curve 0 (\"seam\") is closed in"),
                                                    HasSubstr("b.mrk.json and open in")));
  EXPECT_THAT(message(open, markups("")), HasSubstr("a.mrk.json has 1 curves"));
  EXPECT_THAT(message(open, markups(list_of("Curve", "seam", R"({"position": [0,0,0]})"))),
              HasSubstr("b.mrk.json: markup 0: a curve has two control points"));
  EXPECT_THAT(message(open, markups(list_of("Plane", "P", two_places))), HasSubstr("is of type \"Plane\""));
  EXPECT_THAT(message(open, markups(list_of("Fiducial", "F", two_places + R"(, {"position": [1,"x",0]})"))),
              HasSubstr("markup 0: control point 2: \"position\" is not three numbers"));
  EXPECT_THAT(message(open, markups("7")), HasSubstr("b.mrk.json: markup 0 is no object"));
  EXPECT_THAT(message(open, R"({"pairs": []})"), HasSubstr("b.mrk.json: has no list \"markups\""));
  EXPECT_THAT(message(open, "{"), HasSubstr("b.mrk.json: not valid JSON"));
}

TEST_F(AnchorFiles, PlacesOfTrianglesAreATriangleAndTwoNumbers) {
  const auto message = [&](const std::string& b) {
    return error_message<FormatError>(
        [&] { read_anchor_files(write("a.wrap.json", "[[0, 0.5, 0.25]]", "b.wrap.json", b), models_); });
  };
  EXPECT_EQ(message("[[319, 0, 1]]"), "accepted");
  EXPECT_THAT(message("[[320, 0, 1]]"), HasSubstr("b.wrap.json: point 0: triangle 320 of 320"));
  EXPECT_THAT(message("[[1.5, 0, 1]]"), HasSubstr("point 0 is not [triangle, u, v]"));
  EXPECT_THAT(message("[[0, 0, 1], [0, 0]]"), HasSubstr("point 1 is not [triangle, u, v]"));
  EXPECT_THAT(message("{}"), HasSubstr("b.wrap.json: is no list"));
}

TEST_F(AnchorFiles, SayWhatAFormatHasNoPlaceFor) {
  Anchors anchors = two_pairs(source_, target_);
  EXPECT_EQ(left_out(anchors, AnchorFormat::csv), "");
  EXPECT_EQ(left_out(anchors, AnchorFormat::indices), "the names of 2 pairs");
  anchors.unit = "cm";
  anchors.pairs[0].sigma = 0.25;
  anchors.curves = two_curves();
  anchors.patches = {{"hair", {Points(3, 0), {3}}, {}, true}};
  EXPECT_EQ(left_out(anchors, AnchorFormat::json), "");
  EXPECT_EQ(left_out(anchors, AnchorFormat::csv), "the unit (cm), 2 curves, 1 patch");
  EXPECT_EQ(left_out(anchors, AnchorFormat::meshlab),
            "the unit (cm), the accuracies of 1 pair, 2 curves, 1 patch");
  EXPECT_EQ(left_out(anchors, AnchorFormat::markups),
            "the unit (cm), the accuracies of 1 pair, the fixed points of 1 curve, 1 patch");
}

}  // namespace
}  // namespace bespoke

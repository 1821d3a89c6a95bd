#include "bespoke/pattern/write_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "bespoke/error.h"
#include "bespoke/pattern/sheet/seam_allowance.h"
#include "bespoke/unknown_ending.h"
#include "pattern/tubes.h"
#include "support/file_text.h"
#include "support/run_program.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double drawn = 0.01;  // millimetres

/// A rectangle of this size in millimetres, of a tube.
struct Rectangle {
  double height = 400;
  double width = 36 * test::side_of(36, 60);

  FlatPattern pattern(double scale = 1) const {
    Garment garment = test::garment_of(test::tube(36, 20, 60, height));
    garment.mesh.vertices *= scale;
    PatternOptions options;
    options.cut.auto_cut = true;
    return flat_pattern(garment, nullptr, options);
  }
  double outline() const { return 2 * (height + width); }
};

double length(const std::vector<Eigen::Vector2d>& points, bool is_closed) {
  double sum = 0;
  for (std::size_t k = 0; k + (is_closed ? 0 : 1) < points.size(); ++k)
    sum += (points[(k + 1) % points.size()] - points[k]).norm();
  return sum;
}

class WrittenPatterns : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const SheetOptions& options = {},
                              const PatternFileOptions& file = {.name = "tube"}) const {
    const FlatPattern pattern = rectangle_.pattern();
    write_pattern(directory_ / name, pattern, pattern_sheet(pattern, options), file);
    return directory_ / name;
  }
  /// What a program prints on a line of its own behind "name ".
  static std::string value(const std::string& text, const std::string& name) {
    std::smatch match;
    return std::regex_search(text, match, std::regex(name + " (.*)")) ? match[1].str() : "";
  }

  Rectangle rectangle_;
  test::ScratchDirectory directory_;
};

// The paths of the file, read by a reader of this test's own.
TEST_F(WrittenPatterns, SvgIsInMillimetres) {
  const std::string text = test::read_text(write("a.svg", {.seam_allowance = 10}));
  std::smatch match;
  ASSERT_TRUE(std::regex_search(
      text, match,
      std::regex("width=\"([0-9.]+)mm\" height=\"([0-9.]+)mm\" viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
  EXPECT_EQ(match[1], match[3]);
  EXPECT_EQ(match[2], match[4]);
  const auto length_in = [&](const std::string& id) {
    std::smatch path;
    const std::regex pattern("id=\"" + id + "\"[^>]*>\\s*<path d=\"M([^\"]*) Z\"");
    if (!std::regex_search(text, path, pattern)) return 0.0;
    std::string numbers = path[1];
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    std::istringstream in(numbers);
    std::vector<Eigen::Vector2d> points;
    for (double x = 0, y = 0; in >> x >> y;) points.emplace_back(x, y);
    return length(points, true);
  };
  EXPECT_NEAR(length_in("piece-sew"), rectangle_.outline(), drawn);
  EXPECT_NEAR(length_in("piece-boundary"), rectangle_.outline() + 8 * 10, drawn);
  EXPECT_NEAR(length_in("test-square"), 4 * 50, drawn);
}

// ezdxf 0.18 gives the ends of polylines in blocks of R12 no owner, also in files of its own; it then fixes
// that.
TEST_F(WrittenPatterns, DxfPassesTheAuditOfEzdxf) {
  const char* reader =
      "import sys, ezdxf\n"
      "doc = ezdxf.readfile(sys.argv[1]); audit = doc.audit()\n"
      "print('version', doc.dxfversion); print('errors', len(audit.errors)); print('fixes', "
      "len([f for f in audit.fixes if 'SEQEND' not in f.message]))\n"
      "block = [b for b in doc.blocks if b.name.startswith('P1_')][0]\n"
      "print('block', block.name); print('layers', sorted({e.dxf.layer for e in block}, key=int))\n"
      "import math\n"
      "for e in block.query('POLYLINE'):\n"
      "    p = [v.dxf.location for v in e.vertices]\n"
      "    print('length' + e.dxf.layer, sum((p[i] - p[i-1]).magnitude for i in range(len(p))))\n";
  if (test::run_program({"/usr/bin/python3", "-c", "import ezdxf"}).exit_code != 0)
    GTEST_SKIP() << "python3-ezdxf is missing: tools/setup --tests";
  const test::ProgramResult result =
      test::run_program({"/usr/bin/python3", "-c", reader, write("a.dxf", {.seam_allowance = 10}).string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(value(result.out, "version"), "AC1009");
  EXPECT_EQ(value(result.out, "errors"), "0");
  EXPECT_EQ(value(result.out, "fixes"), "0");
  EXPECT_EQ(value(result.out, "block"), "P1_PIECE");
  EXPECT_EQ(value(result.out, "layers"), "['1', '4', '7', '8', '14', '15']");
  EXPECT_NEAR(std::stod(value(result.out, "length14")), rectangle_.outline(), drawn);
  EXPECT_NEAR(std::stod(value(result.out, "length1")), rectangle_.outline() + 8 * 10, drawn);
}

TEST_F(WrittenPatterns, PdfHasPagesOfItsPaper) {
  if (test::run_program({"pdfinfo", "-v"}).exit_code != 0)
    GTEST_SKIP() << "pdfinfo is missing: tools/setup --tests";
  const auto info = [&](PaperSize paper) {
    return test::run_program({"pdfinfo", write("a.pdf", {}, {.name = "tube", .paper = paper}).string()}).out;
  };
  EXPECT_THAT(info(PaperSize::a4), HasSubstr("595.276 x 841.89 pts (A4)"));
  EXPECT_THAT(info(PaperSize::letter), HasSubstr("612 x 792 pts (letter)"));
  EXPECT_EQ(value(info(PaperSize::roll), "Pages: *"), "1");
  const std::string once = test::read_text(write("a.pdf")), again = test::read_text(write("b.pdf"));
  EXPECT_EQ(once, again);
}

TEST_F(WrittenPatterns, JsonHasVerticesAndSeams) {
  const nlohmann::json json = nlohmann::json::parse(test::read_text(write("a.json")));
  EXPECT_EQ(json["unit"], "mm");
  ASSERT_EQ(json["pieces"].size(), 1u);
  std::vector<Eigen::Vector2d> outline;
  for (const int v : json["pieces"][0]["outline"]) {
    const auto& x = json["pieces"][0]["vertices"][static_cast<std::size_t>(v)];
    outline.emplace_back(x[0], x[1]);
  }
  EXPECT_NEAR(length(outline, true), rectangle_.outline(), drawn);
  EXPECT_NEAR(json["seams"][0]["sides"][1]["length"], rectangle_.height, drawn);
}

TEST_F(WrittenPatterns, GlbIsFlatAndMorphsToTheGarment) {
  const std::string glb = test::read_text(write("a.glb"));
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_THAT(glb, HasSubstr("\"targets\""));
}

TEST_F(WrittenPatterns, RefuseOtherEndings) { EXPECT_THROW(write("a.png"), UnknownEnding); }

TEST(NestedSheet, HasALayerASizeWithOneCentre) {
  const Rectangle rectangle;
  std::vector<SizedPattern> sizes{{"38", rectangle.pattern()}, {"42", rectangle.pattern(1.1)}};
  const Sheet sheet = nested_sheet(sizes);
  ASSERT_EQ(sheet.pieces.size(), 2u);
  EXPECT_NEAR((sheet.pieces[0].box.center() - sheet.pieces[1].box.center()).norm(), 0, drawn);
  const test::ScratchDirectory directory;
  write_sheet(directory / "a.svg", sheet, {.name = "tube"});
  EXPECT_THAT(test::read_text(directory / "a.svg"), HasSubstr("inkscape:label=\"size 42\""));
  write_sheet(directory / "a.dxf", sheet, {.name = "tube"});
  EXPECT_THAT(test::read_text(directory / "a.dxf"), HasSubstr("SIZE_P42"));
  EXPECT_THROW(write_sheet(directory / "a.json", sheet, {}), UnknownEnding);
}

TEST(WithAllowance, IsMitredOrSquared) {
  Eigen::Matrix2Xd quad(2, 4);
  quad << 0, 100, 100, 0, 0, 0, 100, 100;
  const auto mitred = with_allowance(quad, 10, AllowanceCorners::mitred);
  ASSERT_EQ(mitred.size(), 1u);
  EXPECT_NEAR(length(mitred[0], true), 4 * 120, drawn);
  const auto squared = with_allowance(quad, 10, AllowanceCorners::squared);
  EXPECT_EQ(squared[0].size(), 8u);
  EXPECT_LT(length(squared[0], true), length(mitred[0], true));
}

}  // namespace
}  // namespace bespoke

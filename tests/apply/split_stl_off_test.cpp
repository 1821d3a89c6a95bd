#include <gmock/gmock.h>

#include "apply/split_files.h"

namespace bespoke {
namespace {

using test::bytes;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using SplitStl = test::SplitFiles;
using SplitOff = test::SplitFiles;

/// A facet whose edges along x are split, the longest first.
const std::string facet_lines =
    "  Facet Normal 0.6 0 .8\n"
    "    outer loop\n"
    "      vertex 0 0 0\n"
    "      vertex 4.0e0  0 0\n"
    "      vertex 4 1 0\n"
    "    endloop\n"
    "  endfacet\n";

std::string facet_of(const std::string& a, const std::string& b, const std::string& c) {
  return "  Facet Normal 0.6 0 .8\n    outer loop\n      vertex " + a + "\n      vertex " + b +
         "\n      vertex " + c + "\n    endloop\n  endfacet\n";
}

// The second facet has no area, and the third lies straight across x.
const std::string other_facets =
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 0 0 0\nendloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n";

TEST_F(SplitStl, KeepsWhatATextSays) {
  const std::string text = "solid my part\n" + other_facets + facet_lines + "endsolid my part\n";
  const std::string middle = "2.0000000 0.5000000 0.0000000", low = "2.0000000 0.0000000 0.0000000";
  EXPECT_EQ(split("a.stl", text, 1.1), "solid my part\n" + other_facets + facet_of(middle, "0 0 0", low) +
                                           facet_of(middle, low, "4.0e0  0 0") +
                                           facet_of("4 1 0", middle, "4.0e0  0 0") + "endsolid my part\n");
  EXPECT_EQ(split("a.stl", text, 9), text);
}

TEST_F(SplitStl, EndsNewLinesAsTheFileDoes) {
  std::string text;
  for (const char c : "solid\n" + facet_lines + "endsolid\n") text += c == '\n' ? "\r\n" : std::string(1, c);
  const std::string out = split("a.stl", text, 1.1);
  EXPECT_GT(out.size(), text.size());
  for (std::size_t at = out.find('\n'); at != std::string::npos; at = out.find('\n', at + 1))
    ASSERT_EQ(out[at - 1], '\r') << at;
}

std::string packed_facet(const std::vector<float>& corners, std::uint16_t word) {
  std::string facet;
  for (const float value : {0.6F, 0.0F, 0.8F}) facet += bytes(value);
  for (const float value : corners) facet += bytes(value);
  return facet + bytes(word);
}

TEST_F(SplitStl, KeepsWhatBytesSay) {
  const std::string head = "colours of a part" + std::string(63, '\7');
  const std::string others =
      packed_facet({0, 0, 0, 4, 0, 0, 0, 0, 0}, 3) + packed_facet({0, 0, 0, 0, 1, 0, 0, 0, 1}, 4);
  const std::string file = head + bytes(3u) + others + packed_facet({0, 0, 0, 4, 0, 0, 4, 1, 0}, 0xabcd);
  EXPECT_EQ(split("a.stl", file, 1.1), head + bytes(5u) + others +
                                           packed_facet({2, 0.5, 0, 0, 0, 0, 2, 0, 0}, 0xabcd) +
                                           packed_facet({2, 0.5, 0, 2, 0, 0, 4, 0, 0}, 0xabcd) +
                                           packed_facet({4, 1, 0, 2, 0.5, 0, 4, 0, 0}, 0xabcd));
  EXPECT_EQ(split("a.stl", file, 9), file);
}

TEST_F(SplitStl, IsTheRefinedProduct) {
  for (const double length : {0.1, 0.02}) {
    split("a.stl", "solid\n" + other_facets + facet_lines + "endsolid\n", length);
    const Product read = read_product(directory_ / "out_a.stl");
    ASSERT_EQ(read.polygon_start, refined_.product.polygon_start);
    EXPECT_LT((read.vertices(Eigen::all, read.corners) -
               refined_.product.vertices(Eigen::all, refined_.product.corners))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6);
  }
}

TEST_F(SplitOff, KeepsWhatTheFileSays) {
  const std::string text =
      "# made by hand\n"
      "STCNOFF 3 1 3 # counts\n"
      "0 0 0  0 0 1  10 20 30 255  0 0 # first\n"
      "4 0 0  0 1 0  21 20 30 255  1 0\n"
      "4 1 0  0 0 1  30 20 30 255  1 1\n"
      "# faces\n"
      "3 0 1 2  9 8 7 # split\n";
  EXPECT_EQ(split("a.off", text, 9), text);
  EXPECT_EQ(split("a.off", text, 1.1),
            "# made by hand\n"
            "STCNOFF 5 3 7 # counts\n"
            "0 0 0  0 0 1  10 20 30 255  0 0 # first\n"
            "4 0 0  0 1 0  21 20 30 255  1 0\n"
            "4 1 0  0 0 1  30 20 30 255  1 1\n"
            "2.0000000 0.0000000 0.0000000 0.000000 0.707107 0.707107 16 20 30 255 0.500000 0.000000\n"
            "2.0000000 0.5000000 0.0000000 0.000000 0.000000 1.000000 20 20 30 255 0.500000 0.500000\n"
            "# faces\n"
            "3 4 0 3 9 8 7\n3 4 3 1 9 8 7\n3 2 4 1 9 8 7 # split\n");
}

// Colours with a point are shares of one; polygons get further corners.
TEST_F(SplitOff, KnowsRealColoursAndPolygons) {
  const std::string out = split("a.off",
                                "COFF\r\n4 1 0\r\n0 0 0 1 0 0.5 1\r\n4 0 0 0 0 0 1\r\n4 1 0 0 0 0 1\r\n"
                                "0 1 0 0 0 0 1\r\n4 0 1 2 3 7\r\n",
                                1.1);
  EXPECT_THAT(out, StartsWith("COFF\r\n6 1 0\r\n"));
  EXPECT_THAT(out, HasSubstr("2.0000000 0.0000000 0.0000000 0.500000 0.000000 0.250000 1.000000\r\n"));
  EXPECT_THAT(out, HasSubstr("\r\n6 0 4 1 2 5 3 7\r\n"));
}

TEST_F(SplitOff, IsTheRefinedProduct) {
  split("a.off", "5 2 0\n0 0 0\n4 0 0\n4 1 0\n-3 2 1\n-1 3 1\n3 0 1 2\n4 0 2 4 3\n", 0.05);
  const Product read = read_product(directory_ / "out_a.off");
  EXPECT_EQ(read.polygon_start, refined_.product.polygon_start);
  EXPECT_EQ(read.corners, refined_.product.corners);
  EXPECT_LT((read.vertices - refined_.product.vertices).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace bespoke

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <sstream>

#include "apply/split_files.h"

namespace bespoke {
namespace {

using SplitPly = test::SplitFiles;
using test::bytes;
using ::testing::HasSubstr;

std::string ply_header(const std::string& format, int vertices, int faces, const std::string& index = "int") {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nelement camera 1\nproperty list uchar float view\n" + "element vertex " +
         std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
         "property float nz\nproperty uchar red\nproperty int name\nelement face " +
         std::to_string(faces) + "\nproperty uchar flags\nproperty list uchar " + index +
         " vertex_indices\nproperty list uchar float texcoord\nend_header\n";
}

// A triangle whose edges along x are split, the longest first; a second lies straight across x.
const std::string body_lines =
    "2 9 9.5\n"
    "0 0 0 0 0 1 10 7\n"
    "4 0 0 0 1 0 20 8\n"
    "4 1 0 0 0 1 31 9\n"
    "4 1 1 0 0 2 0 -1\n"
    "1 3 0 1 2 6 0 0 1 0 1 1\n"
    "2 3 1 2 3 0\n";

const std::string split_body_lines =
    "2 9 9.5\n"
    "0 0 0 0 0 1 10 7\n"
    "4 0 0 0 1 0 20 8\n"
    "4 1 0 0 0 1 31 9\n"
    "4 1 1 0 0 2 0 -1\n"
    "2.0000000 0.0000000 0.0000000 0.000000 0.707107 0.707107 15 7\n"
    "2.0000000 0.5000000 0.0000000 0.000000 0.000000 1.000000 21 7\n"
    "1 3 5 0 4 6 0.500000 0.500000 0 0 0.500000 0.000000\n"
    "1 3 5 4 1 6 0.500000 0.500000 0.500000 0.000000 1 0\n"
    "1 3 2 5 1 6 1 1 0.500000 0.500000 1 0\n"
    "2 3 1 2 3 0\n";

/// The lines as a binary file has them. Normals are as long there as a float can tell.
std::string packed(const std::string& text, bool big) {
  std::istringstream stream(text);
  std::string body;
  const auto floats = [&](int count) {
    for (float value = 0; count > 0 && stream >> value; --count)
      body += bytes(value == 0.707107F ? std::sqrt(0.5F) : value, big);
  };
  const auto whole = [&] {
    int value = 0;
    stream >> value;
    return value;
  };
  const auto octet = [&] {
    const int value = whole();
    body += bytes(static_cast<std::uint8_t>(value));
    return value;
  };
  const auto vertices = std::count(text.begin(), text.end(), '\n') == 7 ? 4 : 6;
  floats(octet());
  for (int i = 0; i < vertices; ++i) {
    floats(6);
    octet();
    body += bytes(whole(), big);
  }
  while (stream >> std::ws && stream.good()) {
    octet();
    for (int corners = octet(); corners > 0; --corners) body += bytes(whole(), big);
    floats(octet());
  }
  return body;
}

TEST_F(SplitPly, KeepsWhatATextSays) {
  EXPECT_EQ(split("a.ply", ply_header("ascii", 4, 2) + body_lines, 1.1),
            ply_header("ascii", 6, 4) + split_body_lines);
  EXPECT_EQ(split("a.ply", ply_header("ascii", 4, 2) + body_lines, 9),
            ply_header("ascii", 4, 2) + body_lines);
}

// Numbers of a face that is split are words: exponents, infinities and signs stay as they were written.
TEST_F(SplitPly, KeepsTheWordsOfAFaceThatIsSplit) {
  const std::string out =
      split("a.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty float area\nproperty list uchar int vertex_indices\n"
            "property list uchar double tags\nend_header\n0 0 0\n4 0 0\n4 1 0\n"
            "1.5e20 3 0 1 2 4 inf -0 +1E3 NaN\n",
            1.1);
  EXPECT_THAT(out, HasSubstr("\n1.5e20 3 4 0 3 4 inf -0 +1E3 NaN\n1.5e20 3 4 3 1 4 inf -0 +1E3 NaN\n"
                             "1.5e20 3 2 4 1 4 inf -0 +1E3 NaN\n"));
}

TEST_F(SplitPly, KeepsWhatBytesSay) {
  for (const bool big : {false, true}) {
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    EXPECT_EQ(split("a.ply", ply_header(format, 4, 2) + packed(body_lines, big), 1.1),
              ply_header(format, 6, 4) + packed(split_body_lines, big));
  }
}

TEST_F(SplitPly, EndsNewLinesAsTheHeaderDoes) {
  std::string text;
  for (const char c : ply_header("ascii", 4, 2) + body_lines) text += c == '\n' ? "\r\n" : std::string(1, c);
  const std::string out = split("a.ply", text, 1.1);
  for (std::size_t at = out.find('\n'); at != std::string::npos; at = out.find('\n', at + 1))
    ASSERT_EQ(out[at - 1], '\r') << at;
}

TEST_F(SplitPly, BeginsANewLineBehindAVertexAtTheEndOfTheFile) {
  const std::string out =
      split("a.ply",
            "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n"
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n3 0 1 2\n0 0 0\n4 0 0\n4 1 0",
            1.1);
  EXPECT_THAT(out, HasSubstr("\n4 1 0\n2.0000000 0.0000000 0.0000000\n2.0000000 0.5000000 0.0000000\n"));
}

// The last of 256 vertices has the last number that a byte holds.
TEST_F(SplitPly, NamesTheTypeThatHoldsNoNumberOfANewVertex) {
  std::string text =
      ply_header("ascii", 256, 1, "uchar") + "0\n0 0 0 0 0 1 0 0\n4 0 0 0 0 1 0 0\n4 1 0 0 0 1 0 0\n";
  for (int i = 3; i < 256; ++i) text += "0 0 0 0 0 1 0 0\n";
  EXPECT_THAT(test::error_message<InvalidInput>([&] { split("a.ply", text + "0 3 0 1 2 0\n", 1.1); }),
              HasSubstr("the type of the property vertex_indices of the element face does not hold 257,"));
}

/// Polygons of a random cloud, in every encoding.
std::string random_ply(std::mt19937& random, const std::string& format) {
  std::uniform_real_distribution<float> coordinate(-2, 2);
  constexpr int vertices = 12, faces = 9;
  std::ostringstream text;
  text.precision(9);
  std::string body;
  const auto add = [&](auto value) {
    body += bytes(value, format == "binary_big_endian");
    text << +value << ' ';
  };
  for (int i = 0; i < vertices; ++i) {
    for (int k = 0; k < 3; ++k) add(coordinate(random));
    text << '\n';
  }
  for (int i = 0; i < faces; ++i) {
    const auto corners = static_cast<std::uint8_t>(std::uniform_int_distribution<int>(3, 5)(random));
    add(corners);
    const int first = std::uniform_int_distribution<int>(0, vertices - 1)(random);
    for (int k = 0; k < corners; ++k) add((first + 2 * k) % vertices);
    add(static_cast<std::uint8_t>(100 + i));
    text << '\n';
  }
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nproperty uchar number\nend_header\n" +
         (format == "ascii" ? text.str() : body);
}

TEST_F(SplitPly, IsTheRefinedProduct) {
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    std::mt19937 random(11);
    for (int round = 0; round < 20; ++round) {
      split("a.ply", random_ply(random, format), 0.05);
      const Product read = read_product(directory_ / "out_a.ply");
      const Product& expected = refined_.product;
      ASSERT_EQ(read.vertices.cols(), expected.vertices.cols());
      EXPECT_EQ(read.polygon_start, expected.polygon_start);
      EXPECT_EQ(read.corners, expected.corners);
      EXPECT_LT((read.vertices - expected.vertices).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

const std::string lines_header =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element edge 2\nproperty uchar width\nproperty int vertex1\nproperty int vertex2\nend_header\n";

TEST_F(SplitPly, SplitsLinesAndKeepsTheRestOfTheirRecords) {
  const std::string vertices = "8 0 9\n-8 2 9\n-8 3 9\n";
  const std::string out = split("lines.ply", lines_header + vertices + "7 0 1\n9 1 2\n", 9);
  EXPECT_THAT(out, HasSubstr("element vertex 4\n"));
  EXPECT_THAT(out, HasSubstr("element edge 3\n"));
  EXPECT_THAT(out, ::testing::EndsWith(vertices + "0.000000 1.000000 9.000000\n7 0 3\n7 3 1\n9 1 2\n"));
  const Product read = read_product(file("split.ply", out));
  EXPECT_EQ(read.line_edges, (std::vector<int>{0, 3, 3, 1, 1, 2}));
  EXPECT_EQ(split("lines.ply", lines_header + vertices + "7 0 1\n9 1 2\n", 900),
            lines_header + vertices + "7 0 1\n9 1 2\n");
}

TEST_F(SplitPly, NamesTheLineThatEndsNowhere) {
  EXPECT_THAT(test::error_message<FormatError>([&] {
                read_product(file("lines.ply", lines_header + "8 0 9\n-8 2 9\n-8 3 9\n7 0 1\n9 1 3\n"));
              }),
              HasSubstr("lines.ply: edge 1: "));
}

}  // namespace
}  // namespace bespoke

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <sstream>

#include "apply/split_files.h"
#include "bespoke/apply/chord_error.h"

namespace bespoke {
namespace {

using test::identity_motion;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using SplitProduct = test::SplitFiles;

// A triangle whose two edges along x are split, the longer one first. What stands behind it names vertices by
// numbers that grow, or by numbers that count back, which grow only where they reach back over new vertices.
const std::string everything =
    "# made by hand\n"
    "mtllib cloth.mtl\n"
    "o first\n"
    "v 0 0 0 1 0 0\n"
    "v 4 0 0 0 1 0\n"
    "v 4 1 0 0 0 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\n"
    "vn 0 0 1\nvn 0 1 0\n"
    "g left\nusemtl red\ns 1\n"
    "f 1/1/1 2/2/1 3/3/2 # kept\n"
    "l -3 -2\n"
    "o second\n"
    "v 9 0 0\nv 9 1 0\nv 9 0 1\n"
    "usemtl blue\n"
    "f 4 5 6\n"
    "f -3 -2 -1\n"
    "p 6\n";

TEST_F(SplitProduct, KeepsWhatAnObjFileSays) {
  EXPECT_EQ(split("a.obj", everything, 1.1),
            "# made by hand\n"
            "mtllib cloth.mtl\n"
            "o first\n"
            "v 0 0 0 1 0 0\n"
            "v 4 0 0 0 1 0\n"
            "v 4 1 0 0 0 1\n"
            "vt 0 0\nvt 1 0\nvt 1 1\n"
            "vn 0 0 1\nvn 0 1 0\n"
            "g left\nusemtl red\ns 1\n"
            "v 2.0000000 0.5000000 0.0000000 0.500000 0.000000 0.500000\n"
            "v 2.0000000 0.0000000 0.0000000 0.500000 0.500000 0.000000\n"
            "vt 0.500000 0.500000\n"
            "vt 0.500000 0.000000\n"
            "vn 0.000000 0.707107 0.707107\n"
            "f 4/4/3 1/1/1 5/5/1\n"
            "f 4/4/3 5/5/1 2/2/1\n"
            "f 3/3/2 4/4/3 2/2/1 # kept\n"
            "l 1 5 2\n"
            "o second\n"
            "v 9 0 0\nv 9 1 0\nv 9 0 1\n"
            "usemtl blue\n"
            "f 6 7 8\n"
            "f -3 -2 -1\n"
            "p 8\n");
}

TEST_F(SplitProduct, SplitsLines) {
  EXPECT_EQ(split("a.obj", "v -8 0 9\nv 8 2 9\nv 8 3 9\nvt 0\nvt 1\nl 1/1 2/2 # kept\nl -1 -2\np 3\n", 9),
            "v -8 0 9\nv 8 2 9\nv 8 3 9\nvt 0\nvt 1\n"
            "v 0.000000 1.000000 9.000000\nvt 0.500000\nl 1/1 4/3 2/2 # kept\nl -2 -3\np 3\n");
  EXPECT_EQ(refined_.splits.vertices.size(), 1u);
  EXPECT_EQ(refined_.chord.edges, 3u);
  EXPECT_LE(refined_.chord.length, 9);
  // Halved again and again, in the order in which the line goes.
  const std::string fine = split("a.obj", "v 8 2 9\rv -8 0 9\rl 1 2\r", 0.6);
  EXPECT_THAT(fine, StartsWith("v 8 2 9\rv -8 0 9\rv "));
  EXPECT_THAT(fine, HasSubstr("\rl 1 "));
  const Product read = read_product(file("fine.obj", fine));
  ASSERT_EQ(read.line_edges.size(), 16u);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(read.vertices(0, read.line_edges[2 * i]), 8 - 2.0 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(read.vertices(0, read.line_edges[2 * i + 1]), 6 - 2.0 * static_cast<double>(i), 1e-6);
  }
}

TEST_F(SplitProduct, SplitsDegenerateFacesWithTheirNeighbours) {
  const std::string out =
      split("a.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 4 -1 0\nf 1 2 3\nf 1 4 2 2\nf 1 1 2\n", 1.1);
  const Product read = read_product(file("split.obj", out));
  // No vertex lies on an edge of a face that does not end there: nothing hangs.
  ASSERT_EQ(refined_.splits.vertices.size(), 3u);
  const Eigen::Matrix2Xi edges = product_edges(read);
  for (Eigen::Index e = 0; e < edges.cols(); ++e)
    for (int v = 0; v < read.vertices.cols(); ++v) {
      const Vector3 a = read.vertices.col(edges(0, e)), b = read.vertices.col(edges(1, e)),
                    x = read.vertices.col(v);
      if (v == edges(0, e) || v == edges(1, e)) continue;
      EXPECT_GT((x - a).norm() + (b - x).norm(), (b - a).norm() + 1e-6) << out;
    }
}

TEST_F(SplitProduct, LeavesAFileThatStaysStraight) { EXPECT_EQ(split("a.obj", everything, 9), everything); }

TEST_F(SplitProduct, EndsNewLinesAsTheFileDoes) {
  const std::string out = split("a.obj", "v 0 0 0\r\nv 4 0 0\r\nv 4 1 0\r\nf 1 2 3\r\n", 1.1);
  for (std::size_t at = out.find('\n'); at != std::string::npos; at = out.find('\n', at + 1))
    EXPECT_EQ(out[at - 1], '\r') << at;
}

// As many normals as vertices, which no face names, belong to them in their order.
TEST_F(SplitProduct, KeepsNormalsBesideTheirVertices) {
  const std::string out =
      split("a.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nvn 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1 2 3\n", 1.1);
  EXPECT_THAT(out, HasSubstr("v 2.0000000 0.5000000 0.0000000\nv 2.0000000 0.0000000 0.0000000\n"
                             "vn 0.707107 0.000000 0.707107\nvn 0.000000 0.000000 1.000000\nf "));
}

TEST_F(SplitProduct, RefusesFreeFormStatements) {
  EXPECT_THAT(test::error_message<InvalidInput>(
                  [&] { split("a.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nf 1 2 3\ncurv 0 1 1 2\n", 1.1); }),
              HasSubstr("free-form"));
}

TEST_F(SplitProduct, KnowsWhichKindsItCanSplit) {
  for (const char* name : {"a.OBJ", "a.ply", "a.stl", "a.off", "a.gltf", "a.glb"})
    EXPECT_TRUE(can_split_product(name)) << name;
  EXPECT_FALSE(can_split_product("a.xyz"));
  split("a.obj", everything, 1.1);
  const std::string points = file("a.xyz", "0 0 0\n4 0 0\n");
  EXPECT_THAT(test::error_message<InvalidInput>([&] {
                carry_product(points, {directory_ / "b.xyz"}, identity_motion(), {{}, {}, &refined_.splits});
              }),
              StartsWith(points));
}

// Splits belong to the faces that they were found for.
TEST_F(SplitProduct, RefusesSplitsOfOtherFaces) {
  split("a.obj", everything, 1.1);
  const std::vector<std::pair<std::string, std::string>> others{
      {"b.obj", "v 0 0 0\nv 4 0 0\nv 4 1 0\nf 1 2 3\n"},
      {"b.off", "OFF\n3 1 0\n0 0 0\n4 0 0\n4 1 0\n3 0 1 2\n"},
      {"c.off", "OFF\n4 3 0\n0 0 0\n4 0 0\n4 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n3 0 1 3\n"},
      {"b.stl",
       "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 4 0 0\nvertex 4 1 0\nendloop\n"
       "endfacet\nendsolid\n"}};
  for (const auto& [name, content] : others) {
    const std::string path = file(name, content);
    EXPECT_THAT(
        test::error_message<InvalidInput>([&] {
          carry_product(path, {directory_ / ("out_" + name)}, identity_motion(), {{}, {}, &refined_.splits});
        }),
        HasSubstr("it has other faces"))
        << name;
  }
}

/// Objects with vertices of their own between their elements; numbers of both signs; corners of every form.
std::string random_obj(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-2, 2);
  std::uniform_int_distribution<int> few(0, 3);
  std::ostringstream obj;
  obj.precision(5);
  int vertices = 0, textures = 0, normals = 0;
  for (int object = 0; object < 4; ++object) {
    obj << "o " << object << "\n";
    for (int i = 0; i < 5; ++i, ++vertices)
      obj << "v " << coordinate(random) << ' ' << coordinate(random) << ' ' << coordinate(random) << "\n";
    for (int i = 0; i < 3; ++i, ++textures)
      obj << "vt " << coordinate(random) << ' ' << coordinate(random) << "\n";
    for (int i = 0; i < 2; ++i, ++normals) obj << "vn " << coordinate(random) << " 1 0.5\n";
    for (int face = 0; face < 4; ++face) {
      obj << "g " << object << '_' << face << "\n" << (face == 3 ? "l" : "f");
      const int form = few(random), first = std::uniform_int_distribution<int>(0, vertices - 1)(random);
      for (int k = 0; k < (few(random) == 0 ? 5 : 3); ++k) {
        const auto number = [&](int element, int count) {
          return few(random) == 0 ? element - count : element + 1;
        };
        obj << ' ' << number((first + k) % vertices, vertices);
        if (form == 1) obj << '/' << number((first + 2 * k) % textures, textures);
        if (form == 2) obj << "//" << number((first + k) % normals, normals);
        if (form == 3)
          obj << '/' << number(k % textures, textures) << '/' << number((first + k) % normals, normals);
      }
      obj << "\n";
    }
  }
  return obj.str();
}

std::vector<std::string> lines_of_groups(const std::string& obj) {
  std::vector<std::string> lines;
  std::istringstream text(obj);
  for (std::string line; std::getline(text, line);)
    if (line[0] == 'o' || line[0] == 'g') lines.push_back(line);
  return lines;
}

TEST_F(SplitProduct, IsTheRefinedProductAndNamesItsParts) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    const std::string obj = random_obj(random);
    const std::string out = split("a.obj", obj, 0.05);
    const Product read = read_product(directory_ / "out_a.obj");
    const Product& expected = refined_.product;
    ASSERT_EQ(read.vertices.cols(), expected.vertices.cols());
    ASSERT_EQ(read.polygon_start, expected.polygon_start);
    ASSERT_EQ(read.texture.cols(), expected.texture.cols());
    EXPECT_LT((read.vertices(Eigen::all, read.corners) - expected.vertices(Eigen::all, expected.corners))
                  .cwiseAbs()
                  .maxCoeff(),
              2e-6);
    EXPECT_TRUE(read.texture.isApprox(expected.texture, 1e-5));
    EXPECT_EQ(lines_of_groups(out), lines_of_groups(obj));
  }
}

}  // namespace
}  // namespace bespoke

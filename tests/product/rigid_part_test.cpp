#include "bespoke/product/rigid_part.h"

#include <gmock/gmock.h>

#include "product/gltf_scene.h"

namespace bespoke {
namespace {

using test::bend_motion;
using test::bytes;
using test::identity_motion;
using test::read_text;
using ::testing::HasSubstr;

class RigidParts : public test::ProductFiles {
 protected:
  std::string carried_with(const std::string& name, const std::string& content, const PointMotion& motion,
                           const std::vector<RigidPart>& parts) {
    const std::filesystem::path out = directory_ / ("out_" + name);
    summary_ = carry_product(file(name, content), {out}, motion, {parts, {}});
    return read_text(out);
  }
  std::string refusal(const std::string& name, const std::string& content,
                      const std::vector<RigidPart>& parts) {
    return test::error_message<InvalidInput>([&] { carried_with(name, content, bend_motion(), parts); });
  }
};

// Two squares across x = 0, and one from x = 2 to x = 3.
const std::string squares_obj =
    "v -1 0 0\nv 1 0 0\nv 1 1 0\nv -1 1 0\n"
    "v 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\n"
    "o both\ng lens frame\nusemtl glass\nf 1 2 3 4\ng rest\nusemtl cloth\nf 5 6 7 8\n";

/// (x, y, z + x² / 2) of the first square is flat, at z = 0.5, so the best motion is that shift.
const std::string lens_carried =
    "v -1 0 0.5\nv 1 0 0.5\nv 1 1 0.5\nv -1 1 0.5\n"
    "v 2 0 2\nv 3 0 4.5\nv 3 1 4.5\nv 2 1 2\n";

/// The vertex lines without the zeros behind the digits.
std::string vertex_lines(const std::string& obj) {
  std::string lines;
  std::istringstream words(obj);
  for (std::string keyword; words >> keyword && keyword == "v";) {
    double x = 0, y = 0, z = 0;
    words >> x >> y >> z;
    std::ostringstream line;
    line << "v " << x << ' ' << y << ' ' << z << '\n';
    lines += line.str();
  }
  return lines;
}

TEST_F(RigidParts, OfObjAreGroupsObjectsAndMaterials) {
  for (const std::string name : {"lens", "frame", "lens frame", "glass"}) {
    EXPECT_EQ(vertex_lines(carried_with("a.obj", squares_obj, bend_motion(), {{name}})), lens_carried)
        << name;
    ASSERT_EQ(summary_.parts.size(), 1u);
    EXPECT_EQ(summary_.parts[0].points, 4u);
    EXPECT_LT(summary_.parts[0].distances.max, 1e-12);
  }
  carried_with("a.obj", squares_obj, bend_motion(), {{"both"}});
  EXPECT_EQ(summary_.parts[0].points, 8u);
  EXPECT_GT(summary_.parts[0].distances.min, 0.1);
}

// Least squares of the square from x = 2 to x = 3, whose image rises by 2.5 over a length of 1, worked out by
// hand: the image's edge (1, 2.5) along x, of length ℓ = √7.25, and the edge along y as it was.
TEST_F(RigidParts, KeepTheirShapeOrScale) {
  const double length = std::sqrt(7.25);
  carried_with("a.obj", squares_obj, bend_motion(), {{"rest"}});
  EXPECT_NEAR(summary_.parts[0].distances.max, (length - 1) / 2, 1e-12);
  EXPECT_EQ(summary_.parts[0].scale, 1);
  carried_with("a.obj", squares_obj, bend_motion(), {{"rest", PartMotion::similar}});
  const double scale = (length + 1) / 2;
  EXPECT_NEAR(summary_.parts[0].scale, scale, 1e-12);
  EXPECT_NEAR(summary_.parts[0].distances.max, std::hypot(length - scale, scale - 1) / 2, 1e-12);
}

TEST_F(RigidParts, TakeTheirNormalsWithThem) {
  const std::string obj = "v 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nvn 0 0 1\ng sole\nf 1//1 2//1 3//1 4//1\n";
  const std::string out = carried_with("a.obj", obj, bend_motion(), {{"sole"}});
  // Turned by the slope 2.5 about y, all alike, where the map's own normals differ from corner to corner.
  EXPECT_THAT(out, HasSubstr("\nvn -0.9284767 0 0.3713907\n"));
  EXPECT_THAT(out, HasSubstr("f 1//1 2//1 3//1 4//1\n"));
}

TEST_F(RigidParts, OfPlyAreComponents) {
  const std::vector<float> x{-1, 0, 1, 0, 1, 1, -1, 1, 2, 0, 3, 0, 3, 1, 2, 1};
  for (const std::string format : {"ascii", "binary_little_endian"}) {
    std::string ply = "ply\nformat " + format +
                      " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    const std::string header = ply;
    for (std::size_t i = 0; i < 8; ++i)
      ply += format == "ascii" ? std::to_string(x[2 * i]) + " " + std::to_string(x[2 * i + 1]) + " 0\n"
                               : bytes(x[2 * i]) + bytes(x[2 * i + 1]) + bytes(0.0f);
    for (const int first : {0, 4})
      ply += format == "ascii" ? "4 " + std::to_string(first) + " " + std::to_string(first + 1) + " " +
                                     std::to_string(first + 2) + " " + std::to_string(first + 3) + "\n"
                               : bytes(std::uint8_t{4}) + bytes(first) + bytes(first + 1) + bytes(first + 2) +
                                     bytes(first + 3);
    EXPECT_EQ(carried_with("a.ply", ply, identity_motion(), {{"1"}, {"2"}}), ply);
    const std::string out = carried_with("a.ply", ply, bend_motion(), {{"1"}, {"2"}});
    EXPECT_LT(summary_.parts[0].distances.max, 1e-12);
    EXPECT_NEAR(summary_.parts[1].distances.max, (std::sqrt(7.25) - 1) / 2, 1e-12);
    if (format != "ascii") {
      EXPECT_EQ(out.substr(header.size(), 12), bytes(-1.0f) + bytes(0.0f) + bytes(0.5f));
    }
    EXPECT_THAT(refusal("a.ply", ply, {{"3"}}),
                HasSubstr("a.ply: has no part '3'; its components are 1 to 2"));
  }
}

TEST_F(RigidParts, OfGltfAreNodesAndWhatIsBelowThem) {
  test::GltfScene scene = test::morphing_triangle();
  scene.root["nodes"] = {{{"name", "buckle"}, {"children", {1}}, {"translation", {2, 0, 0}}},
                         {{"name", "pin"}, {"mesh", 0}}};
  // The mesh's corners are at (2, 0), (3, 0) and (2, 2); all move alike, the morph target's too.
  for (const char* name : {"buckle", "pin"}) {
    const test::GlbContent out(carried_with("a.glb", scene.glb(), bend_motion(), {{name}}));
    const std::vector<float> x = out.floats(0), shift = out.floats(3);
    const Vector3 edge(x[3] - x[0], x[4] - x[1], x[5] - x[2]);
    EXPECT_NEAR(edge.norm(), 1, 1e-6);
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(shift[3 + axis], edge[static_cast<int>(axis)], 1e-6);
    EXPECT_EQ(summary_.parts[0].points, 3u);
  }
  EXPECT_EQ(carried_with("a.glb", scene.glb(), identity_motion(), {{"pin"}}), scene.glb());
  EXPECT_THAT(refusal("a.glb", scene.glb(), {{"strap"}}),
              HasSubstr("a.glb: has no part 'strap'; its nodes are buckle, pin"));
}

TEST_F(RigidParts, AreRefusedByName) {
  EXPECT_THAT(
      refusal("a.obj", squares_obj, {{"glas"}}),
      HasSubstr("a.obj: has no part 'glas'; its groups are frame, lens, lens frame, rest, its objects are "
                "both, its materials are cloth, glass"));
  EXPECT_THAT(refusal("a.obj", squares_obj, {{"lens"}, {"both"}}),
              HasSubstr("'lens' and 'both' share vertex 1"));
  EXPECT_THAT(refusal("a.obj", squares_obj + "v 2 0 0\nv 4 0 0\nv 4 1 0\ng third\nf 9 10 11\n",
                      {{"rest"}, {"third"}}),
              HasSubstr("'rest' and 'third' have a point in common"));
  EXPECT_THAT(refusal("a.obj", squares_obj + "v 9 0 0\nv 9 0 1\ng rod\nl 9 10\n", {{"rod"}}),
              HasSubstr("the 2 points of the part 'rod' lie on a line"));
  EXPECT_THAT(refusal("a.xyz", "1 2 3\n", {{"rod"}}), HasSubstr("a.xyz: only OBJ, PLY and glTF"));
}

}  // namespace
}  // namespace bespoke

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bespoke/product/mesh_io.h"
#include "bespoke/product/posed_product.h"
#include "command/refusal.h"
#include "product/gltf_scene.h"

// Skinned glTF files whose nodes show another pose than the stored one, in every command that reads them.
namespace bespoke::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Arguments = std::vector<std::string>;

/// How much of a vertex the upper of two joints holds.
double upper_weight(const Vector3& stored) { return std::clamp((stored.y() / 1.4 + 1) / 2, 0.0, 1.0); }

/// What the joints do to the stored vertices: a quarter turn about x, a shift, and one that shears.
Vector3 shown(const Vector3& stored) {
  return Vector3(stored.x(), -stored.z(), stored.y()) + Vector3(20, 0, 5) +
         upper_weight(stored) * Vector3(0.3, 0, 0);
}

/// The mesh as a .glb, with a skin of two joints that move it, or without one.
std::string glb(const TriangleMesh& mesh, bool is_skinned) {
  std::vector<float> x;
  for (const double value : mesh.vertices.reshaped()) x.push_back(static_cast<float>(value));
  std::vector<std::uint16_t> corners;
  for (const int corner : mesh.faces.reshaped()) corners.push_back(static_cast<std::uint16_t>(corner));
  GltfScene scene;
  json attributes;
  attributes["POSITION"] = scene.accessor(x, "VEC3", 5126);
  const int indices = scene.accessor(corners, "SCALAR", 5123);
  scene.root["nodes"] = {{{"mesh", 0}, {"name", "body"}}};
  scene.root["scenes"] = {{{"nodes", {0}}}};
  if (is_skinned) {
    std::vector<std::uint8_t> joints;
    std::vector<float> weights, binds;
    for (const auto& vertex : mesh.vertices.colwise()) {
      const auto upper = static_cast<float>(upper_weight(vertex));
      joints.insert(joints.end(), {0, 1, 0, 0});
      weights.insert(weights.end(), {1 - upper, upper, 0, 0});
    }
    for (int joint = 0; joint < 2; ++joint)
      for (int i = 0; i < 16; ++i) binds.push_back(i % 5 == 0 ? 1.0F : 0.0F);
    attributes["JOINTS_0"] = scene.accessor(joints, "VEC4", 5121);
    attributes["WEIGHTS_0"] = scene.accessor(weights, "VEC4", 5126);
    const int inverse_binds = scene.accessor(binds, "MAT4", 5126);
    scene.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse_binds}}};
    const float half = std::sqrt(0.5F);
    scene.root["nodes"][0]["skin"] = 0;
    for (const double along : {20.0, 20.3})
      scene.root["nodes"].push_back({{"rotation", {half, 0, 0, half}}, {"translation", {along, 0, 5}}});
    scene.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  }
  scene.root["meshes"] = {{{"primitives", {{{"attributes", attributes}, {"indices", indices}}}}}};
  return scene.glb();
}

/// The source of the example pair, and a shell around it, both as plain/NAME.glb and as skinned/NAME.glb,
/// whose stored vertices are the plain ones. Units are the files': no metres are meant.
class PoseOfCommands : public testing::Test {
 protected:
  PoseOfCommands() {
    TriangleMesh source = read_triangle_mesh(file("source.obj"));
    for (const bool is_skinned : {false, true}) {
      fs::create_directory(folder(is_skinned));
      write_text(folder(is_skinned) + "source.glb", glb(source, is_skinned));
      write_text(folder(is_skinned) + "shell.glb", glb({1.2 * source.vertices, source.faces}, is_skinned));
    }
    json anchors = json::parse(read_text(file("anchors.json")));
    anchors.erase("units");
    write_text(file("anchors.json"), anchors.dump());
    for (json& pair : anchors["pairs"]) {
      const json a = pair["a"];
      const Vector3 moved = shown(Vector3(a[0].get<double>(), a[1].get<double>(), a[2].get<double>()));
      pair["a"] = {moved.x(), moved.y(), moved.z()};
    }
    write_text(file("shown.json"), anchors.dump());
  }
  std::string file(const std::string& name) const { return pair_.file(name); }
  std::string folder(bool is_skinned) const { return file(is_skinned ? "skinned/" : "plain/"); }
  std::string skinned(const std::string& name) const { return folder(true) + name; }
  std::string plain(const std::string& name) const { return folder(false) + name; }

  /// Exit code 0, and what was printed to standard output.
  static std::string output(const Arguments& arguments) {
    const ProgramResult result = bespoke(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  }
  ProgramResult fit(const std::string& source, const std::string& anchors, const std::string& map,
                    const Arguments& more = {}) const {
    Arguments all{"fit",         source, file("target.obj"), "--anchors", file(anchors),
                  "--tolerance", "0.5%", "--unit",           "m",         "-o",
                  file(map)};
    all.insert(all.end(), more.begin(), more.end());
    return bespoke(all);
  }

  ExamplePair pair_;
};

TEST_F(PoseOfCommands, OfAFitIsTheShownOneOrTheStored) {
  const std::string source = skinned("source.glb");
  const ProgramResult stored = fit(source, "anchors.json", "stored.vdb", {"--pose", "stored"});
  ASSERT_EQ(stored.exit_code, 0) << stored.err;
  EXPECT_THAT(stored.err, Not(HasSubstr("another pose")));
  ASSERT_EQ(fit(plain("source.glb"), "anchors.json", "plain.vdb").exit_code, 0);
  EXPECT_TRUE(read_text(file("stored.vdb")) == read_text(file("plain.vdb")));
  const ProgramResult as_shown = fit(source, "shown.json", "shown.vdb");
  ASSERT_EQ(as_shown.exit_code, 0) << as_shown.err;
  EXPECT_THAT(as_shown.err, HasSubstr("stored in another pose than its nodes show"));
  // Whoever shows or measures a map knows the pose by what the map was made of.
  for (const char* map : {"stored.vdb", "shown.vdb"})
    EXPECT_THAT(output({"measure", file(map), "--source", source, "--target", file("target.obj"), "-q"}),
                HasSubstr("source to target"));
}

TEST_F(PoseOfCommands, OfVertexNumbersAndAuditsIsTheNamedOne) {
  const std::string source = skinned("source.glb"), target = file("target.obj");
  const Points vertices = read_triangle_mesh(plain("source.glb")).vertices;
  write_text(file("numbers.txt"), "0 0\n100 7\n641 3\n");
  for (const char* pose : {"stored", "shown"}) {
    output({"anchors", "convert", file("numbers.txt"), "--source", source, "--target", target, "--pose", pose,
            "-o", file("converted.json")});
    const json pairs = json::parse(read_text(file("converted.json")))["pairs"];
    ASSERT_EQ(pairs.size(), 3u);
    for (const auto& [pair, vertex] : {std::pair{0, 0}, {1, 100}, {2, 641}}) {
      const Vector3 x = vertices.col(vertex), expected = std::string(pose) == "stored" ? x : shown(x);
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(pairs[static_cast<std::size_t>(pair)]["a"][static_cast<std::size_t>(i)], expected[i],
                    1e-5);
    }
    const std::string audit = output(
        {"anchors", "audit", file("anchors.json"), "--source", source, "--target", target, "--pose", pose});
    EXPECT_THAT(audit,
                std::string(pose) == "stored" ? HasSubstr("nothing is suspicious") : HasSubstr("source: "));
  }
  output({"anchors", "suggest", source, target, "--anchors", file("anchors.json"), "--pose", "stored",
          "--count", "1", "-o", file("more.json")});
  expect_refusal(bespoke({"anchors", "suggest", source, target, "--anchors", file("anchors.json"), "-o",
                          file("more.json")}),
                 2, "the anchors lie beside the target");
}

// Pages hold the command that made them, so that both files are picked under one name.
TEST_F(PoseOfCommands, OfPickedModelsIsTheNamedOne) {
  const auto page = [&](const std::string& source, const std::string& pose) {
    fs::copy_file(source, file("model.glb"), fs::copy_options::overwrite_existing);
    const ProgramResult result =
        bespoke({"pick", file("model.glb"), file("target.obj"), "--pose", pose, "-o", file("pick.html")});
    return result.exit_code == 0 ? read_text(file("pick.html")) : result.err;
  };
  const std::string of_plain = page(plain("source.glb"), "stored");
  if (of_plain.find("pages") != std::string::npos && of_plain.size() < 1000) GTEST_SKIP() << of_plain;
  EXPECT_TRUE(page(skinned("source.glb"), "stored") == of_plain);
  EXPECT_FALSE(page(skinned("source.glb"), "shown") == page(plain("source.glb"), "shown"));
}

TEST_F(PoseOfCommands, OfProductsIsTheNamedOneToo) {
  ASSERT_EQ(fit(plain("source.glb"), "anchors.json", "map.vdb").exit_code, 0);
  const auto measured = [&](const std::string& product, const Arguments& more) {
    Arguments all{"measure",   file("map.vdb"),
                  "--source",  plain("source.glb"),
                  "--target",  file("target.obj"),
                  "--product", product,
                  "--unit",    "map",
                  "--json",    "-q"};
    all.insert(all.end(), more.begin(), more.end());
    return json::parse(output(all))["products"][0];
  };
  json of_plain = measured(plain("shell.glb"), {}),
       of_stored = measured(skinned("shell.glb"), {"--pose", "stored"});
  EXPECT_EQ(of_stored, of_plain);
  EXPECT_NE(measured(skinned("shell.glb"), {}), of_plain);
}

TEST_F(PoseOfCommands, OfProductsThatMapsAreComparedAtIsTheNamedOne) {
  ASSERT_EQ(fit(plain("source.glb"), "anchors.json", "map.vdb").exit_code, 0);
  output({"invert", file("map.vdb"), "-o", file("inverse.vdb")});
  const auto compared = [&](const std::string& product, const Arguments& more) {
    Arguments all{"diff", file("map.vdb"), file("inverse.vdb"), "--product", product, "--json", "-q"};
    all.insert(all.end(), more.begin(), more.end());
    json found = json::parse(output(all))["products"][0];
    found.erase("name");
    return found;
  };
  const json of_plain = compared(plain("shell.glb"), {});
  EXPECT_EQ(compared(skinned("shell.glb"), {"--pose", "stored"}), of_plain);
  EXPECT_NE(compared(skinned("shell.glb"), {}), of_plain);
}

TEST_F(PoseOfCommands, OfACataloguesModelsIsThatOfTheirMaps) {
  fs::create_directory(file("maps"));
  ASSERT_EQ(fit(skinned("source.glb"), "anchors.json", "maps/stored.vdb", {"--pose", "stored"}).exit_code, 0);
  output({"catalog", file("maps")});
  const Arguments found{"apply",      file("product.obj"), "--from",
                        file("maps"), "--source",          skinned("source.glb")};
  Arguments named{"apply", file("maps/stored.vdb"), file("product.obj"), "-o", file("named.obj")};
  Arguments from = found;
  from.insert(from.end(), {"-o", file("found.obj")});
  output(named);
  output(from);
  EXPECT_EQ(read_text(file("found.obj")), read_text(file("named.obj")));
}

TEST_F(PoseOfCommands, OfASizeIsAColumnOfItsTable) {
  write_text(file("measures.json"),
             R"({"units":"m","measures":[{"name":"waist","plane":{"point":[0,0,0],"normal":[0,1,0]}}]})");
  const auto grade = [&](const std::string& source, const std::string& product, const std::string& column,
                         const std::string& value, const std::string& out) {
    write_text(file("sizes.csv"), "size,target,anchors,tolerance,unit" + column + "\nM," +
                                      file("target.obj") + "," + file("anchors.json") + ",0.5%,m" + value +
                                      "\n");
    output({"grade", source, product, "--sizes", file("sizes.csv"), "--measures", file("measures.json"),
            "--out-dir", file(out)});
    return read_text(file(out + "/M/measures.csv"));
  };
  const std::string of_plain = grade(plain("source.glb"), plain("shell.glb"), "", "", "a");
  EXPECT_THAT(of_plain, HasSubstr("\nwaist,"));
  EXPECT_EQ(grade(skinned("source.glb"), skinned("shell.glb"), ",pose", ",stored", "b"), of_plain);
  // Stored vertices are carried as those of the plain file are.
  const Points posed = read_product(file("b/M/shell.glb"), ModelPose::stored).vertices;
  const Points expected = read_triangle_mesh(file("a/M/shell.glb")).vertices;
  ASSERT_EQ(posed.cols(), expected.cols());
  EXPECT_LT((posed - expected).cwiseAbs().maxCoeff(), 1e-5);
}

}  // namespace
}  // namespace bespoke::test

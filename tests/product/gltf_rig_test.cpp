#include <gmock/gmock.h>

#include "bespoke/product/carry_product.h"
#include "bespoke/product/posed_product.h"
#include "product/rig_scene.h"

namespace bespoke {
namespace {

using nlohmann::json;
using test::affine_motion;
using test::at_key;
using test::bend_motion;
using test::GlbContent;
using test::identity_motion;
using test::RigScene;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Of the sleeve's diagonal, 4.2: files hold floats.
constexpr double bound = 1e-5 * 4.2;

class CarryRig : public test::ProductFiles {
 protected:
  static constexpr Eigen::Index button = 3;

  /// As a viewer shows it: the button's vertices, then the sleeve's.
  Points shown(const std::string& glb) const { return read_product(file("shown.glb", glb)).vertices; }

  double difference(const Points& a, const Points& b) const {
    return a.cols() == b.cols() ? (a - b).colwise().norm().maxCoeff() : 1e9;
  }
};

Points points_of(const std::vector<float>& values) {
  return Eigen::Map<const Eigen::Matrix3Xf>(values.data(), 3, static_cast<Eigen::Index>(values.size() / 3))
      .cast<double>();
}

/// x ↦ s R x + t.
PointMotion similarity(double scale) {
  const Matrix3 turn = Eigen::AngleAxisd(0.8, Vector3(1, -2, 2).normalized()).toRotationMatrix();
  return affine_motion(scale * turn, {5, -3, 1});
}

TEST_F(CarryRig, ShowsTheCarriedMesh) {
  RigScene rig;
  for (const PointMotion& motion : {bend_motion(), similarity(1.7)}) {
    const Points before = shown(rig.glb());
    ASSERT_EQ(before.cols(), RigScene::rings * RigScene::corners + 3);
    const Points after = shown(carried("a.glb", rig.glb(), motion));
    EXPECT_LT(difference(after, motion.images(before).front()), bound);
    EXPECT_EQ(summary_.joints, 4u);
    EXPECT_THAT(summary_.warnings, IsEmpty());
  }
}

TEST_F(CarryRig, BindsWhereItShows) {
  RigScene rig;
  const std::string out = carried("a.glb", rig.glb(), bend_motion());
  // In its bind pose a mesh is stored as it is shown, so that both poses agree.
  const PointMotion still = identity_motion();
  carry_product(file("b.glb", out), {directory_ / "c.glb"}, still, {{}, {}, nullptr, ModelPose::stored});
  EXPECT_EQ(test::read_text(directory_ / "c.glb"), out);
}

TEST_F(CarryRig, KeepsEveryByteWhereNothingMoves) {
  RigScene rig;
  EXPECT_EQ(carried("a.glb", rig.glb(), identity_motion()), rig.glb());
}

TEST_F(CarryRig, KeepsWeightsAndWhatExtensionsSay) {
  RigScene rig;
  const GlbContent before(rig.glb()), after(carried("a.glb", rig.glb(), bend_motion()));
  for (const int accessor : {rig.joints, rig.weights}) {
    const auto at = static_cast<std::size_t>(accessor);
    EXPECT_EQ(after.data.substr(after.begin(at), 512), before.data.substr(before.begin(at), 512));
  }
  const std::string extension =
      "\"extensions\": {\n  \"VRMC_vrm\": {\n   \"humanoid\": {\n    \"leftLowerArm\": 2";
  EXPECT_THAT(before.text, HasSubstr(extension));
  EXPECT_THAT(after.text, HasSubstr(extension));
  EXPECT_EQ(after.data.size(), before.data.size());
}

// What carries the whole world alike carries its motion, too.
TEST_F(CarryRig, AnimatesACarriedSimilarityAsTheCarriedAnimation) {
  RigScene rig;
  for (const double scale : {1.0, 2.0}) {
    const PointMotion motion = similarity(scale);
    const GlbContent before(rig.glb()), after(carried("a.glb", rig.glb(), motion));
    for (const std::size_t key : {0u, 1u}) {
      const Points moved = motion.images(shown(at_key(before, key))).front();
      EXPECT_LT(difference(shown(at_key(after, key)), moved), scale * bound) << key;
    }
  }
}

TEST_F(CarryRig, BendsTheSleeveAtTheCarriedElbow) {
  RigScene rig;
  rig.scene.root["animations"][0]["channels"].erase(1);
  const GlbContent after(carried("a.glb", rig.glb(), bend_motion()));
  const Points original = shown(rig.glb());
  const Points straight = shown(at_key(after, 0)), bent = shown(at_key(after, 1));
  std::vector<Eigen::Index> upper, lower;
  for (Eigen::Index i = button; i < original.cols(); ++i)
    if (const double weight = RigScene::lower_weight(original(0, i)); weight == 0 || weight == 1)
      (weight == 0 ? upper : lower).push_back(i);
  // Before the elbow nothing moves, and beyond it all turns by 60° about it.
  EXPECT_LT(difference(bent(Eigen::all, upper), straight(Eigen::all, upper)), bound);
  const Vector3 elbow = bend_motion().images(Vector3(2, 0, 0)).front();
  const Points from = straight(Eigen::all, lower).colwise() - elbow;
  const Points to = bent(Eigen::all, lower).colwise() - elbow;
  const Matrix3 turn = to * from.transpose() * (from * from.transpose()).inverse();
  EXPECT_LT(difference(turn * from, to), bound);
  EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), RigScene::bend, 1e-4);
}

TEST_F(CarryRig, MorphsToTheCarriedMorph) {
  RigScene rig;
  const auto morphed = [&](const std::string& glb) {
    GlbContent content(glb);
    test::GltfScene scene;
    const json target = content.root["meshes"][0]["primitives"][0]["targets"][0];
    std::vector<float> x = content.floats(static_cast<std::size_t>(rig.positions));
    const std::vector<float> shift = content.floats(target["POSITION"]);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += shift[i];
    std::memcpy(content.data.data() + content.begin(static_cast<std::size_t>(rig.positions)), x.data(),
                4 * x.size());
    scene.root = content.root;
    scene.data = content.data;
    return shown(scene.glb());
  };
  const Points after = morphed(carried("a.glb", rig.glb(), bend_motion()));
  EXPECT_LT(difference(after, bend_motion().images(morphed(rig.glb())).front()), bound);
}

TEST_F(CarryRig, AddsInverseBindsWhereTheFileHasNone) {
  RigScene rig;
  json& root = rig.scene.root;
  root["skins"][0].erase("inverseBindMatrices");
  root["nodes"][1] = {{"children", {2}}};
  root["nodes"][2] = {{"children", {3, 4}}};
  root["animations"][0]["channels"].erase(1);
  const Points before = shown(rig.glb());
  const std::string out = carried("a.glb", rig.glb(), bend_motion());
  EXPECT_LT(difference(shown(out), bend_motion().images(before).front()), bound);
  EXPECT_TRUE(GlbContent(out).root["skins"][0].contains("inverseBindMatrices"));
}

// Exporters store equal values once.
TEST_F(CarryRig, SeparatesAnimationsOfJointsThatShareTheirValues) {
  RigScene rig;
  json& animation = rig.scene.root["animations"][0];
  animation["channels"] = {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}},
                           {{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                           {{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}};
  const PointMotion motion = similarity(1);
  const GlbContent before(rig.glb()), after(carried("a.glb", rig.glb(), motion));
  const json& channels = after.root["animations"][0]["channels"];
  const json& samplers = after.root["animations"][0]["samplers"];
  const auto values = [&](std::size_t channel) {
    return after.floats(samplers[channels[channel]["sampler"].get<std::size_t>()]["output"]);
  };
  const std::vector<float> own = before.floats(static_cast<std::size_t>(rig.rotations));
  EXPECT_NE(values(0), own);
  // A similarity turns no joint in its parent's frame but the root.
  for (std::size_t i = 0; i < own.size(); ++i) EXPECT_NEAR(values(1)[i], own[i], 1e-6) << i;
  EXPECT_EQ(values(2), own);
}

TEST_F(CarryRig, TurnsTheTangentsOfCubicSplines) {
  RigScene rig;
  json& animation = rig.scene.root["animations"][0];
  const std::vector<float> cubic{1, 0, 0, -4, 2, -6, 0, 1, 0, 0, 0, 2, -3.5f, 2.25f, -7, 1, 1, 1};
  animation["samplers"][1]["output"] = rig.scene.accessor(cubic, "VEC3", 5126);
  animation["samplers"][1]["interpolation"] = "CUBICSPLINE";
  animation["channels"].erase(0);
  const GlbContent before(rig.glb()), after(carried("a.glb", rig.glb(), similarity(2)));
  const std::vector<float> now = after.floats(after.root["animations"][0]["samplers"][1]["output"]);
  const Matrix3 armature = (Matrix3() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();  // in the scene
  const Matrix3 linear = similarity(2).jacobians(Vector3::Zero().eval()).front();
  const Matrix3 expected = armature.transpose() * linear * armature;
  const auto vector = [](const std::vector<float>& all, std::size_t i) {
    return Vector3(all[3 * i], all[3 * i + 1], all[3 * i + 2]);
  };
  for (const std::size_t i : {0u, 2u, 3u, 5u})
    EXPECT_LT((vector(now, i) - expected * vector(cubic, i)).norm(), 1e-4) << i;
  EXPECT_LT((vector(now, 4) - vector(now, 1) - expected * (vector(cubic, 4) - vector(cubic, 1))).norm(),
            1e-4);
}

/// The sleeve is stored straight, and its nodes show it bent.
std::string posed_rig(RigScene& rig) { return at_key(GlbContent(rig.glb()), 1); }

TEST_F(CarryRig, CarriesAnotherPoseThanTheStoredOneAsItIsShown) {
  RigScene rig;
  const std::string posed = posed_rig(rig);
  const Points before = shown(posed);
  EXPECT_LT(difference(shown(carried("a.glb", posed, bend_motion())), bend_motion().images(before).front()),
            bound);
  EXPECT_THAT(summary_.warnings, ElementsAre(HasSubstr("in the pose in which its nodes show it")));
}

// What is far from where it was moves on as before.
TEST_F(CarryRig, AnimatesACarriedPoseAsTheCarriedAnimation) {
  RigScene rig;
  rig.scene.root["animations"][0]["channels"].erase(1);
  GlbContent content(posed_rig(rig));
  const Matrix3 turn = Eigen::AngleAxisd(2.5, Vector3(1, -2, 2).normalized()).toRotationMatrix();
  const PointMotion motion = affine_motion(turn, {50, -30, 10});
  const std::string out = carried("a.glb", posed_rig(rig), motion);
  std::vector<Eigen::Index> rigid;  // held by one joint: blends depend on the pose of binding
  const Points stored = shown(rig.glb());
  for (Eigen::Index i = 0; i < stored.cols(); ++i)
    if (const double weight = RigScene::lower_weight(stored(0, i)); weight == 0 || weight == 1)
      rigid.push_back(i);
  for (const std::size_t key : {0u, 1u}) {
    const Points moved = motion.images(shown(at_key(content, key))).front();
    const Points now = shown(at_key(GlbContent(out), key));
    EXPECT_LT(difference(now(Eigen::all, rigid), moved(Eigen::all, rigid)), 20 * bound) << key;
    EXPECT_LT(difference(now, moved), 0.5) << key;
  }
}

TEST_F(CarryRig, CarriesTheStoredPoseOnRequest) {
  RigScene rig;
  // As stored the sleeve is where its node is, which is where it is bound.
  rig.scene.root["animations"][0]["channels"].erase(1);
  const Points straight = shown(rig.glb());
  const std::string posed = posed_rig(rig);
  const PointMotion motion = similarity(1.5);
  carry_product(file("a.glb", posed), {directory_ / "b.glb"}, motion, {{}, {}, nullptr, ModelPose::stored});
  const GlbContent out(test::read_text(directory_ / "b.glb"));
  // The key without a bend shows what is stored, and the nodes show the pose that they had.
  const Eigen::Index sleeve = RigScene::rings * RigScene::corners;
  EXPECT_LT(
      difference(shown(at_key(out, 0)).rightCols(sleeve), motion.images(straight).front().rightCols(sleeve)),
      1.5 * bound);
  EXPECT_LT(difference(shown(test::read_text(directory_ / "b.glb")), motion.images(shown(posed)).front()),
            1.5 * bound);
}

TEST_F(CarryRig, ReadsEitherPoseOfAModel) {
  RigScene rig;
  rig.scene.root["animations"][0]["channels"].erase(1);
  const std::string straight = file("straight.glb", rig.glb()), posed = file("posed.glb", posed_rig(rig));
  EXPECT_FALSE(has_two_poses(straight));
  EXPECT_TRUE(has_two_poses(posed));
  // Its node, in the scene's root, places the sleeve as it is stored.
  const Points stored =
      read_product(posed, ModelPose::stored).vertices.rightCols(RigScene::rings * RigScene::corners);
  const Points x = points_of(GlbContent(rig.glb()).floats(static_cast<std::size_t>(rig.positions)));
  EXPECT_LT(difference(stored.rowwise().minCoeff(), x.rowwise().minCoeff()), bound);
  EXPECT_LT(difference(stored.rowwise().maxCoeff(), x.rowwise().maxCoeff()), bound);
  EXPECT_EQ(read_product(straight, ModelPose::stored).vertices, read_product(straight).vertices);
  EXPECT_EQ(read_product(posed, ModelPose::shown).vertices, read_product(posed).vertices);
}

TEST_F(CarryRig, RefusesStoredPosesThatContradictEachOther) {
  RigScene rig;
  json& root = rig.scene.root;
  root["skins"].push_back({{"joints", {1, 2}}});
  root["nodes"].push_back({{"mesh", 0}, {"skin", 1}});
  const std::string path = file("a.glb", rig.glb());
  EXPECT_THAT(
      test::error_message<InvalidInput>([&] {
        carry_product(path, {directory_ / "b.glb"}, identity_motion(), {{}, {}, nullptr, ModelPose::stored});
      }),
      HasSubstr("a.glb: /nodes/1: is a joint of skins that are stored in different poses"));
}

TEST_F(CarryRig, NamesAnAnimationThatIsNone) {
  RigScene rig;
  rig.scene.root["animations"][0]["samplers"][0]["output"] = rig.translations;
  EXPECT_THAT(test::error_message<FormatError>([&] { carried("a.glb", rig.glb(), bend_motion()); }),
              HasSubstr("/animations/0/samplers/0/output: is no VEC4 of rotations"));
}

class BindProduct : public CarryRig {
 protected:
  /// The product where it is, bound to the skeleton of the rig.
  std::string bound_to(const std::string& product, const std::string& target) {
    file("target.glb", target);
    summary_ = carry_product(file("product.glb", product), {directory_ / "bound.glb"}, identity_motion(),
                             {{}, {}, nullptr, ModelPose::shown, directory_ / "target.glb"});
    return test::read_text(directory_ / "bound.glb");
  }

  /// With the target's animation, for the nodes of the bound product that have its joints' names.
  Points shown_at_key(const std::string& bound_glb, const GlbContent& target, std::size_t key) {
    GlbContent content(bound_glb);
    const json posed = GlbContent(at_key(target, key)).root["nodes"];
    for (json& node : content.root["nodes"])
      for (const json& own : posed)
        if (own["name"] == node.value("name", "") && !node.contains("mesh") && !own.contains("mesh"))
          for (const char* path : {"rotation", "translation"})
            if (own.contains(path)) node[path] = own[path];
    test::GltfScene scene;
    scene.root = content.root;
    scene.data = content.data;
    return shown(scene.glb());
  }
};

/// The sleeve alone, without skin, as a node of its own shows it.
test::GltfScene plain_sleeve() {
  RigScene rig;
  json& root = rig.scene.root;
  for (const char* key : {"skins", "animations", "extensions", "extensionsUsed"}) root.erase(key);
  json mesh = root["meshes"][0];
  for (const char* name : {"JOINTS_0", "WEIGHTS_0"}) mesh["primitives"][0]["attributes"].erase(name);
  root["meshes"] = {mesh};
  json armature = root["nodes"][0];
  armature.erase("children");
  armature["mesh"] = 0;
  armature["name"] = "cloth";
  root["nodes"] = {armature};
  return rig.scene;
}

TEST_F(BindProduct, MovesWithTheTarget) {
  RigScene rig;
  const GlbContent target(rig.glb());
  const std::string out = bound_to(plain_sleeve().glb(), rig.glb());
  EXPECT_EQ(summary_.joints, 2u);
  const Eigen::Index sleeve = RigScene::rings * RigScene::corners;
  for (const std::size_t key : {0u, 1u})
    EXPECT_LT(difference(shown_at_key(out, target, key), shown(at_key(target, key)).rightCols(sleeve)),
              bound);
}

TEST_F(BindProduct, LeavesItsOwnSkeletonOut) {
  RigScene own, target;
  own.scene.root["nodes"][1]["name"] = "own upper";
  own.scene.root["nodes"][2]["name"] = "own lower";
  own.scene.root["nodes"][4].erase("mesh");
  const std::string product = posed_rig(own);
  const Points before = shown(product);
  const std::string out = bound_to(product, posed_rig(target));
  EXPECT_LT(difference(shown(out), before), bound);
  const json root = GlbContent(out).root;
  EXPECT_FALSE(root.contains("animations"));
  EXPECT_EQ(root["skins"].size(), 1u);
  for (const json& node : root["scenes"][0]["nodes"]) EXPECT_NE(node, 0);
}

TEST_F(BindProduct, KeepsFourWeightsOfEachVertex) {
  RigScene rig;
  const GlbContent out(bound_to(plain_sleeve().glb(), rig.glb()));
  const std::vector<float> weights =
      out.floats(out.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"]);
  for (std::size_t i = 0; i < weights.size(); i += 4)
    EXPECT_NEAR(weights[i] + weights[i + 1] + weights[i + 2] + weights[i + 3], 1, 1e-6);
}

TEST_F(BindProduct, RefusesWhatHasNoSkeletonToBindTo) {
  RigScene rig;
  EXPECT_THAT(test::error_message<InvalidInput>([&] { bound_to(rig.glb(), plain_sleeve().glb()); }),
              HasSubstr("target.glb: shows no skinned mesh"));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "bound.glb"));
  EXPECT_THAT(test::error_message<InvalidInput>([&] {
                carry_product(file("a.obj", "v 0 0 0\n"), {directory_ / "b.obj"}, identity_motion(),
                              {{}, {}, nullptr, ModelPose::shown, directory_ / "target.glb"});
              }),
              HasSubstr("a.obj: only one .glb is bound to a skeleton"));
}

}  // namespace
}  // namespace bespoke

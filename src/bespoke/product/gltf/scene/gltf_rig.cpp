#include "bespoke/product/gltf/scene/gltf_rig.h"

#include <cmath>

#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

constexpr Eigen::Index vertices_at_a_time = Eigen::Index{1} << 14;

// Below this share of a skeleton's mean limb a translation is rounding, whose quotient says nothing of a
// limb.
constexpr double min_limb = 1e-3;

/// Sums of ∇Ψ over what nodes move.
struct Moved {
  Matrix3 sum = Matrix3::Zero();
  double weight = 0;

  void add(const Matrix3& jacobian, double by) {
    sum += by * jacobian;
    weight += by;
  }
};

/// The rotation of the polar decomposition; the identity of the identity, to the last bit.
Matrix3 polar_rotation(const Matrix3& matrix) {
  return matrix == Matrix3::Identity() ? matrix : nearest_rotation(matrix).rotation;
}

/// The orthonormal factor of a frame, which may mirror.
Matrix3 orientation(const Matrix3& linear) {
  return linear.determinant() < 0 ? Matrix3(-nearest_rotation(-linear).rotation) : polar_rotation(linear);
}

class RigCarrier {
 public:
  RigCarrier(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfPlan& plan,
             const PointMotion& motion)
      : file_(file), accessors_(accessors), scene_(plan.scene), motion_(motion) {
    for (std::size_t node = 0; node < scene_.is_rigged.size(); ++node)
      if (scene_.is_rigged[node]) rigged_.push_back(node);
    moved_.assign(motion.frames, std::vector<Moved>(scene_.is_rigged.size()));
  }

  std::vector<GltfCarriedRig> run() {
    const std::vector<GltfPart> meshes = file_.root().elements("meshes");
    for (const GltfShown& shown : scene_.shown)
      if (shown.skin || shown.holder)
        for (const GltfPart& primitive : meshes[shown.mesh].elements("primitives")) add(shown, primitive);
    const Points places = places_of_rigged();
    const std::vector<Points> images = motion_.at_other_points(places);
    const std::vector<Points> jacobians = motion_.jacobians(places);
    std::vector<GltfCarriedRig> result;
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      GltfCarriedRig rig = turned(moved_[frame], jacobians[frame]);
      place(rig, images[frame]);
      scale_limbs(rig);
      result.push_back(std::move(rig));
    }
    return result;
  }

 private:
  Points places_of_rigged() const {
    Points places(3, static_cast<Eigen::Index>(rigged_.size()));
    for (std::size_t i = 0; i < rigged_.size(); ++i)
      places.col(static_cast<Eigen::Index>(i)) = scene_.scene_from_node[rigged_[i]].offset;
    return places;
  }

  void add(const GltfShown& shown, const GltfPart& primitive) {
    const auto positions = primitive.member("attributes").index("POSITION", accessors_.size());
    // Viewers show such a mesh without a word, where it is bound.
    const bool has_joints = primitive.member("attributes").has("JOINTS_0");
    if (!positions || (shown.skin && !has_joints)) return;
    const GltfPlacement place = placement(file_, scene_, shown, primitive, accessors_);
    const GltfAccessor& vertices = accessors_[*positions];
    GltfWeights weights;
    if (shown.skin)
      weights = read_weights(file_, primitive, scene_.poses.at(*shown.skin).joints.size(), accessors_);
    const auto count = static_cast<Eigen::Index>(vertices.count);
    for (Eigen::Index first = 0; first < count; first += vertices_at_a_time) {
      const Eigen::Index block = std::min(vertices_at_a_time, count - first);
      const auto begin = static_cast<std::size_t>(first);
      const GltfValues x = read_values(vertices, file_.buffers, begin, static_cast<std::size_t>(block));
      const std::vector<Points> jacobians = motion_.jacobians(in_scene(place, x.cast<double>(), begin));
      for (std::size_t frame = 0; frame < motion_.frames; ++frame)
        add(shown, weights, begin, jacobians[frame], moved_[frame]);
    }
  }

  void add(const GltfShown& shown, const GltfWeights& weights, std::size_t first, const Points& jacobians,
           std::vector<Moved>& moved) const {
    for (Eigen::Index i = 0; i < jacobians.cols() / 3; ++i) {
      const Matrix3 jacobian = jacobians.middleCols<3>(3 * i);
      if (shown.holder) {
        moved[*shown.holder].add(jacobian, 1);
        continue;
      }
      const std::vector<std::size_t>& joints = scene_.poses.at(*shown.skin).joints;
      const std::size_t vertex = first + static_cast<std::size_t>(i);
      for (std::size_t k = weights.start[vertex]; k < weights.start[vertex + 1]; ++k)
        moved[joints[weights.weights[k].joint]].add(jacobian, weights.weights[k].weight);
    }
  }

  GltfCarriedRig turned(const std::vector<Moved>& own, const Points& jacobians) const {
    std::vector<Moved> below = own;
    const std::vector<std::size_t>& order = scene_.nodes.order;
    for (auto node = order.rbegin(); node != order.rend(); ++node)
      if (const auto parent = scene_.nodes.parent[*node]) {
        below[*parent].sum += below[*node].sum;
        below[*parent].weight += below[*node].weight;
      }
    GltfCarriedRig rig;
    rig.nodes.resize(own.size());
    for (std::size_t i = 0; i < rigged_.size(); ++i) {
      const std::size_t node = rigged_[i];
      const Moved& moved = own[node].weight > 0 ? own[node] : below[node];
      const Matrix3 mean = moved.weight > 0
                               ? Matrix3(moved.sum / moved.weight)
                               : Matrix3(jacobians.middleCols<3>(3 * static_cast<Eigen::Index>(i)));
      rig.nodes[node].turn = polar_rotation(mean);
    }
    return rig;
  }

  /// With Q the parent's orientation, the joint's rotation in the parent's frame turns by Qᵀ R̃_parentᵀ R̃ Q,
  /// also where scales that are not uniform keep a local frame from having the rotation R̃ R itself.
  void place(GltfCarriedRig& rig, const Points& images) const {
    std::vector<std::size_t> number(rig.nodes.size());
    for (std::size_t i = 0; i < rigged_.size(); ++i) number[rigged_[i]] = i;
    for (const std::size_t node : scene_.nodes.order) {
      GltfCarriedNode& own = rig.nodes[node];
      const AffineMap& before = scene_.scene_from_node[node];
      own.scene_from_node = before;
      if (!scene_.is_rigged[node]) continue;
      const auto parent = scene_.nodes.parent[node];
      const AffineMap parent_before = parent ? scene_.scene_from_node[*parent] : AffineMap();
      const AffineMap parent_now = parent ? rig.nodes[*parent].scene_from_node : AffineMap();
      const Matrix3 parent_turn = parent ? rig.nodes[*parent].turn : Matrix3::Identity();
      const Vector3 image = images.col(static_cast<Eigen::Index>(number[node]));
      const Matrix3 q = orientation(parent_before.linear);
      if (own.turn != parent_turn)
        own.local_turn = polar_rotation(q.transpose() * parent_turn.transpose() * own.turn * q);
      if (!parent || !scene_.is_rigged[*parent]) own.shift_turn = own.local_turn;
      const AffineMap local = composed(inverse_of(parent_before), before);
      own.translation = own.translation_before = local.offset;
      if (is_same(parent_now, parent_before) && own.local_turn == Matrix3::Identity() &&
          image == before.offset)
        continue;
      rig.is_changed = true;
      own.translation = inverse_of(parent_now) * image;
      own.scene_from_node = composed(parent_now, {own.local_turn * local.linear, own.translation});
    }
  }

  /// Translations by the ratio of the limb's lengths; roots, and joints that have none, by that of all limbs.
  void scale_limbs(GltfCarriedRig& rig) const {
    if (!rig.is_changed) return;
    double before = 0, now = 0, limbs = 0;
    const auto for_limbs = [&](const auto& use) {
      for (const std::size_t node : rigged_) {
        const auto parent = scene_.nodes.parent[node];
        const bool is_limb = parent && scene_.is_rigged[*parent];
        use(rig.nodes[node], is_limb, is_limb ? scene_.scene_from_node[*parent].linear : Matrix3::Identity(),
            is_limb ? rig.nodes[*parent].scene_from_node.linear : Matrix3::Identity());
      }
    };
    for_limbs([&](const GltfCarriedNode& node, bool is_limb, const Matrix3& from, const Matrix3& to) {
      if (!is_limb) return;
      before += (from * node.translation_before).norm();
      now += (to * node.translation).norm();
      ++limbs;
    });
    const double all = before > 0 ? now / before : 1;
    for_limbs([&](GltfCarriedNode& node, bool is_limb, const Matrix3& from, const Matrix3&) {
      const bool has_length = is_limb && (from * node.translation_before).norm() > min_limb * before / limbs;
      node.scale = has_length ? node.translation.norm() / node.translation_before.norm() : all;
    });
  }

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  const GltfScene& scene_;
  const PointMotion& motion_;
  std::vector<std::size_t> rigged_;        ///< nodes
  std::vector<std::vector<Moved>> moved_;  ///< of every frame, of every node
};

}  // namespace

bool GltfCarriedNode::moves_translations() const {
  return translation != translation_before || scale != 1 || shift_turn != Matrix3::Identity();
}

std::vector<GltfCarriedRig> carry_rig(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                      const GltfPlan& plan, const PointMotion& motion) {
  return RigCarrier(file, accessors, plan, motion).run();
}

}  // namespace bespoke

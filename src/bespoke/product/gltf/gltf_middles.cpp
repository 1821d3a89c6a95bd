#include "bespoke/product/gltf/gltf_middles.h"

#include <algorithm>
#include <cmath>

#include "bespoke/product/carry/directions.h"

namespace bespoke {
namespace {

constexpr Eigen::Index joints_a_set = 4;

bool is_direction(const std::string& name) { return name == "NORMAL" || name == "TANGENT"; }

/// An application's own whole numbers, and the numbers of features (EXT_mesh_features), which may be floats.
bool is_name(const std::string& name, const GltfAccessor& accessor) {
  return name.starts_with("JOINTS_") || name.starts_with("_FEATURE_ID_") ||
         (name.starts_with("_") && accessor.component != GltfComponent::real && !accessor.is_normalized);
}

/// The values of the vertices of the file, with space for the others.
GltfVertexData read_vertex_data(const GltfPart& list, const std::string& name,
                                const std::vector<GltfAccessor>& accessors,
                                const std::vector<GltfBuffer>& buffers, const GltfMiddles& middles) {
  const GltfAccessor& accessor = accessors[*list.index(name.c_str(), accessors.size())];
  if (accessor.count != middles.own)
    list.fail_at(name.c_str(), "has " + std::to_string(accessor.count) + " values, but there are " +
                                   std::to_string(middles.own) + " positions");
  if (accessor.component == GltfComponent::uint32)
    list.fail_at(name.c_str(), "must be of floats or of 8 or 16 bits, which " + accessor.pointer + " is not");
  GltfVertexData vertex_data{read_values(accessor, buffers, 0, accessor.count), accessor.component,
                             accessor.is_normalized};
  vertex_data.values.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(middles.count()));
  return vertex_data;
}

/// Fills what is behind the file's vertices with `middle(a, b)` of the ends' numbers.
template <class Middle>
void fill(GltfValues& values, const GltfMiddles& middles, const Middle& middle) {
  auto at = static_cast<Eigen::Index>(middles.own);
  for (const auto& [a, b] : middles.ends)
    values.col(at++) = middle(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
}

Eigen::VectorXf mean_of(const GltfValues& values, Eigen::Index a, Eigen::Index b) {
  return (0.5 * (values.col(a).cast<double>() + values.col(b).cast<double>())).cast<float>();
}

Vector3 direction_at(const GltfValues& values, Eigen::Index i) {
  return values.col(i).head<3>().cast<double>();
}

void fill_attribute(const std::string& name, bool has_no_middle, GltfVertexData& vertex_data,
                    const GltfMiddles& middles) {
  GltfValues& values = vertex_data.values;
  fill(values, middles, [&](Eigen::Index a, Eigen::Index b) -> Eigen::VectorXf {
    if (has_no_middle) return values.col(a);
    if (!is_direction(name)) return mean_of(values, a, b);
    Eigen::VectorXf middle = values.col(a);
    const Vector3 direction = middle_direction(direction_at(values, a), direction_at(values, b));
    // What whole numbers make of a unit vector is not as long, and would be rounded once more.
    const bool is_rounded = vertex_data.component != GltfComponent::real;
    middle.head<3>() = (is_rounded ? direction.normalized() : direction).cast<float>();
    return middle;
  });
}

/// One or several sets of joints and their weights.
class SkinMiddles {
 public:
  explicit SkinMiddles(GltfVertexDataByName& attributes) {
    for (int set = 0;; ++set) {
      const auto joints = attributes.find("JOINTS_" + std::to_string(set));
      const auto weights = attributes.find("WEIGHTS_" + std::to_string(set));
      if (joints == attributes.end() || weights == attributes.end()) break;
      if (joints->second.values.rows() != joints_a_set || weights->second.values.rows() != joints_a_set)
        break;
      joints_.push_back(&joints->second);
      weights_.push_back(&weights->second);
    }
  }

  void fill(const GltfMiddles& middles) {
    if (joints_.empty()) return;
    auto at = static_cast<Eigen::Index>(middles.own);
    for (const auto& [a, b] : middles.ends)
      store(merged(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)), at++);
  }

 private:
  struct Hold {
    float joint;
    double weight;
  };

  Eigen::Index slots() const { return joints_a_set * static_cast<Eigen::Index>(joints_.size()); }

  /// The joints of both ends, the one that weighs most first, no more than there is space for.
  std::vector<Hold> merged(Eigen::Index a, Eigen::Index b) const {
    std::map<float, double> weight_of_joint;
    double sum = 0;
    for (std::size_t set = 0; set < joints_.size(); ++set)
      for (const Eigen::Index vertex : {a, b})
        for (Eigen::Index k = 0; k < joints_a_set; ++k) {
          const double weight = 0.5 * static_cast<double>(weights_[set]->values(k, vertex));
          if (!(weight > 0)) continue;
          weight_of_joint[joints_[set]->values(k, vertex)] += weight;
          sum += weight;
        }
    std::vector<Hold> holds;
    for (const auto& [joint, weight] : weight_of_joint) holds.push_back({joint, weight});
    std::stable_sort(holds.begin(), holds.end(),
                     [](const Hold& p, const Hold& q) { return p.weight > q.weight; });
    holds.resize(std::min(holds.size(), static_cast<std::size_t>(slots())));
    double kept = 0;
    for (const Hold& hold : holds) kept += hold.weight;
    for (Hold& hold : holds) hold.weight *= sum / kept;
    round(holds, sum);
    return holds;
  }

  /// Shares in whole numbers keep their sum: the largest one has what rounding leaves over.
  void round(std::vector<Hold>& holds, double sum) const {
    const GltfComponent component = weights_.front()->component;
    if (component == GltfComponent::real || holds.empty()) return;
    const double one = stored_number(component, true, 1);
    double left = std::nearbyint(sum * one);
    for (Hold& hold : holds) left -= hold.weight = std::nearbyint(hold.weight * one);
    holds.front().weight += left;
    for (Hold& hold : holds) hold.weight /= one;
  }

  void store(const std::vector<Hold>& holds, Eigen::Index vertex) {
    for (Eigen::Index slot = 0; slot < slots(); ++slot) {
      const auto i = static_cast<std::size_t>(slot);
      const bool is_used = i < holds.size() && holds[i].weight > 0;
      const auto set = static_cast<std::size_t>(slot / joints_a_set);
      joints_[set]->values(slot % joints_a_set, vertex) = is_used ? holds[i].joint : 0;
      weights_[set]->values(slot % joints_a_set, vertex) = is_used ? static_cast<float>(holds[i].weight) : 0;
    }
  }

  std::vector<GltfVertexData*> joints_, weights_;
};

}  // namespace

GltfVertexDataByName middle_attributes(const GltfPart& attributes, const std::vector<GltfAccessor>& accessors,
                                       const std::vector<GltfBuffer>& buffers, const GltfMiddles& middles) {
  GltfVertexDataByName result;
  for (const std::string& name : attributes.names()) {
    GltfVertexData& vertex_data = result[name] =
        read_vertex_data(attributes, name, accessors, buffers, middles);
    const GltfAccessor& accessor = accessors[*attributes.index(name.c_str(), accessors.size())];
    fill_attribute(name, is_name(name, accessor), vertex_data, middles);
    if (name == "POSITION") vertex_data.component = GltfComponent::real;
  }
  SkinMiddles(result).fill(middles);
  return result;
}

GltfVertexDataByName middle_differences(const GltfPart& target, const GltfVertexDataByName& attributes,
                                        const std::vector<GltfAccessor>& accessors,
                                        const std::vector<GltfBuffer>& buffers, const GltfMiddles& middles) {
  GltfVertexDataByName result;
  for (const std::string& name : target.names()) {
    GltfVertexData& vertex_data = result[name] = read_vertex_data(target, name, accessors, buffers, middles);
    vertex_data.component = GltfComponent::real;
    GltfValues& values = vertex_data.values;
    const auto base = attributes.find(name);
    if (!is_direction(name) || base == attributes.end()) {
      fill_attribute({}, false, vertex_data, middles);
      continue;
    }
    const GltfValues& own = base->second.values;
    fill(values, middles, [&](Eigen::Index a, Eigen::Index b) -> Eigen::VectorXf {
      const Vector3 p = direction_at(own, a), q = direction_at(own, b);
      const Vector3 morphed = middle_direction(p + direction_at(values, a), q + direction_at(values, b));
      return (morphed - middle_direction(p, q)).cast<float>();
    });
  }
  return result;
}

}  // namespace bespoke

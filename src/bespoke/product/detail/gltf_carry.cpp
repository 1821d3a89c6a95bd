#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/detail/directions.h"
#include "bespoke/product/detail/gltf_plan.h"
#include "bespoke/product/detail/gltf_text.h"
#include "bespoke/product/detail/product_formats.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

constexpr Eigen::Index points_at_a_time = Eigen::Index{1} << 16;

// Quantised positions stay so where they lose less than this, relative to their largest coordinate.
constexpr double quantisation_tolerance = 1e-7;

using Values = Eigen::MatrixXd;

/// A file that is being made: the same JSON for all frames to begin with, and bytes of its own.
struct Frame {
  GltfJson json;
  std::vector<std::string> buffers;
  bool is_changed = false;  ///< any value
};

/// Mesh coordinates through the scene's motion and back: image and Jacobian of one frame.
struct LocalMotion {
  Points images, jacobians;
};

class GltfCarrier {
 public:
  GltfCarrier(const InputFile& file, const PointMotion& motion, const Progress& progress)
      : model_(read_gltf(file)), plan_(plan_gltf(model_)), motion_(motion) {
    if (plan_.tasks.empty()) throw FormatError(file.path().string() + ": the file has no vertices");
    frames_.assign(motion.frames, {plan_.json, model_.buffers, false});
    for (const GltfTask& task : plan_.tasks) {
      progress.check();
      const std::vector<Values> carried = carry(task);
      for (std::size_t frame = 0; frame < frames_.size(); ++frame)
        store(task, carried[frame], frames_[frame]);
      const auto count = static_cast<std::size_t>(model_.accessors[task.source()].count);
      (task.role == GltfRole::position ? summary_.points : summary_.directions) += count;
    }
    // Where nothing moves, nothing needs copies either.
    for (Frame& frame : frames_)
      if (!frame.is_changed) frame = {model_.json, model_.buffers, false};
    summary_.warnings = plan_.warnings;
  }

  CarrySummary write(std::vector<OutputFile>& outputs) {
    for (std::size_t frame = 0; frame < outputs.size(); ++frame) {
      write_companions(outputs[frame].name(), frames_[frame]);
      const std::string first = frames_[frame].buffers.empty() ? "" : frames_[frame].buffers.front();
      outputs[frame].write(glb_bytes(model_, text(frames_[frame]), first));
    }
    return summary_;
  }

 private:
  /// The motion of points of a mesh, for every frame: with y = L x + b the scene's point and Ψ the scene's
  /// motion, x + L⁻¹ (Ψ(y) − y), which is x itself where nothing moves, and L⁻¹ J L.
  std::vector<LocalMotion> local_motion(const Points& x, std::size_t transform, bool with_jacobians) const {
    const AffineMap& map = plan_.transforms[transform];
    const Matrix3 back = map.linear.inverse();
    const Points y = map * x;
    const std::vector<Points> images = motion_.images(y);
    std::vector<Points> jacobians;
    if (with_jacobians) jacobians = motion_.jacobians(y);
    std::vector<LocalMotion> result(motion_.frames);
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      result[frame].images = x + back * (images[frame] - y);
      if (!with_jacobians) continue;
      Points& local = result[frame].jacobians = jacobians[frame];
      for (Eigen::Index i = 0; i < local.cols(); i += 3)
        if (local.middleCols<3>(i) != Matrix3::Identity())
          local.middleCols<3>(i) = (back * local.middleCols<3>(i) * map.linear).eval();
    }
    return result;
  }

  /// What values of the role become where the motion is this.
  static Points moved(GltfRole role, const Points& values, const LocalMotion& motion) {
    if (role == GltfRole::position) return motion.images;
    return role == GltfRole::normal ? moved_normals(values, motion.jacobians)
                                    : moved_tangents(values, motion.jacobians);
  }

  std::vector<Values> carry(const GltfTask& task) const {
    const Values positions = model_.values(task.positions);
    const Values base = task.base == task.positions ? positions : model_.values(task.base);
    const bool is_morph = task.difference.has_value();
    const Values difference = is_morph ? model_.values(*task.difference) : Values();
    const Values shift =
        is_morph && task.difference_of_positions ? model_.values(*task.difference_of_positions) : Values();
    std::vector<Values> result(motion_.frames, is_morph ? difference : base);
    const bool with_jacobians = task.role != GltfRole::position;
    const auto count = static_cast<std::size_t>(positions.cols());
    parallel_for(count, points_at_a_time, [&](std::size_t begin, std::size_t end) {
      const auto first = static_cast<Eigen::Index>(begin), size = static_cast<Eigen::Index>(end - begin);
      const Points x = positions.middleCols(first, size);
      const Points values = base.block(0, first, 3, size);
      const std::vector<LocalMotion> at_base = local_motion(x, task.transform, with_jacobians);
      std::vector<LocalMotion> at_morph = at_base;
      Points morphed = values;
      if (is_morph) {
        morphed += difference.block(0, first, 3, size);
        if (shift.cols() > 0)
          at_morph = local_motion(x + Points(shift.middleCols(first, size)), task.transform, with_jacobians);
      }
      for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
        const Points carried = moved(task.role, values, at_base[frame]);
        if (!is_morph) {
          result[frame].block(0, first, 3, size) = carried;
          continue;
        }
        // Only what the motion changes, so that a difference that stays keeps its bits.
        const Points carried_morph = moved(task.role, morphed, at_morph[frame]);
        result[frame].block(0, first, 3, size) += (carried_morph - morphed) - (carried - values);
      }
    });
    return result;
  }

  void store(const GltfTask& task, const Values& carried, Frame& frame) {
    const GltfAccessor& accessor = model_.accessors[task.source()];
    if (!(carried.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <=
          static_cast<double>(std::numeric_limits<float>::max())))
      throw InvalidInput(model_.path.string() + ": /accessors/" + std::to_string(task.source()) +
                         ": a point goes to a place that is not finite in single precision");
    if (!frame.is_changed) frame.is_changed = carried != model_.values(task.source());
    const bool is_dense = accessor.has_view && !accessor.is_sparse;
    if (task.is_copy() || !is_dense || loses_digits(task, accessor, carried)) {
      if (!task.is_copy() && carried == model_.values(task.source())) return;
      store_anew(task.result, carried, frame);
    } else {
      store_values(accessor, carried, frame.buffers[accessor.buffer]);
    }
    update_bounds(task, accessor, is_dense && !task.is_copy(), carried, frame);
  }

  /// Whether whole numbers cannot hold positions. Directions are as coarse as their file has them.
  static bool loses_digits(const GltfTask& task, const GltfAccessor& accessor, const Values& carried) {
    const double limit = component_limit(accessor.component_type);
    if (task.role != GltfRole::position || limit == 0) return false;
    const double scale = accessor.is_normalized ? limit : 1;
    const double least = accessor.component_type == 5120 || accessor.component_type == 5122 ? -limit : 0;
    const auto stored = (carried.array() * scale).round().max(least).min(limit) / scale;
    return (stored - carried.array()).abs().maxCoeff() >
           quantisation_tolerance * std::max(carried.cwiseAbs().maxCoeff(), 1 / scale);
  }

  /// Floats behind the first buffer's bytes, in a view of their own.
  void store_anew(std::size_t index, const Values& carried, Frame& frame) {
    if (frame.buffers.empty()) model_.fail("/buffers", "there is none");
    std::string& buffer = frame.buffers.front();
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    GltfAccessor floats;
    floats.component_type = 5126;
    floats.components = static_cast<int>(carried.rows());
    floats.count = static_cast<std::uint64_t>(carried.cols());
    floats.stride = sizeof(float) * static_cast<std::size_t>(carried.rows());
    floats.offset = buffer.size();
    buffer.resize(buffer.size() + static_cast<std::size_t>(floats.count * floats.stride));
    store_values(floats, carried, buffer);
    frame.json["bufferViews"].push_back({{"buffer", 0},
                                         {"byteOffset", floats.offset},
                                         {"byteLength", floats.count * floats.stride},
                                         {"target", 34962}});
    GltfJson& accessor = frame.json["accessors"][index];
    for (const char* key : {"sparse", "normalized", "byteOffset"}) accessor.erase(key);
    accessor["bufferView"] = frame.json["bufferViews"].size() - 1;
    accessor["componentType"] = 5126;
    frame.json["buffers"][0]["byteLength"] = buffer.size();
  }

  /// The bounds are those of the numbers as they are stored.
  void update_bounds(const GltfTask& task, const GltfAccessor& accessor, bool as_before,
                     const Values& carried, Frame& frame) {
    GltfJson& json = frame.json["accessors"][task.result];
    if (!json.contains("min") && !json.contains("max")) return;
    const double limit = as_before ? component_limit(accessor.component_type) : 0;
    GltfJson least = GltfJson::array(), most = GltfJson::array();
    for (Eigen::Index k = 0; k < carried.rows(); ++k) {
      const auto stored = [&](double value) {
        if (limit == 0) return static_cast<double>(static_cast<float>(value));
        return std::nearbyint(accessor.is_normalized ? value * limit : value);
      };
      least.push_back(shortest(stored(carried.row(k).minCoeff())));
      most.push_back(shortest(stored(carried.row(k).maxCoeff())));
    }
    if (is_same(json, "min", least) && is_same(json, "max", most)) return;
    if (json.contains("min")) json["min"] = std::move(least);
    if (json.contains("max")) json["max"] = std::move(most);
  }

  static GltfJson shortest(double value) {
    if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<long long>(value);
    return value;
  }

  /// Whether the bounds in the file, which may be rounded, are these as floats.
  static bool is_same(const GltfJson& accessor, const char* key, const GltfJson& bounds) {
    if (!accessor.contains(key)) return true;
    const GltfJson& old = accessor[key];
    if (!old.is_array() || old.size() != bounds.size()) return false;
    for (std::size_t i = 0; i < bounds.size(); ++i)
      if (!old[i].is_number() ||
          static_cast<float>(old[i].get<double>()) != static_cast<float>(bounds[i].get<double>()))
        return false;
    return true;
  }

  /// Buffers that are files of their own get names after the output.
  void write_companions(const fs::path& output, Frame& frame) {
    std::vector<fs::path> inputs{model_.path};
    for (std::size_t i = 0; i < frame.buffers.size(); ++i) {
      GltfJson& buffer = frame.json["buffers"][i];
      if (!buffer.contains("uri")) continue;
      const std::string uri = buffer["uri"].get<std::string>();
      if (uri.rfind("data:", 0) == 0) {
        if (model_.buffers[i] != frame.buffers[i])
          buffer["uri"] = uri.substr(0, uri.find(";base64,") + 8) + encode_base64(frame.buffers[i]);
        continue;
      }
      const std::string name =
          output.stem().string() + (frame.buffers.size() > 1 ? "_" + std::to_string(i) : "") + ".bin";
      const fs::path path = output.parent_path() / name;
      std::error_code error;
      if (fs::equivalent(path, model_.path.parent_path() / decoded_uri(uri), error))
        throw InvalidInput(path.string() + ": is a buffer of " + model_.path.string() +
                           " and would be overwritten; choose another directory or name");
      write_outputs({path}, [&](std::vector<OutputFile>& open) { open.front().write(frame.buffers[i]); });
      summary_.companions.push_back(path);
      if (decoded_uri(uri) != name) buffer["uri"] = name;
    }
  }

  /// The JSON with the elements replaced that changed, and new ones behind the old.
  std::string text(const Frame& frame) const {
    struct Edit {
      std::size_t begin, end;
      std::string text;
    };
    std::vector<Edit> edits;
    for (const char* key : {"accessors", "bufferViews", "buffers", "meshes", "nodes"}) {
      if (!model_.json.contains(key)) continue;
      const JsonArray array = find_array(model_.text, key);
      const GltfJson& now = frame.json[key];
      for (std::size_t i = 0; i < array.elements.size(); ++i) {
        if (now[i] == model_.json[key][i]) continue;
        const auto begin = static_cast<std::size_t>(array.elements[i].data() - model_.text.data());
        edits.push_back({begin, begin + array.elements[i].size(), now[i].dump()});
      }
      std::string behind;
      for (std::size_t i = array.elements.size(); i < now.size(); ++i)
        behind += (i > 0 ? "," : "") + now[i].dump();
      if (!behind.empty()) edits.push_back({array.end, array.end, behind});
    }
    std::sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
    std::string result;
    std::size_t at = 0;
    for (const Edit& edit : edits) {
      result.append(model_.text, at, edit.begin - at).append(edit.text);
      at = edit.end;
    }
    return result.append(model_.text, at);
  }

  GltfModel model_;
  GltfPlan plan_;
  const PointMotion& motion_;
  std::vector<Frame> frames_;
  CarrySummary summary_;
};

}  // namespace

CarrySummary carry_gltf(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                        const Progress& progress) try {
  return GltfCarrier(file, motion, progress).write(outputs);
} catch (const nlohmann::json::exception& error) {
  // A member of another type than its name asks for.
  throw FormatError(file.path().string() + ": the JSON is no glTF: " + error.what());
}

}  // namespace bespoke

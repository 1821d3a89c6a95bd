#include "bespoke/product/detail/gltf_frame.h"

#include <algorithm>
#include <cmath>

#include "bespoke/parallel.h"
#include "bespoke/product/detail/number_text.h"

namespace bespoke {
namespace {

constexpr std::size_t vectors_at_a_time = std::size_t{1} << 16;
constexpr std::size_t alignment = 4;      // of vertex attributes in a buffer, bytes
constexpr int vertex_attributes = 34962;  // what a view is for: ARRAY_BUFFER
/// Whole numbers without a point.
GltfJson json_number(double value) {
  if (value == std::floor(value) && std::abs(value) < largest_whole) return static_cast<std::int64_t>(value);
  return value;
}

/// Whether the bounds in the file, which may be rounded, are these as floats.
bool is_same(const GltfJson& old, const GltfJson& bounds) {
  if (!old.is_array() || old.size() != bounds.size()) return false;
  for (std::size_t i = 0; i < bounds.size(); ++i)
    if (!old[i].is_number() || old[i].get<float>() != bounds[i].get<float>()) return false;
  return true;
}

}  // namespace

void GltfFrame::store(const GltfTask& task, const GltfValues& values) {
  const GltfAccessor& accessor = accessors_[task.source()];
  const bool is_real = accessor.component == GltfComponent::real;
  // Whole numbers are too coarse for positions, and too small for differences.
  const bool is_fine = is_real || (task.role != GltfRole::position && !task.difference);
  if (!task.is_copy() && accessor.dense && !accessor.sparse && is_fine) {
    store_in(*accessor.dense, values);
    return update_bounds(task.result, accessor.component, accessor.is_normalized, values);
  }
  if (task.is_copy() || !accessor.sparse || !is_real || !store_sparse(accessor, values))
    append(task.result, values);
  update_bounds(task.result, GltfComponent::real, false, values);
}

void GltfFrame::store_in(const GltfPlace& place, const GltfValues& values) {
  is_changed_[place.buffer] = true;
  parallel_for(place.count, vectors_at_a_time, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin), size = static_cast<Eigen::Index>(end - begin);
    store_values(place, begin, values.middleCols(first, size), buffers_[place.buffer]);
  });
}

// Returns false where values change that are not among the sparse ones.
bool GltfFrame::store_sparse(const GltfAccessor& accessor, const GltfValues& values) {
  GltfValues expected = read_values(accessor, buffers_, 0, accessor.count);
  GltfValues own(values.rows(), static_cast<Eigen::Index>(accessor.sparse->indices.size()));
  for (Eigen::Index i = 0; i < own.cols(); ++i) {
    const std::uint32_t at = accessor.sparse->indices[static_cast<std::size_t>(i)];
    expected.col(at) = own.col(i) = values.col(at);
  }
  if (expected != values) return false;
  store_in(accessor.sparse->values, own);
  return true;
}

void GltfFrame::append(std::size_t index, const GltfValues& values) {
  if (buffers_.empty()) file_.root().fail("has no buffer for values that change");
  std::string& buffer = buffers_.front();
  GltfPlace place;
  place.components = static_cast<std::size_t>(values.rows());
  place.count = static_cast<std::size_t>(values.cols());
  place.stride = place.vector_size();
  place.offset = (buffer.size() + alignment - 1) / alignment * alignment;
  buffer.resize(place.end());
  store_in(place, values);
  json_["bufferViews"].push_back({{"buffer", 0},
                                  {"byteOffset", place.offset},
                                  {"byteLength", place.end() - place.offset},
                                  {"target", vertex_attributes}});
  json_["buffers"][0]["byteLength"] = buffer.size();
  GltfJson& accessor = json_["accessors"][index];
  for (const char* key : {"sparse", "normalized", "byteOffset"}) accessor.erase(key);
  accessor["bufferView"] = json_["bufferViews"].size() - 1;
  accessor["componentType"] = static_cast<int>(GltfComponent::real);
}

// The bounds are those of the numbers as they are stored.
void GltfFrame::update_bounds(std::size_t index, GltfComponent component, bool is_normalized,
                              const GltfValues& values) {
  GltfJson& accessor = json_["accessors"][index];
  if (!accessor.contains("min") && !accessor.contains("max")) return;
  struct Bounds {
    Eigen::VectorXf least, most;
  };
  const auto chunk = [&](std::size_t begin, std::size_t end) {
    const auto columns =
        values.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin));
    return Bounds{columns.rowwise().minCoeff(), columns.rowwise().maxCoeff()};
  };
  const Bounds first{values.col(0), values.col(0)};
  const Bounds bounds = parallel_reduce(static_cast<std::size_t>(values.cols()), vectors_at_a_time, first,
                                        chunk, [](const Bounds& a, const Bounds& b) {
                                          return Bounds{a.least.cwiseMin(b.least), a.most.cwiseMax(b.most)};
                                        });
  GltfJson least = GltfJson::array(), most = GltfJson::array();
  for (Eigen::Index k = 0; k < values.rows(); ++k) {
    least.push_back(json_number(stored_number(component, is_normalized, bounds.least[k])));
    most.push_back(json_number(stored_number(component, is_normalized, bounds.most[k])));
  }
  if (accessor.contains("min") && !is_same(accessor["min"], least)) accessor["min"] = std::move(least);
  if (accessor.contains("max") && !is_same(accessor["max"], most)) accessor["max"] = std::move(most);
}

void GltfFrame::name_buffer(std::size_t buffer, const std::string& file_name) {
  GltfJson& uri = json_["buffers"][buffer]["uri"];
  if (file_name_of_uri(uri.get<std::string>()) != file_name) uri = uri_of_file_name(file_name);
}

std::string GltfFrame::text() {
  for (std::size_t i = 0; i < buffers_.size(); ++i) {
    GltfJson& buffer = json_["buffers"][i];
    if (!is_changed_[i] || !buffer.contains("uri")) continue;
    const std::string uri = buffer["uri"].get<std::string>();
    if (is_data_uri(uri)) buffer["uri"] = data_uri_of(uri, buffers_[i]);
  }
  return edited_json(file_.text, file_.json, json_);
}

}  // namespace bespoke

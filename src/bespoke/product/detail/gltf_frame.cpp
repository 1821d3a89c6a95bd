#include "bespoke/product/detail/gltf_frame.h"

#include "bespoke/parallel.h"
#include "bespoke/product/detail/gltf_additions.h"

namespace bespoke {
namespace {

constexpr std::size_t vectors_at_a_time = std::size_t{1} << 16;

}  // namespace

void GltfFrame::store(const GltfTask& task, const GltfValues& values) {
  const GltfAccessor& accessor = accessors_[task.source()];
  const bool is_real = accessor.component == GltfComponent::real;
  // Whole numbers are too coarse for positions, and too small for differences.
  const bool is_fine = is_real || (task.role != GltfRole::position && !task.difference);
  if (!task.is_copy() && accessor.dense && !accessor.sparse && is_fine) {
    store_in(*accessor.dense, values);
    return update_bounds(json_["accessors"][task.result], accessor.component, accessor.is_normalized, values);
  }
  if (task.is_copy() || !accessor.sparse || !is_real || !store_sparse(accessor, values))
    append(task.result, values);
  update_bounds(json_["accessors"][task.result], GltfComponent::real, false, values);
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
  GltfPlace room;
  room.components = static_cast<std::size_t>(values.rows());
  room.count = static_cast<std::size_t>(values.cols());
  store_in(add_view(json_, buffers_, room, GltfTarget::vertices), values);
  GltfJson& accessor = json_["accessors"][index];
  for (const char* key : {"sparse", "normalized", "byteOffset"}) accessor.erase(key);
  accessor["bufferView"] = json_["bufferViews"].size() - 1;
  accessor["componentType"] = static_cast<int>(GltfComponent::real);
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

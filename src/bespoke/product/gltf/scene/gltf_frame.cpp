#include "bespoke/product/gltf/scene/gltf_frame.h"

#include <utility>

namespace bespoke {

void GltfFrame::store(const GltfTask& task, GltfValues values) {
  const GltfAccessor& accessor = accessors_[task.source()];
  const bool is_real = accessor.component == GltfComponent::real;
  // Whole numbers are too coarse for positions, and too small for differences.
  const bool is_fine = is_real || (task.role != GltfRole::position && !task.difference);
  GltfJson& json = json_["accessors"][task.result];
  if (!task.is_copy() && accessor.dense && !accessor.sparse && is_fine) {
    update_bounds(json, accessor.component, accessor.is_normalized, values);
    return store_in(*accessor.dense, std::move(values));
  }
  update_bounds(json, GltfComponent::real, false, values);
  if (task.is_copy() || !accessor.sparse || !is_real || !store_sparse(accessor, values))
    append(task.result, std::move(values), GltfTarget::vertices);
}

void GltfFrame::store_in(const GltfPlace& place, GltfValues values) {
  is_changed_[place.buffer] = true;
  buffers_[place.buffer].replace(rows_of_values(place, std::move(values)));
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
  store_in(accessor.sparse->values, std::move(own));
  return true;
}

std::size_t GltfFrame::store_data(std::optional<std::size_t> own, const std::string& type,
                                  GltfValues values) {
  if (!own) return add(type, GltfComponent::real, {}, std::move(values));
  const GltfAccessor& accessor = accessors_[*own];
  update_bounds(json_["accessors"][*own], GltfComponent::real, false, values);
  if (accessor.dense && !accessor.sparse && accessor.component == GltfComponent::real)
    store_in(*accessor.dense, std::move(values));
  else
    append(*own, std::move(values), {});
  return *own;
}

std::size_t GltfFrame::add(const std::string& type, GltfComponent component, std::optional<GltfTarget> target,
                           GltfValues values) {
  if (buffers_.empty()) file_.root().fail("has no buffer for new values");
  GltfPlace place;
  place.component = component;
  place.components = static_cast<std::size_t>(values.rows());
  place.count = static_cast<std::size_t>(values.cols());
  store_in(add_view(json_, buffers_, place, target), std::move(values));
  json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                {"componentType", static_cast<int>(component)},
                                {"count", place.count},
                                {"type", type}});
  return json_["accessors"].size() - 1;
}

void GltfFrame::append(std::size_t index, GltfValues values, std::optional<GltfTarget> target) {
  if (buffers_.empty()) file_.root().fail("has no buffer for values that change");
  GltfPlace place;
  place.components = static_cast<std::size_t>(values.rows());
  place.count = static_cast<std::size_t>(values.cols());
  store_in(add_view(json_, buffers_, place, target), std::move(values));
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
    if (is_data_uri(uri)) buffer["uri"] = data_uri_of(uri, buffers_[i].content());
  }
  return edited_json(file_.text, file_.json, json_);
}

}  // namespace bespoke

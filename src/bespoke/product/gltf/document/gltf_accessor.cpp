#include "bespoke/product/gltf/document/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/gltf/document/gltf_extensions.h"

namespace bespoke {
namespace {

// Without bytes that bound it, a count is taken for a mistake beyond this.
constexpr std::uint64_t max_zeros = std::uint64_t{1} << 28;

constexpr std::size_t vectors_at_a_time = std::size_t{1} << 16;

std::size_t size_of(GltfComponent component) {
  switch (component) {
    case GltfComponent::int8:
    case GltfComponent::uint8:
      return 1;
    case GltfComponent::int16:
    case GltfComponent::uint16:
      return 2;
    case GltfComponent::uint32:
    case GltfComponent::real:
      break;
  }
  return 4;
}

struct Range {
  double least, most;
};

Range range_of(GltfComponent component) {
  switch (component) {
    case GltfComponent::int8:
      return {-127, 127};
    case GltfComponent::uint8:
      return {0, 255};
    case GltfComponent::int16:
      return {-32767, 32767};
    case GltfComponent::uint16:
      return {0, 65535};
    default:
      return {0, 4294967295.0};
  }
}

GltfComponent read_component(const GltfPart& part) {
  const std::uint64_t number = part.whole("componentType");
  if (number < 5120 || number > 5126 || number == 5124) part.fail_at("componentType", "is unknown");
  return static_cast<GltfComponent>(number);
}

std::size_t read_components(const GltfPart& part) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 7> types{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  const std::string type = part.text("type");
  for (const auto& [name, count] : types)
    if (type == name) return count;
  part.fail_at("type", "is unknown");
}

/// From the first byte of vector `first` to the last of `count` vectors, of which there is one.
std::string read_places(const GltfPlace& place, std::size_t first, std::size_t count,
                        const GltfBuffer& buffer) {
  std::string bytes((count - 1) * place.stride + place.vector_size(), '\0');
  buffer.read(place.offset + first * place.stride, bytes.data(), bytes.size());
  return bytes;
}

class AccessorReader {
 public:
  explicit AccessorReader(const GltfFile& file) : file_(file), views_(file.root().elements("bufferViews")) {}

  GltfAccessor read(const GltfPart& part) const {
    GltfAccessor accessor;
    accessor.pointer = part.pointer();
    accessor.type = part.text("type");
    accessor.component = read_component(part);
    accessor.components = read_components(part);
    accessor.is_normalized = part.flag("normalized");
    const std::uint64_t count = part.whole("count");
    if (count == 0) part.fail_at("count", "is zero");
    GltfPlace place{accessor.component, accessor.is_normalized, accessor.components, count, 0, 0, 0};
    if (part.has("bufferView"))
      accessor.dense = placed(part, place);
    else if (count > max_zeros)
      part.fail_at("count", "is more than can be without a bufferView");
    accessor.count = count;
    if (part.has("sparse")) accessor.sparse = read_sparse(part.member("sparse"), place);
    return accessor;
  }

 private:
  /// The same vectors where the part's view and offset say that they are.
  GltfPlace placed(const GltfPart& part, GltfPlace place) const {
    const GltfPart& view = views_[required(part, "bufferView", views_.size())];
    require_not_compressed(view);
    place.buffer = required(view, "buffer", file_.buffers.size());
    const std::uint64_t begin = view.whole_or("byteOffset", 0), length = view.whole("byteLength");
    const std::uint64_t size = file_.buffers[place.buffer].size();
    if (begin > size || length > size - begin) view.fail("ends behind its buffer");
    const std::uint64_t offset = part.whole_or("byteOffset", 0);
    place.stride = view.whole_or("byteStride", place.vector_size());
    if (place.stride < place.vector_size()) view.fail_at("byteStride", "is less than a vector has bytes");
    const bool fits = offset <= length && place.vector_size() <= length - offset &&
                      place.count - 1 <= (length - offset - place.vector_size()) / place.stride;
    if (!fits) part.fail("ends behind its buffer view");
    place.offset = begin + offset;
    return place;
  }

  static std::size_t required(const GltfPart& part, const char* key, std::size_t count) {
    if (!part.has(key)) part.fail(std::string("has no ") + key);
    return *part.index(key, count);
  }

  GltfAccessor::Sparse read_sparse(const GltfPart& part, GltfPlace place) const {
    GltfAccessor::Sparse sparse;
    const std::size_t count = place.count;
    place.count = part.whole("count");
    if (place.count == 0 || place.count > count) part.fail_at("count", "is not one of the accessor's");
    const GltfPart indices = part.member("indices");
    GltfPlace at = place;
    at.component = read_component(indices);
    if (range_of(at.component).least < 0 || at.component == GltfComponent::real)
      indices.fail_at("componentType", "is no type of numbers of vectors");
    at.components = 1;
    at = placed(indices, at);
    sparse.indices = read_indices(at);
    for (std::size_t i = 0; i < sparse.indices.size(); ++i)
      if (sparse.indices[i] >= count || (i > 0 && sparse.indices[i] <= sparse.indices[i - 1]))
        indices.fail("number " + std::to_string(i) + ", " + std::to_string(sparse.indices[i]) +
                     ", is not above the one before it and below " + std::to_string(count));
    sparse.values = placed(part.member("values"), place);
    return sparse;
  }

  std::vector<std::uint32_t> read_indices(const GltfPlace& at) const {
    std::vector<std::uint32_t> indices(at.count, 0);
    // Little-endian, so the low bytes are those of the smaller types.
    const std::string bytes = read_places(at, 0, at.count, file_.buffers[at.buffer]);
    for (std::size_t i = 0; i < at.count; ++i)
      std::memcpy(&indices[i], bytes.data() + i * at.stride, at.vector_size());
    return indices;
  }

  const GltfFile& file_;
  std::vector<GltfPart> views_;
};

template <class Stored>
void load(const GltfPlace& place, std::size_t first, const GltfBuffer& buffer, GltfValues& values) {
  if (values.cols() == 0) return;
  if (std::is_same_v<Stored, float> && place.stride == place.vector_size())
    return buffer.read(place.offset + first * place.stride, reinterpret_cast<char*>(values.data()),
                       static_cast<std::size_t>(values.size()) * sizeof(float));
  const std::string places = read_places(place, first, static_cast<std::size_t>(values.cols()), buffer);
  const char* bytes = places.data();
  const double limit = range_of(place.component).most;
  for (Eigen::Index i = 0; i < values.cols(); ++i, bytes += place.stride)
    for (Eigen::Index k = 0; k < values.rows(); ++k) {
      Stored stored;
      std::memcpy(&stored, bytes + static_cast<std::size_t>(k) * sizeof stored, sizeof stored);
      if constexpr (std::is_same_v<Stored, float>)
        values(k, i) = stored;
      else
        values(k, i) = static_cast<float>(place.is_normalized ? std::max(stored / limit, -1.0) : stored);
    }
}

void load(const GltfPlace& place, std::size_t first, const GltfBuffer& buffer, GltfValues& values) {
  switch (place.component) {
    case GltfComponent::int8:
      return load<std::int8_t>(place, first, buffer, values);
    case GltfComponent::uint8:
      return load<std::uint8_t>(place, first, buffer, values);
    case GltfComponent::int16:
      return load<std::int16_t>(place, first, buffer, values);
    case GltfComponent::uint16:
      return load<std::uint16_t>(place, first, buffer, values);
    case GltfComponent::uint32:
      return load<std::uint32_t>(place, first, buffer, values);
    case GltfComponent::real:
      return load<float>(place, first, buffer, values);
  }
}

/// Whether vectors of two places have a byte in common.
bool overlap(const GltfPlace& a, const GltfPlace& b) {
  if (a.buffer != b.buffer || a.end() <= b.offset || b.end() <= a.offset) return false;
  if (a.stride != b.stride) return true;
  // Interleaved attributes lie between one another.
  const GltfPlace& early = a.offset <= b.offset ? a : b;
  const GltfPlace& late = a.offset <= b.offset ? b : a;
  const std::size_t phase = (late.offset - early.offset) % a.stride;
  return phase < early.vector_size() || a.stride - phase < late.vector_size();
}

}  // namespace

std::size_t GltfPlace::vector_size() const { return components * size_of(component); }

std::vector<GltfAccessor> read_accessors(const GltfFile& file) {
  const AccessorReader reader(file);
  std::vector<GltfAccessor> accessors;
  for (const GltfPart& part : file.root().elements("accessors")) accessors.push_back(reader.read(part));
  return accessors;
}

GltfValues read_values(const GltfAccessor& accessor, const std::vector<GltfBuffer>& buffers,
                       std::size_t first, std::size_t count) {
  GltfValues values =
      GltfValues::Zero(static_cast<Eigen::Index>(accessor.components), static_cast<Eigen::Index>(count));
  if (accessor.dense) load(*accessor.dense, first, buffers[accessor.dense->buffer], values);
  if (!accessor.sparse) return values;
  const std::vector<std::uint32_t>& indices = accessor.sparse->indices;
  const auto begin = std::lower_bound(indices.begin(), indices.end(), first);
  const auto end = std::lower_bound(begin, indices.end(), first + count);
  GltfValues own(values.rows(), end - begin);
  const GltfPlace& place = accessor.sparse->values;
  load(place, static_cast<std::size_t>(begin - indices.begin()), buffers[place.buffer], own);
  for (auto at = begin; at != end; ++at)
    values.col(static_cast<Eigen::Index>(*at - first)) = own.col(at - begin);
  return values;
}

double stored_number(GltfComponent component, bool is_normalized, float value) {
  if (component == GltfComponent::real) return static_cast<double>(value);
  const Range range = range_of(component);
  const double number = static_cast<double>(value) * (is_normalized ? range.most : 1);
  return std::nearbyint(std::clamp(number, range.least, range.most));
}

GltfRows GltfPlace::rows(std::string packed) const {
  const auto owner = std::make_shared<const std::string>(std::move(packed));
  return {offset, stride, vector_size(), count, std::shared_ptr<const char>(owner, owner->data())};
}

GltfRows rows_of_values(const GltfPlace& place, GltfValues values) {
  if (place.component == GltfComponent::real) {
    const auto owner = std::make_shared<const GltfValues>(std::move(values));
    return {place.offset, place.stride, place.vector_size(), place.count,
            std::shared_ptr<const char>(owner, reinterpret_cast<const char*>(owner->data()))};
  }
  const std::size_t size = size_of(place.component);
  std::string packed(place.count * place.vector_size(), '\0');
  parallel_for(place.count, vectors_at_a_time, [&](std::size_t begin, std::size_t end) {
    char* to = packed.data() + begin * place.vector_size();
    for (std::size_t i = begin; i < end; ++i)
      for (Eigen::Index k = 0; k < values.rows(); ++k, to += size) {
        const auto number = static_cast<long long>(
            stored_number(place.component, place.is_normalized, values(k, static_cast<Eigen::Index>(i))));
        std::memcpy(to, &number, size);  // the low bytes come first
      }
  });
  return place.rows(std::move(packed));
}

std::vector<bool> shares_bytes(const std::vector<GltfAccessor>& accessors) {
  struct Owned {
    GltfPlace place;
    std::size_t accessor;
  };
  std::vector<Owned> places;
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    if (accessors[i].dense) places.push_back({*accessors[i].dense, i});
    if (accessors[i].sparse) places.push_back({accessors[i].sparse->values, i});
  }
  std::sort(places.begin(), places.end(), [](const Owned& a, const Owned& b) {
    return std::pair(a.place.buffer, a.place.offset) < std::pair(b.place.buffer, b.place.offset);
  });
  std::vector<bool> shared(accessors.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t k = i + 1; k < places.size() && places[k].place.buffer == places[i].place.buffer &&
                                places[k].place.offset < places[i].place.end();
         ++k)
      if (places[i].accessor != places[k].accessor && overlap(places[i].place, places[k].place))
        shared[places[i].accessor] = shared[places[k].accessor] = true;
  return shared;
}

}  // namespace bespoke

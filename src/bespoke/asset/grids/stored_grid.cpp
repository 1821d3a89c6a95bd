#include "bespoke/asset/grids/stored_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <sstream>
#include <type_traits>

#include "bespoke/error.h"

namespace bespoke {
namespace {

class ByteWriter {
 public:
  template <class T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void vector(const Vector3& value) {
    for (const double coordinate : value) number(coordinate);
  }
  template <class Container>
  void sequence(const Container& items) {
    number(static_cast<std::uint64_t>(items.size()));
    bytes_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(items[0]));
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  T number() {
    T value;
    std::memcpy(&value, next(sizeof value), sizeof value);
    return value;
  }
  Vector3 vector() {
    const double x = number<double>(), y = number<double>(), z = number<double>();
    return {x, y, z};
  }
  template <class Container>
  Container sequence() {
    using Item = typename Container::value_type;
    const auto count = number<std::uint64_t>();
    if (count > rest_.size() / sizeof(Item)) throw InvalidInput("a sequence is longer than what holds it");
    Container items(count, Item{});
    if (count > 0) std::memcpy(items.data(), next(count * sizeof(Item)), count * sizeof(Item));
    return items;
  }
  /// A count of things that take at least one byte each.
  std::uint64_t count() {
    const auto value = number<std::uint64_t>();
    if (value > rest_.size()) throw InvalidInput("a count is larger than what follows it");
    return value;
  }
  void require_end() const {
    if (!rest_.empty()) throw InvalidInput(std::to_string(rest_.size()) + " bytes follow the last grid");
  }

 private:
  const char* next(std::size_t bytes) {
    if (bytes > rest_.size()) throw InvalidInput("ends early");
    const char* data = rest_.data();
    rest_.remove_prefix(bytes);
    return data;
  }
  std::string_view rest_;
};

void write_metadata(ByteWriter& writer, const Metadata& metadata) {
  writer.number(static_cast<std::uint64_t>(metadata.size()));
  for (const auto& [key, value] : metadata) {
    writer.sequence(key);
    writer.number(static_cast<std::uint8_t>(value.index()));
    if (const auto* text = std::get_if<std::string>(&value)) writer.sequence(*text);
    if (const auto* flag = std::get_if<bool>(&value)) writer.number(static_cast<std::uint8_t>(*flag));
    if (const auto* integer = std::get_if<std::int64_t>(&value)) writer.number(*integer);
    if (const auto* real = std::get_if<double>(&value)) writer.number(*real);
    if (const auto* vector = std::get_if<Vector3>(&value)) writer.vector(*vector);
  }
}

Metadata read_metadata(ByteReader& reader) {
  Metadata metadata;
  const std::uint64_t count = reader.count();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto key = reader.sequence<std::string>();
    switch (reader.number<std::uint8_t>()) {
      case 0:
        metadata[key] = reader.number<std::uint8_t>() != 0;
        break;
      case 1:
        metadata[key] = reader.number<std::int64_t>();
        break;
      case 2:
        metadata[key] = reader.number<double>();
        break;
      case 3:
        metadata[key] = reader.sequence<std::string>();
        break;
      case 4:
        metadata[key] = reader.vector();
        break;
      default:
        throw InvalidInput("metadata of an unknown type");
    }
  }
  return metadata;
}

}  // namespace

void require_storable(double voxel_size, const std::string& what) {
  if (std::isfinite(voxel_size) && voxel_size >= min_voxel_size) return;
  std::ostringstream message;
  message
      << what << ": voxel size " << voxel_size << " is below " << min_voxel_size
      << ", the least that OpenVDB stores; give the models in a smaller unit, for instance mm instead of m";
  throw InvalidInput(message.str());
}

void require_valid(const StoredGrid& grid) {
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) throw InvalidInput("grid " + grid.name + ": " + what);
  };
  require(grid.components == 1 || grid.components == 3, "neither Vec3S nor Float");
  require_storable(grid.voxel_size, "grid " + grid.name);
  require(grid.origin.allFinite(), "its origin is not finite");
  require(std::isfinite(grid.background), "its background is not finite");
  require(!grid.leaves.empty(), "holds no values");
  require(grid.values.size() == grid.leaves.size() * leaf_nodes * static_cast<std::size_t>(grid.components),
          "values do not fit its leaves");
  require(grid.active.empty() || grid.active.size() == grid.leaves.size(), "masks do not fit its leaves");
  require(
      std::adjacent_find(grid.leaves.begin(), grid.leaves.end(), std::greater_equal<>()) == grid.leaves.end(),
      "leaves are not in order, or one is there twice");
  require(
      std::all_of(grid.values.begin(), grid.values.end(), [](float value) { return std::isfinite(value); }),
      "a value is not finite");
}

std::string to_bytes(const StoredFile& file) {
  ByteWriter writer;
  write_metadata(writer, file.metadata);
  writer.number(static_cast<std::uint64_t>(file.grids.size()));
  for (const StoredGrid& grid : file.grids) {
    writer.sequence(grid.name);
    writer.number(grid.components);
    writer.number(static_cast<std::uint8_t>(grid.grid_class == GridClass::level_set));
    writer.number(static_cast<std::uint8_t>(grid.half));
    writer.number(grid.voxel_size);
    writer.vector(grid.origin);
    writer.number(grid.background);
    writer.sequence(grid.leaves);
    writer.sequence(grid.active);
    writer.sequence(grid.values);
    write_metadata(writer, grid.metadata);
  }
  return writer.take();
}

StoredFile stored_file_from_bytes(std::string_view bytes) {
  ByteReader reader(bytes);
  StoredFile file;
  file.metadata = read_metadata(reader);
  const std::uint64_t grids = reader.count();
  for (std::uint64_t i = 0; i < grids; ++i) {
    StoredGrid grid;
    grid.name = reader.sequence<std::string>();
    grid.components = reader.number<int>();
    grid.grid_class = reader.number<std::uint8_t>() != 0 ? GridClass::level_set : GridClass::unknown;
    grid.half = reader.number<std::uint8_t>() != 0;
    grid.voxel_size = reader.number<double>();
    grid.origin = reader.vector();
    grid.background = reader.number<float>();
    grid.leaves = reader.sequence<std::vector<LeafCoordinates>>();
    grid.active = reader.sequence<std::vector<LeafMask>>();
    grid.values = reader.sequence<std::vector<float>>();
    grid.metadata = read_metadata(reader);
    file.grids.push_back(std::move(grid));
  }
  reader.require_end();
  return file;
}

}  // namespace bespoke

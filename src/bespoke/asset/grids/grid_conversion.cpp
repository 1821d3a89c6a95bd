#include "bespoke/asset/grids/grid_conversion.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cstring>
#include <sstream>
#include <streambuf>
#include <utility>

#include "bespoke/asset/grids/vdb_grid.h"
#include "bespoke/asset/grids/vdb_leaves.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

// Magic number, format version, two library versions and the offsets flag come before the UUID's text.
constexpr std::size_t uuid_offset = 8 + 4 + 4 + 4 + 1;
constexpr std::size_t uuid_length = 36;
constexpr std::size_t leaf_grain = 64;

// OpenVDB's own, written anew into each grid by every writer.
const std::string own_prefix = "bespoke:";

/// io::File writes to a path only, io::Stream leaves out the offsets that lazy readers need.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    std::ostringstream stream(std::ios::binary);
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    Archive::write(stream, grids, /*seekable=*/true, metadata);
    return std::move(stream).str();
  }
};

class MemoryBuffer : public std::streambuf {
 public:
  explicit MemoryBuffer(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());  // streambuf's get area is never written to
    setg(begin, begin, begin + bytes.size());
  }

 protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode) override {
    const off_type base = direction == std::ios_base::beg   ? 0
                          : direction == std::ios_base::cur ? gptr() - eback()
                                                            : egptr() - eback();
    const off_type size = egptr() - eback();
    if (offset < -base || offset > size - base) return pos_type(off_type(-1));
    setg(eback(), eback() + base + offset, egptr());
    return pos_type(base + offset);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(off_type(position), std::ios_base::beg, mode);
  }
};

template <class Grid>
inline constexpr int component_count = std::is_same_v<Grid, openvdb::FloatGrid> ? 1 : 3;

openvdb::Metadata::Ptr to_vdb(const MetadataValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return openvdb::BoolMetadata(*flag).copy();
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return openvdb::Int64Metadata(*integer).copy();
  if (const auto* real = std::get_if<double>(&value)) return openvdb::DoubleMetadata(*real).copy();
  if (const auto* text = std::get_if<std::string>(&value)) return openvdb::StringMetadata(*text).copy();
  const Vector3& v = std::get<Vector3>(value);
  return openvdb::Vec3DMetadata(openvdb::Vec3d(v.x(), v.y(), v.z())).copy();
}

void insert(openvdb::MetaMap& map, const Metadata& metadata) {
  for (const auto& [key, value] : metadata) map.insertMeta(key, *to_vdb(value));
}

template <class Grid>
typename Grid::ValueType uniform_value(float value) {
  return typename Grid::ValueType(value);
}

template <class Grid>
openvdb::GridBase::Ptr to_vdb(const StoredGrid& stored) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  const auto grid = Grid::create(uniform_value<Grid>(stored.background));
  std::vector<Leaf*> leaves;
  leaves.reserve(stored.leaves.size());
  for (const LeafCoordinates& leaf : stored.leaves)
    leaves.push_back(grid->tree().touchLeaf(openvdb::Coord(first_node(leaf).data())));
  constexpr std::size_t floats = leaf_nodes * component_count<Grid>;
  parallel_for(leaves.size(), leaf_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::memcpy(static_cast<void*>(leaves[i]->buffer().data()), stored.values.data() + i * floats,
                  floats * sizeof(float));
      if (stored.active.empty()) {
        leaves[i]->setValuesOn();
      } else {
        auto mask = leaves[i]->getValueMask();
        for (std::size_t word = 0; word < stored.active[i].size(); ++word)
          mask.template getWord<openvdb::Index64>(static_cast<openvdb::Index>(word)) = stored.active[i][word];
        leaves[i]->setValueMask(mask);
      }
    }
  });
  if (stored.grid_class == GridClass::level_set) {
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    if constexpr (component_count<Grid> == 1) openvdb::tools::signedFloodFill(grid->tree());
  }
  if (component_count<Grid> == 3) grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  return grid;
}

openvdb::GridBase::Ptr to_vdb(const StoredGrid& stored) {
  const auto grid =
      stored.components == 3 ? to_vdb<openvdb::Vec3SGrid>(stored) : to_vdb<openvdb::FloatGrid>(stored);
  grid->setName(stored.name);
  grid->setSaveFloatAsHalf(stored.half);
  // Transform's constructor from a map would recompute the voxel size from rounded positions.
  const auto transform = openvdb::math::Transform::createLinearTransform(stored.voxel_size);
  transform->postTranslate(openvdb::Vec3d(stored.origin.x(), stored.origin.y(), stored.origin.z()));
  grid->setTransform(transform);
  insert(*grid, stored.metadata);
  return grid;
}

void require(bool holds, const openvdb::GridBase& grid, const std::string& what) {
  if (!holds) throw FormatError("grid " + grid.getName() + ": " + what);
}

// Not parallel: this also runs in a forked child, where only the forking thread lives on.
void read_leaves(const openvdb::GridBase& base, auto& grid, StoredGrid& stored) {
  using Grid = std::decay_t<decltype(grid)>;
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(Grid::TreeType::ValueOnCIter::LEAF_DEPTH - 1);
  require(!tile, base, "has active tiles");

  const auto leaves = sorted_leaves(grid.tree());
  constexpr std::size_t floats = leaf_nodes * component_count<Grid>;
  stored.components = component_count<Grid>;
  if constexpr (component_count<Grid> == 1) {
    stored.background = grid.background();
  } else {
    stored.background = grid.background().x();
    require(grid.background() == openvdb::Vec3s(stored.background), base, "background differs by component");
  }
  stored.leaves.resize(leaves.size());
  stored.active.resize(leaves.size());
  stored.values.resize(leaves.size() * floats);
  bool all_active = true;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const auto& leaf = *leaves[i].second;
    stored.leaves[i] = leaves[i].first;
    require(leaf.buffer().data() != nullptr, base, "a leaf has no values");
    std::memcpy(stored.values.data() + i * floats, static_cast<const void*>(leaf.buffer().data()),
                floats * sizeof(float));
    stored.active[i] = active_mask(leaf);
    all_active = all_active && leaf.getValueMask().isOn();
  }
  if (all_active) stored.active.clear();
}

/// OpenVDB keeps simpler maps (no translation, unit scale) as other types, hence by the matrix.
void read_lattice(const openvdb::GridBase& grid, StoredGrid& stored) {
  require(grid.transform().isLinear(), grid, "its transform is not linear");
  const openvdb::Mat4d matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
  stored.voxel_size = matrix(0, 0);
  stored.origin = {matrix(3, 0), matrix(3, 1), matrix(3, 2)};  // it acts on row vectors
  const openvdb::Vec3d translation(matrix(3, 0), matrix(3, 1), matrix(3, 2));
  openvdb::Mat4d uniform = openvdb::Mat4d::identity();
  uniform.setToScale(openvdb::Vec3d(stored.voxel_size));
  uniform.setTranslation(translation);
  require(matrix == uniform, grid, "its transform is not a uniform scale and a translation");
}

/// 8-4-4-4-12 digits of the hash of everything else, so that equal content has an equal name.
void name_by_content(std::string& bytes) {
  std::fill_n(bytes.begin() + uuid_offset, uuid_length, '0');
  std::string uuid = sha256(bytes.data(), bytes.size()).substr(0, 32);
  for (const std::size_t position : {8, 13, 18, 23}) uuid.insert(position, "-");
  bytes.replace(uuid_offset, uuid_length, uuid);
}

}  // namespace

MetadataValue from_vdb(const std::string& key, const openvdb::Metadata& metadata) {
  if (const auto* flag = dynamic_cast<const openvdb::BoolMetadata*>(&metadata)) return flag->value();
  if (const auto* integer = dynamic_cast<const openvdb::Int64Metadata*>(&metadata)) return integer->value();
  if (const auto* real = dynamic_cast<const openvdb::DoubleMetadata*>(&metadata)) return real->value();
  if (const auto* text = dynamic_cast<const openvdb::StringMetadata*>(&metadata)) return text->value();
  if (const auto* vector = dynamic_cast<const openvdb::Vec3DMetadata*>(&metadata)) {
    const openvdb::Vec3d v = vector->value();
    return Vector3(v.x(), v.y(), v.z());
  }
  throw FormatError("metadata " + key + " has the unexpected type " + metadata.typeName());
}

StoredGrid from_vdb(const openvdb::GridBase& grid) {
  StoredGrid stored;
  stored.name = grid.getName();
  stored.half = grid.saveFloatAsHalf();
  read_lattice(grid, stored);
  for (auto entry = grid.beginMeta(); entry != grid.endMeta(); ++entry)
    if (entry->first.rfind(own_prefix, 0) == 0)
      stored.metadata[entry->first] = from_vdb(entry->first, *entry->second);

  if (grid.isType<openvdb::Vec3SGrid>()) {
    require(grid.getVectorType() == openvdb::VEC_CONTRAVARIANT_RELATIVE, grid,
            "its vectors are not contravariant-relative");
    read_leaves(grid, static_cast<const openvdb::Vec3SGrid&>(grid), stored);
  } else if (grid.isType<openvdb::FloatGrid>()) {
    read_leaves(grid, static_cast<const openvdb::FloatGrid&>(grid), stored);
  } else {
    require(false, grid, "has the type " + grid.type() + ", not Vec3S or Float");
  }
  const auto grid_class = grid.getGridClass();
  require(grid_class == openvdb::GRID_UNKNOWN || grid_class == openvdb::GRID_LEVEL_SET, grid,
          "has the class " + openvdb::GridBase::gridClassToString(grid_class));
  stored.grid_class = grid_class == openvdb::GRID_LEVEL_SET ? GridClass::level_set : GridClass::unknown;
  return stored;
}

Metadata from_vdb(const openvdb::MetaMap& map) {
  Metadata metadata;
  for (auto entry = map.beginMeta(); entry != map.endMeta(); ++entry)
    metadata[entry->first] = from_vdb(entry->first, *entry->second);
  return metadata;
}

void initialize_vdb() { openvdb::initialize(); }

std::string vdb_bytes(const StoredFile& file) {
  initialize_vdb();
  openvdb::MetaMap metadata;
  insert(metadata, file.metadata);
  openvdb::GridCPtrVec grids;
  for (const StoredGrid& grid : file.grids) grids.push_back(to_vdb(grid));
  MemoryArchive archive;
  archive.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  std::string bytes = archive.bytes(grids, metadata);
  name_by_content(bytes);
  return bytes;
}

StoredFile stored_file_from_vdb(std::string_view bytes) {
  initialize_vdb();
  try {
    MemoryBuffer buffer(bytes);
    std::istream stream(&buffer);
    // OpenVDB does not look at the stream's state: without this it would go on with rubbish after the end.
    stream.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
    openvdb::io::Stream archive(stream, /*delayLoad=*/false);
    if (stream.tellg() != static_cast<std::streamoff>(bytes.size()))
      throw FormatError("the last grid does not end where the trailer says");
    StoredFile file;
    file.metadata = from_vdb(*archive.getMetadata());
    const auto grids = archive.getGrids();
    for (const auto& grid : *grids) {
      if (!grid) throw FormatError("a grid is missing");
      file.grids.push_back(from_vdb(*grid));
    }
    return file;
  } catch (const FormatError&) {
    throw;
  } catch (const std::exception& error) {
    throw FormatError(std::string("OpenVDB: ") + error.what());
  }
}

}  // namespace bespoke

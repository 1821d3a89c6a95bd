#include "bespoke/asset/grids/vdb_part.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>

#include <istream>
#include <string>
#include <utility>

#include "bespoke/asset/grids/grid_conversion.h"
#include "bespoke/asset/grids/vdb_grid.h"
#include "bespoke/asset/grids/vdb_leaves.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

using Grid = openvdb::Vec3SGrid;

openvdb::CoordBBox nodes_of(const LeafBox& leaves) {
  const LatticeCoordinates first = first_node(leaves.low), last = first_node(leaves.high);
  return {openvdb::Coord(first.data()), openvdb::Coord(last.data()).offsetBy(leaf_edge - 1)};
}

std::vector<LeafCoordinates> leaves_of(const Grid& grid) {
  std::vector<LeafCoordinates> leaves;
  for (const auto& [leaf, node] : sorted_leaves(grid.tree())) leaves.push_back(leaf);
  return leaves;
}

/// What `action` returns; errors of OpenVDB become FormatError, our own pass.
template <class Action>
auto with_format_errors(const Action& action) {
  try {
    return action();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw FormatError(std::string("OpenVDB: ") + error.what());
  }
}

}  // namespace

/// io::File opens a path of its own, io::Stream reads all; this does what they do, grid by grid.
struct VdbPart::Archive : public openvdb::io::Archive {
  explicit Archive(std::streambuf& bytes) : stream(&bytes) {
    // OpenVDB does not look at the stream's state: without this it would go on with rubbish after the end.
    stream.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
    readHeader(stream);
    if (!inputHasGridOffsets()) throw FormatError("does not say where its grids begin");
    stream_metadata->setSeekable(true);
    openvdb::io::setStreamMetadataPtr(stream, stream_metadata, /*transfer=*/false);
    openvdb::io::setVersion(stream, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(stream, compression());
    openvdb::MetaMap map;
    map.readMeta(stream);
    metadata = from_vdb(map);
    for (int left = readGridCount(stream); left > 0; --left) {
      openvdb::io::GridDescriptor descriptor;
      descriptor.read(stream);
      descriptors.push_back(descriptor);
      descriptor.seekToEnd(stream);
    }
  }

  StoredGridPart read(std::size_t number, const LeafBox& leaves) {
    const openvdb::io::GridDescriptor& descriptor = descriptors.at(number);
    if (descriptor.gridType() != Grid::gridType() || descriptor.isInstance())
      throw FormatError("grid " + descriptor.gridName() + " is no Vec3S grid of its own");
    const auto grid = Grid::create();
    grid->setSaveFloatAsHalf(descriptor.saveFloatAsHalf());
    descriptor.seekToGrid(stream);
    readGridCompression(stream);
    // What the stream carries besides bytes is of one grid, and refers to it.
    const OfOneGrid of_one_grid(*this);
    of_one_grid.metadata->setHalfFloat(grid->saveFloatAsHalf());
    openvdb::io::setGridClass(stream, openvdb::GRID_UNKNOWN);
    openvdb::io::setGridBackgroundValuePtr(stream, nullptr);
    grid->readMeta(stream);
    // They tell the lengths of the leaves' values, so that to skip a leaf no byte of it is read.
    of_one_grid.metadata->gridMetadata() = static_cast<const openvdb::MetaMap&>(*grid);
    grid->removeMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD);
    openvdb::io::setGridClass(stream, grid->getGridClass());
    of_one_grid.metadata->setLeaf(0);
    grid->readTransform(stream);
    require_readable_to(descriptor.getBlockPos());
    grid->readTopology(stream);
    StoredGridPart part;
    part.all_leaves = leaves_of(*grid);
    if (grid->tree().activeTileCount() > 0)
      throw FormatError("grid " + descriptor.gridName() + ": has active tiles");
    // Whole leaves, so OpenVDB has none to cut. But it turns those of one value into tiles.
    grid->readBuffers(stream, nodes_of(leaves));
    grid->tree().voxelizeActiveTiles(/*threaded=*/false);
    part.grid = from_vdb(*grid);
    return part;
  }

  /// OpenVDB loses the nodes at hand when the stream throws while it reads topology, so what would throw does
  /// so before.
  void require_readable_to(std::streamoff end) {
    const std::streamoff begin = stream.tellg();
    stream.ignore(end - begin);
    stream.seekg(begin);
  }

  struct OfOneGrid {
    explicit OfOneGrid(Archive& owner)
        : archive(owner), metadata(new openvdb::io::StreamMetadata(*owner.stream_metadata)) {
      openvdb::io::setStreamMetadataPtr(archive.stream, metadata, /*transfer=*/false);
    }
    ~OfOneGrid() {
      openvdb::io::setStreamMetadataPtr(archive.stream, archive.stream_metadata, /*transfer=*/false);
    }
    OfOneGrid(const OfOneGrid&) = delete;
    OfOneGrid& operator=(const OfOneGrid&) = delete;
    Archive& archive;
    openvdb::io::StreamMetadata::Ptr metadata;
  };

  std::istream stream;
  openvdb::io::StreamMetadata::Ptr stream_metadata{new openvdb::io::StreamMetadata};
  Metadata metadata;
  std::vector<openvdb::io::GridDescriptor> descriptors;
};

VdbPart::VdbPart(std::streambuf& bytes) {
  initialize_vdb();
  archive_ = with_format_errors([&] { return std::make_unique<Archive>(bytes); });
}

VdbPart::~VdbPart() = default;

const Metadata& VdbPart::metadata() const { return archive_->metadata; }

std::size_t VdbPart::grid_count() const { return archive_->descriptors.size(); }

StoredGridPart VdbPart::read(std::size_t grid, const LeafBox& leaves) {
  return with_format_errors([&] { return archive_->read(grid, leaves); });
}

}  // namespace bespoke

#include <algorithm>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/ply/ply_binary.h"
#include "bespoke/product/ply/ply_text.h"

namespace bespoke {
namespace {

/// What a block holds that tells components apart.
struct ConnectedBlock {
  std::vector<double> coordinates;   ///< three a vertex
  std::vector<std::uint32_t> faces;  ///< of each the number of its corners, and the corners
};

ConnectedBlock read_binary(const PlyBlock& block, const PlyHeader& header,
                           const std::filesystem::path& path) {
  ConnectedBlock content;
  content.faces = face_corners(header, block, path);
  if (block.element != header.vertex || block.count == 0) return content;
  content.coordinates.resize(3 * block.count);
  PlyPlaces(header, block).read(header.position, content.coordinates.data());
  return content;
}

/// All vertices, and which are connected.
class Components {
 public:
  explicit Components(const PlyHeader& header)
      : sets_(static_cast<int>(header.elements[header.vertex].count)) {}

  void add(ConnectedBlock&& content) {
    coordinates_.insert(coordinates_.end(), content.coordinates.begin(), content.coordinates.end());
    const std::vector<std::uint32_t>& faces = content.faces;
    for (std::size_t at = 0; at < faces.size(); at += 1 + faces[at])
      for (std::size_t k = 2; k <= faces[at]; ++k)
        sets_.join(static_cast<int>(faces[at + 1]), static_cast<int>(faces[at + k]));
  }

  /// The coordinates of each part's vertices.
  std::vector<std::vector<double>> of_parts(const std::vector<RigidPart>& parts,
                                            const std::filesystem::path& path) {
    const std::size_t count = coordinates_.size() / 3;
    std::vector<std::size_t> number(count);  // of a component, at its least vertex
    std::size_t components = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (least(i) == i) number[i] = ++components;
    std::vector<std::vector<double>> result(parts.size());
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const std::string& name = parts[part].name;
      long long wanted = 0;
      if (!read_integer(name.data(), name.data() + name.size(), wanted)) wanted = 0;
      for (std::size_t i = 0; i < count; ++i)
        if (number[least(i)] == static_cast<std::size_t>(std::max(wanted, 0LL)))
          result[part].insert(result[part].end(), &coordinates_[3 * i], &coordinates_[3 * i] + 3);
      if (result[part].empty())
        refuse_part(name,
                    "its components are 1 to " + std::to_string(components) +
                        ", in the order of their first vertices",
                    path);
    }
    return result;
  }

 private:
  std::size_t least(std::size_t vertex) {
    return static_cast<std::size_t>(sets_.least(static_cast<int>(vertex)));
  }

  DisjointSets sets_;
  std::vector<double> coordinates_;
};

}  // namespace

std::vector<PartPoints> find_ply_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                       const Progress& progress) {
  const PlyHeader header = read_ply_header(file);
  if (header.elements[header.vertex].count > std::numeric_limits<int>::max())
    throw InvalidInput(file.path().string() + ": has too many vertices to tell its components");
  Components components(header);
  if (header.encoding == PlyHeader::Encoding::ascii) {
    const PlyText format(file.path(), header);
    TextCutter cutter = format.cutter();
    walk_blocks(
        {file, format.begin()}, [&](const Window& window) { return cutter(window); },
        [&](const TextBlock& block) {
          TextRecords records = format.records(block);
          ConnectedBlock content{{}, std::move(records.faces)};
          for (const NumberTriple& point : records.points)
            for (const NumberText& number : point) content.coordinates.push_back(number.value);
          return content;
        },
        [&](const TextBlock&, ConnectedBlock&& content) { components.add(std::move(content)); }, progress);
    format.require_complete(cutter.sums());
  } else {
    PlyCutter cutter(file, header);
    walk_blocks(
        {file, header.size}, [&](const Window& window) { return cutter(window); },
        [&](const PlyBlock& block) { return read_binary(block, header, file.path()); },
        [&](const PlyBlock&, ConnectedBlock&& content) { components.add(std::move(content)); }, progress);
  }
  return parts_of(parts, components.of_parts(parts, file.path()));
}

}  // namespace bespoke

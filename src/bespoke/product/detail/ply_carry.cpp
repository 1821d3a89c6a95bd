#include <cmath>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/detail/directions.h"
#include "bespoke/product/detail/ply_binary.h"
#include "bespoke/product/detail/ply_text.h"
#include "bespoke/product/detail/product_formats.h"

namespace bespoke {
namespace {

using Offsets = std::vector<std::array<std::size_t, 3>>;

class PlyBinaryCarrier {
 public:
  PlyBinaryCarrier(const InputFile& file, const PlyHeader& header, const PointMotion& motion)
      : file_(file), header_(header), motion_(motion) {}

  /// Nothing for a block that stays as it is.
  std::vector<std::string> carry(const PlyBlock& block) const {
    if (block.element != header_.vertex || block.count == 0) return {};
    const PlyOffsets offsets = vertex_offsets(header_, block);
    const Points x = read(block, offsets.position, header_.position);
    require_finite_input(block, x);
    const std::vector<Points> images = motion_.images(x);
    std::vector<Points> jacobians;
    Points normals;
    if (header_.normal) {
      jacobians = motion_.jacobians(x);
      normals = read(block, offsets.normal, *header_.normal);
    }
    std::vector<std::string> frames(motion_.frames, std::string(block.bytes));
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      write(images[frame], offsets.position, header_.position, frames[frame]);
      if (header_.normal)
        write(moved_normals(normals, jacobians[frame]), offsets.normal, *header_.normal, frames[frame]);
    }
    return frames;
  }

 private:
  PlyScalar type(std::size_t property) const {
    return header_.elements[header_.vertex].properties[property].type;
  }

  Points read(const PlyBlock& block, const Offsets& offsets, const std::array<std::size_t, 3>& of) const {
    Points result(3, static_cast<Eigen::Index>(block.count));
    const std::array types{type(of[0]), type(of[1]), type(of[2])};
    for (std::size_t i = 0; i < block.count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        result(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)) =
            read_value(block.bytes.data() + offsets[i][axis], types[axis], header_.encoding);
    return result;
  }

  void write(const Points& moved, const Offsets& offsets, const std::array<std::size_t, 3>& of,
             std::string& bytes) const {
    const bool is_normal = &of != &header_.position;
    const std::array types{type(of[0]), type(of[1]), type(of[2])};
    for (std::size_t i = 0; i < offsets.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value = moved(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i));
        const double limit = types[axis] == PlyScalar::float32
                                 ? static_cast<double>(std::numeric_limits<float>::max())
                                 : std::numeric_limits<double>::max();
        if (!(std::abs(value) <= limit)) {
          if (is_normal) continue;  // a normal that was none keeps its bytes
          throw InvalidInput(file_.path().string() +
                             ": a point goes to a place that the file's numbers cannot hold");
        }
        write_value(bytes.data() + offsets[i][axis], value, types[axis], header_.encoding);
      }
  }

  void require_finite_input(const PlyBlock& block, const Points& x) const {
    if (x.allFinite()) return;
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        if (!std::isfinite(x(axis, i)))
          throw FormatError(file_.path().string() + ": vertex " +
                            std::to_string(block.first + static_cast<std::uint64_t>(i)) + " of " +
                            std::to_string(header_.elements[header_.vertex].count) + ": " + "xyz"[axis] +
                            " is not finite");
  }

  const InputFile& file_;
  const PlyHeader& header_;
  const PointMotion& motion_;
};

void carry_binary(const InputFile& file, std::vector<OutputFile>& outputs, const PlyHeader& header,
                  const PointMotion& motion, const Progress& progress) {
  std::string head(header.size, '\0');
  file.read(0, head.data(), head.size());
  for (OutputFile& output : outputs) output.write(head);
  const PlyBinaryCarrier carrier(file, header, motion);
  PlyCutter cutter(file, header);
  walk_blocks(
      file, header.size, [&](const Window& window) { return cutter(window); },
      [&](const PlyBlock& block) { return carrier.carry(block); },
      [&](const PlyBlock& block, std::vector<std::string>&& frames) {
        for (std::size_t frame = 0; frame < outputs.size(); ++frame)
          outputs[frame].write(frames.empty() ? block.bytes : std::string_view(frames[frame]));
      },
      progress);
}

void require_real(const InputFile& file, const PlyHeader& header) {
  const PlyElement& vertex = header.elements[header.vertex];
  for (const auto& triple : {std::optional(header.position), header.normal})
    for (std::size_t axis = 0; triple && axis < 3; ++axis)
      if (const PlyProperty& property = vertex.properties[(*triple)[axis]]; !is_real(property.type))
        throw FormatError(file.path().string() + ": the property " + property.name +
                          " is of a whole-number type, which holds no carried coordinates");
}

void warn_of_faces(const PlyHeader& header, CarrySummary& summary) {
  for (const PlyElement& element : header.elements)
    for (const PlyProperty& property : element.properties)
      if (&element != &header.elements[header.vertex] && property.name == "nx")
        summary.warnings.push_back("the normals of the element '" + element.name + "' were left as they are");
}

}  // namespace

CarrySummary carry_ply(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const PlyHeader header = read_ply_header(file);
  require_real(file, header);
  CarrySummary summary;
  if (header.encoding == PlyHeader::Encoding::ascii) {
    summary = carry_text(file, outputs, PlyText(file.path(), header), motion, progress);
  } else {
    carry_binary(file, outputs, header, motion, progress);
    summary.points = static_cast<std::size_t>(header.elements[header.vertex].count);
    summary.directions = header.normal ? summary.points : 0;
  }
  warn_of_faces(header, summary);
  return summary;
}

}  // namespace bespoke

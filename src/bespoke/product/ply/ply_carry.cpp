#include <cmath>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/carry/directions.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/ply/ply_binary.h"
#include "bespoke/product/ply/ply_text.h"

namespace bespoke {
namespace {

class PlyBinaryCarrier {
 public:
  PlyBinaryCarrier(const InputFile& file, const PlyHeader& header, const PointMotion& motion)
      : file_(file), header_(header), motion_(motion) {}

  struct Carried {
    std::vector<std::string> frames;  ///< none for a block that stays as it is
    FaceFaults faults;
  };

  Carried carry(const PlyBlock& block) const {
    Carried carried;
    carried.faults.add(face_corners(header_, block, file_.path()));
    carried.frames = frames_of(block);
    return carried;
  }

 private:
  std::vector<std::string> frames_of(const PlyBlock& block) const {
    if (block.element != header_.vertex || block.count == 0) return {};
    const PlyPlaces places(header_, block);
    Points x(3, static_cast<Eigen::Index>(block.count)), normals(3, x.cols());
    places.read(header_.position, x.data());
    require_finite_input(block, x);
    const std::vector<Points> images = motion_.images(x);
    std::vector<Points> jacobians;
    if (header_.normal) {
      jacobians = motion_.jacobians(x);
      places.read(*header_.normal, normals.data());
    }
    std::vector<std::string> frames(motion_.frames, std::string(block.bytes));
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      if (!places.write(header_.position, images[frame].data(), frames[frame].data()))
        throw InvalidInput(file_.path().string() +
                           ": a point goes to a place that the file's numbers cannot hold");
      // A normal that was none keeps its bytes.
      if (header_.normal)
        places.write(*header_.normal, moved_normals(normals, jacobians[frame]).data(), frames[frame].data());
    }
    return frames;
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

FaceFaults carry_binary(const InputFile& file, std::vector<OutputFile>& outputs, const PlyHeader& header,
                        const PointMotion& motion, const Progress& progress) {
  FaceFaults faults;
  std::string head(header.size, '\0');
  file.read(0, head.data(), head.size());
  for (OutputFile& output : outputs) output.write(head);
  const PlyBinaryCarrier carrier(file, header, motion);
  PlyCutter cutter(file, header);
  walk_blocks(
      {file, header.size}, [&](const Window& window) { return cutter(window); },
      [&](const PlyBlock& block) { return carrier.carry(block); },
      [&](const PlyBlock& block, PlyBinaryCarrier::Carried&& carried) {
        faults.add(carried.faults);
        for (std::size_t frame = 0; frame < outputs.size(); ++frame)
          outputs[frame].write(carried.frames.empty() ? block.bytes
                                                      : std::string_view(carried.frames[frame]));
      },
      progress);
  return faults;
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
    summary.degenerate = carry_binary(file, outputs, header, motion, progress).degenerate(file.path());
    if (summary.degenerate.count > 0) summary.warnings.push_back(to_string(summary.degenerate));
    summary.points = static_cast<std::size_t>(header.elements[header.vertex].count);
    summary.directions = header.normal ? summary.points : 0;
  }
  warn_of_faces(header, summary);
  return summary;
}

}  // namespace bespoke

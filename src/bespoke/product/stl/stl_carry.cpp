#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/carry/directions.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/stl/stl_file.h"

namespace bespoke {
namespace {

class StlBinary {
 public:
  StlBinary(const InputFile& file, std::size_t facets, const PointMotion& motion)
      : file_(file), facets_(facets), motion_(motion) {}

  std::vector<std::string> carry(const FacetBlock& block) const {
    const Points stored = facet_points(block, file_, facets_);
    const Eigen::Index facets = stored.cols() / 4;
    Points corners(3, 3 * facets), normals(3, facets), centers(3, facets);
    for (Eigen::Index i = 0; i < facets; ++i) {
      normals.col(i) = stored.col(4 * i);
      corners.middleCols<3>(3 * i) = stored.middleCols<3>(4 * i + 1);
      centers.col(i) = corners.middleCols<3>(3 * i).rowwise().mean();
    }
    const std::vector<Points> images = motion_.images(corners);
    const std::vector<Points> jacobians = motion_.jacobians(centers);
    std::vector<std::string> frames(motion_.frames, std::string(block.bytes));
    for (std::size_t frame = 0; frame < motion_.frames; ++frame)
      write(images[frame], moved_normals(normals, jacobians[frame]), frames[frame]);
    return frames;
  }

 private:
  void write(const Points& corners, const Points& normals, std::string& bytes) const {
    if (!(corners.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <=
          static_cast<double>(std::numeric_limits<float>::max())))
      throw InvalidInput(file_.path().string() +
                         ": a point goes to a place that the file's numbers cannot hold");
    for (Eigen::Index i = 0; i < normals.cols(); ++i) {
      char* const facet = bytes.data() + static_cast<std::size_t>(i) * stl_facet_size;
      const Eigen::Vector3f normal = normals.col(i).cast<float>();
      const Eigen::Matrix3f corner = corners.middleCols<3>(3 * i).cast<float>();
      // A normal that is no number keeps its bytes.
      if (normal.allFinite()) std::memcpy(facet, normal.data(), stl_normal_size);
      std::memcpy(facet + stl_normal_size, corner.data(), sizeof(float) * 9);
    }
  }

  const InputFile& file_;
  std::size_t facets_;
  const PointMotion& motion_;
};

CarrySummary carry_binary(const InputFile& file, std::vector<OutputFile>& outputs, std::size_t facets,
                          const PointMotion& motion, const Progress& progress) {
  std::string head(stl_header_size, '\0');
  file.read(0, head.data(), head.size());
  for (OutputFile& output : outputs) output.write(head);
  const StlBinary stl(file, facets, motion);
  FacetCutter cutter;
  walk_blocks(
      {file, stl_header_size}, [&](const Window& window) { return cutter(window); },
      [&](const FacetBlock& block) { return stl.carry(block); },
      [&](const FacetBlock&, std::vector<std::string>&& frames) {
        for (std::size_t frame = 0; frame < outputs.size(); ++frame) outputs[frame].write(frames[frame]);
      },
      progress);
  CarrySummary summary;
  summary.points = 3 * facets;
  summary.directions = facets;
  return summary;
}

}  // namespace

CarrySummary carry_stl(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  if (const std::optional<std::size_t> facets = binary_stl_facets(file))
    return carry_binary(file, outputs, *facets, motion, progress);
  return carry_text(file, outputs, StlText(file.path()), motion, progress);
}

}  // namespace bespoke

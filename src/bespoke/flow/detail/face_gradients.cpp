#include "bespoke/flow/detail/face_gradients.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Of the squared bounding-box diagonal: the measure of inspect_mesh for faces without area.
constexpr double min_area = 1e-14;

struct Frame {
  Matrix3 edges;    // two edges and the unit normal, as columns
  double area = 0;  // squared mesh units
};

Frame frame(const Points& vertices, const Eigen::Vector3i& face) {
  Frame result;
  result.edges.col(0) = vertices.col(face[1]) - vertices.col(face[0]);
  result.edges.col(1) = vertices.col(face[2]) - vertices.col(face[0]);
  const Vector3 normal = result.edges.col(0).cross(result.edges.col(1));
  const double twice_area = normal.norm();
  result.area = twice_area / 2;
  result.edges.col(2) = twice_area > 0 ? Vector3(normal / twice_area) : Vector3::Zero();
  return result;
}

}  // namespace

FaceGradients face_gradients(const TriangleMesh& source, const Points& fitted) {
  const Eigen::Index count = source.faces.cols();
  const double threshold = min_area * std::pow(diagonal(source.vertices), 2);
  FaceGradients gradients{Points(3, 3 * count), Eigen::VectorXd(count)};
  parallel_for(static_cast<std::size_t>(count), faces_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (auto face = static_cast<Eigen::Index>(begin); face < static_cast<Eigen::Index>(end); ++face) {
      const Frame from = frame(source.vertices, source.faces.col(face));
      Frame to = frame(fitted, source.faces.col(face));
      const bool usable = from.area > threshold;
      gradients.areas[face] = usable ? from.area : 0;
      if (usable) to.edges.col(2) *= std::sqrt(to.area / from.area);
      gradients.matrices.middleCols<3>(3 * face) =
          usable ? Matrix3(to.edges * from.edges.inverse()) : Matrix3(Matrix3::Identity());
    }
  });
  return gradients;
}

}  // namespace bespoke

#include "bespoke/clearance/prepared_product.h"

#include <string>
#include <utility>

#include "bespoke/clearance/detail/prepared_data.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

// Edges longer than the voxels of a distance grid on a model of the product's size are sampled in their
// middle from the start, others when they are looked at: between nodes the field is smooth.
constexpr double sample_spacing = 1.0 / 128;

std::unique_ptr<const PreparedProduct::Data> prepared(TriangleMesh mesh, const std::vector<int>& parts,
                                                      const Eigen::Matrix2Xi& lines) {
  const Eigen::Index count = mesh.vertices.cols();
  if (!parts.empty() && static_cast<Eigen::Index>(parts.size()) != count)
    throw InvalidInput("a product of " + std::to_string(count) + " vertices has part numbers for " +
                       std::to_string(parts.size()));
  if (count == 0) throw InvalidInput("a product without vertices has no clearance");
  if (!mesh.vertices.allFinite()) throw InvalidInput("a vertex of the product is not finite");
  for (const auto& indices : {mesh.faces.reshaped().eval(), lines.reshaped().eval()})
    if (indices.size() > 0 && (indices.minCoeff() < 0 || indices.maxCoeff() >= count))
      throw InvalidInput("a face or line of the product names a vertex that it does not have");
  CorrectionGraph graph = correction_graph(mesh, lines, parts);
  SmoothCorrection energy(graph);
  const double size = diagonal(mesh.vertices);
  const double spacing = size > 0 ? sample_spacing * size : 1;
  ProductSamples samples = constraint_samples(mesh, lines, spacing);
  ProductSamples checks = check_samples(mesh, lines, spacing);
  return std::unique_ptr<const PreparedProduct::Data>(new PreparedProduct::Data{
      std::move(mesh), std::move(graph), std::move(energy), std::move(samples), std::move(checks)});
}

}  // namespace

PreparedProduct::PreparedProduct(TriangleMesh mesh, const std::vector<int>& parts,
                                 const Eigen::Matrix2Xi& lines)
    : data_(prepared(std::move(mesh), parts, lines)) {}
PreparedProduct::~PreparedProduct() = default;
PreparedProduct::PreparedProduct(PreparedProduct&&) noexcept = default;
PreparedProduct& PreparedProduct::operator=(PreparedProduct&&) noexcept = default;

const TriangleMesh& PreparedProduct::mesh() const { return data_->mesh; }

}  // namespace bespoke

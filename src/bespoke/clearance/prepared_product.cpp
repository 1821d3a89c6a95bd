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

double spacing_of(const TriangleMesh& mesh) {
  const double size = diagonal(mesh.vertices);
  return size > 0 ? sample_spacing * size : 1;
}

TriangleMesh valid(TriangleMesh mesh, const std::vector<int>& parts, const Eigen::Matrix2Xi& lines) {
  const Eigen::Index count = mesh.vertices.cols();
  if (!parts.empty() && static_cast<Eigen::Index>(parts.size()) != count)
    throw InvalidInput("a product of " + std::to_string(count) + " vertices has part numbers for " +
                       std::to_string(parts.size()));
  if (count == 0) throw InvalidInput("a product without vertices has no clearance");
  if (!mesh.vertices.allFinite()) throw InvalidInput("a vertex of the product is not finite");
  for (const auto& indices : {mesh.faces.reshaped().eval(), lines.reshaped().eval()})
    if (indices.size() > 0 && (indices.minCoeff() < 0 || indices.maxCoeff() >= count))
      throw InvalidInput("a face or line of the product names a vertex that it does not have");
  return mesh;
}

}  // namespace

SourceSamples::SourceSamples(ProductSamples of, const TriangleMesh& product)
    : samples(std::make_shared<const ProductSamples>(std::move(of))),
      places([samples = samples, &product] { return places_of(*samples, product.vertices); }) {}

PreparedProduct::Data::Data(TriangleMesh product, const Eigen::Matrix2Xi& lines,
                            const std::vector<int>& parts)
    : mesh(valid(std::move(product), parts, lines)),
      graph(correction_graph(mesh, lines, parts)),
      energy(graph),
      samples(constraint_samples(mesh, lines, spacing_of(mesh)), mesh),
      checks(check_samples(mesh, lines, spacing_of(mesh)), mesh),
      places(mesh),
      edges(mesh_edges(mesh).edges) {}

PreparedProduct::PreparedProduct(TriangleMesh mesh, const std::vector<int>& parts,
                                 const Eigen::Matrix2Xi& lines)
    : data_(std::make_unique<const Data>(std::move(mesh), lines, parts)) {}
PreparedProduct::~PreparedProduct() = default;
PreparedProduct::PreparedProduct(PreparedProduct&&) noexcept = default;
PreparedProduct& PreparedProduct::operator=(PreparedProduct&&) noexcept = default;

const TriangleMesh& PreparedProduct::mesh() const { return data_->mesh; }

}  // namespace bespoke

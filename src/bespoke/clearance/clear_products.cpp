#include "bespoke/clearance/clear_products.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/product/carry_product.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"
#include "bespoke/quality/self_intersection.h"
#include "bespoke/rigid/rigid_alignment.h"

namespace bespoke {
namespace {

/// Moves the part's columns of `images` to where the motion of least squares takes `places`.
void keep_shape(const Points& places, const std::vector<Eigen::Index>& columns, PartMotion motion,
                Points& images) {
  Points from(3, static_cast<Eigen::Index>(columns.size())), to = from;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = places.col(columns[i]);
    to.col(static_cast<Eigen::Index>(i)) = images.col(columns[i]);
  }
  const Vector3 mean = from.rowwise().mean(), image_mean = to.rowwise().mean();
  const Matrix3 rotation = align_rigidly(from, to, Eigen::VectorXd::Ones(from.cols())).rotation;
  const Points turned = rotation * (from.colwise() - mean);
  const double scale = motion == PartMotion::similar
                           ? (to.colwise() - image_mean).cwiseProduct(turned).sum() / turned.squaredNorm()
                           : 1;
  for (std::size_t i = 0; i < columns.size(); ++i)
    images.col(columns[i]) = image_mean + scale * turned.col(static_cast<Eigen::Index>(i));
}

TriangleMesh together(const TriangleMesh& a, const Points& a_places, const TriangleMesh& b,
                      const Points& b_places) {
  TriangleMesh both{Points(3, a_places.cols() + b_places.cols()), Faces(3, a.faces.cols() + b.faces.cols())};
  both.vertices << a_places, b_places;
  both.faces << a.faces, b.faces.array() + static_cast<int>(a_places.cols());
  return both;
}

/// Pairs of a face of `a` and one of `b`.
std::vector<std::pair<int, int>> pairs_between(const TriangleMesh& a, const Points& a_places,
                                               const TriangleMesh& b, const Points& b_places) {
  if (!bounding_box(a_places).intersects(bounding_box(b_places))) return {};
  const Eigen::Index split = a.faces.cols();
  auto pairs = intersections_of_first(together(a, a_places, b, b_places), split);
  std::erase_if(pairs, [&](const std::pair<int, int>& pair) { return pair.second < split; });
  return pairs;
}

}  // namespace

WornProduct read_worn_product(const std::filesystem::path& file, const std::vector<RigidPart>& parts,
                              double scale, ModelPose pose) {
  const Product product = read_product(file, pose);
  WornProduct worn{file.filename().string(), nullptr, {}, parts};
  if (!parts.empty())
    worn.part_of_vertex = parts_of_places(file, product.vertices, {parts, {}, nullptr, pose});
  const Eigen::Matrix2Xi lines = Eigen::Map<const Eigen::Matrix2Xi>(
      product.line_edges.data(), 2, static_cast<Eigen::Index>(product.line_edges.size() / 2));
  try {
    worn.prepared = std::make_shared<const PreparedProduct>(
        TriangleMesh{scale * product.vertices, triangulated(product)}, worn.part_of_vertex, lines);
  } catch (const InvalidInput& error) {
    throw InvalidInput(file.string() + ": " + error.what());
  }
  return worn;
}

Points carried_vertices(const WornProduct& product, const ElasticMap& elastic,
                        const RigidTransform& target_from_source) {
  const Points& places = product.prepared->mesh().vertices;
  Points images = target_from_source * elastic(places);
  for (std::size_t part = 0; part < product.parts.size(); ++part) {
    std::vector<Eigen::Index> columns;
    for (std::size_t v = 0; v < product.part_of_vertex.size(); ++v)
      if (product.part_of_vertex[v] == static_cast<int>(part))
        columns.push_back(static_cast<Eigen::Index>(v));
    if (!columns.empty()) keep_shape(places, columns, product.parts[part].motion, images);
  }
  return images;
}

bool ProductClearance::is_clear() const {
  return summary.is_clear() && std::all_of(layers.begin(), layers.end(),
                                           [](const LayerContact& layer) { return layer.after == 0; });
}

std::string to_string(const LayerContact& contact) {
  return contact.lower + " under " + contact.upper + ": " + std::to_string(contact.before) +
         " pairs of faces passed through each other on the source and are left, " +
         std::to_string(contact.after) + " new";
}

LayerContact layer_contact(const WornProduct& lower, const Points& lower_after, const WornProduct& upper,
                           const Points& upper_after) {
  LayerContact contact{lower.name, upper.name};
  const TriangleMesh &a = lower.prepared->mesh(), &b = upper.prepared->mesh();
  if (a.faces.cols() == 0 || b.faces.cols() == 0) return contact;
  const auto before = pairs_between(a, a.vertices, b, b.vertices);
  const auto after = pairs_between(a, lower_after, b, upper_after);
  std::vector<std::pair<int, int>> further;
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(further));
  contact.before = before.size();
  contact.after = further.size();
  return contact;
}

}  // namespace bespoke

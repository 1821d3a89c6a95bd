#include "bespoke/pattern/garment.h"

#include <optional>

#include "bespoke/error.h"
#include "bespoke/pattern/flattening/flat_faces.h"
#include "bespoke/product/face_groups.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/product_io.h"

namespace bespoke {
namespace {

double mm_per_unit(const std::filesystem::path& path, const Product& product, const std::string& given) {
  const std::string& unit = given.empty() ? product.unit : given;
  if (unit.empty())
    throw InvalidInput(path.string() +
                       ": its format does not say the unit of its coordinates, and a pattern is in " +
                       "millimetres; name it: --unit cm");
  return required_unit_factor(unit, "mm");
}

/// Fans as `triangulated` makes them, with the polygon and the corners that each is of.
struct Fans {
  std::vector<int> polygons;
  std::vector<std::array<int, 3>> corners;
};

Fans fans_of(const Product& product) {
  Fans fans;
  const auto vertex = [&](int corner) { return product.corners[static_cast<std::size_t>(corner)]; };
  for (std::size_t p = 0; p + 1 < product.polygon_start.size(); ++p) {
    const int first = product.polygon_start[p];
    for (int k = first + 2; k < product.polygon_start[p + 1]; ++k) {
      if (vertex(first) == vertex(k - 1) || vertex(k - 1) == vertex(k) || vertex(k) == vertex(first))
        continue;
      fans.polygons.push_back(static_cast<int>(p));
      fans.corners.push_back({first, k - 1, k});
    }
  }
  return fans;
}

/// The groups of the first rule that names several, if the wanted one is automatic.
std::optional<FaceGroups> groups_of(const std::filesystem::path& path, PieceRule wanted, PieceRule& rule) {
  for (const auto& [kind, of_kind] : {std::pair{FaceGroupKind::groups, PieceRule::groups},
                                      std::pair{FaceGroupKind::objects, PieceRule::objects},
                                      std::pair{FaceGroupKind::materials, PieceRule::materials}}) {
    if (wanted != PieceRule::automatic && wanted != of_kind) continue;
    FaceGroups groups = face_groups(path, kind);
    rule = of_kind;
    if (groups.names.size() > 1) return groups;
    if (wanted == of_kind && groups.names.empty())
      throw InvalidInput(
          path.string() + ": it has no " + std::string(name_of(piece_rules, wanted)) +
          "; pieces may come from charts, groups, objects, materials, components or a seam file");
    if (wanted == of_kind) return groups;
  }
  return {};
}

void require_areas(const Garment& garment) {
  try {
    rest_faces(garment.mesh);
  } catch (const InvalidInput& error) {
    throw InvalidInput(garment.path + ": " + error.what() + "; remove such faces, or merge their vertices");
  }
}

}  // namespace

Garment read_garment(const std::filesystem::path& path, const GarmentOptions& options) {
  Product product = read_product(path);
  if (product.texture.cols() == 0) product.texture = corner_texture(path);
  Garment garment;
  garment.path = path.string();
  garment.mesh.vertices = mm_per_unit(path, product, options.unit) * product.vertices;
  const Fans fans = fans_of(product);
  if (fans.polygons.empty())
    throw InvalidInput(path.string() + ": it has no faces, so there is nothing to flatten");
  garment.mesh.faces.resize(3, static_cast<Eigen::Index>(fans.polygons.size()));
  if (product.texture.cols() > 0) garment.texture.resize(2, garment.mesh.faces.size());
  for (std::size_t f = 0; f < fans.polygons.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const int corner = fans.corners[f][k];
      garment.mesh.faces(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(f)) =
          product.corners[static_cast<std::size_t>(corner)];
      if (garment.texture.cols() > 0)
        garment.texture.col(static_cast<Eigen::Index>(3 * f + k)) = product.texture.col(corner);
    }
  garment.group_of_face.assign(fans.polygons.size(), 0);
  const bool has_charts = garment.texture.cols() > 0;
  if (options.rule == PieceRule::charts && !has_charts)
    throw InvalidInput(path.string() +
                       ": it has no texture coordinates, so no charts; leave out --pieces, or name " +
                       "groups, objects, materials or components");
  std::optional<FaceGroups> groups;
  if (options.rule == PieceRule::charts || (options.rule == PieceRule::automatic && has_charts))
    garment.rule = PieceRule::charts;
  else if (options.rule != PieceRule::components)
    groups = groups_of(path, options.rule, garment.rule);
  if (!groups) {
    if (garment.rule != PieceRule::charts) garment.rule = PieceRule::components;
    if (options.rule == PieceRule::automatic) groups = face_groups(path, FaceGroupKind::groups);  // for names
  }
  if (groups && !groups->names.empty()) {
    garment.group_names = groups->names;
    for (std::size_t f = 0; f < fans.polygons.size(); ++f)
      garment.group_of_face[f] = groups->of_polygon[static_cast<std::size_t>(fans.polygons[f])];
  }
  require_areas(garment);
  return garment;
}

}  // namespace bespoke

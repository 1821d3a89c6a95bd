#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/enum_names.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What of a product's file says where its pieces end.
enum class PieceRule {
  automatic,   ///< charts, where there is a texture; else the first of the next that names several; else
               ///< components
  charts,      ///< faces joined by equal texture coordinates (of glTF the first ones)
  groups,      ///< of OBJ
  objects,     ///< of OBJ; what nodes show in glTF
  materials,   ///< of OBJ; of primitives in glTF
  components,  ///< faces joined by shared vertices
};

inline constexpr std::array piece_rules{Named<PieceRule>{"auto", PieceRule::automatic},
                                        Named<PieceRule>{"charts", PieceRule::charts},
                                        Named<PieceRule>{"groups", PieceRule::groups},
                                        Named<PieceRule>{"objects", PieceRule::objects},
                                        Named<PieceRule>{"materials", PieceRule::materials},
                                        Named<PieceRule>{"components", PieceRule::components}};

/// A product as triangles, in millimetres, with what its file says of pieces.
struct Garment {
  std::string path;                        ///< for messages
  TriangleMesh mesh;                       ///< vertices as in the file; polygons as fans
  Eigen::Matrix2Xd texture;                ///< 2×3m, or empty
  PieceRule rule = PieceRule::components;  ///< never automatic
  std::vector<int> group_of_face;          ///< m: by the rule, or all 0
  std::vector<std::string> group_names;
};

struct GarmentOptions {
  PieceRule rule = PieceRule::automatic;
  std::string unit = {};  ///< of the coordinates, where the file says none: "cm"
};

/// Reads a product (product_io.h). Throws as read_product, and InvalidInput where no unit is known, for a
/// rule that the file says nothing for, and for faces without area.
Garment read_garment(const std::filesystem::path& path, const GarmentOptions& options);

}  // namespace bespoke

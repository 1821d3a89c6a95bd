#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/asset/grids/preview.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"
#include "support/shapes.h"

namespace bespoke::test {

/// A closed surface around `center`.
inline TriangleMesh sphere(const Vector3& center, double radius, int levels) {
  return shapes::moved(shapes::icosphere(levels), {radius * Matrix3::Identity(), center});
}

/// u(x) = (0.1 sin x, 0.1 sin y, 0.1 cos z), times a window that is zero at the ends of the leaves.
inline PyramidLevel wavy_level(const Vector3& origin, double voxel_size, std::vector<LeafCoordinates> leaves,
                               double amplitude) {
  PyramidLevel level{voxel_size, std::move(leaves), {}};
  for (const LeafCoordinates& leaf : level.leaves)
    for (int i = 0; i < leaf_edge; ++i)
      for (int j = 0; j < leaf_edge; ++j)
        for (int k = 0; k < leaf_edge; ++k) {
          const Vector3 node(leaf[0] * leaf_edge + i, leaf[1] * leaf_edge + j, leaf[2] * leaf_edge + k);
          const Vector3 x = origin + voxel_size * node;
          const double window = i * (leaf_edge - 1 - i) / 12.25 * j * (leaf_edge - 1 - j) / 12.25;
          for (const double u : {std::sin(x.x()), std::sin(x.y()), std::cos(x.z())})
            level.values.push_back(static_cast<float>(amplitude * window * u));
        }
  return level;
}

/// A two-level asset of a few leaves, without preview.
inline Asset small_asset() {
  Asset asset;
  asset.target_from_source.rotation =
      Eigen::AngleAxisd(0.3, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  asset.target_from_source.translation = {0.5, -0.25, 1.0 / 3};
  asset.steps.front().affine.linear << 1.1, 0.02, 0, -0.01, 0.95, 0.03, 0, 0, 1.05;
  asset.steps.front().affine.offset = {0.1, 0.2, -0.3};
  asset.steps.front().pyramid.origin = {-1.0 / 3, -1.1, -0.9};
  const double voxel_size = 0.012369952865891319 * 10;  // neither it nor its sums with the origin are exact
  asset.steps.front().pyramid.levels = {
      wavy_level(asset.steps.front().pyramid.origin, voxel_size, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}, 0.05),
      wavy_level(asset.steps.front().pyramid.origin, voxel_size / 2, {{0, 1, 0}, {1, 1, 1}}, 0.01)};
  asset.steps.front().certificate.certified = 12345;
  asset.steps.front().certificate.min_determinant = 0.0625;
  asset.steps.front().certificate.affine_determinant = asset.steps.front().affine.linear.determinant();
  asset.steps.front().certificate.places = {{1, {0.1, 0.2, 0.3}, 1e-3}};
  asset.record.unit = "dm";
  asset.record.elastic_method = "csrbf";
  asset.record.surface_fit_method = "laplacian";
  asset.record.lambda = 0.4;
  asset.record.tolerance = 1e-3;
  asset.record.bake_error = {100, 1e-6, 1e-5, 1e-4, 2e-4, 5e-4};
  asset.record.options_json = R"({"lambda":"10%","max_memory":8589934592})";
  asset.record.stages_json = R"([{"name":"rigid","residual":0.1}])";
  asset.record.anchors = {{"nose \"tip\" é", {0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 1.5, 0.01},
                          {"", {1, 0, 0}, {0, 1, 0}, std::numeric_limits<double>::infinity(), 0}};
  asset.record.source = {std::string(64, 'a'), Box(Vector3(-1, -1, -1), Vector3(1, 1, 1))};
  asset.record.target = {std::string(64, 'b'), Box(Vector3(-2, -1, -1), Vector3(1, 3, 1))};
  return asset;
}

/// The same with preview grids of one leaf each, so that its file stays small.
inline Asset tiny_asset() {
  Asset asset = small_asset();
  std::vector<StoredGrid> grids(3);
  const char* names[] = {displacement_name, source_distance_name, jacobian_name};
  for (std::size_t i = 0; i < grids.size(); ++i) {
    grids[i].name = names[i];
    grids[i].components = i == 0 ? 3 : 1;
    grids[i].voxel_size = 0.25;
    grids[i].leaves = {{-1, 0, 2}};
    for (int n = 0; n < grids[i].components * leaf_nodes; ++n)
      grids[i].values.push_back(static_cast<float>(n % 37) / 16);
    grids[i].metadata["bespoke:meaning"] = std::string("a test");
  }
  grids[1].grid_class = GridClass::level_set;
  grids[1].background = 3;
  asset.preview = std::make_shared<PreviewGrids>(std::move(grids));
  return asset;
}

/// As write_asset writes large ones.
inline void write_with_block_hashes(const std::filesystem::path& path, const Asset& asset) {
  write_asset(path, asset);
  const std::string bytes = read_text(path);
  write_text(path, seal(unseal(bytes), TrailerForm::block_hashes));
}

}  // namespace bespoke::test

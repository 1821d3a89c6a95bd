// Maps the space around one model onto the space around another and carries a product across.
#include <bespoke/apply/apply_to_product.h>
#include <bespoke/asset/asset_io.h>
#include <bespoke/pipeline/make_map.h>
#include <bespoke/product/mesh_io.h>

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 7) {
    std::fprintf(stderr, "usage: fit_and_apply SOURCE TARGET ANCHORS PRODUCT MAP.vdb OUT\n");
    return 1;
  }
  const bespoke::TriangleMesh source = bespoke::read_triangle_mesh(argv[1]);
  const bespoke::TriangleMesh target = bespoke::read_triangle_mesh(argv[2]);
  const bespoke::Anchors anchors = bespoke::read_anchors(argv[3]);
  const bespoke::MakeMapOptions options = bespoke::default_options(bespoke::diagonal(source.vertices));
  const bespoke::MadeMap made = bespoke::make_map({source, target, anchors}, options);
  bespoke::write_asset(argv[5], made.asset);
  const bespoke::ProductSummary moved =
      bespoke::apply_to_product(argv[4], {argv[6]}, *made.exact, made.asset.target_from_source);
  std::printf("%s\n", to_string(moved.points).c_str());
} catch (const bespoke::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}

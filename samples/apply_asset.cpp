// Applies a stored map to points, half-way and all the way.
#include <bespoke/apply/apply_mapping.h>
#include <bespoke/asset/asset_io.h>

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: apply_asset MAP.vdb\n");
    return 1;
  }
  const bespoke::Asset asset = bespoke::read_asset(argv[1]);
  const bespoke::ElasticChain map = bespoke::loaded_chain(asset.steps);

  bespoke::Points points(3, 2);
  points.col(0) = asset.record.source.box.center();
  points.col(1) = asset.record.source.box.max();
  const bespoke::AppliedPoints moved =
      bespoke::apply_mapping(map, asset.target_from_source, points, {0.5, 1.0}, {.path = asset.path});
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const bespoke::Vector3 from = points.col(i);
    const bespoke::Vector3 half = moved.frames[0].col(i);
    const bespoke::Vector3 to = moved.frames[1].col(i);
    std::printf("(%g, %g, %g) -> (%g, %g, %g) -> (%g, %g, %g)\n", from.x(), from.y(), from.z(), half.x(),
                half.y(), half.z(), to.x(), to.y(), to.z());
  }
} catch (const bespoke::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}

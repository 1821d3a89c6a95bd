// Says whether a stored map is proved to be a bijection, how exact it is and where its anchors end up.
#include <bespoke/asset/asset_io.h>
#include <bespoke/error.h>

#include <cstdio>

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: inspect_asset MAP.vdb\n");
    return 1;
  }
  const bespoke::Asset asset = bespoke::read_asset(argv[1]);
  std::printf("bijection: %s\n", whole_certificate(asset).is_bijection() ? "proved" : "not proved");
  std::printf("bake error: %s\n", to_string(asset.record.bake_error).c_str());
  for (const bespoke::AnchorRecord& anchor : asset.record.anchors)
    std::printf("%s: %g %s\n", anchor.name.c_str(), anchor.residual, asset.record.unit.c_str());
} catch (const bespoke::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}

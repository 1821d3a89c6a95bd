#include <bespoke/asset/asset_io.h>
#include <bespoke/pipeline/make_map.h>
#include <bespoke/report/inspection.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  std::fputs(bespoke::inspection_text(bespoke::read_asset(argv[1])).c_str(), stdout);
}

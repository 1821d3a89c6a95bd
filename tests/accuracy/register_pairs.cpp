// Registers the pairs of models in folders, without a map: tests/accuracy/ablate.py links it with a copy of
// the registration whose constants it can set.
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/registration/registration.h"
#include "bespoke/thread_arena.h"

namespace {

namespace fs = std::filesystem;
using namespace bespoke;

void register_pair(const fs::path& folder) {
  const TriangleMesh source = read_triangle_mesh(folder / "source.obj");
  const TriangleMesh target = read_triangle_mesh(folder / "target.obj");
  const fs::path pairs = folder / "anchors.json";
  const Anchors anchors = fs::exists(pairs) ? read_anchors(pairs) : Anchors{};
  const MakeMapOptions options = default_options(diagonal(source.vertices));
  const Points places = registered_vertices(register_models({source, target, anchors}, options.fit));
  std::ofstream file(folder / "registered.f64", std::ios::binary);
  file.write(reinterpret_cast<const char*>(places.data()),
             static_cast<std::streamsize>(sizeof(double) * static_cast<std::size_t>(places.size())));
}

}  // namespace

/// register_pairs FOLDER…: of each source.obj, target.obj and, if it is there, anchors.json; writes
/// registered.f64, where the source's vertices went, and prints the folder, the CPU seconds, and what went
/// wrong.
int main(int argc, char** argv) {
  run_on_threads(1, [&] {
    for (int k = 1; k < argc; ++k) {
      const std::clock_t begin = std::clock();
      std::string failure;
      try {
        fs::remove(fs::path(argv[k]) / "registered.f64");
        register_pair(argv[k]);
      } catch (const std::exception& error) {
        failure = error.what();
      }
      const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      std::printf("%s\t%.2f\t%s\n", argv[k], seconds, failure.c_str());
      std::fflush(stdout);
    }
  });
}

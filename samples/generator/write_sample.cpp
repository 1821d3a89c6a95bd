#include <fstream>
#include <nlohmann/json.hpp>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/product/mesh_io.h"
#include "samples.h"

namespace bespoke {
namespace {

std::string anchors_json(const std::vector<AnchorPair>& pairs) {
  const auto coordinates = [](const Vector3& point) {
    return nlohmann::ordered_json{point.x(), point.y(), point.z()};
  };
  // One pair a line.
  std::string text = "{\"units\": \"cm\", \"pairs\": [\n";
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const nlohmann::ordered_json pair = {
        {"name", pairs[i].name}, {"a", coordinates(pairs[i].a)}, {"b", coordinates(pairs[i].b)}};
    text += "  " + pair.dump() + (i + 1 < pairs.size() ? ",\n" : "\n");
  }
  return text + "]}\n";
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    if (!file.flush()) throw FileError(path.string() + ": writing failed");
  });
}

}  // namespace

std::vector<std::filesystem::path> write_sample(const Sample& sample,
                                                const std::filesystem::path& directory) {
  const std::filesystem::path folder = directory / sample.name;
  make_directories(folder);

  std::vector<std::filesystem::path> written;
  const auto write_mesh = [&](const std::string& name, const TriangleMesh& mesh) {
    written.push_back(folder / (name + ".obj"));
    write_triangle_mesh(written.back(), mesh);
  };
  write_mesh("source", sample.source);
  for (const SampleProduct& product : sample.products) {
    write_mesh(product.name, product.mesh);
    if (product.seams.seams.empty()) continue;
    written.push_back(folder / (product.name + "_seams.json"));
    write_text(written.back(), seam_file_text(product.mesh, product.seams));
  }
  for (const SampleTarget& target : sample.targets) {
    const std::string ending = target.name.empty() ? "" : "_" + target.name;
    write_mesh("target" + ending, target.mesh);
    written.push_back(folder / ("anchors" + ending + ".json"));
    write_text(written.back(), anchors_json(target.anchors));
  }
  return written;
}

}  // namespace bespoke

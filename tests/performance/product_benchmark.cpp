#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "bespoke/product/carry_product.h"
#include "bespoke/product/mesh_io.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

constexpr int side = 1400;  // about 2 M vertices, 4 M triangles

float height(int i, int j) { return static_cast<float>(std::sin(0.01 * i) * std::cos(0.013 * j)); }

template <class Value>
void append(std::string& text, Value value) {
  text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string obj_grid() {
  std::string text;
  char line[100];
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", 0.1 * i, 0.1 * j,
                    static_cast<double>(height(i, j)));
      text += line;
    }
  for (int i = 1; i < side; ++i)
    for (int j = 1; j < side; ++j) {
      const int a = (i - 1) * side + j, b = a + 1, c = a + side, d = c + 1;
      std::snprintf(line, sizeof line, "f %d %d %d\nf %d %d %d\n", a, c, b, b, c, d);
      text += line;
    }
  return text;
}

std::string ply_grid() {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(side * side) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(2 * (side - 1) * (side - 1)) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (const float value : {0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j), height(i, j)})
        append(text, value);
  for (int i = 1; i < side; ++i)
    for (int j = 1; j < side; ++j) {
      const int a = (i - 1) * side + j - 1;
      for (const int corners : {0, 1}) {
        append(text, std::uint8_t{3});
        append(text, corners == 0 ? a : a + 1);
        append(text, a + side);
        append(text, corners == 0 ? a + 1 : a + side + 1);
      }
    }
  return text;
}

std::string glb_grid() {
  std::string data;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (const float value : {0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j), height(i, j)})
        append(data, value);
  const std::size_t positions = data.size();
  for (int i = 1; i < side; ++i)
    for (int j = 1; j < side; ++j) {
      const int a = (i - 1) * side + j - 1, b = a + 1, c = a + side, d = c + 1;
      for (const int corner : {a, c, b, b, c, d}) append(data, corner);
    }
  const std::string indices = std::to_string((data.size() - positions) / 4);
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
      R"({"bufferView":0,"componentType":5126,"type":"VEC3","min":[0,0,-1],"max":[139.9,139.9,1],"count":)" +
      std::to_string(side * side) + R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" +
      indices + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(positions) +
      R"(},{"buffer":0,"byteOffset":)" + std::to_string(positions) + R"(,"byteLength":)" +
      std::to_string(data.size() - positions) + R"(}],"buffers":[{"byteLength":)" +
      std::to_string(data.size()) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  append(glb, 2u);
  append(glb, static_cast<std::uint32_t>(28 + json.size() + data.size()));
  append(glb, static_cast<std::uint32_t>(json.size()));
  glb += "JSON" + json;
  append(glb, static_cast<std::uint32_t>(data.size()));
  return glb + std::string("BIN\0", 4) + data;
}

/// A turn and a shift: what is measured is the file, not the look-up.
PointMotion affine_motion() {
  const Matrix3 turn = Eigen::AngleAxisd(0.3, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  PointMotion motion;
  motion.images = [turn](const Points& x) {
    return std::vector<Points>{(turn * x).colwise() + Vector3(1, 2, 3)};
  };
  motion.jacobians = [turn](const Points& x) { return std::vector<Points>{turn.replicate(1, x.cols())}; };
  return motion;
}

void Carry(benchmark::State& state, const char* name, const std::string& content) {
  const test::ScratchDirectory directory;
  const auto in = directory / name, out = directory / (std::string("out_") + name);
  std::ofstream(in, std::ios::binary) << content;
  for (auto _ : state) carry_product(in, {out}, affine_motion());
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * content.size()));
}

/// `cat in > out`.
void Copy(benchmark::State& state, const std::string& content) {
  const test::ScratchDirectory directory;
  const auto in = directory / "in", out = directory / "out";
  std::ofstream(in, std::ios::binary) << content;
  const std::string command = "cat " + in.string() + " > " + out.string();
  for (auto _ : state)
    if (std::system(command.c_str()) != 0) state.SkipWithError("no cat");
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * content.size()));
}

/// As a reference model.
void Read(benchmark::State& state, const char* name, const std::string& content) {
  const test::ScratchDirectory directory;
  std::ofstream(directory / name, std::ios::binary) << content;
  for (auto _ : state) benchmark::DoNotOptimize(read_triangle_mesh(directory / name));
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * content.size()));
}

void CarryObj(benchmark::State& state) { Carry(state, "a.obj", obj_grid()); }
void CarryPly(benchmark::State& state) { Carry(state, "a.ply", ply_grid()); }
void CarryGlb(benchmark::State& state) { Carry(state, "a.glb", glb_grid()); }
void ReadObj(benchmark::State& state) { Read(state, "a.obj", obj_grid()); }
void ReadPly(benchmark::State& state) { Read(state, "a.ply", ply_grid()); }
void CopyObj(benchmark::State& state) { Copy(state, obj_grid()); }
void CopyPly(benchmark::State& state) { Copy(state, ply_grid()); }
void CopyGlb(benchmark::State& state) { Copy(state, glb_grid()); }

// Bytes of the input per second on all cores.
BENCHMARK(CarryObj)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(CarryPly)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(CarryGlb)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(ReadObj)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(ReadPly)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(CopyObj)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(CopyPly)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(CopyGlb)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace bespoke

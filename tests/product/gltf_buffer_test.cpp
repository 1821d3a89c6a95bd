#include "bespoke/product/gltf/document/gltf_buffer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>

#include "support/scratch_directory.h"

namespace bespoke {
namespace {

// More than is read and written at a time, and no multiple of it.
constexpr std::size_t own_size = (std::size_t{1} << 21) + 12345, grown_size = own_size + 1000;

std::string random_bytes(std::size_t size, std::mt19937& random) {
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

GltfRows random_rows(std::mt19937& random) {
  const auto below = [&](std::size_t end) { return random() % end; };
  GltfRows rows;
  rows.size = 1 + below(16);
  rows.stride = rows.size + (below(2) == 0 ? 0 : below(40));
  rows.count = 1 + below(grown_size / rows.stride - 1);
  rows.offset = below(grown_size - ((rows.count - 1) * rows.stride + rows.size) + 1);
  const auto bytes = std::make_shared<const std::string>(random_bytes(rows.count * rows.size, random));
  rows.bytes = std::shared_ptr<const char>(bytes, bytes->data());
  return rows;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(GltfBuffer, IsTheFileWithRowsReplacedWhereverItIsRead) {
  std::mt19937 random(1);
  const test::ScratchDirectory directory;
  std::string expected = random_bytes(own_size, random);
  std::ofstream(directory / "in", std::ios::binary) << "before" << expected << "behind";
  const InputFile file(directory / "in");
  GltfBuffer from_file(file, 6, own_size), held(expected);
  expected.resize(grown_size, '\0');
  for (GltfBuffer* const buffer : {&from_file, &held}) buffer->grow(grown_size);
  for (int i = 0; i < 20; ++i) {
    const GltfRows rows = random_rows(random);
    for (std::size_t row = 0; row < rows.count; ++row)
      expected.replace(rows.offset + row * rows.stride, rows.size, rows.bytes.get() + row * rows.size,
                       rows.size);
    from_file.replace(rows);
    held.replace(rows);
  }
  for (const GltfBuffer& buffer : {from_file, held}) {
    EXPECT_TRUE(buffer.content() == expected);
    write_outputs({directory / "out"},
                  [&](std::vector<OutputFile>& outputs) { buffer.write(outputs.front()); });
    EXPECT_TRUE(read_file(directory / "out") == expected);
    for (int i = 0; i < 200; ++i) {
      const std::size_t begin = random() % grown_size, size = random() % (grown_size - begin) % 1000;
      std::string part(size, 'x');
      buffer.read(begin, part.data(), size);
      EXPECT_TRUE(part == expected.substr(begin, size)) << size << " bytes from " << begin;
    }
  }
}

TEST(GltfBuffer, OfNothingIsEmpty) {
  EXPECT_EQ(GltfBuffer().size(), 0u);
  EXPECT_EQ(GltfBuffer().content(), "");
}

}  // namespace
}  // namespace bespoke

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bespoke/product/product_io.h"
#include "product/good_products.h"
#include "product/text_dialects.h"

namespace bespoke {
namespace {

/// What the first byte of an input chooses from.
constexpr std::array endings{".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".xyz", ".csv"};

/// On a file system in memory where there is one.
const std::filesystem::path& directory() {
  static const std::filesystem::path path = [] {
    const std::filesystem::path memory = "/dev/shm";
    std::string name =
        ((std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path()) / "fuzz_XXXXXX")
            .string();
    if (!::mkdtemp(name.data())) std::abort();
    return std::filesystem::path(name);
  }();
  return path;
}

}  // namespace
}  // namespace bespoke

/// Writes a good file of every kind, and texts in all dialects, into the corpus, which is the last argument.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace bespoke;
  const std::filesystem::path corpus = (*argv)[*argc - 1];
  if (!std::filesystem::is_directory(corpus)) return 0;
  for (const test::GoodProduct& good : test::good_products()) {
    const std::string ending = std::filesystem::path(good.name).extension().string();
    const auto kind = std::find(endings.begin(), endings.end(), ending) - endings.begin();
    test::write_text(corpus / ("good_" + good.name), static_cast<char>(kind) + good.content);
    std::vector<test::TextDialect> dialects = test::line_dialects();
    for (const test::TextDialect& dialect : test::blank_dialects()) dialects.push_back(dialect);
    for (std::size_t i = 0; i < dialects.size() && good.content.find('\0') == std::string::npos; ++i)
      test::write_text(corpus / ("dialect_" + std::to_string(i) + "_" + good.name),
                       static_cast<char>(kind) + dialects[i].of(good.content));
  }
  return 0;
}

/// A file is refused by one of the library's errors, or comes out of the identity as it was. Its faces are
/// read, or it is refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bespoke;
  if (size < 2) return 0;
  const std::string ending = endings[data[0] % endings.size()];
  const std::string content(reinterpret_cast<const char*>(data) + 1, size - 1);
  // Buffers beside a file get other names.
  if (ending == ".gltf" && content.find("data:") == std::string::npos) return 0;
  const std::filesystem::path in = directory() / ("in" + ending), out = directory() / ("out" + ending);
  test::write_text(in, content);
  try {
    carry_product(in, {out}, test::identity_motion());
  } catch (const Error&) {
    return 0;
  }
  if (test::read_text(out) != content) {
    std::fputs("what the identity carries has changed\n", stderr);
    std::abort();
  }
  if (!can_read_product(in)) return 0;
  try {
    triangulated(read_product(in));
  } catch (const Error&) {
  }
  return 0;
}

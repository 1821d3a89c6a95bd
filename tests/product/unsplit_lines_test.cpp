#include "bespoke/product/unsplit_lines.h"

#include "product/product_files.h"

namespace bespoke {
namespace {

using UnsplitLines = test::ProductFiles;

TEST_F(UnsplitLines, ArePrimitivesOfLinesLoopsAndStripsOfGltf) {
  const std::string primitives =
      R"({"attributes":{},"mode":1},{"attributes":{}},{"attributes":{},"mode":3},{"attributes":{},"mode":0})";
  EXPECT_EQ(unsplit_line_primitives(file(
                "a.gltf", R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[)" + primitives + "]}]}")),
            2u);
  EXPECT_EQ(unsplit_line_primitives(file("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")), 0u);
}

}  // namespace
}  // namespace bespoke

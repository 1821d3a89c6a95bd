#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "command/example_pair.h"
#include "product/gltf_scene.h"

namespace bespoke {
namespace {

using test::bespoke;
using test::ExamplePair;
using test::ProgramResult;
using ::testing::HasSubstr;

/// Prints how many points of an OBJ lie in the image, and the largest distance of x plus the image's vector
/// from the same point of another OBJ, as an independent reader of the file sees it.
constexpr const char* reader = R"(
import sys
import numpy as np
image, product, moved, space = sys.argv[1:]
header, data = open(image, 'rb').read().split(b'\n\n', 1)
fields = dict(line.split(': ', 1) for line in header.decode().splitlines() if ': ' in line)
sizes = np.array([int(n) for n in fields['sizes'].split()])
vector = lambda text: np.array([float(c) for c in text.strip('()').split(',')])
origin = vector(fields['space origin'])
steps = np.array([vector(d) for d in fields['space directions'].split()[1:]])
values = np.frombuffer(data, '<f4').reshape(sizes[::-1])
flip = np.array([-1, -1, 1]) if space == 'ras' else np.ones(3)
points = lambda path: np.array([line.split()[1:4] for line in open(path) if line.startswith('v ')], float) * flip
errors = []
for x, y in zip(points(product), points(moved)):
    place = np.linalg.solve(steps.T, x - origin)
    if (place < 0).any() or (place > sizes[1:] - 1).any(): continue
    low = np.minimum(place.astype(int), sizes[1:] - 2)
    weights = ((np.prod(np.where(c, place - low, low + 1 - place)), c) for c in np.ndindex(2, 2, 2))
    errors.append(np.linalg.norm(x + sum(w * values[tuple((low + c)[::-1])] for w, c in weights) - y))
print(len(errors), max(errors))
)";

struct Found {
  int points = 0;
  double worst = 0;
};

class ExportCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    if (test::run_program({"/usr/bin/python3", "-c", "import numpy"}).exit_code != 0)
      GTEST_SKIP() << "NumPy (python3-numpy) is not installed";
    ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
    test::write_text(pair_.file("read.py"), reader);
  }

  Found compare(const std::string& image, const std::string& product, const std::string& moved,
                const std::string& space) {
    const ProgramResult result =
        test::run_program({"/usr/bin/python3", pair_.file("read.py"), pair_.file(image), pair_.file(product),
                           pair_.file(moved), space});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    Found found;
    std::istringstream(result.out) >> found.points >> found.worst;
    return found;
  }

  ExamplePair pair_;
};

/// The number after "max " in the line that begins with "error".
double stated_error(const std::string& out) {
  const std::size_t line = out.find("error");
  return std::stod(out.substr(out.find("max ", line) + 4));
}

TEST_F(ExportCommand, ImageMovesProductsAsApplyDoes) {
  ASSERT_EQ(pair_.apply("map.vdb", {"-o", pair_.file("moved.obj")}).exit_code, 0);
  for (const std::string space : {"lps", "ras"}) {
    const ProgramResult result = bespoke(
        {"export", pair_.file("map.vdb"), "--grid", "3%", "--space", space, "-o", pair_.file("map.nrrd")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Found found = compare("map.nrrd", "product.obj", "moved.obj", space);
    EXPECT_GT(found.points, 100);
    EXPECT_LT(found.worst, 1.5 * stated_error(result.out));
  }
}

TEST_F(ExportCommand, PulledImageLeadsBack) {
  ASSERT_EQ(pair_.apply("map.vdb", {"-o", pair_.file("moved.obj")}).exit_code, 0);
  const ProgramResult result =
      bespoke({"export", pair_.file("map.vdb"), "--grid", "3%", "--pull", "-o", pair_.file("back.nrrd")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Found found = compare("back.nrrd", "moved.obj", "product.obj", "lps");
  EXPECT_GT(found.points, 100);
  EXPECT_LT(found.worst, 1.5 * stated_error(result.out));
}

/// As reader, of a .vdb of one grid, which it looks up as OpenVDB's box sampler does: background beyond the
/// nodes.
constexpr const char* vdb_reader = R"(
import sys
import numpy as np
import pyopenvdb as vdb
image, product, moved, _ = sys.argv[1:]
grid = vdb.read(image, 'displacement')
low, high = (np.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
node = grid.getConstAccessor().getValue
points = lambda path: np.array([line.split()[1:4] for line in open(path) if line.startswith('v ')], float)
errors = []
for x, y in zip(points(product), points(moved)):
    place = np.array(grid.transform.worldToIndex(tuple(x)))
    if (place < low).any() or (place > high).any(): continue
    first = np.floor(place).astype(int)
    weights = ((np.prod(np.where(c, place - first, first + 1 - place)), c) for c in np.ndindex(2, 2, 2))
    errors.append(np.linalg.norm(x + sum(w * np.array(node(tuple((first + c).tolist()))) for w, c in weights) - y))
print(len(errors), max(errors))
)";

TEST_F(ExportCommand, VdbOfOneLevelMovesProductsAsApplyDoes) {
  if (test::run_program({"/usr/bin/python3", "-c", "import pyopenvdb"}).exit_code != 0)
    GTEST_SKIP() << "pyopenvdb (python3-openvdb) is not installed";
  test::write_text(pair_.file("read.py"), vdb_reader);
  ASSERT_EQ(pair_.apply("map.vdb", {"-o", pair_.file("moved.obj")}).exit_code, 0);
  const ProgramResult result =
      bespoke({"export", pair_.file("map.vdb"), "--grid", "3%", "-o", pair_.file("level.vdb")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Found found = compare("level.vdb", "product.obj", "moved.obj", "");
  EXPECT_GT(found.points, 100);
  EXPECT_LT(found.worst, 1.5 * stated_error(result.out));
  // It moves products in other programs, but it is no asset.
  EXPECT_EQ(bespoke({"info", pair_.file("level.vdb")}).exit_code, 2);
}

TEST_F(ExportCommand, NanovdbConvertsTheOneLevel) {
  if (!test::is_installed("nanovdb_convert"))
    GTEST_SKIP() << "nanovdb_convert (libnanovdb-tools) is not installed";
  ASSERT_EQ(
      bespoke({"export", pair_.file("map.vdb"), "--grid", "3%", "-o", pair_.file("level.vdb")}).exit_code, 0);
  ASSERT_EQ(
      test::run_program({"nanovdb_convert", pair_.file("level.vdb"), pair_.file("level.nvdb")}).exit_code, 0);
  EXPECT_THAT(test::run_program({"nanovdb_print", pair_.file("level.nvdb")}).out,
              ::testing::AllOf(HasSubstr("displacement"), HasSubstr("Vec3f")));
}

// The product's faces use its vertices in their order, so the file's are in that order too.
TEST_F(ExportCommand, MorphTargetsLieWhereApplyPutsTheProduct) {
  const ProgramResult result = bespoke({"export", pair_.file("map.vdb"), "--morph", "2", "--product",
                                        pair_.file("product.obj"), "-o", pair_.file("product.glb")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("cm, shown in metres"));
  const test::GlbContent file(test::read_text(pair_.file("product.glb")));
  const nlohmann::json& primitive = file.root["meshes"][0]["primitives"][0];
  const auto points = [&](const nlohmann::json& accessor) -> Points {
    const std::vector<float> values = file.floats(accessor);
    return Eigen::Map<const Eigen::Matrix3Xf>(values.data(), 3, static_cast<Eigen::Index>(values.size() / 3))
        .cast<double>();
  };
  const Points base = points(primitive["attributes"]["POSITION"]);
  for (const auto& [target, t] : {std::pair(0, "0.5"), std::pair(1, "1")}) {
    ASSERT_EQ(pair_.apply("map.vdb", {"--t", t, "-o", pair_.file("moved.obj")}).exit_code, 0);
    const Points moved = test::read_obj_points(pair_.file("moved.obj"));
    const Points found = base + points(primitive["targets"][static_cast<std::size_t>(target)]["POSITION"]);
    ASSERT_EQ(found.cols(), moved.cols());
    // Base, difference and the OBJ are rounded once each.
    EXPECT_LT((found - moved).colwise().norm().maxCoeff(), 3 * test::float_rounding(moved));
  }
  const ProgramResult again = bespoke({"export", pair_.file("map.vdb"), "--morph", "2", "--product",
                                       pair_.file("product.glb"), "-o", pair_.file("again.glb")});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("morph targets of its own"));
  EXPECT_FALSE(pair_.has("again.glb"));
}

TEST_F(ExportCommand, RefusesWithoutLeavingAnything) {
  const std::vector<std::string> before = pair_.files();
  const auto refused = [&](const std::vector<std::string>& extra, int code, const std::string& words) {
    std::vector<std::string> arguments{"export", pair_.file("map.vdb")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const ProgramResult result = bespoke(arguments);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(pair_.files(), before);
  };
  refused({"--grid", "3%", "-o", pair_.file("map.nii")}, 1, ".vti, .nrrd");
  refused({"--grid", "0.001%", "-o", pair_.file("map.vti")}, 4, "fit");
  refused({"--grid", "-3", "-o", pair_.file("map.vti")}, 1, "--grid");
  refused({"-o", pair_.file("map.vti")}, 1, "--grid");
  const std::string product = pair_.file("product.obj");
  refused({"--morph", "2", "-o", pair_.file("map.glb")}, 1, "--product");
  refused({"--morph", "2", "--product", product, "-o", pair_.file("map.gltf")}, 1, ".glb");
  refused({"--morph", "0", "--product", product, "-o", pair_.file("map.glb")}, 1, "--morph");
  refused({"--morph", "2", "--product", product, "--grid", "3%", "-o", pair_.file("map.glb")}, 1, "either");
  refused({"--morph", "2", "--product", pair_.file("none.obj"), "-o", pair_.file("map.glb")}, 4, "none.obj");
  refused({"--grid", "3%", "--space", "up", "-o", pair_.file("map.nrrd")}, 1, "--space");
  refused({"--grid", "3%", "--space", "ras", "-o", pair_.file("map.vti")}, 1, "own frame");
}

}  // namespace
}  // namespace bespoke

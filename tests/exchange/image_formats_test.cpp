#include "bespoke/exchange/image_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "bespoke/error.h"
#include "support/file_text.h"
#include "support/run_program.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

DisplacementImage ramp() {
  DisplacementImage image{Vector3(1, 2, 3), 0.5, {2, 3, 2}, {}};
  for (int n = 0; n < 36; ++n) image.values.push_back(0.25f * static_cast<float>(n));
  return image;
}

std::vector<float> floats_at(const std::string& bytes, std::size_t begin) {
  std::vector<float> values(36);
  std::memcpy(values.data(), bytes.data() + begin, values.size() * sizeof(float));
  return values;
}

TEST(ImageFormats, NrrdSaysWhereItsVectorsLie) {
  const test::ScratchDirectory directory;
  write_displacement_image(directory / "map.nrrd", ramp(), {"from here to there, cm"});
  const std::string bytes = test::read_text(directory / "map.nrrd");
  EXPECT_EQ(bytes.find("NRRD0005\n# from here to there, cm\n"), 0u);
  for (const char* line : {"\ntype: float\n", "\ndimension: 4\n", "\nsizes: 3 2 3 2\n",
                           "\nspace origin: (1,2,3)\n", "\nspace: left-posterior-superior\n",
                           "\nencoding: raw\n", "\nspace directions: none (0.5,0,0) (0,0.5,0) (0,0,0.5)\n"})
    EXPECT_THAT(bytes, HasSubstr(line));
  EXPECT_EQ(floats_at(bytes, bytes.find("\n\n") + 2), ramp().values);
  EXPECT_EQ(bytes.size(), bytes.find("\n\n") + 2 + 36 * sizeof(float));
}

TEST(ImageFormats, NrrdOfModelsInRasIsTurned) {
  const test::ScratchDirectory directory;
  write_displacement_image(directory / "map.nrrd", ramp(), {"turned", WorldSpace::ras});
  const std::string bytes = test::read_text(directory / "map.nrrd");
  EXPECT_THAT(bytes, HasSubstr("\nspace origin: (-1,-2,3)\n"));
  EXPECT_THAT(bytes, HasSubstr("none (-0.5,"));
  const std::vector<float> values = floats_at(bytes, bytes.find("\n\n") + 2);
  for (std::size_t n = 0; n < 36; ++n) EXPECT_EQ(values[n], (n % 3 < 2 ? -1 : 1) * ramp().values[n]);
}

// VTK carries points through the file as the image itself does.
TEST(ImageFormats, VtkMovesPointsAsTheImageDoes) {
  if (test::run_program({"/usr/bin/python3", "-c", "import vtkmodules"}).exit_code != 0)
    GTEST_SKIP() << "VTK for Python (python3-paraview or python3-vtk9) is not installed";
  const test::ScratchDirectory directory;
  write_displacement_image(directory / "map.vti", ramp(), {"from here to there"});
  test::write_text(directory / "read.py", R"(
import sys
from vtkmodules.vtkFiltersHybrid import vtkGridTransform
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
reader = vtkXMLImageDataReader()
reader.SetFileName(sys.argv[1])
transform = vtkGridTransform()
transform.SetDisplacementGridConnection(reader.GetOutputPort())
transform.SetInterpolationModeToLinear()
for x in ((1, 2, 3), (1.5, 3, 3.5), (1.2, 2.7, 3.4)):
    print(*("%.9g" % c for c in transform.TransformPoint(x)))
)");
  const test::ProgramResult result =
      test::run_program({"/usr/bin/python3", directory / "read.py", directory / "map.vti"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  Points x(3, 3);
  x << 1, 1.5, 1.2, 2, 3, 2.7, 3, 3.5, 3.4;
  const Points expected = x + ramp()(x);
  std::istringstream numbers(result.out);
  for (Eigen::Index column = 0; column < 3; ++column)
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      double found = 0;
      ASSERT_TRUE(numbers >> found) << result.out;
      EXPECT_NEAR(found, expected(axis, column), 1e-5);
    }
}

/// Columns of x, and where a script that reads the image puts them. The script prints three numbers a line.
Points moved_by_script(const test::ScratchDirectory& directory, const std::string& script,
                       const std::filesystem::path& image, const Points& x) {
  test::write_text(directory / "read.py", script);
  std::vector<std::string> arguments{"/usr/bin/python3", directory / "read.py", image};
  for (const double coordinate : x.reshaped()) arguments.push_back(std::to_string(coordinate));
  const test::ProgramResult result = test::run_program(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::istringstream numbers(result.out);
  Points moved(3, x.cols());
  for (double& coordinate : moved.reshaped()) EXPECT_TRUE(numbers >> coordinate) << result.out;
  return moved;
}

Points nodes_of_ramp() {
  Points x(3, 4);
  x << 1, 1.5, 1, 1.5, 2, 2, 3, 3, 3, 3, 3.5, 3.5;
  return x;
}

bool python_has(const std::string& modules) {
  return test::run_program({"/usr/bin/python3", "-c", "import " + modules}).exit_code == 0;
}

/// By the header's documentation alone.
constexpr const char* nifti_reader = R"(
import gzip, struct, sys
import numpy as np
data = gzip.open(sys.argv[1]).read()
assert struct.unpack_from('<i', data)[0] == 348 and data[344:348] == b'n+1\0'
dim = struct.unpack_from('<8h', data, 40)
assert dim[0] == 5 and dim[4:6] == (1, 3), dim
assert struct.unpack_from('<3h', data, 68) == (1006, 16, 32)
world_from_node = np.array(struct.unpack_from('<12f', data, 280)).reshape(3, 4)
b, c, d, *offset = struct.unpack_from('<6f', data, 256)
assert np.allclose(offset, world_from_node[:, 3]) and b == c == 0
assert np.allclose(np.diag([1 - 2 * d * d, 1 - 2 * d * d, 1]) * struct.unpack_from('<f', data, 80)[0], world_from_node[:, :3])
values = np.frombuffer(data, '<f4', offset=int(struct.unpack_from('<f', data, 108)[0]))
values = values.reshape(dim[1:4] + (3,), order='F')
for x in np.array(sys.argv[2:], float).reshape(-1, 3):
    node = np.linalg.solve(world_from_node[:, :3], x - world_from_node[:, 3])
    assert np.allclose(node, node.round())
    print(*(x + values[tuple(node.round().astype(int))]))
)";

TEST(ImageFormats, NiftiSaysWhereItsVectorsLieInRas) {
  if (!python_has("numpy")) GTEST_SKIP() << "NumPy (python3-numpy) is not installed";
  const test::ScratchDirectory directory;
  const Points expected = nodes_of_ramp() + ramp()(nodes_of_ramp());
  for (const WorldSpace space : {WorldSpace::ras, WorldSpace::lps}) {
    write_displacement_image(directory / "map.nii.gz", ramp(), {"from here to there", space});
    const double sign = space == WorldSpace::lps ? -1 : 1;
    const Matrix3 ras_from_model = Vector3(sign, sign, 1).asDiagonal();
    const Points moved =
        moved_by_script(directory, nifti_reader, directory / "map.nii.gz", ras_from_model * nodes_of_ramp());
    EXPECT_LT((ras_from_model * moved - expected).cwiseAbs().maxCoeff(), 1e-5);
  }
}

TEST(ImageFormats, NibabelReadsNifti) {
  if (!python_has("nibabel")) GTEST_SKIP() << "nibabel (python3-nibabel) is not installed";
  const test::ScratchDirectory directory;
  write_displacement_image(directory / "map.nii.gz", ramp(), {"from here to there", WorldSpace::ras});
  const Points moved = moved_by_script(directory, R"(
import sys
import nibabel
import numpy as np
image = nibabel.load(sys.argv[1])
assert image.header.get_intent()[0] == 'displacement vector', image.header
assert image.header['descrip'] == b'from here to there'
for x in np.array(sys.argv[2:], float).reshape(-1, 3):
    node = np.linalg.solve(image.affine, [*x, 1])[:3].round().astype(int)
    print(*(x + image.get_fdata()[tuple(node)][0]))
)",
                                       directory / "map.nii.gz", nodes_of_ramp());
  EXPECT_LT((moved - nodes_of_ramp() - ramp()(nodes_of_ramp())).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(ImageFormats, NiftiRefusesMoreNodesThanItCounts) {
  DisplacementImage image{Vector3::Zero(), 1, {40000, 1, 1}, std::vector<float>(120000)};
  const test::ScratchDirectory directory;
  try {
    write_displacement_image(directory / "map.nii.gz", image, {});
    FAIL() << "not refused";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("40000 nodes along an axis"));
  }
  EXPECT_FALSE(std::filesystem::exists(directory / "map.nii.gz"));
}

TEST(ImageFormats, PyopenvdbReadsOneGrid) {
  if (!python_has("numpy, pyopenvdb")) GTEST_SKIP() << "pyopenvdb (python3-openvdb) is not installed";
  const test::ScratchDirectory directory;
  write_displacement_image(directory / "map.vdb", ramp(), {"from here to there"});
  const Points moved = moved_by_script(directory, R"(
import sys
import numpy as np
import pyopenvdb as vdb
[grid], metadata = vdb.readAll(sys.argv[1])
assert (grid.name, grid.valueTypeName) == ('displacement', 'vec3s')
assert grid['vector_type'] == 'contravariant relative' and grid['bespoke:meaning'] == 'from here to there'
assert grid.activeVoxelCount() == 12 and grid.background == (0, 0, 0)
for x in np.array(sys.argv[2:], float).reshape(-1, 3):
    node = np.round(grid.transform.worldToIndex(tuple(x))).astype(int)
    print(*(x + grid.getConstAccessor().getValue(tuple(node.tolist()))))
)",
                                       directory / "map.vdb", nodes_of_ramp());
  EXPECT_LT((moved - nodes_of_ramp() - ramp()(nodes_of_ramp())).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(ImageFormats, SameImageGivesTheSameBytes) {
  const test::ScratchDirectory directory;
  for (const std::string ending : {".vti", ".nrrd", ".nii.gz", ".vdb"}) {
    write_displacement_image(directory / ("a" + ending), ramp(), {"from here to there"});
    write_displacement_image(directory / ("b" + ending), ramp(), {"from here to there"});
    EXPECT_EQ(test::read_text(directory / ("a" + ending)), test::read_text(directory / ("b" + ending)));
  }
}

TEST(ImageFormats, RefusesOtherEndings) {
  const test::ScratchDirectory directory;
  for (const char* name : {"map.nii", "map", "map.VTI", "map.gz"}) {
    try {
      write_displacement_image(directory / name, ramp(), {});
      FAIL() << name;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), HasSubstr(".vti, .nrrd, .nii.gz, .vdb"));
    }
    EXPECT_FALSE(std::filesystem::exists(directory / name));
  }
}

}  // namespace
}  // namespace bespoke

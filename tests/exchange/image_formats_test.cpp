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
    GTEST_SKIP() << "VTK for Python (python3-vtk9) is not installed";
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

TEST(ImageFormats, RefusesOtherEndings) {
  const test::ScratchDirectory directory;
  for (const char* name : {"map.nii.gz", "map", "map.VTI"}) {
    try {
      write_displacement_image(directory / name, ramp(), {});
      FAIL() << name;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), HasSubstr(".vti, .nrrd"));
    }
    EXPECT_FALSE(std::filesystem::exists(directory / name));
  }
}

}  // namespace
}  // namespace bespoke

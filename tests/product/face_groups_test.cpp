#include "bespoke/product/face_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(FaceGroups, AreThoseOfTheStatementsBefore) {
  const test::ScratchDirectory directory;
  test::write_text(
      directory / "a.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\ng sleeve left\nusemtl red\nf 1 3 4\nf 1 2 4\n"
      "usemtl blue\ng body\nf 2 3 4\n");
  const FaceGroups groups = face_groups(directory / "a.obj", FaceGroupKind::groups);
  EXPECT_THAT(groups.names, ElementsAre("", "sleeve left", "body"));
  EXPECT_THAT(groups.of_polygon, ElementsAre(0, 1, 1, 2));
  EXPECT_THAT(face_groups(directory / "a.obj", FaceGroupKind::materials).of_polygon, ElementsAre(0, 1, 1, 2));
  EXPECT_THAT(face_groups(directory / "a.obj", FaceGroupKind::objects).names, IsEmpty());
}

}  // namespace
}  // namespace bespoke

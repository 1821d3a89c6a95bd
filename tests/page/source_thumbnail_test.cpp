#include "bespoke/page/source_thumbnail.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/small_asset.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

TEST(SourceThumbnail, ShowsTheSource) {
  const Asset round = with_preview(test::small_asset(), test::sphere(Vector3::Zero(), 0.8, 3));
  const Asset square = with_preview(test::small_asset(), shapes::cube());
  EXPECT_THAT(source_thumbnail(round, 32), testing::StartsWith("data:image/png;base64,iVBORw0KGgo"));
  EXPECT_EQ(source_thumbnail(round, 32), source_thumbnail(round, 32));
  EXPECT_NE(source_thumbnail(round, 32), source_thumbnail(square, 32));
  EXPECT_THROW(source_thumbnail(test::small_asset(), 32), InvalidInput);
}

}  // namespace
}  // namespace bespoke

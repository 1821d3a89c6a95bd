#include "bespoke/page/page_file.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"

namespace bespoke {
namespace {

TEST(PageFile, PutsTheSceneIntoItsPlaceAsBase64) {
  // RFC 4648, section 10.
  EXPECT_EQ(page_with_scene("<a>{{scene}}</a>", ""), "<a></a>");
  EXPECT_EQ(page_with_scene("<a>{{scene}}</a>", "f"), "<a>Zg==</a>");
  EXPECT_EQ(page_with_scene("<a>{{scene}}</a>", "fo"), "<a>Zm8=</a>");
  EXPECT_EQ(page_with_scene("<a>{{scene}}</a>", "foobar"), "<a>Zm9vYmFy</a>");
  EXPECT_EQ(page_with_scene("{{scene}}", std::string("\0\xFF\x80", 3)), "AP+A");
}

TEST(PageFile, RefusesAPageWithNoPlaceOrTwo) {
  EXPECT_THROW(page_with_scene("<a></a>", "x"), InvalidInput);
  EXPECT_THROW(page_with_scene("{{scene}}{{scene}}", "x"), InvalidInput);
}

}  // namespace
}  // namespace bespoke

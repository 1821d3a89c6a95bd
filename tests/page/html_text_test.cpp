#include "bespoke/page/html_text.h"

#include <gtest/gtest.h>

namespace bespoke {
namespace {

TEST(HtmlText, HoldsNoMarkup) {
  EXPECT_EQ(escaped("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;>");
  EXPECT_EQ(escaped("naïve"), "naïve");
}

TEST(HtmlText, LeadsToFilesOfAnyName) {
  EXPECT_EQ(link_address("a b/c#1?.html"), "a%20b/c%231%3F.html");
  EXPECT_EQ(link_address("../maps/anna-2_x.vdb~"), "../maps/anna-2_x.vdb~");
  EXPECT_EQ(link_address("ï"), "%C3%AF");
}

}  // namespace
}  // namespace bespoke

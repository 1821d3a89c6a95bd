#include "bespoke/page/map_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/small_asset.h"

namespace bespoke {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class MapReports : public testing::Test {
 protected:
  MapReport report() const {
    return map_report({asset_, source_, target_, products_, findings_, "a <map>", "bespoke report \"a b\""});
  }
  Asset asset_ = test::small_asset();
  TriangleMesh source_ = test::sphere(Vector3(0.2, -0.4, -0.2), 0.6, 2);
  TriangleMesh target_ = test::sphere(Vector3(0.9, 0.1, 0.1), 0.6, 2);
  std::vector<NamedProduct> products_{{"ring.obj", test::sphere(Vector3(0.2, -0.4, -0.2), 0.7, 2)}};
  FitFindings findings_;
};

TEST_F(MapReports, ShowSurfaceSourceAndTargetFromTwoSides) {
  const MapReport found = report();
  ASSERT_EQ(found.pictures.size(), 6u);
  for (const ReportPicture& picture : found.pictures) EXPECT_THAT(picture.png, StartsWith("\x89PNG"));
  EXPECT_THAT(found.pictures[0].caption, AllOf(StartsWith("From the front"), HasSubstr("dm")));
  EXPECT_THAT(found.quality, HasSubstr("Hausdorff"));
  EXPECT_THAT(found.info, HasSubstr("bake error"));
}

TEST_F(MapReports, DrawNoProductsWhereThereAreNone) {
  products_.clear();
  EXPECT_EQ(report().pictures.size(), 2u);
}

TEST_F(MapReports, MarkdownNamesItsPicturesAndHtmlHoldsThem) {
  const MapReport found = report();
  const std::string markdown = report_markdown(found, "dress_");
  EXPECT_THAT(markdown, AllOf(StartsWith("# a <map>\n"), HasSubstr("](dress_source_side.png)"),
                              HasSubstr("bespoke report \"a b\"")));
  const std::string html = report_html(found);
  EXPECT_THAT(html, AllOf(HasSubstr("<h1>a &lt;map></h1>"), HasSubstr("src=\"data:image/png;base64,iVBOR"),
                          Not(HasSubstr("http"))));
}

TEST_F(MapReports, AreTheSameBytesEveryTime) { EXPECT_EQ(report_html(report()), report_html(report())); }

}  // namespace
}  // namespace bespoke

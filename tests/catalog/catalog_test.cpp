#include "bespoke/catalog/catalog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/small_asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/vector_grid.h"
#include "bespoke/catalog/catalog_file.h"
#include "bespoke/error.h"
#include "bespoke/sha256.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class CatalogTest : public ::testing::Test {
 protected:
  CatalogTest() {
    std::filesystem::create_directories(directory_ / "women/<a&b>");
    add("women/<a&b>/x.vdb", 'a', 'b');
    add("c.vdb", 'a', 'd');
    test::write_text(directory_ / "notes.txt", "no map");
    test::write_text(directory_ / ".hidden.vdb", "no map");
  }
  void add(const std::string& name, char source, char target) const {
    Asset asset = test::small_asset();
    asset.record.source.hash = std::string(64, source);
    asset.record.target.hash = std::string(64, target);
    write_asset(directory_ / name, with_preview(std::move(asset), test::sphere(Vector3::Zero(), 0.8, 2)));
  }
  Catalog index() const { return index_assets(directory_.path()); }

  test::ScratchDirectory directory_;
};

TEST_F(CatalogTest, ListsWhatAssetsSayOfThemselves) {
  const Catalog catalog = index();
  EXPECT_TRUE(catalog.refused.empty());
  ASSERT_EQ(catalog.assets.size(), 2u);
  const CatalogEntry& entry = catalog.assets[0];
  EXPECT_EQ(entry.file, "c.vdb");
  EXPECT_EQ(catalog.assets[1].file, "women/<a&b>/x.vdb");
  const std::string bytes = test::read_text(directory_ / "c.vdb");
  const Asset asset = read_asset(directory_ / "c.vdb");
  EXPECT_EQ(entry.bytes, bytes.size());
  EXPECT_EQ(entry.sha256, sha256(bytes.data(), bytes.size()));
  EXPECT_EQ(entry.source.hash, std::string(64, 'a'));
  EXPECT_EQ(entry.target.hash, std::string(64, 'd'));
  EXPECT_EQ(entry.unit, asset.record.unit);
  EXPECT_EQ(entry.tolerance, asset.record.tolerance);
  EXPECT_EQ(entry.error_max, asset.record.bake_error.max);
  EXPECT_EQ(entry.voxels, voxel_count(asset));
  EXPECT_EQ(entry.anchors, asset.record.anchors.size());
  EXPECT_EQ(entry.bijection, whole_certificate(asset).is_bijection());
  EXPECT_THAT(entry.thumbnail, StartsWith("data:image/png;base64,iVBOR"));
}

TEST_F(CatalogTest, RefusesWhatIsNoSoundAsset) {
  std::string damaged = test::read_text(directory_ / "c.vdb");
  damaged[damaged.size() / 2] ^= 1;
  test::write_text(directory_ / "b.vdb", damaged);
  test::write_text(directory_ / "women/empty.vdb", "");
  const Catalog catalog = index();
  EXPECT_EQ(catalog.assets.size(), 2u);
  ASSERT_EQ(catalog.refused.size(), 2u);
  EXPECT_EQ(catalog.refused[0].file, "b.vdb");
  EXPECT_THAT(catalog.refused[0].reason,
              AllOf(Not(HasSubstr(directory_.path().string())), HasSubstr("SHA-256")));
  EXPECT_EQ(catalog.refused[1].file, "women/empty.vdb");
}

TEST_F(CatalogTest, PassesOverOtherVolumesButNotAssetsCutShort) {
  const std::vector<float> values(24, 0.5F);
  const VectorGrid image{"displacement", "an image", Vector3::Zero(), 1, {2, 2, 2}, values};
  test::write_text(directory_ / "image.vdb", vdb_of_one_grid(image));
  const std::string whole = test::read_text(directory_ / "c.vdb");
  test::write_text(directory_ / "cut.vdb", whole.substr(0, whole.size() / 2));
  const Catalog catalog = index();
  EXPECT_THAT(catalog.others, ElementsAre("image.vdb"));
  ASSERT_EQ(catalog.refused.size(), 1u);
  EXPECT_EQ(catalog.refused[0].file, "cut.vdb");
}

TEST_F(CatalogTest, ComesBackFromItsFile) {
  test::write_text(directory_ / "b.vdb", "damaged");
  const Catalog catalog = index();
  const std::string json = catalog_json(catalog);
  test::write_text(catalog_path(directory_.path()), json);
  EXPECT_EQ(catalog_json(read_catalog(catalog_path(directory_.path()))), json);
  // Made anew of the same files, beside the old one.
  EXPECT_EQ(catalog_json(index()), json);
}

TEST_F(CatalogTest, SaysHowToMakeItAnewWhereItCannotBeRead) {
  const std::filesystem::path path = catalog_path(directory_.path());
  const std::string how = "`bespoke catalog " + directory_.path().string() + "`";
  EXPECT_THAT(test::error_message<FileError>([&] { read_catalog(path); }), HasSubstr(how));
  const std::string json = catalog_json(index());
  std::string other_version = json, without_key = json;
  other_version.replace(other_version.find("\"version\": 1"), 12, "\"version\": 2");
  without_key.replace(without_key.find("\"voxels\""), 8, "\"foxels\"");
  for (const std::string& text : {std::string("{}"), std::string("["), std::string("[]"), other_version,
                                  without_key, json.substr(0, json.size() / 2)}) {
    test::write_text(path, text);
    EXPECT_THAT(test::error_message<FormatError>([&] { read_catalog(path); }), HasSubstr(how));
  }
}

TEST_F(CatalogTest, PageShowsEveryMapAndEscapesNames) {
  test::write_text(directory_ / "b.vdb", "damaged");
  const std::string page = catalog_page(index());
  EXPECT_THAT(page, AllOf(HasSubstr("<h1>2 maps</h1>"), HasSubstr("href=\"women/%3Ca%26b%3E/x.vdb\""),
                          HasSubstr("women/&lt;a&amp;b>/x.vdb"), HasSubstr("<li>b.vdb: "),
                          HasSubstr("src=\"data:image/png;base64,")));
  EXPECT_THAT(page, Not(HasSubstr("<a&b>")));
}

TEST_F(CatalogTest, OfNoDirectoryIsAnError) {
  EXPECT_THROW(index_assets(directory_ / "absent"), FileError);
  EXPECT_THROW(index_assets(directory_ / "c.vdb"), FileError);
  const test::ScratchDirectory empty;
  EXPECT_TRUE(index_assets(empty.path()).assets.empty());
}

}  // namespace
}  // namespace bespoke

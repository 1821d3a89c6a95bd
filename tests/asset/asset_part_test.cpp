#include "bespoke/asset/asset_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "asset/small_asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/lattice/part_map.h"
#include "support/pyramid_part_of.h"
#include "support/random_pyramid.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A step whose leaves fill a cube, and so that parts of them lie in many blocks of the file: two levels,
/// full except for the finer one's upper half.
MapStep wide_step(unsigned seed) {
  MapStep step = test::small_asset().steps.front();
  step.pyramid = test::random_pyramid(2, seed);
  const auto fill = [](PyramidLevel& level, int low, int high) {
    level.leaves.clear();
    for (int i = low; i < high; ++i)
      for (int j = low; j < high; ++j)
        for (int k = low; k < high; ++k) level.leaves.push_back({i, j, k});
  };
  fill(step.pyramid.levels[0], -4, 4);
  fill(step.pyramid.levels[1], -8, 0);
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> value(-0.01f, 0.01f);
  for (PyramidLevel& level : step.pyramid.levels) {
    level.values.resize(leaf_floats * level.leaves.size());
    for (float& v : level.values) v = rounded_to_half(value(engine));
  }
  return step;
}

Asset wide_asset(std::size_t steps) {
  Asset asset = test::tiny_asset();
  asset.steps.clear();
  for (std::size_t step = 0; step < steps; ++step)
    asset.steps.push_back(wide_step(static_cast<unsigned>(step)));
  return asset;
}

class AssetParts : public testing::Test {
 protected:
  void write(const Asset& asset) {
    test::write_with_block_hashes(path_, asset);
    bytes_ = test::read_text(path_);
  }

  void expect_bits_of_the_whole(unsigned seed) {
    const Asset asset = read_asset(path_);
    const ElasticChain whole = loaded_chain(asset.steps);
    std::mt19937 engine(seed);
    for (int n = 0; n < 12; ++n) {
      const Box box = test::random_box(engine, n % 2 == 0 ? 1 : 8);
      std::optional<AssetPart> part = read_asset_part(path_, box);
      ASSERT_TRUE(part);
      EXPECT_EQ(part->target_from_source.translation, asset.target_from_source.translation);
      EXPECT_EQ(part->record.source.hash, asset.record.source.hash);
      EXPECT_EQ(part->path, asset.path);
      const ElasticChain chain = loaded_chain(std::move(part->steps));
      const Points x = test::points_in(box, 2000, engine);
      ASSERT_EQ(chain(x), whole(x)) << "box " << n;
      ASSERT_EQ(chain.displacement_gradient(x), whole.displacement_gradient(x)) << "box " << n;
      ASSERT_EQ(chain.at(x, 0.7), whole.at(x, 0.7)) << "box " << n;
    }
  }

  test::ScratchDirectory directory_;
  std::filesystem::path path_ = directory_ / "map.vdb";
  std::string bytes_;
};

TEST_F(AssetParts, HaveTheBitsOfTheWhole) {
  write(wide_asset(1));
  expect_bits_of_the_whole(1);
}

TEST_F(AssetParts, OfAChainFollowTheBoxThroughItsSteps) {
  Asset asset = wide_asset(3);
  asset.path = RotationPath::flow;
  write(asset);
  expect_bits_of_the_whole(2);
}

TEST_F(AssetParts, OfHalfPrecisionHaveTheBitsOfTheWhole) {
  Asset asset = wide_asset(1);
  asset.steps.front().pyramid.precision = ValuePrecision::half;
  write(asset);
  expect_bits_of_the_whole(3);
}

TEST_F(AssetParts, HaveLeavesOfOneValue) {
  Asset asset = wide_asset(1);
  // One leaf in three, and every one of a block of the lattice.
  PyramidLevel& level = asset.steps.front().pyramid.levels.front();
  for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf) {
    const LeafCoordinates& place = level.leaves[leaf];
    if (leaf % 3 == 0 || *std::min_element(place.begin(), place.end()) >= 0)
      std::fill_n(level.values.begin() + static_cast<std::ptrdiff_t>(leaf * leaf_floats), leaf_floats,
                  leaf % 2 == 0 ? 0.0f : 0.0078125f);
  }
  write(asset);
  expect_bits_of_the_whole(4);
}

TEST_F(AssetParts, OfAffineStepsNeedNoLevels) {
  Asset asset = wide_asset(2);
  asset.steps.front().pyramid.levels.clear();
  write(asset);
  expect_bits_of_the_whole(4);
}

TEST_F(AssetParts, ReadLittleOfTheFileForASmallBox) {
  write(wide_asset(1));
  const std::optional<AssetPart> small = read_asset_part(path_, {Vector3(2, 1, 4), Vector3(2.5, 1.5, 4.5)});
  EXPECT_EQ(small->file_bytes, bytes_.size());
  EXPECT_LT(small->bytes_read, bytes_.size() / 3);
  const std::optional<AssetPart> all =
      read_asset_part(path_, {Vector3::Constant(-100), Vector3::Constant(100)});
  EXPECT_GT(all->bytes_read, bytes_.size() * 9 / 10);
}

TEST_F(AssetParts, OfAFileWithOneHashAreNone) {
  write_asset(path_, wide_asset(1));
  EXPECT_FALSE(read_asset_part(path_, {Vector3::Zero(), Vector3::Ones()}));
}

TEST_F(AssetParts, OfNoBoxAreRefused) {
  write(wide_asset(1));
  EXPECT_THROW(read_asset_part(path_, {}), InvalidInput);
  EXPECT_THROW(read_asset_part(path_, {Vector3::Zero(), Vector3::Constant(NAN)}), InvalidInput);
}

TEST_F(AssetParts, ThrowWhereTheyAreAskedForMore) {
  write(wide_asset(1));
  const ElasticChain chain =
      loaded_chain(read_asset_part(path_, {Vector3(2, 1, 4), Vector3(2.5, 1.5, 4.5)})->steps);
  EXPECT_THROW(chain(Points(Vector3(-6, -6, -6))), OutsidePart);
}

// Damage anywhere is found by who reads the whole, and damage in what a part reads by who reads the part.
TEST_F(AssetParts, FindDamageInEveryBlockThatTheyRead) {
  write(wide_asset(1));
  const Box box(Vector3(2, 1, 4), Vector3(2.5, 1.5, 4.5));
  const Points x = box.center();
  const Points image = loaded_chain(read_asset_part(path_, box)->steps)(x);
  const std::size_t content = AssetSections(unseal(bytes_)).vdb.size();
  int found = 0, untouched = 0;
  for (std::size_t block = 0; block * block_size < content; ++block) {
    std::string damaged = bytes_;
    damaged[std::min(content - 1, block * block_size + 12345)] ^= 4;
    test::write_text(path_, damaged);
    const auto names_the_block =
        ThrowsMessage<FormatError>(HasSubstr("block at byte " + std::to_string(block * block_size)));
    EXPECT_THAT([&] { read_asset(path_); }, names_the_block);
    try {
      EXPECT_EQ(loaded_chain(read_asset_part(path_, box)->steps)(x), image);
      ++untouched;
    } catch (const FormatError&) {
      EXPECT_THAT([&] { read_asset_part(path_, box); }, names_the_block);
      ++found;
    }
  }
  EXPECT_GT(found, 2);
  EXPECT_GT(untouched, found);
}

TEST_F(AssetParts, OfAFileThatIsCutOrLongerAreRefused) {
  write(wide_asset(1));
  const Box box(Vector3(2, 1, 4), Vector3(2.5, 1.5, 4.5));
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, bytes_.size() / 2, bytes_.size() - 1}) {
    test::write_text(path_, bytes_.substr(0, size));
    EXPECT_THAT([&] { read_asset_part(path_, box); }, ThrowsMessage<FormatError>(HasSubstr("map.vdb: ")));
  }
  test::write_text(path_, bytes_ + "x");
  EXPECT_THROW(read_asset_part(path_, box), FormatError);
  EXPECT_THROW(read_asset_part(directory_ / "absent.vdb", box), FileError);
}

TEST_F(AssetParts, AreAlsoReadAsAWholeWithTheSameContent) {
  Asset asset = wide_asset(2);
  asset.exact_map = std::string(3 * block_size, 'e');
  write(asset);
  for (const bool untrusted : {false, true}) {
    const Asset read = read_asset(path_, {.untrusted = untrusted});
    EXPECT_EQ(read.exact_map, asset.exact_map);
    for (std::size_t step = 0; step < 2; ++step)
      for (std::size_t level = 0; level < 2; ++level)
        EXPECT_EQ(read.steps[step].pyramid.levels[level].values,
                  asset.steps[step].pyramid.levels[level].values);
    test::write_with_block_hashes(directory_ / "again.vdb", read);
    EXPECT_EQ(test::read_text(directory_ / "again.vdb"), bytes_);
  }
  expect_bits_of_the_whole(5);
}

// Byte 8 of the trailer is its version.
TEST_F(AssetParts, AreOfLargeFilesOnly) {
  Asset asset = test::tiny_asset();
  write_asset(path_, asset);
  const std::string small = test::read_text(path_);
  EXPECT_EQ(small[small.size() - trailer_size + 8], 1) << "programs in the field read on";
  const std::size_t grids = small.size() - trailer_size;
  for (const std::size_t missing : {1, 0}) {
    asset.exact_map.assign(block_hashes_from - grids - missing, 'e');
    write_asset(path_, asset);
    const std::string large = test::read_text(path_);
    EXPECT_EQ(large[large.size() - trailer_size + 8], missing == 0 ? 2 : 1);
    EXPECT_EQ(large.substr(0, grids), small.substr(0, grids));
  }
  const std::optional<AssetPart> part = read_asset_part(path_, {Vector3::Zero(), Vector3::Ones()});
  ASSERT_TRUE(part);
  EXPECT_LT(part->bytes_read, 10 * block_size) << "the exact map is not read";
}

}  // namespace
}  // namespace bespoke

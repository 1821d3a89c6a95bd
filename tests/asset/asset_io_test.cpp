#include "bespoke/asset/asset_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <functional>

#include "asset/small_asset.h"
#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/asset/grids/grid_conversion.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

class AssetIo : public testing::Test {
 protected:
  test::ScratchDirectory directory_;

  std::string written(const Asset& asset) {
    write_asset(directory_ / "map.vdb", asset);
    return test::read_text(directory_ / "map.vdb");
  }
  Asset read_bytes(const std::string& bytes, bool untrusted = false) {
    test::write_text(directory_ / "read.vdb", bytes);
    return read_asset(directory_ / "read.vdb", {.untrusted = untrusted});
  }
};

void expect_same(const Asset& a, const Asset& b) {
  EXPECT_EQ(a.target_from_source.rotation, b.target_from_source.rotation);
  EXPECT_EQ(a.target_from_source.translation, b.target_from_source.translation);
  EXPECT_EQ(a.steps.front().affine.linear, b.steps.front().affine.linear);
  EXPECT_EQ(a.steps.front().affine.offset, b.steps.front().affine.offset);
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.steps.front().pyramid.origin, b.steps.front().pyramid.origin);
  ASSERT_EQ(a.steps.front().pyramid.levels.size(), b.steps.front().pyramid.levels.size());
  for (std::size_t i = 0; i < a.steps.front().pyramid.levels.size(); ++i) {
    EXPECT_EQ(a.steps.front().pyramid.levels[i].voxel_size, b.steps.front().pyramid.levels[i].voxel_size);
    EXPECT_EQ(a.steps.front().pyramid.levels[i].leaves, b.steps.front().pyramid.levels[i].leaves);
    EXPECT_EQ(a.steps.front().pyramid.levels[i].values, b.steps.front().pyramid.levels[i].values);
  }
  EXPECT_EQ(record_json(a), record_json(b));
  EXPECT_EQ(a.exact_map, b.exact_map);
}

Asset in_half_precision(Asset asset) {
  asset.steps.front().pyramid.precision = ValuePrecision::half;
  for (PyramidLevel& level : asset.steps.front().pyramid.levels)
    for (float& value : level.values) value = rounded_to_half(value);
  return asset;
}

TEST_F(AssetIo, HalfPrecisionTakesLessRoomAndComesBackAsItWas) {
  const Asset single = test::tiny_asset();
  const Asset half = in_half_precision(single);
  const std::string bytes = written(half);
  EXPECT_LT(bytes.size(), written(single).size());
  for (const bool untrusted : {false, true}) {
    const Asset read = read_bytes(bytes, untrusted);
    EXPECT_EQ(read.steps.front().pyramid.precision, ValuePrecision::half);
    expect_same(read, half);
    EXPECT_EQ(written(read), bytes);
    const Certificate before = certify(half.steps.front().pyramid, half.steps.front().affine),
                      after = certify(read.steps.front().pyramid, read.steps.front().affine);
    EXPECT_EQ(after.certified, before.certified);
    EXPECT_EQ(after.min_determinant, before.min_determinant);
  }
}

// What the first assets of version 1 hold. The reader takes nothing less and nothing more, so any other set
// would make files of one version that programs of that version refuse. Half precision came later.
TEST_F(AssetIo, SinglePrecisionKeepsToTheKeysOfTheFirstAssets) {
  const std::vector<std::string> first = {"affine_determinant",
                                          "affine_offset",
                                          "affine_row_0",
                                          "affine_row_1",
                                          "affine_row_2",
                                          "cells_certified",
                                          "cells_folded",
                                          "cells_undecided",
                                          "convention",
                                          "direction",
                                          "elastic_method",
                                          "error_max",
                                          "error_p99",
                                          "format_version",
                                          "is_bijection",
                                          "lambda",
                                          "least_determinant",
                                          "levels",
                                          "record",
                                          "rotation_path",
                                          "rotation_row_0",
                                          "rotation_row_1",
                                          "rotation_row_2",
                                          "source_box_max",
                                          "source_box_min",
                                          "source_hash",
                                          "surface_fit_method",
                                          "target_box_max",
                                          "target_box_min",
                                          "target_hash",
                                          "tolerance",
                                          "translation",
                                          "unit"};
  const auto keys_of = [](const Asset& asset) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : file_metadata(record_json(asset)))
      keys.push_back(key.substr(std::string("bespoke:").size()));
    std::sort(keys.begin(), keys.end());
    return keys;
  };
  EXPECT_EQ(keys_of(test::tiny_asset()), first);
  EXPECT_THAT(record_json(test::tiny_asset()), Not(HasSubstr("precision")));
  EXPECT_THAT(keys_of(in_half_precision(test::tiny_asset())), Contains("precision"));
}

TEST_F(AssetIo, RefusesValuesThatHalfPrecisionWouldChange) {
  Asset asset = in_half_precision(test::tiny_asset());
  asset.steps.front().pyramid.levels[0].values[5] = 0.1f;
  EXPECT_THAT([&] { written(asset); }, ThrowsMessage<InvalidInput>(HasSubstr("half precision")));
}

TEST_F(AssetIo, ReadsBackWhatWasWritten) {
  Asset asset = test::tiny_asset();
  asset.path = RotationPath::euler;
  asset.exact_map = std::string("any\0bytes", 9);
  const std::string bytes = written(asset);
  expect_same(read_bytes(bytes), asset);
  expect_same(read_bytes(bytes, /*untrusted=*/true), asset);
}

// (s + o) − o differs from s for these, so whoever derives the voxel size from two points rounds it.
TEST_F(AssetIo, KeepsEveryBitOfTheLattice) {
  Asset asset = test::tiny_asset();
  asset.steps.front().pyramid.origin = {-1.346511805807968, -1.8102458160690365, -1.1204059798501647};
  asset.steps.front().pyramid.levels[0].voxel_size = 0.09486832917676327;
  asset.steps.front().pyramid.levels[1].voxel_size = 0.09486832917676327 / 2;
  expect_same(read_bytes(written(asset)), asset);
}

TEST_F(AssetIo, KeepsTheSignOfZeroAndDenormals) {
  Asset asset = test::tiny_asset();
  asset.steps.front().pyramid.levels[0].values[0] = -0.0f;
  asset.steps.front().pyramid.levels[0].values[1] = std::numeric_limits<float>::denorm_min();
  const Asset read = read_bytes(written(asset));
  for (std::size_t i = 0; i < asset.steps.front().pyramid.levels[0].values.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(read.steps.front().pyramid.levels[0].values[i]),
              std::bit_cast<std::uint32_t>(asset.steps.front().pyramid.levels[0].values[i]));
}

TEST_F(AssetIo, WriteReadWriteGivesTheSameBytes) {
  const Asset asset = with_preview(test::small_asset(), test::sphere({0, 0, 0}, 1, 3));
  const std::string first = written(asset);
  EXPECT_EQ(written(read_bytes(first)), first);
  EXPECT_EQ(written(read_bytes(first, /*untrusted=*/true)), first);
}

TEST_F(AssetIo, GivesTheSameBytesAtAnyThreadCount) {
  std::string first;
  for (const std::size_t threads : {1, 2, 8}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const std::string bytes = written(with_preview(test::small_asset(), test::sphere({0, 0, 0}, 1, 4)));
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << threads << " threads";
  }
}

TEST_F(AssetIo, OfAnAffineMapHasNoLevelButADisplacement) {
  Asset asset = test::small_asset();
  asset.steps.front().pyramid.levels.clear();
  const Asset read = read_bytes(written(with_preview(asset, test::sphere({0, 0, 0}, 1, 1))));
  EXPECT_TRUE(read.steps.front().pyramid.levels.empty());
  EXPECT_FALSE(read.preview->grids().front().leaves.empty());
}

TEST_F(AssetIo, ReadsTextThatIsNotUtf8) {
  Asset asset = test::tiny_asset();
  asset.record.anchors[0].name = "\xff\xfe";
  asset.record.unit = "\xe9";
  const std::string bytes = written(asset);
  EXPECT_EQ(written(read_bytes(bytes)), bytes);
}

TEST_F(AssetIo, RefusesToWriteWhatIsNotValid) {
  const auto refuses = [&](const std::function<void(Asset&)>& spoil, const std::string& why) {
    Asset asset = test::tiny_asset();
    spoil(asset);
    EXPECT_THAT([&] { write_asset(directory_ / "bad.vdb", asset); },
                ThrowsMessage<InvalidInput>(HasSubstr(why)));
    EXPECT_FALSE(std::filesystem::exists(directory_ / "bad.vdb"));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses([](Asset& a) { a.target_from_source.rotation *= 2; }, "not a rotation");
  refuses([](Asset& a) { a.target_from_source.rotation.col(0) *= -1; }, "not a rotation");
  refuses([&](Asset& a) { a.target_from_source.translation.x() = nan; }, "rigid part");
  refuses([&](Asset& a) { a.steps.front().affine.linear(0, 0) = nan; }, "affine part");
  refuses(
      [&](Asset& a) { a.steps.front().pyramid.levels[1].values[7] = std::numeric_limits<float>::infinity(); },
      "level 1");
  refuses(
      [](Asset& a) {
        a.steps.front().pyramid.levels = {test::wavy_level({0, 0, 0}, 1e-5, {{0, 0, 0}}, 1e-6)};
      },
      "smaller unit");
  refuses([](Asset& a) { a.steps.front().certificate.certified = 0; }, "no cell is certified");
  refuses([](Asset& a) { a.steps.front().certificate.min_determinant = 0; }, "least determinant");
  refuses([](Asset& a) { a.steps.front().certificate.affine_determinant = 1; }, "affine determinant");
  refuses([&](Asset& a) { a.record.lambda = nan; }, "lambda");
  refuses([&](Asset& a) { a.record.anchors[0].weight = 0; }, "weight");
  refuses([&](Asset& a) { a.record.source.box.setEmpty(); }, "source bounding box");
  refuses([&](Asset& a) { a.record.options_json = "{"; }, "options_json");
  refuses([&](Asset& a) { a.record.stages_json = "{}"; }, "stages_json");
  refuses([&](Asset& a) { a.preview.reset(); }, "with_preview");
}

/// tiny_asset() with another step after its own.
Asset tiny_chain() {
  Asset asset = test::tiny_asset();
  MapStep second = asset.steps.front();
  second.affine.offset = {0.3, 0, 0.1};
  second.affine.linear *= 0.9;
  second.certificate.affine_determinant = second.affine.linear.determinant();
  second.pyramid.origin = {0.25, 0, 0};
  second.pyramid.levels.pop_back();
  asset.steps.push_back(std::move(second));
  asset.path = RotationPath::flow;
  return asset;
}

TEST_F(AssetIo, RoundTripsAChain) {
  const Asset asset = tiny_chain();
  const std::string bytes = written(asset);
  for (const bool untrusted : {false, true}) {
    const Asset read = read_bytes(bytes, untrusted);
    expect_same(read, asset);
    ASSERT_EQ(read.steps.size(), 2u);
    EXPECT_EQ(read.steps[1].affine.linear, asset.steps[1].affine.linear);
    EXPECT_EQ(read.steps[1].affine.offset, asset.steps[1].affine.offset);
    EXPECT_EQ(read.steps[1].pyramid.origin, asset.steps[1].pyramid.origin);
    ASSERT_EQ(read.steps[1].pyramid.levels.size(), 1u);
    EXPECT_EQ(read.steps[1].pyramid.levels[0].values, asset.steps[1].pyramid.levels[0].values);
    EXPECT_EQ(written(read), bytes);
  }
}

TEST_F(AssetIo, NamesTheGridsAndEntriesOfEveryStep) {
  const StoredFile file = stored_file_from_vdb(unseal(written(tiny_chain())).vdb);
  std::vector<std::string> names;
  for (const StoredGrid& grid : file.grids) names.push_back(grid.name);
  EXPECT_THAT(names,
              testing::ElementsAre("displacement", "source_distance", "jacobian", "u_0", "u_1", "s1_u_0"));
  EXPECT_EQ(std::get<std::int64_t>(file.metadata.at(version_key)), 2);
  EXPECT_EQ(std::get<std::int64_t>(file.metadata.at("bespoke:steps")), 2);
  EXPECT_EQ(std::get<std::int64_t>(file.metadata.at("bespoke:levels")), 2);
  EXPECT_EQ(std::get<std::int64_t>(file.metadata.at("bespoke:s1_levels")), 1);
  EXPECT_EQ(std::get<Vector3>(file.metadata.at("bespoke:s1_affine_offset")), Vector3(0.3, 0, 0.1));
  EXPECT_EQ(std::get<std::string>(file.metadata.at("bespoke:rotation_path")), "flow");
}

TEST_F(AssetIo, RefusesAChainWithAStepThatItCannotVouchFor) {
  Asset no_steps = test::tiny_asset(), broken = tiny_chain(), mixed = tiny_chain();
  no_steps.steps.clear();
  broken.steps[1].affine.linear(0, 0) = std::numeric_limits<double>::quiet_NaN();
  mixed.steps[1].pyramid.precision = ValuePrecision::half;
  mixed.steps[1].pyramid.levels.clear();
  EXPECT_THAT([&] { require_valid(no_steps); }, ThrowsMessage<InvalidInput>(HasSubstr("no steps")));
  EXPECT_THAT([&] { require_valid(broken); }, ThrowsMessage<InvalidInput>(HasSubstr("affine part")));
  EXPECT_THAT([&] { require_valid(mixed); }, ThrowsMessage<InvalidInput>(HasSubstr("one precision")));
}

TEST(WholeCertificate, IsABijectionOnlyWhenEveryStepIs) {
  Asset asset = tiny_chain();
  const Certificate whole = whole_certificate(asset);
  EXPECT_TRUE(whole.is_bijection());
  EXPECT_EQ(whole.certified, 2 * asset.steps[0].certificate.certified);
  EXPECT_NEAR(whole.min_determinant, 0.0625 * 0.0625, 1e-15);
  asset.steps[1].certificate.folded = 1;
  EXPECT_FALSE(whole_certificate(asset).is_bijection());
  asset.steps[1].certificate.folded = 0;
  asset.steps[0].certificate.affine_determinant = asset.steps[1].certificate.affine_determinant = -1;
  EXPECT_FALSE(whole_certificate(asset).is_bijection());
}

TEST_F(AssetIo, NamesTheFileThatCannotBeRead) {
  EXPECT_THAT([&] { read_asset(directory_ / "absent.vdb"); },
              ThrowsMessage<FileError>(HasSubstr("absent.vdb")));
  EXPECT_THAT([&] { read_asset(directory_ / ""); },
              ThrowsMessage<FileError>(HasSubstr("not a regular file")));
}

TEST_F(AssetIo, NamesTheFileThatCannotBeWritten) {
  EXPECT_THAT([&] { write_asset(directory_ / "absent" / "map.vdb", test::tiny_asset()); },
              ThrowsMessage<FileError>(HasSubstr("absent")));
}

TEST_F(AssetIo, RejectsWhatIsNoAsset) {
  EXPECT_THAT([&] { read_bytes(""); }, ThrowsMessage<FormatError>(HasSubstr("not a bespoke asset")));
  EXPECT_THAT([&] { read_bytes(std::string(1000, 'x')); },
              ThrowsMessage<FormatError>(HasSubstr("not a bespoke asset")));
  const StoredFile plain = stored_file_from_vdb(unseal(written(test::tiny_asset())).vdb);
  EXPECT_THAT([&] { read_bytes(vdb_bytes(plain)); },
              ThrowsMessage<FormatError>(HasSubstr("not a bespoke asset")));
}

TEST_F(AssetIo, RejectsAnotherTrailerVersion) {
  std::string bytes = written(test::tiny_asset());
  bytes[bytes.size() - trailer_size + 8] = 3;
  EXPECT_THAT([&] { read_bytes(bytes); }, ThrowsMessage<FormatError>(HasSubstr("trailer version 3")));
}

// Each spoils the content and seals it anew, so that only the reader's own checks stand in its way.
TEST_F(AssetIo, RejectsWellSealedContentThatItCannotVouchFor) {
  const std::string sound = written(test::tiny_asset());
  const auto rejects = [&](const std::function<void(StoredFile&)>& spoil, const std::string& why) {
    StoredFile file = stored_file_from_vdb(unseal(sound).vdb);
    spoil(file);
    const std::string bytes = seal({vdb_bytes(file), ""});
    for (const bool untrusted : {false, true})
      EXPECT_THAT([&] { read_bytes(bytes, untrusted); }, ThrowsMessage<FormatError>(HasSubstr(why)));
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  rejects([](StoredFile& f) { f.metadata.erase(version_key); }, "bespoke:format_version is missing");
  rejects([](StoredFile& f) { f.metadata[version_key] = std::int64_t{3}; }, "format version 3");
  rejects([](StoredFile& f) { f.metadata[version_key] = std::int64_t{2}; }, "format_version contradicts");
  rejects([](StoredFile& f) { f.metadata[version_key] = 1.0; }, "not a 64-bit integer");
  rejects([](StoredFile& f) { f.metadata.erase(record_key); }, "bespoke:record is missing");
  rejects([](StoredFile& f) { f.metadata[record_key] = std::string("{"); }, "not JSON");
  rejects([](StoredFile& f) { f.metadata[record_key] = std::string(1000, '['); }, "nests deeper");
  rejects([](StoredFile& f) { f.metadata[record_key] = std::string("{}"); }, "is missing");
  rejects([](StoredFile& f) { f.metadata.erase("bespoke:unit"); }, "bespoke:unit is missing");
  rejects([](StoredFile& f) { f.metadata["bespoke:unit"] = std::string("mile"); }, "contradicts");
  rejects([](StoredFile& f) { f.metadata["bespoke:lambda"] = 7.0; }, "contradicts");
  rejects([](StoredFile& f) { f.metadata["bespoke:more"] = 7.0; }, "unexpected metadata");
  rejects([](StoredFile& f) { std::swap(f.grids[3], f.grids[4]); }, "in the place of u_0");
  rejects([](StoredFile& f) { std::swap(f.grids[0], f.grids[3]); }, "in the place of u_0");
  rejects([](StoredFile& f) { std::swap(f.grids[1], f.grids[2]); }, "in the place of source_distance");
  rejects([](StoredFile& f) { f.grids.pop_back(); }, "4 grids, the record requires 5");
  rejects([](StoredFile& f) { f.grids.push_back(f.grids[4]), f.grids[5].name = "u_2"; },
          "in the place of target_distance");
  rejects([](StoredFile& f) { f.grids[3] = f.grids[1], f.grids[3].name = "u_0"; }, "no Vec3S");
  rejects([](StoredFile& f) { f.grids[3].voxel_size *= 2; }, "contradicts the record");
  rejects([](StoredFile& f) { f.grids[4].origin.x() += 1e-9; }, "contradicts the record");
  rejects([](StoredFile& f) { f.grids[3].background = 1; }, "background");
  rejects([&](StoredFile& f) { f.grids[3].values[5] = nan; }, "not finite");
  rejects([&](StoredFile& f) { f.grids[0].values[5] = nan; }, "not finite");
  rejects([](StoredFile& f) { f.grids[3].leaves.pop_back(), f.grids[3].values.resize(2 * 3 * leaf_nodes); },
          "leaves");
  rejects(
      [](StoredFile& f) {
        f.grids[3].leaves[0] = {-50, 0, 0}, f.grids[4].leaves[0] = {90, 0, 0};
      },
      "level");
  rejects([](StoredFile& f) { f.grids[0].leaves.clear(), f.grids[0].values.clear(); }, "holds no values");
  rejects([](StoredFile& f) { f.grids[1].grid_class = GridClass::unknown; }, "class");
  rejects([](StoredFile& f) { f.grids[3].active.assign(f.grids[3].leaves.size(), LeafMask{}); }, "inactive");
}

}  // namespace
}  // namespace bespoke

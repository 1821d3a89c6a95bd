#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>

#include "asset/small_asset.h"
#include "bespoke/asset/asset_io.h"

// Programs that know nothing of bespoke open its assets.
namespace bespoke {
namespace {

using testing::HasSubstr;

struct ProgramRun {
  int status = 0;
  std::string output;
};

ProgramRun run(const std::string& command) {
  ProgramRun result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
    result.output.append(buffer.data(), got);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return result;
}

// With one hash for all and with one a block: other programs ignore what follows the grids.
class AssetClients : public testing::TestWithParam<TrailerForm> {
 protected:
  AssetClients() {
    Asset asset = with_preview(test::small_asset(), test::sphere({0, 0, 0}, 1, 3));
    asset.exact_map = "bytes that other programs do not read";
    write(asset);
  }
  void write(const Asset& asset) {
    if (GetParam() == TrailerForm::block_hashes)
      test::write_with_block_hashes(path_, asset);
    else
      write_asset(path_, asset);
  }
  // Where the project is checked these programs are part of the set-up; elsewhere they may be missing.
  static bool is_missing(const std::string& probe) {
    return run(probe).status != 0 && std::getenv("CI") == nullptr;
  }
  test::ScratchDirectory directory_;
  std::filesystem::path path_ = directory_ / "map.vdb";
};

INSTANTIATE_TEST_SUITE_P(BothTrailers, AssetClients,
                         testing::Values(TrailerForm::one_hash, TrailerForm::block_hashes));

TEST_P(AssetClients, VdbPrintShowsAllGridsAndMetadata) {
  if (is_missing("which vdb_print")) GTEST_SKIP() << "vdb_print is not installed";
  const ProgramRun print = run("vdb_print -l -m " + path_.string());
  EXPECT_EQ(print.status, 0) << print.output;
  for (const char* text : {"displacement", "source_distance", "jacobian", "u_0", "u_1",
                           "contravariant relative", "level set", "bespoke:direction", "maps points a to b",
                           "bespoke:rotation_row_2", "bespoke:record", "bespoke:is_bijection"})
    EXPECT_THAT(print.output, HasSubstr(text));
}

TEST_P(AssetClients, PyopenvdbReadsAllGridsAndMetadata) {
  const std::string python = "/usr/bin/python3";
  if (is_missing(python + " -c 'import pyopenvdb'")) GTEST_SKIP() << "pyopenvdb is not installed";
  test::write_text(directory_ / "read.py", R"(
import json, sys
import pyopenvdb as vdb
grids, metadata = vdb.readAll(sys.argv[1])
record = json.loads(metadata['bespoke:record'])
assert metadata['bespoke:format_version'] == 1
assert metadata['bespoke:direction'] == 'maps points a to b'
assert list(metadata['bespoke:translation']) == record['rigid']['translation']
for key in metadata: metadata[key]
by_name = {grid.name: grid for grid in grids}
assert sorted(by_name) == ['displacement', 'jacobian', 'source_distance', 'u_0', 'u_1'], by_name
for grid in grids:
    for key in grid.metadata: grid.metadata[key]
    assert grid.activeVoxelCount() > 0
u = by_name['u_0']
assert u.activeVoxelCount() == 512 * record['pyramid']['levels'][0]['leaves']
assert u.transform.voxelSize()[0] == record['pyramid']['levels'][0]['voxel_size']
assert list(u.transform.indexToWorld((0, 0, 0))) == record['pyramid']['origin']
assert u.background == (0, 0, 0)
print('value', repr(u.getConstAccessor().getValue((3, 4, 2))))
)");
  const ProgramRun read = run(python + " " + (directory_ / "read.py").string() + " " + path_.string());
  EXPECT_EQ(read.status, 0) << read.output;
  EXPECT_THAT(read.output, HasSubstr("value ("));
}

TEST_P(AssetClients, PyopenvdbReadsHalfPrecision) {
  const std::string python = "/usr/bin/python3";
  if (is_missing(python + " -c 'import pyopenvdb'")) GTEST_SKIP() << "pyopenvdb is not installed";
  Asset asset = test::small_asset();
  asset.steps.front().pyramid.precision = ValuePrecision::half;
  for (PyramidLevel& level : asset.steps.front().pyramid.levels)
    for (float& value : level.values) value = rounded_to_half(value);
  write(with_preview(asset, test::sphere({0, 0, 0}, 1, 3)));
  test::write_text(directory_ / "read.py", R"(
import sys
import pyopenvdb as vdb
grids, metadata = vdb.readAll(sys.argv[1])
assert metadata['bespoke:precision'] == 'half'
by_name = {grid.name: grid for grid in grids}
assert by_name['u_0'].saveFloatAsHalf and not by_name['displacement'].saveFloatAsHalf
print('%.9g' % by_name['u_0'].getConstAccessor().getValue((3, 4, 2))[0])
)");
  const ProgramRun read = run(python + " " + (directory_ / "read.py").string() + " " + path_.string());
  ASSERT_EQ(read.status, 0) << read.output;
  EXPECT_EQ(std::stof(read.output), asset.steps.front().pyramid.levels[0].values[3 * ((3 * 8 + 4) * 8 + 2)]);
}

TEST_P(AssetClients, NanovdbConvertsIt) {
  // Not required even where the project is checked: Ubuntu 22.04 has no package of it.
  if (run("which nanovdb_convert").status != 0) GTEST_SKIP() << "nanovdb_convert is not installed";
  const ProgramRun convert =
      run("nanovdb_convert -f " + path_.string() + " " + (directory_ / "map.nvdb").string());
  EXPECT_EQ(convert.status, 0) << convert.output;
  const ProgramRun print = run("nanovdb_print " + (directory_ / "map.nvdb").string());
  for (const char* name : {"displacement", "source_distance", "jacobian", "u_0", "u_1"})
    EXPECT_THAT(print.output, HasSubstr(name));
}

}  // namespace
}  // namespace bespoke

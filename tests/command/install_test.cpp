#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

TEST(InstalledPackage, BuildsAConsumer) {
  const ExamplePair pair;
  const std::string prefix = pair.file("prefix");
  const ProgramResult install =
      run_program({BESPOKE_CMAKE, "--install", BESPOKE_BINARY_DIR, "--prefix", prefix});
  ASSERT_EQ(install.exit_code, 0) << install.err;
  // One source that includes every installed header: none may include one that is not.
  std::string all_headers;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(prefix + "/include"))
    if (entry.path().extension() == ".h") all_headers += "#include \"" + entry.path().string() + "\"\n";
  write_text(pair.file("all_headers.cpp"), all_headers);
  EXPECT_THAT(all_headers, HasSubstr("bespoke/pipeline/make_map.h"));
  const ProgramResult configure = run_program(
      {BESPOKE_CMAKE, "-G", BESPOKE_GENERATOR, "-S", BESPOKE_SOURCE_DIR "/tests/consumer", "-B",
       pair.file("build"), "-DCMAKE_PREFIX_PATH=" + prefix, "-DCMAKE_BUILD_TYPE=Release",
       "-DALL_HEADERS=" + pair.file("all_headers.cpp"), "-DCMAKE_CXX_FLAGS=" BESPOKE_SANITIZE_FLAGS});
  ASSERT_EQ(configure.exit_code, 0) << configure.err;
  const ProgramResult build = run_program({BESPOKE_CMAKE, "--build", pair.file("build")});
  ASSERT_EQ(build.exit_code, 0) << build.out << build.err;

  // The installed command makes an asset, the consumer reads it.
  const ProgramResult fit = run_program({prefix + "/bin/bespoke", "fit", pair.file("source.obj"),
                                         pair.file("target.obj"), "--anchors", pair.file("anchors.json"),
                                         "-o", pair.file("map.vdb"), "--tolerance", "0.5%"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const ProgramResult consumer = run_program({pair.file("build/consumer"), pair.file("map.vdb")});
  EXPECT_EQ(consumer.exit_code, 0) << consumer.err;
  EXPECT_THAT(consumer.out, HasSubstr("anchors      14"));
}

}  // namespace
}  // namespace bespoke::test

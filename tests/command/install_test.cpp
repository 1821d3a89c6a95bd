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
  // One source for each installed header: none may need one that is not installed, or that comes before it.
  std::string sources;
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(prefix + "/include")) {
    if (entry.path().extension() != ".h") continue;
    const std::string source = pair.file("header_" + std::to_string(count++) + ".cpp");
    write_text(source, "#include \"" + entry.path().string() + "\"\n");
    sources += (sources.empty() ? "" : ";") + source;
  }
  EXPECT_GT(count, 40u);
  EXPECT_LE(count, 50u) << "what other modules need but users do not is not installed";
  const ProgramResult configure =
      run_program({BESPOKE_CMAKE, "-G", BESPOKE_GENERATOR, "-S", BESPOKE_SOURCE_DIR "/tests/consumer", "-B",
                   pair.file("build"), "-DCMAKE_PREFIX_PATH=" + prefix, "-DCMAKE_BUILD_TYPE=Release",
                   "-DALL_HEADERS=" + sources, "-DCMAKE_CXX_FLAGS=" BESPOKE_SANITIZE_FLAGS});
  ASSERT_EQ(configure.exit_code, 0) << configure.err;
  const ProgramResult build = run_program({BESPOKE_CMAKE, "--build", pair.file("build"), "--parallel", "2"});
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

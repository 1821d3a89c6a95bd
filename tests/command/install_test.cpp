#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::ContainsRegex;
using testing::Each;
using testing::HasSubstr;
using testing::IsSupersetOf;

std::string install(const ExamplePair& pair) {
  std::string prefix = pair.file("prefix");
  const ProgramResult installed =
      run_program({BESPOKE_CMAKE, "--install", BESPOKE_BINARY_DIR, "--prefix", prefix});
  EXPECT_EQ(installed.exit_code, 0) << installed.err;
  return prefix;
}

/// Configures and builds a project of tests/consumer against what is installed.
void build_consumer(const std::string& project, const std::string& prefix, const std::string& folder,
                    const std::vector<std::string>& definitions = {}) {
  std::vector<std::string> arguments{BESPOKE_CMAKE,
                                     "-G",
                                     BESPOKE_GENERATOR,
                                     "-S",
                                     BESPOKE_SOURCE_DIR "/tests/" + project,
                                     "-B",
                                     folder,
                                     "-DCMAKE_PREFIX_PATH=" + prefix,
                                     "-DCMAKE_BUILD_TYPE=Release",
                                     "-DCMAKE_CXX_FLAGS=" BESPOKE_SANITIZE_FLAGS};
  arguments.insert(arguments.end(), definitions.begin(), definitions.end());
  const ProgramResult configure = run_program(arguments);
  ASSERT_EQ(configure.exit_code, 0) << configure.err;
  const ProgramResult build = run_program({BESPOKE_CMAKE, "--build", folder, "--parallel", "2"});
  ASSERT_EQ(build.exit_code, 0) << build.out << build.err;
}

/// Names, without versions, of the shared libraries that a program itself asks for.
std::vector<std::string> linked_libraries(const std::string& program) {
  const ProgramResult found = run_program({"/usr/bin/env", "readelf", "-d", program});
  EXPECT_EQ(found.exit_code, 0) << found.err;
  std::vector<std::string> names;
  const std::regex needed(R"(NEEDED.*\[([A-Za-z0-9_+]+))");
  for (std::sregex_iterator it(found.out.begin(), found.out.end(), needed), end; it != end; ++it)
    names.push_back((*it)[1]);
  return names;
}

TEST(InstalledPackage, BuildsAConsumer) {
  const ExamplePair pair;
  const std::string prefix = install(pair);
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
  ASSERT_NO_FATAL_FAILURE(
      build_consumer("consumer", prefix, pair.file("build"), {"-DALL_HEADERS=" + sources}));

  // The installed command makes an asset, the consumer reads it.
  const ProgramResult fit = run_program({prefix + "/bin/bespoke", "fit", pair.file("source.obj"),
                                         pair.file("target.obj"), "--anchors", pair.file("anchors.json"),
                                         "-o", pair.file("map.vdb"), "--tolerance", "0.5%"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const ProgramResult consumer = run_program({pair.file("build/consumer"), pair.file("map.vdb")});
  EXPECT_EQ(consumer.exit_code, 0) << consumer.err;
  EXPECT_THAT(consumer.out, HasSubstr("anchors      14"));
}

// What carries points needs OpenVDB with its own headers' libraries, TBB and a hash; Eigen and JSON are
// headers.
TEST(InstalledPackage, LinksTheCoreAlone) {
  const ExamplePair pair;
  const std::string prefix = install(pair);
  ASSERT_NO_FATAL_FAILURE(build_consumer("consumer/core", prefix, pair.file("core")));
  const std::vector<std::string> libraries = linked_libraries(pair.file("core/core_consumer"));
  EXPECT_THAT(libraries, IsSupersetOf({"libopenvdb", "libtbb", "libcrypto"}));
  EXPECT_THAT(libraries,
              Each(ContainsRegex("^(libopenvdb|libImath|libboost_iostreams|libtbb|libcrypto|libstdc[+]+|libm|"
                                 "libgcc_s|libc|ld|lib[a-z]*san)$")));

  const ProgramResult fit = run_program({prefix + "/bin/bespoke", "fit", pair.file("source.obj"),
                                         pair.file("target.obj"), "--anchors", pair.file("anchors.json"),
                                         "-o", pair.file("map.vdb"), "--tolerance", "0.5%"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const ProgramResult applied = run_program({pair.file("core/core_consumer"), pair.file("map.vdb")});
  EXPECT_EQ(applied.exit_code, 0) << applied.err;
  EXPECT_THAT(applied.out, HasSubstr(" -> "));
}

}  // namespace
}  // namespace bespoke::test

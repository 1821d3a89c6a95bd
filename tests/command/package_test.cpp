#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class DebianPackage : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_installed("dpkg-shlibdeps") || !is_installed("help2man"))
      GTEST_SKIP() << "dpkg-dev and help2man are not installed: tools/setup --package";
  }

  /// Where the new package lies.
  static std::string packed(const std::string& directory) {
    const ProgramResult pack =
        run_program({BESPOKE_CPACK, "--config", BESPOKE_BINARY_DIR "/CPackConfig.cmake", "-B", directory});
    EXPECT_EQ(pack.exit_code, 0) << pack.out << pack.err;
    std::string package;
    for (const auto& entry : std::filesystem::directory_iterator(directory))
      if (entry.path().extension() == ".deb") package = entry.path().string();
    EXPECT_THAT(package, HasSubstr("/bespoke_"));
    return package;
  }
};

// The tags that stay stand in cmake/debian/lintian_overrides, each with its reason.
TEST_F(DebianPackage, LintianHasNoErrorsOrWarnings) {
  if (!is_installed("lintian")) GTEST_SKIP() << "lintian is not installed: tools/setup --package";
  const ScratchDirectory directory;
  const ProgramResult check =
      run_program({"lintian", "--no-cfg", "--fail-on", "error,warning", packed(directory.path())});
  EXPECT_EQ(check.exit_code, 0) << check.err;
  EXPECT_THAT(check.out, IsEmpty());
}

// The package is unpacked, not installed, so that the test needs no rights and shows that it may lie
// anywhere.
TEST_F(DebianPackage, HoldsACommandThatWorksWhereverItLies) {
  const ExamplePair pair;
  const std::string package = packed(pair.file("packages"));
  EXPECT_THAT(run_program({"dpkg-deb", "--field", package, "Depends"}).out, HasSubstr("libopenvdb"));

  const std::string root = pair.file("root");
  ASSERT_EQ(run_program({"dpkg-deb", "--extract", package, root}).exit_code, 0);
  const std::string command = root + "/usr/bin/bespoke";
  const ProgramResult fit =
      run_program({command, "fit", pair.file("source.obj"), pair.file("target.obj"), "--anchors",
                   pair.file("anchors.json"), "-o", pair.file("map.vdb"), "--tolerance", "0.5%"});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  const ProgramResult manual =
      run_program({"/bin/sh", "-c", "zcat " + root + "/usr/share/man/man1/bespoke.1.gz"});
  EXPECT_THAT(manual.out, HasSubstr("suggest"));
  for (const char* file : {"/usr/share/fish/vendor_completions.d/bespoke.fish",
                           "/usr/share/zsh/vendor-completions/_bespoke", "/usr/share/doc/bespoke/copyright"})
    EXPECT_TRUE(std::filesystem::exists(root + file)) << file;

  const std::string completion = root + "/usr/share/bash-completion/completions/bespoke";
  const auto completed = [&](const std::string& words, int last) {
    return run_program({"/bin/bash", "-c",
                        "source " + completion + "; COMP_WORDS=(" + command + " " + words +
                            "); COMP_CWORD=" + std::to_string(last) + "; _bespoke; echo \"${COMPREPLY[*]}\""})
        .out;
  };
  EXPECT_EQ(completed("anch", 1), "anchors\n");
  EXPECT_EQ(completed("anchors su", 2), "suggest\n");
  EXPECT_EQ(completed("fit --anchor", 2), "--anchors --anchor-sigma\n");
}

}  // namespace
}  // namespace bespoke::test

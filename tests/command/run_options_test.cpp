#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <tuple>

#include "command/example_pair.h"

// What holds for every subcommand: --quiet, --threads, Ctrl-C, a full disk, too little memory, a terminal.
namespace bespoke::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Arguments = std::vector<std::string>;

/// map.vdb leads from the pair's source to its target, back.vdb the other way.
class EverySubcommand : public testing::Test {
 protected:
  EverySubcommand() {
    EXPECT_EQ(pair_.fit("map.vdb").exit_code, 0);
    EXPECT_EQ(bespoke({"invert", file("map.vdb"), "-o", file("back.vdb")}).exit_code, 0);
  }

  std::string file(const std::string& name) const { return pair_.file(name); }
  Arguments fit(const std::string& out, const Arguments& extra = {}) const {
    Arguments all{"fit", file("source.obj"), file("target.obj"), "--anchors", file("anchors.json"),
                  "-o",  file(out),          "--tolerance",      "0.5%"};
    all.insert(all.end(), extra.begin(), extra.end());
    return all;
  }
  Arguments apply(const std::string& out) const {
    return {"apply", file("map.vdb"), file("product.obj"), "-o", file(out)};
  }
  Arguments invert(const std::string& out) const { return {"invert", file("map.vdb"), "-o", file(out)}; }
  Arguments compose(const std::string& out) const {
    return {"compose", file("map.vdb"), file("back.vdb"), "-o", file(out)};
  }
  Arguments check() const { return {"check", file("map.vdb"), "--json"}; }
  Arguments measure() const {
    return {"measure", file("map.vdb"), "--source", file("source.obj"), "--target", file("target.obj")};
  }
  Arguments samples(const std::string& out) const { return {"samples", file(out), "shoe"}; }

  ExamplePair pair_;
};

ProgramResult run(Arguments arguments, const Arguments& extra) {
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  return bespoke(arguments);
}

TEST_F(EverySubcommand, IsSilentWhenQuiet) {
  for (const Arguments& arguments :
       {fit("q.vdb"), apply("q.obj"), invert("i.vdb"), compose("c.vdb"), samples("q")}) {
    const ProgramResult result = run(arguments, {"--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, IsEmpty()) << arguments[0];
    EXPECT_THAT(result.err, IsEmpty()) << arguments[0];
  }
  for (const Arguments& arguments : {check(), measure()}) {
    const ProgramResult result = run(arguments, {"-q"});
    EXPECT_THAT(result.out, Not(IsEmpty())) << arguments[0];  // what it is requested
    EXPECT_THAT(result.err, IsEmpty()) << arguments[0];
  }
}

TEST_F(EverySubcommand, GivesTheSameBytesOnAnyNumberOfThreads) {
  struct Job {
    Arguments arguments;
    std::string output;  // empty: what it prints
  };
  for (const Job& job :
       {Job{fit("p.vdb", {"--paper", "--keep-exact"}), "p.vdb"},
        Job{fit("f.vdb", {"--elastic", "pffd-smooth", "--keep-exact"}), "f.vdb"},
        Job{fit("m.vdb", {"--elastic", "multiscale", "--fitted-out", file("m.ply")}), "m.ply"},
        Job{apply("a.obj"), "a.obj"}, Job{invert("i.vdb"), "i.vdb"}, Job{compose("c.vdb"), "c.vdb"},
        Job{check(), ""}, Job{measure(), ""}, Job{samples("s"), "s/shoe/source.obj"}}) {
    std::string first;
    for (const std::string threads : {"1", "2", "8"}) {
      const ProgramResult result = run(job.arguments, {"--threads", threads});
      ASSERT_EQ(result.exit_code, 0) << result.err;
      const std::string bytes = job.output.empty() ? result.out : read_text(file(job.output));
      ASSERT_THAT(bytes, Not(IsEmpty()));
      if (first.empty()) first = bytes;
      EXPECT_TRUE(bytes == first) << job.arguments[0] << " on " << threads << " threads";
    }
  }
}

TEST_F(EverySubcommand, RefusesNumbersOfThreadsThatAreNone) {
  for (const Arguments& arguments :
       {fit("x.vdb"), apply("x.obj"), invert("x.vdb"), compose("x.vdb"), check(), measure(), samples("x")})
    for (const std::string threads : {"0", "-1", "1025", "many"}) {
      const ProgramResult result = run(arguments, {"--threads=" + threads});
      EXPECT_EQ(result.exit_code, 1) << arguments[0];
      EXPECT_THAT(result.err, AllOf(HasSubstr("--threads"), HasSubstr(threads)));
    }
}

// The size of a file is limited as a full disk limits it.
TEST_F(EverySubcommand, LeavesNothingOnAFullDisk) {
  const Arguments before = pair_.files();
  const std::string shell = R"(trap "" XFSZ; ulimit -f 4; exec "$0" "$@")";
  for (const Arguments& arguments :
       {fit("x.vdb"), fit("x.vdb", {"--fitted-out", file("x.ply")}), apply("x.obj"), apply("x.ply"),
        apply("x.off"), apply("x.stl"), invert("x.vdb"), compose("x.vdb")}) {
    Arguments all{"sh", "-c", shell, BESPOKE_COMMAND};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.push_back("-q");
    const ProgramResult result = run_program(all);
    EXPECT_EQ(result.exit_code, 4) << arguments[0] << result.err;
    EXPECT_THAT(result.err, HasSubstr("x."));
    EXPECT_EQ(pair_.files(), before) << arguments[0];
  }
}

TEST_F(EverySubcommand, LeavesNothingWhenMemoryRunsOut) {
  if (std::string(BESPOKE_SANITIZE_FLAGS) != "") GTEST_SKIP() << "sanitizers reserve more than the limit";
  const Arguments before = pair_.files();
  // Some 24 million voxels, which --max-memory allows, in 400 MB.
  Arguments all{"sh", "-c", R"(ulimit -v 400000; exec "$0" "$@")", BESPOKE_COMMAND};
  for (const std::string& argument : fit("x.vdb", {"--elastic", "pffd-smooth", "--voxel-size", "0.2%", "-q"}))
    all.push_back(argument);
  const ProgramResult result = run_program(all);
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("out of memory"));
  EXPECT_EQ(pair_.files(), before);
}

TEST_F(EverySubcommand, DrawsABarOnATerminal) {
  // `script` gives the command a terminal for its standard error.
  std::string line = BESPOKE_COMMAND;
  for (const std::string& argument : fit("x.vdb", {"--strict", "--lambda", "20%"}))
    line += " '" + argument + "'";
  const ProgramResult result = run_program({"script", "--quiet", "--return", "--command", line, "/dev/null"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("\rbake"), HasSubstr("###"), HasSubstr(" %, "), HasSubstr(" left")));
}

// ---- signals

struct LongRun {
  const char* name;
  Arguments arguments;  ///< files stand in braces
  const char* stage;    ///< interrupted when it is announced
};

std::ostream& operator<<(std::ostream& stream, const LongRun& run) { return stream << run.name; }

class Interrupted : public EverySubcommand, public testing::WithParamInterface<std::tuple<LongRun, int>> {
 protected:
  Arguments with_files(Arguments arguments) const {
    for (std::string& argument : arguments)
      if (argument.front() == '{') argument = file(argument.substr(1, argument.size() - 2));
    return arguments;
  }
};

TEST_P(Interrupted, LeavesNothing) {
  const auto& [run, signal] = GetParam();
  std::filesystem::create_directory(file("out"));
  const Arguments before = pair_.files();
  Arguments arguments{BESPOKE_COMMAND};
  for (const std::string& argument : with_files(run.arguments)) arguments.push_back(argument);
  RunningProgram program(arguments);
  ASSERT_TRUE(program.wait_for_error_text(run.stage));
  program.send(signal);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
  EXPECT_THAT(result.err, HasSubstr("bespoke: interrupted\n"));
  EXPECT_EQ(pair_.files(), before);
}

// Each would take many seconds; --threads 1 gives the signal time to arrive.
INSTANTIATE_TEST_SUITE_P(
    Runs, Interrupted,
    testing::Combine(
        testing::Values(
            LongRun{"fit_while_fitting",
                    {"fit", "{source.obj}", "{target.obj}", "--anchors", "{anchors.json}", "-o", "{x.vdb}",
                     "--voxel-size", "0.15%", "--fitted-out", "{x.ply}", "--report", "{x.json}"},
                    "surface-fit: "},
            LongRun{"fit_while_baking",
                    {"fit", "{source.obj}", "{target.obj}", "--anchors", "{anchors.json}", "-o", "{x.vdb}",
                     "--elastic", "csrbf", "--voxel-size", "0.15%"},
                    "bake: "},
            LongRun{"apply",
                    {"apply", "{map.vdb}", "{product.obj}", "--out-dir", "{out}", "--frames", "5000"},
                    "apply: "},
            LongRun{"invert", {"invert", "{map.vdb}", "-o", "{x.vdb}", "--tolerance", "0.0005%"}, "bake: "},
            LongRun{"measure",
                    [] {
                      Arguments all{"measure",  "{map.vdb}",    "--source", "{source.obj}",
                                    "--target", "{target.obj}", "--json"};
                      for (int i = 0; i < 50; ++i) all.insert(all.end(), {"--product", "{source.obj}"});
                      return all;
                    }(),
                    "surfaces: "},
            LongRun{"compose",
                    {"compose", "{map.vdb}", "{back.vdb}", "-o", "{x.vdb}", "--tolerance", "0.0005%"},
                    "bake: "}),
        testing::Values(SIGINT, SIGTERM)),
    [](const auto& parameter) {
      return std::get<0>(parameter.param).name +
             std::string(std::get<1>(parameter.param) == SIGINT ? "_int" : "_term");
    });

}  // namespace
}  // namespace bespoke::test

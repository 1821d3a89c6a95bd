#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command/example_pair.h"

// samples/cluster, as it is used: with engines that are there (tools/setup --cluster installs them).
namespace bespoke::test {
namespace {

using nlohmann::json;

const std::string cluster = std::string(BESPOKE_SOURCE_DIR) + "/samples/cluster";

bool has_program(const std::string& name) {
  return run_program({"sh", "-c", "command -v " + name}).exit_code == 0;
}

class ClusterSamples : public testing::Test {
 protected:
  ClusterSamples() {
    EXPECT_EQ(pair_.fit("map.vdb").exit_code, 0);
    std::string manifest;
    for (int i = 0; i < jobs; ++i)
      manifest += json{{"command", "apply"},
                       {"map", pair_.file("map.vdb")},
                       {"product", pair_.file("product.obj")},
                       {"t", 0.1 * i},
                       {"output", pair_.file("out/" + std::to_string(i) + ".obj")}}
                      .dump() +
                  "\n";
    write_text(pair_.file("jobs.jsonl"), manifest);
  }
  /// Runs a script of the shell in the pair's directory.
  ProgramResult shell(const std::string& script) const {
    return run_program(
        {"bash", "-euc", "export BESPOKE=" BESPOKE_COMMAND "; cd " + pair_.file(".") + "; " + script});
  }
  void expect_all_outputs() const {
    for (int i = 0; i < jobs; ++i) EXPECT_TRUE(pair_.has("out/" + std::to_string(i) + ".obj")) << i;
  }

  static constexpr int jobs = 10;
  ExamplePair pair_;
};

TEST_F(ClusterSamples, RunInSnakemake) {
  if (!has_program("snakemake")) GTEST_SKIP() << "there is no snakemake";
  const ProgramResult result =
      shell("HOME=$PWD snakemake -s " + cluster + "/snakemake/Snakefile --profile " + cluster +
            "/snakemake/profiles/local --config manifest=jobs.jsonl shards=3 "
            "bespoke=$BESPOKE 2>&1");
  EXPECT_EQ(result.exit_code, 0) << result.out;
  expect_all_outputs();
}

TEST_F(ClusterSamples, RunInSlurm) {
  for (const char* name : {"slurmctld", "slurmd", "munged", "sbatch"})
    if (!has_program(name)) GTEST_SKIP() << "there is no " << name;
  if (shell("id -u").out != "0\n") GTEST_SKIP() << "slurmd runs as root";
  const ProgramResult result = shell("trap '" + cluster + "/slurm/loopback.sh stop slurm' EXIT; " + cluster +
                                     "/slurm/loopback.sh start slurm 2>&1; export "
                                     "SLURM_CONF=$PWD/slurm/slurm.conf; sbatch --wait --array=1-3 "
                                     "--cpus-per-task=1 " +
                                     cluster + "/slurm/batch.sbatch jobs.jsonl 2>&1");
  EXPECT_EQ(result.exit_code, 0) << result.out;
  expect_all_outputs();
}

}  // namespace
}  // namespace bespoke::test

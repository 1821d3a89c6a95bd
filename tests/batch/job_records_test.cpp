#include "bespoke/batch/job_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "batch/batch_scene.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class JobRecordsTest : public ::testing::Test {
 protected:
  JobRecordsTest() {
    scene_.write("a", "A");
    scene_.write("b", "B");
    carry_out(job());
  }

  BatchJob job() { return scene_.job(1, {"a", "b"}, {"c", "d"}); }

  static void carry_out(const BatchJob& job) {
    JobRecords records;
    const std::vector<RecordedFile> inputs = records.inputs_of(job);
    records.write(job, inputs, job.run({}));
  }

  static std::string reason(const BatchJob& job) { return JobRecords().reason_to_run(job); }

  /// Another time of change, by hours.
  void touch(const std::string& name, int hours) const {
    const fs::path path = scene_.file(name);
    fs::last_write_time(path, fs::last_write_time(path) + std::chrono::hours(hours));
  }

  test::BatchScene scene_;
};

TEST_F(JobRecordsTest, KnowsAFinishedJob) { EXPECT_THAT(reason(job()), IsEmpty()); }

TEST_F(JobRecordsTest, IsNotMovedByATouch) {
  for (const char* name : {"a", "b", "c", "d"}) touch(name, 1);
  EXPECT_THAT(reason(job()), IsEmpty());
}

TEST_F(JobRecordsTest, SeesOtherContentOfTheSameSize) {
  scene_.write("b", "X");
  EXPECT_THAT(reason(job()), HasSubstr("b has changed"));
  scene_.write("b", "B");
  EXPECT_THAT(reason(job()), IsEmpty());
  scene_.write("d", "XY");
  EXPECT_THAT(reason(job()), HasSubstr("d has changed"));
}

TEST_F(JobRecordsTest, SeesContentThatChangedWithinATick) {
  // As long as nothing but the time of change tells, a file that was written just now is read again.
  scene_.write("a", "X");
  carry_out(job());
  const auto time = fs::last_write_time(scene_.file("a"));
  scene_.write("a", "Y");
  fs::last_write_time(scene_.file("a"), time);
  EXPECT_THAT(reason(job()), HasSubstr("a has changed"));
}

TEST_F(JobRecordsTest, SeesAMissingOutput) {
  fs::remove(scene_.file("d"));
  EXPECT_THAT(reason(job()), HasSubstr("d is missing"));
}

TEST_F(JobRecordsTest, SeesOtherOptionsCommandsAndFiles) {
  BatchJob options = job();
  options.options = {{"half", "true"}};
  EXPECT_THAT(reason(options), HasSubstr("options"));
  BatchJob command = job();
  command.command = "part";
  EXPECT_THAT(reason(command), HasSubstr("options"));
  EXPECT_THAT(reason(scene_.job(1, {"b", "a"}, {"c", "d"})), HasSubstr("has changed"));
  EXPECT_THAT(reason(scene_.job(1, {"a"}, {"c", "d"})), HasSubstr("other inputs"));
  EXPECT_THAT(reason(scene_.job(1, {"a", "b"}, {"c", "d", "a"})), HasSubstr("other outputs"));
}

TEST_F(JobRecordsTest, TakesADamagedRecordForNone) {
  const fs::path record = record_path(job());
  const std::string text = test::read_text(record);
  for (const std::size_t size : {std::size_t{0}, text.size() / 2, text.size() - 3}) {
    test::write_text(record, text.substr(0, size));
    EXPECT_THAT(reason(job()), HasSubstr("no record")) << size;
  }
  for (const char* damaged : {"[]", "{\"version\":1}", "{\"inputs\":3,\"outputs\":[],\"options\":{}}"}) {
    test::write_text(record, damaged);
    EXPECT_THAT(reason(job()), HasSubstr("no record")) << damaged;
  }
}

TEST_F(JobRecordsTest, BelievesTheLastOfTwoLines) {
  scene_.write("b", "X");
  carry_out(job());
  EXPECT_THAT(reason(job()), IsEmpty());
  scene_.write("b", "B");
  EXPECT_THAT(reason(job()), HasSubstr("b has changed"));
}

TEST_F(JobRecordsTest, FollowsADirectoryThatMoves) {
  fs::create_directory(scene_.file("moved"));
  for (const std::string name : {".bespoke-jobs.jsonl", "c", "d"})
    fs::rename(scene_.file(name), scene_.file("moved/" + name));
  EXPECT_THAT(reason(scene_.job(1, {"a", "b"}, {"moved/c", "moved/d"})), IsEmpty());
}

TEST_F(JobRecordsTest, AlwaysRunsAJobThatWritesNothing) {
  EXPECT_THAT(reason(scene_.job(1, {"a"}, {})), HasSubstr("writes no file"));
}

}  // namespace
}  // namespace bespoke

#include "bespoke/batch/packed_jobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <sstream>

#include "batch/batch_scene.h"
#include "bespoke/batch/detail/tar_format.h"
#include "bespoke/batch/job_records.h"
#include "bespoke/batch/run_batch.h"
#include "support/run_program.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

using Contents = std::map<std::string, std::string>;  // by name

/// A season in the working directory: a map that jobs read, their products, and jobs on their own.
class PackedJobsTest : public ::testing::Test {
 protected:
  PackedJobsTest() {
    for (const char* name : {"a", "b", "c"}) scene_.write(name, std::string(300, *name));
    fs::current_path(scene_.file(""));
  }
  ~PackedJobsTest() override { fs::current_path(before_); }

  BatchJob job(std::size_t line, const std::vector<std::string>& inputs,
               const std::vector<std::string>& outputs) {
    BatchJob job = scene_.job(line, inputs, outputs);
    // As manifests name them: seen from the working directory.
    for (JobFile& output : job.outputs) output.path = output.path.lexically_relative(scene_.file(""));
    for (JobFile& input : job.inputs) input.path = input.path.lexically_relative(scene_.file(""));
    job.run = scene_.run_of(job);
    return job;
  }

  std::vector<BatchJob> season() {
    std::vector<BatchJob> jobs{job(1, {"a"}, {"out/map"})};
    for (std::size_t line = 2; line < 8; ++line) {
      const std::string name = "out/" + std::to_string(line);
      jobs.push_back(job(line, {"out/map", "b"}, {name + "/product", name + "/report"}));
    }
    jobs.push_back(job(8, {"c"}, {"alone"}));
    jobs.push_back(job(9, {"c"}, {"long/" + std::string(150, 'n') + "/" + std::string(90, 'n')}));
    return jobs;
  }

  std::vector<JobState> run(std::vector<BatchJob> jobs, PackedJobs* pack, int threads = 1) {
    scene_.ran.clear();
    BatchOptions options;
    options.threads = options.jobs = threads;
    options.max_memory = std::size_t{1} << 34;
    options.keep_going = true;
    options.pack = pack;
    const JobGraph graph = make_job_graph(std::move(jobs));
    EXPECT_THAT(graph.faults, IsEmpty());
    results_ = run_batch(graph, forecast_jobs(graph), options);
    std::vector<JobState> states;
    for (const JobResult& result : results_) states.push_back(result.state);
    return states;
  }

  std::vector<JobState> run_packed(std::vector<BatchJob> jobs, int threads = 1) {
    PackedJobs pack("out.tar", PackedJobs::Access::write);
    return run(std::move(jobs), &pack, threads);
  }

  /// All files below a directory but inputs, records and the archive.
  static Contents files_in(const fs::path& directory) {
    Contents contents;
    for (const auto& entry : fs::recursive_directory_iterator(directory)) {
      const std::string name = entry.path().lexically_relative(directory).string();
      const bool is_record = name.find(".bespoke-jobs") != std::string::npos;
      if (entry.is_regular_file() && !is_record && name.size() > 1 && name != "out.tar")
        contents[name] = test::read_text(entry.path());
    }
    return contents;
  }

  static void unpack(const fs::path& directory) {
    fs::create_directories(directory);
    const test::ProgramResult result = test::run_program({"tar", "-xf", "out.tar", "-C", directory});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
  }

  /// What the archive unpacks to.
  static Contents packed() {
    const test::ScratchDirectory directory;
    unpack(directory.path());
    return files_in(directory.path());
  }

  /// Names of products in the archive, as tar lists them, in order.
  static std::vector<std::string> listed() {
    std::istringstream lines(test::run_program({"tar", "-tf", "out.tar"}).out);
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);)
      if (line.find(".bespoke-jobs") == std::string::npos) names.push_back(line);
    return names;
  }

  fs::path before_ = fs::current_path();
  test::BatchScene scene_;
  std::vector<JobResult> results_;
};

TEST_F(PackedJobsTest, HoldsWhatFilesWouldHold) {
  EXPECT_THAT(run(season(), nullptr), Each(JobState::done));
  const Contents wanted = files_in(".");
  for (const int threads : {1, 4}) {
    fs::remove_all("out");
    fs::remove_all("long");
    fs::remove("alone");
    fs::remove("out.tar");
    fs::remove_all(".bespoke-jobs.jsonl");
    fs::remove_all(".bespoke-jobs");
    EXPECT_THAT(run_packed(season(), threads), Each(JobState::done));
    // What other jobs read is a file as ever; of the others there is no trace, not even a directory.
    EXPECT_EQ(files_in("."), (Contents{{"out/map", wanted.at("out/map")}}));
    EXPECT_FALSE(fs::exists("long"));
    Contents in_archive = packed();
    EXPECT_THAT(listed(), SizeIs(in_archive.size()));
    in_archive["out/map"] = wanted.at("out/map");
    EXPECT_EQ(in_archive, wanted);

    EXPECT_THAT(run_packed(season(), threads), Each(JobState::up_to_date));
    unpack(".");
    EXPECT_EQ(files_in("."), wanted);
    EXPECT_THAT(run(season(), nullptr, threads), Each(JobState::up_to_date));
    EXPECT_THAT(scene_.ran, IsEmpty());
  }
}

TEST_F(PackedJobsTest, IsLeftAloneWhereNothingIsToBeDone) {
  run_packed(season());
  const std::string bytes = scene_.read("out.tar");
  const auto time = fs::last_write_time("out.tar");
  EXPECT_THAT(run_packed(season()), Each(JobState::up_to_date));
  EXPECT_TRUE(scene_.read("out.tar") == bytes);
  EXPECT_EQ(fs::last_write_time("out.tar"), time);
  EXPECT_EQ(fs::file_size("out.tar") % 512, 0u);
}

TEST_F(PackedJobsTest, IsCompletedFromEveryTruncation) {
  run_packed(season());
  const Contents wanted = packed();
  const std::string whole = scene_.read("out.tar");
  std::vector<std::uint64_t> ends;  // of jobs: where the next begins, or the files of records
  {
    const RandomAccessFile file("out.tar", RandomAccessFile::Access::read);
    TarReader reader(file);
    while (const auto member = reader.next())
      if (member->kind == TarMember::Kind::comment || member->name.find(".bespoke-jobs") != std::string::npos)
        ends.push_back(member->begin);
  }
  constexpr std::size_t packed_jobs = 8;
  // The mark and the first job begin; the files of records of as many directories end the last.
  ASSERT_EQ(ends.size(), 1 + packed_jobs + 8);
  ends = {ends.begin() + 2, ends.begin() + 2 + packed_jobs};

  std::mt19937 random(7);
  std::vector<std::size_t> sizes{0, 1, 511, 512, 1023, 1024, 1025, whole.size() - 1, whole.size() - 512};
  for (const std::uint64_t end : ends)
    for (const int offset : {-1, 0, 1}) sizes.push_back(end + offset);
  for (int i = 0; i < 100; ++i) sizes.push_back(random() % whole.size());
  for (const std::size_t size : sizes) {
    test::write_text("out.tar", whole.substr(0, size));
    const auto kept = std::count_if(ends.begin(), ends.end(), [&](auto end) { return end <= size; });
    const std::vector<JobState> states = run_packed(season(), size % 2 == 0 ? 1 : 3);
    ASSERT_EQ(std::count(states.begin(), states.end(), JobState::up_to_date), 1 + kept) << size;
    ASSERT_THAT(scene_.ran, SizeIs(packed_jobs - kept)) << size;
    ASSERT_EQ(packed(), wanted) << size;
    ASSERT_THAT(listed(), SizeIs(wanted.size())) << size;
    ASSERT_EQ(scene_.read("out.tar").size(), whole.size()) << size;
  }
}

TEST_F(PackedJobsTest, DoesNotBelieveDamagedContentThatWasNotFinished) {
  run_packed(season());
  const Contents wanted = packed();
  const std::string whole = scene_.read("out.tar");
  std::string damaged = whole.substr(0, whole.size() - 1024);
  damaged[damaged.find(std::string(300, 'c')) + 7] = '\0';
  test::write_text("out.tar", damaged);
  run_packed(season());
  EXPECT_THAT(scene_.ran, SizeIs(1));
  EXPECT_EQ(packed(), wanted);
  EXPECT_THAT(listed(), SizeIs(wanted.size()));
  // A hole at a header ends what can be read.
  test::write_text("out.tar", whole.substr(0, 1024) + std::string(2048, '\0') + whole.substr(3072));
  run_packed(season());
  EXPECT_THAT(scene_.ran, SizeIs(8));
  EXPECT_EQ(packed(), wanted);
}

TEST_F(PackedJobsTest, HoldsEachOutputOnceThoughItsInputsChanged) {
  run_packed(season());
  const std::size_t members = listed().size();
  for (const char* text : {"other", "longer than before"}) {
    scene_.write("c", text);
    {
      PackedJobs pack("out.tar", PackedJobs::Access::read);
      EXPECT_THAT(pack.reason_to_run(job(8, {"c"}, {"alone"})), HasSubstr("c has changed"));
    }
    run_packed(season());
    EXPECT_THAT(scene_.ran, UnorderedElementsAre(8, 9));
    EXPECT_EQ(packed().at("alone"), text);
    EXPECT_THAT(listed(), SizeIs(members));
    EXPECT_THAT(run_packed(season()), Each(JobState::up_to_date));
  }
}

TEST_F(PackedJobsTest, ForgetsAJobWhoseOutputAnotherHasWritten) {
  run_packed({job(1, {"a"}, {"one", "two"})});
  run_packed({job(1, {"b"}, {"two"})});
  EXPECT_THAT(listed(), ElementsAre("one", "two"));
  EXPECT_EQ(packed(), (Contents{{"one", scene_.read("a")}, {"two", scene_.read("b")}}));
  const auto reason = [&](const BatchJob& job) {
    return PackedJobs("out.tar", PackedJobs::Access::read).reason_to_run(job);
  };
  EXPECT_THAT(reason(job(1, {"b"}, {"two"})), IsEmpty());
  EXPECT_THAT(reason(job(1, {"a"}, {"one", "two"})), HasSubstr("no record"));
  EXPECT_THAT(reason(job(1, {"a"}, {"three"})), HasSubstr("not in the archive"));
  EXPECT_THAT(reason(job(1, {"b"}, {"two", "one"})), HasSubstr("other outputs"));
  BatchJob other = job(1, {"b"}, {"two"});
  other.options = {{"half", "true"}};
  EXPECT_THAT(reason(other), HasSubstr("options"));
}

TEST_F(PackedJobsTest, HoldsNothingOfAJobThatFails) {
  scene_.write("bad", "bad");
  run_packed({job(1, {"bad"}, {"one"}), job(2, {"a"}, {"two"})});
  EXPECT_EQ(results_[0].state, JobState::failed);
  EXPECT_THAT(listed(), ElementsAre("two"));
  BatchJob silent = job(3, {"a"}, {"three"});
  silent.run = [](const Progress&) { return JobFindings{}; };
  run_packed({silent});
  EXPECT_THAT(results_[0].error, HasSubstr("output three was not written"));
  EXPECT_THAT(listed(), ElementsAre("two"));
}

TEST_F(PackedJobsTest, TakesFurtherOutputsAlong) {
  const auto with_companion = [&] {
    BatchJob whole = job(1, {"a"}, {"out/mesh"});
    whole.run = [run = whole.run](const Progress& progress) {
      JobFindings findings = run(progress);
      const fs::path companion = "out/mesh.bin";
      write_atomically(companion, [](const fs::path& temporary) { test::write_text(temporary, "bin"); });
      findings.further_outputs = {companion};
      return findings;
    };
    return whole;
  };
  run_packed({with_companion()});
  EXPECT_THAT(listed(), ElementsAre("out/mesh", "out/mesh.bin"));
  unpack(".");
  EXPECT_THAT(run({with_companion()}, nullptr), ElementsAre(JobState::up_to_date));
  fs::remove("out/mesh.bin");
  EXPECT_THAT(run({with_companion()}, nullptr), ElementsAre(JobState::done));
}

TEST_F(PackedJobsTest, UnpacksBesideOthersOfTheSameDirectories) {
  run_packed({job(1, {"a"}, {"out/one"})});
  unpack(".");
  fs::remove("out.tar");
  run_packed({job(2, {"b"}, {"out/two"})});
  unpack(".");
  run({job(3, {"c"}, {"out/three"})}, nullptr);
  EXPECT_THAT(
      run({job(1, {"a"}, {"out/one"}), job(2, {"b"}, {"out/two"}), job(3, {"c"}, {"out/three"})}, nullptr),
      Each(JobState::up_to_date));
}

TEST_F(PackedJobsTest, IsWrittenByOneAtATime) {
  PackedJobs first("out.tar", PackedJobs::Access::write);
  try {
    PackedJobs("out.tar", PackedJobs::Access::write);
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("out.tar"), HasSubstr("another process is writing it")));
  }
  EXPECT_EQ(run(season(), &first), std::vector<JobState>(9, JobState::done));
}

TEST_F(PackedJobsTest, TouchesNothingThatItDidNotMake) {
  test::write_text("note", "not an archive");
  test::run_program({"tar", "-cf", "other.tar", "note"});
  for (const std::string& text :
       {scene_.read("note"), scene_.read("other.tar"), std::string(4096, '\0'), std::string("\x1f\x8b", 2)}) {
    test::write_text("out.tar", text);
    for (const auto access : {PackedJobs::Access::read, PackedJobs::Access::write})
      EXPECT_THROW(PackedJobs("out.tar", access), FormatError);
    EXPECT_TRUE(scene_.read("out.tar") == text);
  }
  fs::remove("out.tar");
  fs::create_directory("out.tar");
  EXPECT_THROW(PackedJobs("out.tar", PackedJobs::Access::write), FileError);
  EXPECT_THROW(PackedJobs("/dev/full", PackedJobs::Access::write), FileError);
  EXPECT_FALSE(fs::exists("absent.tar"));
  EXPECT_THAT(PackedJobs("absent.tar", PackedJobs::Access::read).reason_to_run(job(8, {"c"}, {"alone"})),
              HasSubstr("not in the archive"));
  EXPECT_FALSE(fs::exists("absent.tar"));
}

TEST_F(PackedJobsTest, NamesWhatCannotBePacked) {
  fs::create_directories("below");
  fs::current_path("below");
  BatchJob outside = scene_.job(3, {"a"}, {"outside"});
  BatchJob inside = scene_.job(4, {"a"}, {"below/inside"});  // though its path is absolute
  BatchJob itself = job(5, {"a"}, {"p"});
  itself.outputs = {{"output", "../below/out.tar"}};
  BatchJob read = job(6, {"a"}, {"map"});
  read.outputs.front().path = scene_.file("read");  // outside, but no product
  BatchJob reader = scene_.job(7, {"read"}, {"below/product"});
  const JobGraph graph = make_job_graph({outside, inside, itself, read, reader});
  std::vector<std::string> faults;
  for (const ManifestFault& fault : packing_faults(graph, "out.tar"))
    faults.push_back(std::to_string(fault.line) + " " + fault.what);
  EXPECT_THAT(faults, ElementsAre(AllOf(HasSubstr("3 output "), HasSubstr("outside the working directory")),
                                  AllOf(HasSubstr("5 output "), HasSubstr("is the archive itself"))));
}

}  // namespace
}  // namespace bespoke

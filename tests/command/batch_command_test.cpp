#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::EndsWith;
using testing::Field;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class BatchCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return pair_.file(name); }
  std::string read(const std::string& name) const { return read_text(file(name)); }

  json fit(const std::string& output) const {
    return {{"command", "fit"},
            {"source", file("source.obj")},
            {"target", file("target.obj")},
            {"anchors", file("anchors.json")},
            {"tolerance", "0.5%"},
            {"output", file(output)}};
  }
  json apply(const std::string& map, const std::string& output) const {
    return {
        {"command", "apply"}, {"map", file(map)}, {"product", file("product.obj")}, {"output", file(output)}};
  }
  /// The manifest of the jobs, a line each.
  std::string manifest(const std::vector<json>& jobs) const {
    std::string text;
    for (const json& job : jobs) text += job.dump() + "\n";
    write_text(file("jobs.jsonl"), text);
    return file("jobs.jsonl");
  }
  ProgramResult batch(const std::vector<json>& jobs, const std::vector<std::string>& extra = {}) const {
    std::vector<std::string> arguments{"batch", manifest(jobs)};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }
  /// The only page of a map in a directory.
  std::string page_name(const std::string& directory) const {
    std::string name;
    for (const fs::directory_entry& entry : fs::directory_iterator(file(directory)))
      if (entry.path().extension() == ".html" && entry.path().filename() != "index.html")
        name = directory + "/" + entry.path().filename().string();
    return name;
  }
  std::vector<json> log(const std::string& name) const {
    std::vector<json> records;
    std::istringstream lines(read(name));
    for (std::string line; std::getline(lines, line);) records.push_back(json::parse(line));
    return records;
  }

  ExamplePair pair_;
};

TEST_F(BatchCommand, WritesTheBitsOfTheSingleCommands) {
  json inverse = apply("map.vdb", "back.ply");
  inverse["inverse"] = true;
  inverse["product"] = file("target.obj");
  json frames = apply("map.vdb", "frame.obj");
  frames["frames"] = 3;
  const ProgramResult result = batch(
      {apply("map.vdb", "out.obj"),
       frames,
       inverse,
       {{"command", "invert"}, {"map", file("map.vdb")}, {"output", file("inverse.vdb")}},
       {{"command", "compose"},
        {"ab", file("map.vdb")},
        {"bc", file("inverse.vdb")},
        {"output", file("there.vdb")}},
       {{"command", "check"}, {"map", file("there.vdb")}, {"json", true}, {"output", file("check.json")}},
       {{"command", "diff"}, {"a", file("map.vdb")}, {"b", file("map.vdb")}, {"output", file("diff.txt")}},
       {{"command", "export"}, {"map", file("map.vdb")}, {"grid", "5%"}, {"output", file("map.vti")}},
       {{"command", "measure"},
        {"map", file("map.vdb")},
        {"source", file("source.obj")},
        {"target", file("target.obj")},
        {"product", {file("product.obj"), file("source.obj")}},
        {"output", file("measure.txt")}},
       fit("map.vdb")},
      {"--log", file("log.jsonl")});
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const auto expect_same = [&](const std::vector<std::string>& arguments, const std::string& output,
                               const std::string& batched) {
    const ProgramResult single = bespoke(arguments);
    ASSERT_EQ(single.exit_code, 0) << single.err;
    const std::string bytes = output.empty() ? single.out : read(output);
    EXPECT_FALSE(bytes.empty());
    EXPECT_TRUE(bytes == read(batched)) << batched;
  };
  ASSERT_EQ(pair_.fit("single.vdb").exit_code, 0);
  EXPECT_TRUE(read("single.vdb") == read("map.vdb"));
  expect_same({"apply", file("map.vdb"), file("product.obj"), "-o", file("s.obj")}, "s.obj", "out.obj");
  expect_same({"apply", file("map.vdb"), file("product.obj"), "-o", file("f.obj"), "--frames", "3"},
              "f_002.obj", "frame_002.obj");
  expect_same({"apply", file("map.vdb"), file("target.obj"), "-o", file("s.ply"), "--inverse"}, "s.ply",
              "back.ply");
  expect_same({"invert", file("map.vdb"), "-o", file("i.vdb")}, "i.vdb", "inverse.vdb");
  expect_same({"compose", file("map.vdb"), file("i.vdb"), "-o", file("c.vdb")}, "c.vdb", "there.vdb");
  expect_same({"check", file("c.vdb"), "--json", "-q"}, "", "check.json");
  expect_same({"diff", file("map.vdb"), file("map.vdb"), "-q"}, "", "diff.txt");
  expect_same({"export", file("map.vdb"), "--grid", "5%", "-o", file("e.vti"), "-q"}, "e.vti", "map.vti");
  expect_same({"measure", file("map.vdb"), "--source", file("source.obj"), "--target", file("target.obj"),
               "--product", file("product.obj"), "--product", file("source.obj"), "-q"},
              "", "measure.txt");

  const std::vector<json> records = log("log.jsonl");
  ASSERT_EQ(records.size(), 10u);
  for (const json& record : records) {
    EXPECT_EQ(record["state"], "done");
    EXPECT_GT(record["seconds"], 0);
    EXPECT_GT(record["memory"], 1000000);
  }
  EXPECT_EQ(records[0]["line"], 10);  // all others need it
  EXPECT_EQ(records[0]["figures"]["bijection"], true);
}

TEST_F(BatchCommand, ShowsProductsOnPagesAsItsJobsCarryThem) {
  json clear = apply("map.vdb", "clear.obj");
  clear["clearance"] = "1%";
  const std::vector<json> jobs{fit("map.vdb"), apply("map.vdb", "out.obj"), clear};
  const ProgramResult result = batch(jobs, {"--html", file("pages")});
  if (result.exit_code == 4) GTEST_SKIP() << result.err;  // built without pages
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(read("pages/index.html"), HasSubstr("<h1>2 results</h1>"));
  // One as it is carried, one moved outwards by 1 %.
  std::set<std::string> pages, pictures;
  for (const fs::directory_entry& entry : fs::directory_iterator(file("pages"))) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".png") pictures.insert(read("pages/" + name));
    if (entry.path().extension() == ".html" && name != "index.html") pages.insert(read("pages/" + name));
  }
  EXPECT_EQ(pages.size(), 2u);
  EXPECT_EQ(pictures.size(), 2u);
}

TEST_F(BatchCommand, ShowsWhatItFitsOnPages) {
  json back = apply("map.vdb", "back.obj");
  back["inverse"] = true;
  back["product"] = file("target.obj");  // nothing that the source wears
  const std::vector<json> jobs{fit("map.vdb"), apply("map.vdb", "out.obj"), back};
  const ProgramResult first = batch(jobs, {"--html", file("pages")});
  if (first.exit_code == 4) GTEST_SKIP() << first.err;  // built without pages
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::string index = read("pages/index.html");
  EXPECT_THAT(index,
              AllOf(HasSubstr("<h1>1 result</h1>"), HasSubstr(">product.obj<"), HasSubstr("../map.vdb")));
  EXPECT_THAT(batch(jobs, {"--html", file("pages")}).err, HasSubstr("5 up to date"));
  // The page tells what makes it alone, not which batch did.
  const std::string name = page_name("pages"), page = read(name);
  fs::remove_all(file("pages"));
  ASSERT_EQ(batch(jobs, {"--html", file("pages"), "--jobs", "1", "--shard", "1/1"}).exit_code, 0);
  EXPECT_TRUE(read(name) == page);
  EXPECT_TRUE(read("pages/index.html") == index);

  // One that fails is named; the others are shown.
  json other = fit("other.vdb");
  other["anchors"] = file("three.json");
  write_text(file("three.json"), R"({"pairs": []})");
  EXPECT_EQ(batch({fit("map.vdb"), other}, {"--html", file("pages"), "--keep-going"}).exit_code, 3);
  EXPECT_THAT(read("pages/index.html"), AllOf(HasSubstr("<h1>1 result</h1>"), HasSubstr("Not made")));
  write_text(file("taken"), "");
  const ProgramResult taken = batch(jobs, {"--html", file("taken")});
  EXPECT_EQ(taken.exit_code, 4);
  EXPECT_THAT(taken.err, HasSubstr("taken: is no directory"));
}

TEST_F(BatchCommand, RepeatsNothingThatIsUpToDate) {
  const std::vector<json> jobs{fit("map.vdb"), apply("map.vdb", "moved/out.obj")};
  ASSERT_EQ(batch(jobs).exit_code, 0);
  const auto time = fs::last_write_time(file("moved/out.obj"));
  fs::last_write_time(file("source.obj"), fs::last_write_time(file("source.obj")) + std::chrono::hours(1));
  const ProgramResult again = batch(jobs, {"--json"});
  EXPECT_THAT(again.out, HasSubstr("\"up-to-date\":2"));
  EXPECT_EQ(fs::last_write_time(file("moved/out.obj")), time);
  EXPECT_THAT(batch(jobs, {"--dry-run"}).out, StartsWith("0 of 2 jobs"));
  write_text(file("product.obj"), read("product.obj") + "# changed\n");
  const ProgramResult dry = batch(jobs, {"--dry-run"});
  EXPECT_THAT(dry.out,
              AllOf(HasSubstr("line 2: apply"), HasSubstr("product.obj has changed"), HasSubstr("1 of 2")));
  EXPECT_EQ(fs::last_write_time(file("moved/out.obj")), time);
  EXPECT_THAT(batch(jobs, {"--json"}).out, AllOf(HasSubstr("\"up-to-date\":1"), HasSubstr("\"done\":1")));
  EXPECT_THAT(read("moved/out.obj"), EndsWith("# changed\n"));
}

TEST_F(BatchCommand, RefusesBadManifestsBeforeAnythingRuns) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  const json good = apply("map.vdb", "good.obj");
  const auto with = [&](const char* key, const json& value) {
    json job = apply("map.vdb", "out.obj");
    job[key] = value;
    return job;
  };
  const auto without = [&](const char* key) {
    json job = apply("map.vdb", "out.obj");
    job.erase(key);
    return job;
  };
  struct Bad {
    std::vector<json> jobs;
    const char* message;  // of line 2
  };
  for (const Bad& bad : {
           Bad{{good, with("speed", 3)}, "unknown key \"speed\""},
           Bad{{good, with("threads", 3)}, "for the whole batch"},
           Bad{{good, with("command", "knit")}, "unknown command \"knit\""},
           Bad{{good, without("map")}, "\"map\" is missing"},
           Bad{{good, without("output")}, "-o OUT"},
           Bad{{good, with("product", file("absent.obj"))}, "absent.obj does not exist"},
           Bad{{good, with("output", file("good.obj"))}, "is written by line 1"},
           Bad{{good, with("output", file("product.obj"))}, "also what the job writes"},
           Bad{{good, with("t", "half")}, "half"},
           Bad{{good, with("exact", 1)}, "either true or false"},
           Bad{{good, with("map", {file("map.vdb"), file("map.vdb")})}, "takes one value"},
           Bad{{good, with("output", file("out.step"))}, "out.step"},
           Bad{{good, json::array({1})}, "not a JSON object"},
           Bad{{good,
                {{"command", "invert"}, {"map", file("y.vdb")}, {"output", file("x.vdb")}},
                {{"command", "invert"}, {"map", file("x.vdb")}, {"output", file("y.vdb")}}},
               "waits for itself: line 2"},
       }) {
    const ProgramResult result = batch(bad.jobs, {"--keep-going"});
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("jobs.jsonl:2: "), HasSubstr(bad.message), HasSubstr("nothing was run\n")));
    EXPECT_FALSE(pair_.has("good.obj")) << bad.message;
  }
  EXPECT_THAT(batch({}).err, HasSubstr("holds no job"));
  EXPECT_EQ(bespoke({"batch", file("absent.jsonl")}).exit_code, 4);
  for (const std::string shard : {"0/2", "3/2", "1", "a/b", "1/2x"})
    EXPECT_EQ(batch({good}, {"--shard", shard}).exit_code, 1) << shard;
  EXPECT_THAT(batch({good}, {"--max-memory", "1MB"}).err,
              AllOf(HasSubstr("jobs.jsonl:1"), HasSubstr("--max-memory is 2 MB")));
  EXPECT_FALSE(pair_.has("good.obj"));
}

TEST_F(BatchCommand, TakesCsv) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  write_text(file("jobs.csv"), "command,map,product,output,t\napply," + file("map.vdb") + "," +
                                   file("product.obj") + "," + file("a.obj") + ",\napply," + file("map.vdb") +
                                   "," + file("product.obj") + "," + file("b.obj") + ",0\n");
  EXPECT_EQ(bespoke({"batch", file("jobs.csv"), "-q"}).exit_code, 0);
  EXPECT_EQ(read_obj_points(file("b.obj")), read_obj_points(file("product.obj")));
  EXPECT_NE(read("a.obj"), read("b.obj"));
}

TEST_F(BatchCommand, NamesTheLineOfAJobThatFails) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  // Large, so that it starts first.
  write_text(file("broken.obj"), "v 0 0\n#" + std::string(1 << 20, 'x') + "\n");
  json broken = apply("map.vdb", "broken_out.obj");
  broken["product"] = file("broken.obj");
  const std::vector<json> jobs{broken, apply("map.vdb", "out.obj")};
  const ProgramResult stopped = batch(jobs, {"--jobs", "1", "--log", file("log.jsonl")});
  EXPECT_EQ(stopped.exit_code, 3);
  EXPECT_THAT(stopped.err, AllOf(HasSubstr("jobs.jsonl:1: apply: "), HasSubstr("broken.obj"),
                                 HasSubstr("1 of 2 jobs failed, 1 did not run")));
  EXPECT_EQ(log("log.jsonl")[1]["state"], "not-run");
  EXPECT_FALSE(pair_.has("out.obj"));
  const ProgramResult result = batch(jobs, {"--keep-going", "--progress", "openjd"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(pair_.has("out.obj"));
  EXPECT_FALSE(pair_.has("broken_out.obj"));
  EXPECT_THAT(result.out, AllOf(HasSubstr("openjd_progress: 100.0\n"),
                                HasSubstr("openjd_status: 1 of 2 done"), HasSubstr("openjd_fail: ")));
}

TEST_F(BatchCommand, StopsBetweenJobsOnASignal) {
  std::vector<json> jobs;
  for (int i = 0; i < 30; ++i) {
    jobs.push_back(fit("m" + std::to_string(i) + ".vdb"));
    jobs.back()["tolerance"] = "0.2%";
  }
  RunningProgram program(
      {BESPOKE_COMMAND, "batch", manifest(jobs), "--jobs", "1", "--log", file("log.jsonl")});
  ASSERT_TRUE(program.wait_for_error_text("1 running"));
  program.send(SIGTERM);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 128 + SIGTERM) << result.err;
  EXPECT_THAT(result.err, HasSubstr("did not run"));
  const std::vector<json> records = log("log.jsonl");
  ASSERT_EQ(records.size(), 30u);
  const auto done =
      std::count_if(records.begin(), records.end(), [](const json& r) { return r["state"] == "done"; });
  EXPECT_GE(done, 1);
  EXPECT_LT(done, 30);
  for (int i = 0; i < 30; ++i) EXPECT_EQ(pair_.has("m" + std::to_string(i) + ".vdb"), i < done);
}

/// What jobs have written in a directory, by name; records aside, which hold times.
std::map<std::string, std::string> products(const std::string& directory) {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    const std::string name = fs::relative(entry.path(), directory).string();
    if (entry.is_regular_file() && !name.ends_with(".bespoke-jobs.jsonl"))
      found[name] = read_text(entry.path());
  }
  return found;
}

/// Two fits and eight products of each, into a directory.
std::vector<json> season(const ExamplePair& pair, const std::string& directory) {
  std::vector<json> jobs;
  for (const std::string size : {"s", "m"}) {
    const std::string map = directory + "/" + size + ".vdb";
    for (int i = 0; i < 8; ++i)
      jobs.push_back({{"command", "apply"},
                      {"map", map},
                      {"product", pair.file("product.obj")},
                      {"t", 0.125 * (i + 1)},
                      {"output", directory + "/" + size + "/" + std::to_string(i) + ".obj"}});
    jobs.push_back({{"command", "fit"},
                    {"source", pair.file("source.obj")},
                    {"target", pair.file("target.obj")},
                    {"anchors", pair.file("anchors.json")},
                    {"tolerance", size == "s" ? "0.5%" : "0.4%"},
                    {"output", map}});
  }
  return jobs;
}

TEST_F(BatchCommand, ReachesTheSameStateWhateverIsKilled) {
  ASSERT_EQ(batch(season(pair_, file("undisturbed")), {"-q"}).exit_code, 0);
  const auto wanted = products(file("undisturbed"));
  ASSERT_EQ(wanted.size(), 18u);

  constexpr int kills = 12;
  std::mt19937 random(12);
  const std::string path = manifest(season(pair_, file("killed")));
  const std::vector<std::vector<std::string>> workers{
      {"--threads", "1"}, {"--threads", "3"}, {"--shard", "1/2"}, {"--shard", "2/2", "--threads", "2"}};
  for (int kill = 0; kill < kills; ++kill) {
    std::vector<std::unique_ptr<RunningProgram>> programs;
    // Now and then two of them write the same files.
    for (int i = 0; i <= kill % 3; ++i) {
      std::vector<std::string> arguments{BESPOKE_COMMAND, "batch", path, "-q"};
      const auto& worker = workers[random() % workers.size()];
      arguments.insert(arguments.end(), worker.begin(), worker.end());
      programs.push_back(std::make_unique<RunningProgram>(arguments));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
    for (const auto& program : programs) program->send(SIGKILL);
    for (const auto& program : programs) program->wait();
    for (const auto& [name, bytes] : fs::exists(file("killed")) ? products(file("killed")) : wanted) {
      ASSERT_TRUE(wanted.contains(name)) << name << " after kill " << kill;
      ASSERT_TRUE(bytes == wanted.at(name)) << name << " after kill " << kill;
    }
  }
  EXPECT_EQ(bespoke({"batch", path, "-q", "--threads", "2"}).exit_code, 0);
  EXPECT_TRUE(products(file("killed")) == wanted);
}

/// Batches that pack, run in the directory of the example: names in the archive are seen from there.
class PackedBatchCommand : public BatchCommand {
 protected:
  /// A program and its arguments, started there.
  std::vector<std::string> there(const std::vector<std::string>& command,
                                 const std::string& before = "") const {
    std::vector<std::string> words{"sh", "-c", before + "cd \"$0\" && exec \"$@\"", file("")};
    words.insert(words.end(), command.begin(), command.end());
    return words;
  }
  ProgramResult run_there(const std::vector<std::string>& arguments, const std::string& before = "") const {
    std::vector<std::string> command{BESPOKE_COMMAND};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run_program(there(command, before));
  }
  /// What an archive holds and which files others leave, but records.
  std::map<std::string, std::string> unpacked(const std::string& archive) const {
    const ScratchDirectory directory;
    const ProgramResult result = run_program({"tar", "-xf", file(archive), "-C", directory.path()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    std::map<std::string, std::string> found = products(directory.path());
    std::erase_if(found,
                  [](const auto& row) { return row.first.find(".bespoke-jobs") != std::string::npos; });
    return found;
  }
};

TEST_F(PackedBatchCommand, PutsTheSameProductsIntoOneFile) {
  const std::string path = manifest(season(pair_, "season"));
  ASSERT_EQ(run_there({"batch", path, "-q"}).exit_code, 0);
  const auto wanted = products(file("season"));
  ASSERT_EQ(wanted.size(), 18u);
  fs::remove_all(file("season"));

  ASSERT_EQ(run_there({"batch", path, "-q", "--pack", "1.tar", "--shard", "1/2"}).exit_code, 0);
  const ProgramResult dry = run_there({"batch", path, "--pack", "1.tar", "--dry-run"});
  EXPECT_THAT(dry.out, HasSubstr("9 of 18 jobs would run"));
  ASSERT_EQ(run_there({"batch", path, "-q", "--pack", "2.tar", "--shard", "2/2"}).exit_code, 0);
  EXPECT_THAT(products(file("season")), testing::SizeIs(2));  // the maps
  EXPECT_EQ(unpacked("1.tar").size(), 8u);
  EXPECT_THAT(run_there({"batch", path, "--pack", "1.tar", "--shard", "1/2", "--json"}).out,
              HasSubstr("\"up-to-date\":9"));
  for (const std::string archive : {"1.tar", "2.tar"})
    ASSERT_EQ(run_program({"tar", "-xf", file(archive), "-C", file("")}).exit_code, 0);
  EXPECT_THAT(run_there({"batch", path, "--dry-run"}).out, StartsWith("0 of 18 jobs"));
  auto found = products(file("season"));
  std::erase_if(found, [](const auto& row) { return row.first.find(".bespoke-jobs") != std::string::npos; });
  EXPECT_TRUE(found == wanted);
}

TEST_F(PackedBatchCommand, HoldsWhatEveryCommandWrites) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  const auto into = [&](const std::string& output, json job) {
    job["output"] = "results/" + output;
    return job;
  };
  json frames = apply("map.vdb", ""), refined = frames, reported = frames;
  frames["frames"] = 20;
  refined["refine"] = "0.01%";
  reported["report"] = "results/of_apply.json";
  const std::string path = manifest(
      {into("frame.obj", frames), into("refined.obj", refined), into("reported.obj", reported),
       into("map.vdb", fit("")),
       into("check.json", {{"command", "check"}, {"map", file("map.vdb")}, {"json", true}}),
       into("inverse.vdb", {{"command", "invert"}, {"map", file("map.vdb")}}),
       into("map.vti", {{"command", "export"}, {"map", file("map.vdb")}, {"grid", "5%"}}),
       into(
           "morph.glb",
           {{"command", "export"}, {"map", file("map.vdb")}, {"morph", 2}, {"product", file("product.obj")}}),
       into("pictures.md", {{"command", "report"},
                            {"map", file("map.vdb")},
                            {"source", file("source.obj")},
                            {"target", file("target.obj")}})});
  const ProgramResult packed = run_there({"batch", path, "-q", "--pack", "out.tar"});
  ASSERT_EQ(packed.exit_code, 0) << packed.err;
  EXPECT_FALSE(pair_.has("results"));
  auto found = unpacked("out.tar");
  const ProgramResult plain = run_there({"batch", path, "-q"});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  auto wanted = products(file("results"));
  ASSERT_GT(wanted.size(), 30u);
  EXPECT_EQ(found.size(), wanted.size());
  // The report of an apply says how long that took.
  wanted.erase("of_apply.json");
  for (const auto& [name, bytes] : wanted) EXPECT_TRUE(found["results/" + name] == bytes) << name;
  EXPECT_GT(wanted["refined.obj"].size(), wanted["reported.obj"].size());
}

TEST_F(PackedBatchCommand, ReachesTheSameStateWhateverIsKilled) {
  const std::string path = manifest(season(pair_, "season"));
  ASSERT_EQ(run_there({"batch", path, "-q", "--pack", "undisturbed.tar"}).exit_code, 0);
  const auto wanted = unpacked("undisturbed.tar");
  ASSERT_EQ(wanted.size(), 16u);
  fs::remove_all(file("season"));
  fs::create_directory(file("temporary"));

  constexpr int kills = 12;
  std::mt19937 random(13);
  for (int kill = 0; kill < kills; ++kill) {
    RunningProgram program(there({"env", "TMPDIR=" + file("temporary"), BESPOKE_COMMAND, "batch", path, "-q",
                                  "--pack", "killed.tar", "--threads", kill % 2 == 0 ? "1" : "3"}));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
    program.send(SIGKILL);
    program.wait();
    EXPECT_TRUE(fs::is_empty(file("temporary"))) << kill;
    for (const auto& [name, bytes] :
         fs::exists(file("season")) ? products(file("season")) : std::map<std::string, std::string>())
      EXPECT_THAT(name, EndsWith(".vdb")) << kill;
  }
  const ProgramResult last = run_there({"batch", path, "-q", "--pack", "killed.tar"});
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_TRUE(unpacked("killed.tar") == wanted);
}

TEST_F(PackedBatchCommand, RefusesWhatIsNoPlaceForAnArchive) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  json good = apply("map.vdb", "out.obj"), outside = good;
  outside["output"] = "../outside.obj";
  const std::string path = manifest({good, outside});
  EXPECT_THAT(run_there({"batch", path, "--pack", "out.zip"}),
              AllOf(Field(&ProgramResult::exit_code, 1), Field(&ProgramResult::err, HasSubstr(".tar"))));
  EXPECT_EQ(run_there({"batch", path, "--pack", "out.tar", "--html", "pages"}).exit_code, 1);
  for (const std::vector<std::string>& extra : {std::vector<std::string>{}, {"--dry-run"}}) {
    std::vector<std::string> arguments{"batch", path, "--pack", "out.tar"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const ProgramResult result = run_there(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("jobs.jsonl:2: output ../outside.obj lies outside"),
                                  HasSubstr("1 fault; nothing was run")));
  }
  EXPECT_FALSE(pair_.has("out.tar"));
  manifest({good});
  write_text(file("out.tar"), "a note");
  const ProgramResult other = run_there({"batch", path, "--pack", "out.tar"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("out.tar: is not an archive that `bespoke batch --pack` has made"));
  EXPECT_EQ(read("out.tar"), "a note");
  EXPECT_THAT(
      run_there({"batch", path, "--pack", "jobs.jsonl/out.tar"}),
      AllOf(Field(&ProgramResult::exit_code, 4), Field(&ProgramResult::err, HasSubstr("jobs.jsonl"))));
}

TEST_F(PackedBatchCommand, IsWholeAfterADiskThatWasFull) {
  ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  std::vector<json> jobs;
  for (int i = 0; i < 8; ++i) {
    jobs.push_back(apply("map.vdb", "out_" + std::to_string(i) + ".obj"));
    jobs.back()["t"] = 0.1 * i;
  }
  const std::string path = manifest(jobs);
  ASSERT_EQ(run_there({"batch", path, "-q", "--pack", "whole.tar"}).exit_code, 0);
  const auto wanted = unpacked("whole.tar");
  // As files may be no larger, the archive finds no space: for some of the products, or for the last block.
  // Units of 512 bytes.
  const auto some = 4 * fs::file_size(file("product.obj")) / 512;
  const auto all_but_the_end = fs::file_size(file("whole.tar")) / 512 - 1;
  for (const auto blocks : {some, all_but_the_end}) {
    fs::remove(file("out.tar"));
    const std::string full = "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; ";
    const ProgramResult result = run_there({"batch", path, "-q", "--pack", "out.tar"}, full);
    // A job that fails gives 3, the end of the archive that fails as well gives 4.
    EXPECT_THAT(result.exit_code, testing::AnyOf(3, 4)) << result.err;
    EXPECT_THAT(result.err, HasSubstr("out.tar: cannot be written: File too large"));
    const auto kept = unpacked("out.tar");
    EXPECT_GT(kept.size(), 0u);
    EXPECT_EQ(kept.size() == wanted.size(), blocks == all_but_the_end);
    const ProgramResult again = run_there({"batch", path, "--json", "--pack", "out.tar"});
    EXPECT_THAT(again.out, HasSubstr("\"up-to-date\":" + std::to_string(kept.size())));
    EXPECT_TRUE(unpacked("out.tar") == wanted);
  }
}

}  // namespace
}  // namespace bespoke::test

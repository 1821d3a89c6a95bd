#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command/refusal.h"

// Outputs that are no regular files, of every command that writes: written into or refused, never replaced.
namespace bespoke::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class OutputStreamsOfCommands : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
    ASSERT_EQ(::mkfifo(pipe_.c_str(), 0600), 0);
  }
  std::string file(const std::string& name) const { return pair_.file(name); }
  std::string linked(const std::string& name) const {
    fs::create_symlink(pipe_, file(name));
    return file(name);
  }
  /// What the pipe's reader is given by a run that succeeds.
  std::string piped(const std::vector<std::string>& arguments) const {
    std::future<std::string> reader = std::async(std::launch::async, [&] { return read_text(pipe_); });
    const ProgramResult result = bespoke(arguments);
    // The reader waits for a writer, also where the command did not come to be one.
    if (result.exit_code != 0) write_text(pipe_, "");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(fs::is_fifo(fs::symlink_status(pipe_)));
    return reader.get();
  }
  std::vector<std::string> measure(const std::vector<std::string>& extra) const {
    std::vector<std::string> all{"measure",  file("map.vdb"),    "--source", file("source.obj"),
                                 "--target", file("target.obj"), "-q"};
    all.insert(all.end(), extra.begin(), extra.end());
    return all;
  }

  ExamplePair pair_;
  const std::string pipe_ = pair_.file("pipe");
};

TEST_F(OutputStreamsOfCommands, PipesTakeProductsMapsReportsAndTexts) {
  const std::string map = file("map.vdb"), product = file("product.obj");
  ASSERT_EQ(bespoke({"apply", map, product, "-o", file("out.obj")}).exit_code, 0);
  const std::string carried = read_text(file("out.obj"));
  EXPECT_EQ(piped({"apply", map, product, "-o", pipe_}), carried);
  EXPECT_EQ(piped({"apply", map, product, "-o", linked("link.obj")}), carried);
  EXPECT_THAT(piped({"check", map, "-o", pipe_}), HasSubstr("a bijection of space"));
  EXPECT_EQ(piped(measure({"-o", pipe_})), bespoke(measure({})).out);
  EXPECT_TRUE(nlohmann::json::accept(piped({"apply", map, product, "-o", file("b.obj"), "--report", pipe_})));
  EXPECT_TRUE(piped({"invert", map, "-o", linked("inverse.vdb")}).size() > 1000);
  EXPECT_THAT(piped({"anchors", "convert", file("anchors.json"), "-o", pipe_}), HasSubstr("\"pairs\""));
  EXPECT_TRUE(fs::is_symlink(file("link.obj")) && fs::is_symlink(file("inverse.vdb")));
}

TEST_F(OutputStreamsOfCommands, OfAFitTakeMapAndConfidence) {
  const auto fit = [&](const std::vector<std::string>& outputs) {
    std::vector<std::string> all{
        "fit", file("source.obj"), file("target.obj"), "--anchors", file("anchors.json"), "--tolerance", "5%",
        "-q"};
    all.insert(all.end(), outputs.begin(), outputs.end());
    return all;
  };
  const std::string link = linked("streamed.vdb");
  ASSERT_EQ(bespoke(fit({"-o", file("a.vdb"), "--confidence-out", file("a.txt")})).exit_code, 0);
  EXPECT_TRUE(piped(fit({"-o", link})) == read_text(file("a.vdb")));
  EXPECT_EQ(piped(fit({"-o", file("b.vdb"), "--confidence-out", pipe_})), read_text(file("a.txt")));
  expect_refusal(bespoke(fit({"-o", link, "--html", file("pages")})), 1,
                 "--html: shows the map from its file");
}

TEST_F(OutputStreamsOfCommands, DevicesStayDevices) {
  const std::string device = file("null");
  if (::mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0) GTEST_SKIP() << "only root makes devices";
  fs::create_symlink(device, file("null.obj"));
  const std::string map = file("map.vdb"), product = file("product.obj");
  for (const std::vector<std::string>& outputs : {std::vector<std::string>{"-o", device},
                                                  {"-o", file("null.obj")},
                                                  {"-o", device, "--report", device}}) {
    std::vector<std::string> arguments{"apply", map, product};
    arguments.insert(arguments.end(), outputs.begin(), outputs.end());
    EXPECT_EQ(bespoke(arguments).exit_code, 0);
    EXPECT_TRUE(fs::is_character_file(fs::symlink_status(device)));
    EXPECT_TRUE(fs::is_symlink(file("null.obj")));
  }
  // A run that fails after its report was written takes back files only.
  expect_refusal(bespoke({"apply", map, product, "-o", device, "--report", file("none/report.json")}), 4,
                 "does not exist");
  EXPECT_TRUE(fs::is_character_file(fs::symlink_status(device)));
}

TEST_F(OutputStreamsOfCommands, ADashIsStandardOutputAndSummariesGoElsewhere) {
  const std::string map = file("map.vdb"), product = file("product.obj");
  ASSERT_EQ(bespoke({"apply", map, product, "-o", file("out.obj")}).exit_code, 0);
  const ProgramResult applied = bespoke({"apply", map, product, "-o", "-"});
  EXPECT_EQ(applied.exit_code, 0);
  EXPECT_EQ(applied.out, read_text(file("out.obj")));
  EXPECT_THAT(applied.err, HasSubstr("points"));
  EXPECT_THAT(bespoke({"check", map, "-o", "-"}).out, HasSubstr("a bijection of space"));
  EXPECT_EQ(bespoke(measure({"-o", "-", "--json"})).out, bespoke(measure({"--json"})).out);
  EXPECT_TRUE(
      nlohmann::json::accept(bespoke({"apply", map, product, "-o", file("b.obj"), "--report", "-"}).out));
  EXPECT_TRUE(nlohmann::json::accept(bespoke({"anchors", "convert", file("anchors.json"), "-o", "-"}).out));
  EXPECT_FALSE(fs::exists("-"));
  expect_refusal(bespoke({"apply", map, product, "-o", "-", "--report", "-"}), 1,
                 "-: would be written twice");
  expect_refusal(bespoke({"apply", map, product, "-o", "-", "--frames", "2"}), 1, "--frames");
  expect_refusal(bespoke({"invert", map, "-o", "-"}), 1, "- must end in .vdb");
}

TEST_F(OutputStreamsOfCommands, SocketsAreRefusedBeforeTheWork) {
  const std::string path = file("s");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path.size(), sizeof address.sun_path);
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  expect_refusal(bespoke({"check", file("map.vdb"), "-o", path}), 4, "it is a socket");
  EXPECT_TRUE(fs::is_socket(path));
  ::close(socket);
}

TEST_F(OutputStreamsOfCommands, AreNoOutputsOfJobs) {
  const auto batch = [&](const std::string& output, const std::vector<std::string>& extra = {}) {
    const nlohmann::json job{{"command", "check"}, {"map", file("map.vdb")}, {"output", output}};
    write_text(file("jobs.jsonl"), job.dump() + "\n");
    std::vector<std::string> all{"batch", file("jobs.jsonl")};
    all.insert(all.end(), extra.begin(), extra.end());
    return bespoke(all);
  };
  for (const std::string& output : {pipe_, std::string("-")}) {
    const ProgramResult refused = batch(output);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("output " + output + " is no file"));
  }
  const ProgramResult logged = batch(file("check.txt"), {"--log", "-", "-q"});
  EXPECT_EQ(logged.exit_code, 0) << logged.err;
  EXPECT_TRUE(nlohmann::json::accept(logged.out)) << logged.out;
  expect_refusal(batch("again.txt", {"--pack", linked("pack.tar")}), 4, "is no regular file");
  EXPECT_TRUE(fs::is_fifo(pipe_));
}

}  // namespace
}  // namespace bespoke::test

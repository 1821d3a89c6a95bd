#include "bespoke/batch/job_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batch/batch_scene.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MakeJobGraph : public ::testing::Test {
 protected:
  MakeJobGraph() { scene_.write("a", "A"); }

  /// Of the only fault.
  static std::string fault(const JobGraph& graph, std::size_t line) {
    EXPECT_EQ(graph.faults.size(), 1u);
    if (graph.faults.empty()) return {};
    EXPECT_EQ(graph.faults[0].line, line);
    return graph.faults[0].what;
  }

  test::BatchScene scene_;
};

TEST_F(MakeJobGraph, JoinsReadersToWriters) {
  const JobGraph graph = make_job_graph(
      {scene_.job(1, {"b", "c"}, {"d"}), scene_.job(2, {"a"}, {"b", "c"}), scene_.job(3, {"a"}, {"e"})});
  EXPECT_THAT(graph.faults, IsEmpty());
  EXPECT_THAT(graph.needs[0], ElementsAre(1));
  EXPECT_THAT(graph.feeds[1], ElementsAre(0));
  EXPECT_THAT(connected_jobs(graph), ElementsAre(ElementsAre(0, 1), ElementsAre(2)));
  const JobGraph part = subgraph(graph, {0, 1});
  EXPECT_THAT(part.needs[0], ElementsAre(1));
  EXPECT_EQ(subgraph(graph, {2}).jobs[0].line, 3u);
}

TEST_F(MakeJobGraph, TakesTwoNamesOfAFileForOne) {
  std::filesystem::create_directory(scene_.file("sub"));
  std::filesystem::create_directory_symlink(scene_.file("sub"), scene_.file("link"));
  const JobGraph graph =
      make_job_graph({scene_.job(1, {"a"}, {"sub/b"}), scene_.job(2, {"link/../link/b"}, {"c"})});
  EXPECT_THAT(graph.faults, IsEmpty());
  EXPECT_THAT(graph.needs[1], ElementsAre(0));
}

TEST_F(MakeJobGraph, NamesTheLinesOfTwoWriters) {
  EXPECT_THAT(fault(make_job_graph({scene_.job(3, {"a"}, {"b"}), scene_.job(7, {"a"}, {"./b"})}), 7),
              AllOf(HasSubstr("b"), HasSubstr("line 3")));
  EXPECT_THAT(fault(make_job_graph({scene_.job(3, {"a"}, {"b", "b"})}), 3), HasSubstr("by this job already"));
}

TEST_F(MakeJobGraph, NamesMissingFiles) {
  EXPECT_THAT(fault(make_job_graph({scene_.job(4, {"absent"}, {"b"})}), 4),
              AllOf(HasSubstr("product"), HasSubstr("absent"), HasSubstr("does not exist")));
}

TEST_F(MakeJobGraph, NamesWhoReadsWhatItWrites) {
  EXPECT_THAT(fault(make_job_graph({scene_.job(5, {"a"}, {"a"})}), 5), HasSubstr("also what the job writes"));
}

TEST_F(MakeJobGraph, NamesACycleAndNobodyElse) {
  const std::string what = fault(make_job_graph({scene_.job(1, {"d"}, {"e"}), scene_.job(2, {"d"}, {"b"}),
                                                 scene_.job(3, {"b"}, {"c"}), scene_.job(4, {"c"}, {"d"})}),
                                 4);
  EXPECT_THAT(what, AllOf(HasSubstr("line 4"), HasSubstr("line 3"), HasSubstr("line 2")));
  EXPECT_THAT(what, ::testing::Not(HasSubstr("line 1")));
}

}  // namespace
}  // namespace bespoke

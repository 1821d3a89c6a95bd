#include <cmath>
#include <sstream>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/mesh_io.h"
#include "command/fit_command.h"
#include "support/shapes.h"

namespace bespoke::test {
namespace {

using ::testing::HasSubstr;

/// A fit onto points of the target, all vertices of the pair's target and of its halved edges, with normals.
class CloudTarget : public FitCommand {
 protected:
  CloudTarget() {
    const TriangleMesh target = read_triangle_mesh(pair_.file("target.obj"));
    const TriangleMesh fine = shapes::subdivided(shapes::subdivided(target));
    const Points normals = vertex_normals(fine);
    std::ostringstream text;
    text.precision(9);
    text << "ply\nformat ascii 1.0\nelement vertex " << fine.vertices.cols()
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
            "ny\nproperty float nz\nend_header\n";
    for (Eigen::Index i = 0; i < fine.vertices.cols(); ++i)
      text << fine.vertices.col(i).transpose() << ' ' << normals.col(i).transpose() << '\n';
    write_text(pair_.file("target.ply"), text.str());
  }

  ProgramResult fit(const std::string& target, const std::string& map,
                    const std::vector<std::string>& extra = {}) const {
    std::vector<std::string> arguments{
        "fit", pair_.file("source.obj"), pair_.file(target), "--anchors", pair_.file("anchors.json"),
        "-o",  pair_.file(map),          "--tolerance",      "0.5%"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  Points carried(const std::string& map) const {
    const std::string out = pair_.file(map + ".obj");
    const ProgramResult result = bespoke({"apply", pair_.file(map), pair_.file("source.obj"), "-o", out});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_obj_points(out);
  }
};

TEST_F(CloudTarget, GivesTheMapOfTheMeshWithinItsSpacing) {
  ASSERT_EQ(fit("target.obj", "mesh.vdb").exit_code, 0);
  const ProgramResult result =
      fit("target.ply", "cloud.vdb", {"--verbose", "--report", pair_.file("report.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("cloud        cloud of 10242 points"));
  const json stage = read_json("report.json")["stages"][0];
  EXPECT_EQ(stage["name"], "cloud");
  EXPECT_EQ(stage["points"], 10242);
  const double spacing = stage["spacing"];
  EXPECT_LT(stage["distances"]["p95"], spacing / 10);

  // Both fits register the source to their surface; along it they may differ by as much as the surfaces'
  // normals do.
  const Points onto_mesh = carried("mesh.vdb"), onto_cloud = carried("cloud.vdb");
  EXPECT_LT((onto_mesh - onto_cloud).colwise().norm().maxCoeff(), spacing);
  const ClosestPointTree target(read_triangle_mesh(pair_.file("target.obj")));
  for (const auto& x : onto_cloud.colwise())
    EXPECT_LT(std::sqrt(target.closest(x)->squared_distance), spacing / 2);
}

TEST_F(CloudTarget, IsTheSameFileForEveryCommandThatReadsTheTarget) {
  ASSERT_EQ(fit("target.ply", "map.vdb").exit_code, 0);
  const std::vector<std::string> models{"--source", pair_.file("source.obj"), "--target"};
  const auto run = [&](std::vector<std::string> arguments, const std::string& target) {
    arguments.insert(arguments.end(), models.begin(), models.end());
    arguments.push_back(pair_.file(target));
    return bespoke(arguments);
  };
  EXPECT_EQ(run({"measure", pair_.file("map.vdb")}, "target.ply").exit_code, 0);
  EXPECT_EQ(run({"view", pair_.file("map.vdb"), "-o", pair_.file("map.html")}, "target.ply").exit_code, 0);
  const ProgramResult other = run({"measure", pair_.file("map.vdb")}, "target.obj");
  EXPECT_NE(other.exit_code, 0);
  EXPECT_THAT(other.err, HasSubstr("target.obj: is not the target that the map was made of"));
  EXPECT_EQ(info("map.vdb")["stages"][0]["name"], "cloud");
}

TEST_F(CloudTarget, IsRefusedAsSource) {
  const ProgramResult result =
      bespoke({"fit", pair_.file("target.ply"), pair_.file("source.obj"), "-o", pair_.file("map.vdb")});
  expect_refusal(result, 2, "target.ply: is a point cloud, which can be a target only");
}

}  // namespace
}  // namespace bespoke::test

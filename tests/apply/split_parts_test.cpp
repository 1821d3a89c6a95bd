#include <gmock/gmock.h>

#include <array>
#include <set>
#include <sstream>

#include "apply/split_files.h"

namespace bespoke {
namespace {

using test::bend;

/// A strip of triangles of length 1 a column from x = 0 to x = 8, those from 3 to 5 in the group "plate".
std::string strip() {
  std::ostringstream text;
  for (int x = 0; x <= 8; ++x) text << "v " << x << " 0 0\nv " << x << " 1 0\n";
  for (int x = 0; x < 8; ++x) {
    text << "g " << (x == 3 || x == 4 ? "plate" : "cloth") << '\n';
    const int a = 2 * x + 1;
    text << "f " << a << ' ' << a + 2 << ' ' << a + 1 << "\nf " << a + 1 << ' ' << a + 2 << ' ' << a + 3
         << '\n';
  }
  return text.str();
}

class SplitParts : public test::SplitFiles {
 protected:
  /// The strip's points, carried by `bend` with the plate as it is, and its edges split for this chord error.
  std::string carried(const std::string& name, const std::string& content, double length) {
    const std::filesystem::path in = file(name, content), out = directory_ / ("out_" + name);
    Product product = read_product(in);
    VertexParts parts = parts_of_places(in, product.vertices, {{plate_}, {}});
    refined_ = refine_product(std::move(product), bend, length, std::move(parts));
    summary_ = carry_product(in, {out}, test::bend_motion(), {{plate_}, {}, &refined_.splits});
    return out;
  }

  const RigidPart plate_{"plate"};
  CarrySummary summary_;
};

/// The points of a group of an OBJ file.
Points points_of(const std::filesystem::path& path, const std::string& group) {
  const Product product = read_product(path);
  const std::vector<int> part = parts_of_places(path, product.vertices, {{{group}}, {}});
  std::vector<Eigen::Index> own;
  for (std::size_t i = 0; i < part.size(); ++i)
    if (part[i] == 0) own.push_back(static_cast<Eigen::Index>(i));
  return product.vertices(Eigen::all, own);
}

TEST_F(SplitParts, StayFlatAndWhereTheyAreWithoutSplits) {
  const std::string out = carried("a.obj", strip(), 1e-3);
  const std::vector<PartSummary> with_splits = summary_.parts;
  carry_product(directory_ / "a.obj", {directory_ / "whole.obj"}, test::bend_motion(), {{plate_}, {}});
  const Points plate = points_of(out, "plate"), whole = points_of(directory_ / "whole.obj", "plate");
  ASSERT_GE(plate.cols(), whole.cols());
  EXPECT_EQ(plate.leftCols(whole.cols()), whole);
  EXPECT_EQ(with_splits.front().points, static_cast<std::size_t>(whole.cols()));
  const Vector3 a = whole.col(0), normal = (whole.col(1) - a).cross(whole.col(2) - a).normalized();
  EXPECT_LT((normal.transpose() * (plate.colwise() - a)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(SplitParts, LeaveTheRestAsFineAsItIsAskedFor) {
  carried("a.obj", strip(), 1e-3);
  EXPECT_LE(refined_.chord.length, 1e-3);
  EXPECT_GT(refined_.splits.vertices.size(), 100u);
  // Nothing within the plate needs a split, but edges of it may be the longest of triangles beside it.
  std::size_t within = 0, without_parts = 0;
  const auto count = [](const Product& product, std::size_t& vertices) {
    for (const auto& x : product.vertices.colwise()) vertices += x[0] > 3 && x[0] < 5 && x[0] != 4;
  };
  count(refined_.product, within);
  split("b.obj", strip(), 1e-3);
  count(refined_.product, without_parts);
  EXPECT_LT(within, without_parts / 2) << "of " << refined_.splits.vertices.size();
}

TEST_F(SplitParts, ThatAreAllTheProductNeedNoSplit) {
  std::string text = strip();
  for (std::size_t at; (at = text.find("g cloth")) != std::string::npos;) text.replace(at, 7, "g plate");
  carried("a.obj", text, 1e-9);
  EXPECT_TRUE(refined_.splits.vertices.empty());
  EXPECT_EQ(refined_.chord.length, 0);
}

std::size_t places(const Points& points) {
  std::set<std::array<double, 3>> places;
  for (const auto& x : points.colwise()) places.insert({x[0], x[1], x[2]});
  return places.size();
}

// Two squares side by side, each with vertices of its own: what was at one place is at one place.
TEST_F(SplitParts, KeepSeamsClosed) {
  const std::string obj =
      "g plate\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n"
      "g cloth\nv 2 0 0\nv 6 0 0\nv 6 2 0\nv 2 2 0\nf 5 6 7\nf 5 7 8\n";
  const Product carried_product = read_product(carried("a.obj", obj, 1e-2));
  const Points& before = refined_.product.vertices;
  EXPECT_EQ(carried_product.vertices.cols(), before.cols());
  EXPECT_LT(places(before), static_cast<std::size_t>(before.cols()) - 1);
  EXPECT_EQ(places(carried_product.vertices), places(before));
}

}  // namespace
}  // namespace bespoke

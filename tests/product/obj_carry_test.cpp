#include <gmock/gmock.h>

#include "product/product_files.h"

namespace bespoke {
namespace {

using CarryObj = test::ProductFiles;
using test::affine_motion;
using test::bend_motion;
using test::identity_motion;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Every construct that a program may write, in one file.
const std::string odd_obj =
    "# comment \\\r\n"
    "mtllib some thing.mtl other.mtl\r\n"
    "o Object.001\r\n\r\n"
    "\tv  +0 0.50 -1e-3 # first\r\n"
    "v 1.00000000000000001 2 3.25 0.5 0.5 0.25\n"
    "v .5 1. -0.0 1\n"
    "v 1 \\\n  2 \\\r\n  3\n"
    "vt 0 0 0\nvt 0.5 1\n"
    "vn 0 0 1\nvn 0.707 0 -0.707 # slanted\nvn 0 2 0\n"
    "g part one\nusemtl cloth\ns 1\n"
    "f -4/1/1 -3/2/1 2/1/2 \\\n 4//3\n";

TEST_F(CarryObj, WithTheIdentityKeepsEveryByte) {
  std::string good = odd_obj;
  good.erase(good.find("f -4"));
  good +=
      "f -4/1/1 -3/2/1 \\\n 3/2/2 4/1/3\nf 1//1 2//1 4//2\nl 1 2 3\np 4\ns off\nvp 0.3 0.1\ncurv 0 1 1 2\n"
      "cstype bezier\nend\n\n# the last line has no line break\nv 9 9 9";
  EXPECT_EQ(carried("a.obj", good, identity_motion()), good);
  EXPECT_EQ(summary_.points, 5u);
  EXPECT_EQ(summary_.directions, 3u);
  EXPECT_THAT(summary_.warnings, ::testing::ElementsAre(HasSubstr("free-form")));
}

TEST_F(CarryObj, ChangesPositionsAndNothingElse) {
  const Matrix3 swap = Vector3(2, 2, 2).asDiagonal();
  EXPECT_EQ(
      carried("a.obj",
              "# v 1 2 3\r\nv 1 2 3 0.5 0.5 0.5 # red\r\nv 0.25 1 1\nusemtl m\ng a b\nvt 0.5 0.5\nv 0 0 0\n"
              "f 1/1 2/1 3/1\nl 1/1 2/1\n",
              affine_motion(swap, Vector3(0, 0, 1))),
      "# v 1 2 3\r\nv 2.0000000 4.0000000 7.0000000 0.5 0.5 0.5 # red\r\nv 0.5000000 2.0000000 3.0000000\n"
      "usemtl m\ng a b\nvt 0.5 0.5\nv 0 0 1.0000000\nf 1/1 2/1 3/1\nl 1/1 2/1\n");
}

TEST_F(CarryObj, WritesTheDigitsThatTheFileCarries) {
  const PointMotion third = affine_motion(Matrix3::Identity() / 3, Vector3::Zero());
  EXPECT_EQ(carried("a.obj", "v 1.000000000 1 0\n", third), "v 0.333333333 0.333333333 0\n");
  // A diagonal of about 1000 needs four decimals, one of 0.001 ten.
  EXPECT_EQ(carried("a.obj", "v 1000 0 0\nv 0 1 0\n", third), "v 333.3333 0 0\nv 0 0.3333 0\n");
  EXPECT_EQ(carried("a.obj", "v 0.001 0 0\nv 0 0.0001 0\n", third),
            "v 0.0003333333 0 0\nv 0 0.0000333333 0\n");
  // All that a double holds.
  EXPECT_EQ(carried("a.obj", "v 1.0000000000000000 0.1 0.2\nv 0 0 0\n", third),
            "v 0.3333333333333333 0.0333333333333333 0.0666666666666667\nv 0 0 0\n");
}

TEST_F(CarryObj, TurnsNormalsByTheInverseTransposeAndKeepsTheirLength) {
  Matrix3 shear = Matrix3::Identity();
  shear(0, 1) = 1;  // x + y
  const std::string out = carried("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 2.0000 0 0\nf 1//1 2//1 3//1\n",
                                  affine_motion(shear, Vector3::Zero()));
  EXPECT_EQ(out, "v 0 0 0\nv 1 0 0\nv 1.0000000 1 0\nvn 1.4142136 -1.4142136 0\nf 1//1 2//1 3//1\n");
}

TEST_F(CarryObj, DividesANormalWhereItsVerticesTurnDifferently) {
  // At x = 0 the bend leaves (0, 0, 1) as it is, at x = 1 it becomes (-1, 0, 1) / √2.
  EXPECT_EQ(
      carried("a.obj",
              "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1 # up\nvn 0 1 0\nf 1//1 2//1 3//1\nf -3//-2 1//2 3//-1\n",
              bend_motion()),
      "v 0 0 0\nv 1 0 0.5000000\nv 0 1 0\nvn 0 0 1 # up\nvn -0.7071068 0 0.7071068 # up\nvn 0 1 0\n"
      "f 1//1 2//2 3//1\nf -3//-3 1//3 3//-1\n");
}

TEST_F(CarryObj, JoinsNormalsWithPointsInTheirOrderWhereNoFaceDoes) {
  EXPECT_EQ(carried("a.obj", "vn 0 0 1\nv 0 0 0\nvn 0 0 1\nv 1 0 0\n", bend_motion()),
            "vn 0 0 1\nv 0 0 0\nvn -0.7071068 0 0.7071068\nv 1 0 0.5000000\n");
  carried("a.obj", "v 0 0 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 1//1 1//1\n", bend_motion());
  EXPECT_THAT(summary_.warnings, ::testing::ElementsAre(HasSubstr("1 degenerate face, which was kept"),
                                                        HasSubstr("1 normals that no face uses")));
}

TEST_F(CarryObj, WritesEveryFrame) {
  PointMotion two;
  two.frames = 2;
  two.images = [](const Points& x) { return std::vector<Points>{x, 2 * x}; };
  two.jacobians = [](const Points& x) {
    return std::vector<Points>(2, Matrix3::Identity().replicate(1, x.cols()));
  };
  const auto a = directory_ / "a.obj", b = directory_ / "b.obj";
  carry_product(file("in.obj", "v 1 2 3\nvn 0 0 1\np 1\n"), {a, b}, two);
  EXPECT_EQ(test::read_text(a), "v 1 2 3\nvn 0 0 1\np 1\n");
  EXPECT_EQ(test::read_text(b), "v 2.0000000 4.0000000 6.0000000\nvn 0 0 1\np 1\n");
  EXPECT_THROW(carry_product(file("in.obj", "v 1 2 3\n"), {a}, two), InvalidInput);
}

TEST_F(CarryObj, OfManyBlocksIsThatOfOne) {
  // Long enough for several blocks and waves; indices lead back and forward across them.
  std::string text, doubled;
  const int count = 80000;
  const std::string comment = "# " + std::string(200, '.') + "\n";
  for (int i = 1; i <= count; ++i) {
    const std::string n = std::to_string(i);
    text += "v " + n + " 0 1.0000000\nvn 0 0 1\n";
    doubled += "v " + std::to_string(2 * i) + ".000 0 2.0000000\nvn 0 0 1\n";
    const std::string face = "f -1//-1 1//1 " + std::to_string(count) + "//" + n + "\n";
    text += face + comment;
    doubled += face + comment;
  }
  EXPECT_GT(text.size(), std::size_t{1} << 24);
  EXPECT_TRUE(carried("a.obj", text, identity_motion()) == text);
  EXPECT_TRUE(carried("a.obj", text, affine_motion(2 * Matrix3::Identity(), Vector3::Zero())) == doubled);
  EXPECT_THAT(complaint("a.obj", text + "v 1 2 x\n"),
              HasSubstr("a.obj:" + std::to_string(4 * count + 1) + ": z"));
}

TEST_F(CarryObj, NamesTheLineOfWhatIsWrong) {
  EXPECT_THAT(complaint("a.obj", odd_obj), HasSubstr("a.obj:19: the corners of a face differ in form"));
  const std::string good = "# a\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(complaint("a.obj", good + "v 1 abc 0\n"),
              HasSubstr("a.obj:5: y: 'abc' is not a finite number"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 nan 0\n"), HasSubstr(":5: y: 'nan'"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 1e999 0\n"), HasSubstr(":5: y: '1e999'"));
  EXPECT_THAT(complaint("a.obj", good + "v 1 2\n"), HasSubstr(":5: missing z"));
  EXPECT_THAT(complaint("a.obj", good + "vn 0 1\n"), HasSubstr(":5: missing z"));
  EXPECT_THAT(complaint("a.obj", good + "f 1 2 4\n"), HasSubstr(":5: a face names vertex 4 of 3"));
  EXPECT_THAT(complaint("a.obj", good + "f 1 2 -4\nv 1 1 1\n"), HasSubstr(":5: a face names vertex -4 of 3"));
  EXPECT_THAT(complaint("a.obj", good + "f 1//1 2//1 3//1\n"), HasSubstr(":5: a face names normal 1 of 0"));
  // 16 GB, were the number taken for that of a normal.
  EXPECT_THAT(complaint("a.obj", good + "f 1//4294967000 2//1 3//1\n"),
              HasSubstr(":5: a face names normal 4294967000 of 0"));
  EXPECT_THAT(complaint("a.obj", good + "f 1 2\n"), HasSubstr(":5: a face of 2 corners"));
  EXPECT_THAT(complaint("a.obj", good + "l 1\n"), HasSubstr(":5: a line of 1 corners"));
  for (const char* corner : {"x", "0", "3///", "/3", "3/1/1/1", "//", "3.0"})
    EXPECT_THAT(complaint("a.obj", good + "f 1 2 " + corner + "\n"), HasSubstr(":5: a face has the corner"))
        << corner;
  EXPECT_THAT(complaint("a.obj", "# nothing\n"), HasSubstr("the file has no vertices"));
  EXPECT_THAT(complaint("a.obj", ""), HasSubstr("the file is empty"));
  EXPECT_FALSE(std::filesystem::exists(directory_ / "out_a.obj"));
}

}  // namespace
}  // namespace bespoke

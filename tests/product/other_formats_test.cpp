#include <gmock/gmock.h>

#include "product/product_files.h"

namespace bespoke {
namespace {

using CarryStl = test::ProductFiles;
using CarryOff = test::ProductFiles;
using CarryPoints = test::ProductFiles;
using CarryProduct = test::ProductFiles;
using test::bend_motion;
using test::bytes;
using test::identity_motion;
using ::testing::HasSubstr;

const std::string odd_stl =
    "solid a b c\r\n FACET NORMAL 0 0 1\n  outer   loop\n\n   vertex 0 0 0\n   vertex 1.5 0 0\n\tvertex 0 "
    "1e0 0\n"
    "endloop\n endfacet\nendsolid a b c\n\nsolid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 "
    "0\n"
    "vertex 0 0 0\nendloop\nendfacet\nendsolid";

TEST_F(CarryStl, OfTextChangesPointsAndNormalsAndNothingElse) {
  EXPECT_EQ(carried("a.stl", odd_stl, identity_motion()), odd_stl);
  std::string expected = odd_stl;
  expected.replace(expected.find("1.5 0 0"), 7, "1.5 0 1.1250000");
  // At the middle of the corners, x = 0.5.
  expected.replace(expected.find("0 0 1\n"), 5, "-0.4472136 0 0.8944272");
  EXPECT_EQ(carried("a.stl", odd_stl, bend_motion()), expected);
  EXPECT_EQ(summary_.points, 6u);
}

std::string facet(float x, std::uint16_t attribute) {
  std::string result;
  for (const float value : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, x, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f})
    result += bytes(value);
  return result + bytes(attribute);
}

TEST_F(CarryStl, OfBytesChangesPointsAndNormalsAndNothingElse) {
  const std::string head = std::string("solid in name only").append(62, '\x7f') + bytes(2u);
  const std::string whole = head + facet(1.5f, 7) + facet(0, 0xffff);
  EXPECT_EQ(carried("a.stl", whole, identity_motion()), whole);
  std::string expected = whole;
  expected.replace(84 + 32, 4, bytes(1.125f));
  expected.replace(84, 12,
                   bytes(static_cast<float>(-1 / std::sqrt(5.0))) + bytes(0.0f) +
                       bytes(static_cast<float>(2 / std::sqrt(5.0))));
  EXPECT_EQ(carried("a.stl", whole, bend_motion()), expected);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(complaint("short.stl", whole.substr(0, size)), "accepted") << size;
  EXPECT_THAT(complaint("a.stl", head + facet(std::nanf(""), 0) + facet(0, 0)), HasSubstr("facet 0 of 2"));
}

TEST_F(CarryStl, KeepsTheSignsOfZerosAndWhatIsNoNormal) {
  std::string stl = std::string(80, 's') + bytes(2u);
  for (const float x : {-0.0f, 1.0f, -0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, -0.0f})
    stl += bytes(x);
  stl += bytes(std::uint16_t{0});
  for (const float x : {std::nanf(""), 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f})
    stl += bytes(x);
  stl += bytes(std::uint16_t{0});
  EXPECT_EQ(carried("a.stl", stl, identity_motion()), stl);
}

TEST_F(CarryStl, NamesTheLineOfWhatIsWrong) {
  const std::string begin = "solid\nfacet normal 0 0 1\nouter loop\n";
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\nvertex 1 x 0\n"), HasSubstr("a.stl:5: y: 'x'"));
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\nendloop\n"),
              HasSubstr("a.stl:5: 'endloop' where vertex"));
  EXPECT_THAT(complaint("a.stl", begin + "vertex 0 0 0\n"),
              HasSubstr("the file ends before the facet's vertex"));
  EXPECT_THAT(complaint("a.stl", odd_stl.substr(0, odd_stl.rfind("endsolid"))), HasSubstr("before endsolid"));
  EXPECT_THAT(complaint("a.stl", "solid\nendsolid\n"), HasSubstr("no vertices"));
}

TEST_F(CarryOff, ChangesPointsAndNormalsAndNothingElse) {
  const std::string off =
      "# made by hand\nCNOFF 3 2 0 # counts\n\n0 0 0 0 0 1 255 0 0\n# between\n1.00 0 0 0 0 1 0 255 0\r\n"
      "0 1e-20 0 0 0 1 0 0 255\n3 2 1 0 0.5 0.5 0.5\n2 0 1";
  EXPECT_EQ(carried("a.off", off, identity_motion()), off);
  std::string expected = off;
  expected.replace(expected.find("1.00 0 0 0 0 1"), 14, "1.00 0 0.5000000 -0.7071068 0 0.7071068");
  EXPECT_EQ(carried("a.off", off, bend_motion()), expected);
  for (const std::string header : {"OFF\n", "OFF ", "COFF\n", "STOFF\n", ""}) {
    const std::string plain = header + "2 0 0\n0 0 0\n1 2 3 0.5\n";
    EXPECT_EQ(carried("a.off", plain, identity_motion()), plain);
  }
}

TEST_F(CarryOff, NamesTheLineOfWhatIsWrong) {
  const std::string good = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(complaint("a.off", good + "3 0 1 3\n"),
              HasSubstr("a.off:6: a face names vertex 3, outside 0 … 2"));
  EXPECT_THAT(complaint("a.off", good + "4 0 1 2\n"), HasSubstr("a.off:6: missing corner"));
  EXPECT_THAT(complaint("a.off", good), HasSubstr("ends after 0 of 1 faces"));
  EXPECT_THAT(complaint("a.off", good + "3 0 1 2\n3 0 1 2\n"),
              HasSubstr("a.off:7: a line behind the last face"));
  EXPECT_THAT(complaint("a.off", "OFF\n3 1 0\n0 0 0\n"), HasSubstr("ends after 1 of 3 vertices"));
  EXPECT_THAT(complaint("a.off", "4OFF\n1 0 0\n0 0 0 0\n"), HasSubstr(":1: an OFF file begins with OFF"));
  EXPECT_THAT(complaint("a.off", "OFF BINARY\n1234"), HasSubstr("binary OFF is not read"));
}

TEST_F(CarryPoints, OfLinesChangesPointsAndUnitVectorsBehindThem) {
  const std::string colours = "# a\n1.0 0 0 255 0 0\n\n 2 0 0 1 0 0 label\n";
  EXPECT_EQ(carried("a.xyz", colours, bend_motion()),
            "# a\n1.0 0 0.5000000 255 0 0\n\n 2 0 2.0000000 1 0 0 label\n");
  EXPECT_EQ(carried("a.xyz", "1 0 0 0 0 1\n0 0 0 0 0 1", bend_motion()),
            "1 0 0.5000000 -0.7071068 0 0.7071068\n0 0 0 0 0 1");
  EXPECT_THAT(complaint("a.xyz", "1 2 3\n1 2\n"), HasSubstr("a.xyz:2: missing z"));
}

TEST_F(CarryPoints, OfATableChangesTheColumnsThatItsHeaderNames) {
  EXPECT_EQ(
      carried("a.csv", "name,Z,\"y\", X ,nz,ny,nx\r\n\"a, b\",0,0,\"1.0\",1,0,0\r\n,1,2,0,0,0,1\n",
              bend_motion()),
      "name,Z,\"y\", X ,nz,ny,nx\r\n\"a, b\",0.5000000,0,\"1.0\",0.7071068,0,-0.7071068\r\n,1,2,0,0,0,1\n");
  EXPECT_EQ(carried("a.csv", "x;y;z\n1;0;0\n", bend_motion()), "x;y;z\n1;0;0.5000000\n");
  EXPECT_EQ(carried("a.csv", "id\tx\ty\tz\n\t1\t0\t0\n", bend_motion()), "id\tx\ty\tz\n\t1\t0\t0.5000000\n");
  EXPECT_THAT(complaint("a.csv", "a,b\n1,2\n"), HasSubstr("a.csv:1: the header of a point table names"));
  EXPECT_THAT(complaint("a.csv", "x,y,z\n1,2\n"), HasSubstr("a.csv:2: 2 fields where the header has 3"));
  EXPECT_THAT(complaint("a.csv", "x,y,z\n1,2,\"3\n"), HasSubstr("a.csv:2: a quote"));
  EXPECT_THAT(complaint("a.csv", "x,y,z\n1,2,\n"), HasSubstr("a.csv:2: z: ''"));
}

TEST_F(CarryProduct, NamesTheEndingsThatAreKnown) {
  const auto message = [&](const std::string& name) {
    return test::error_message<InvalidInput>([&] { carried(name, "v 1 2 3\n", identity_motion()); });
  };
  EXPECT_THAT(message("a.step"),
              ::testing::AllOf(HasSubstr("a.step: the name must end in .obj, .ply"), Not(HasSubstr("USD"))));
  for (const char* name : {"a.usd", "a.usda", "a.usdc", "a.USDZ"})
    EXPECT_THAT(message(name), HasSubstr("USD is not read: convert it to .glb"));
  EXPECT_THROW(carry_product(file("a.obj", "v 1 2 3\n"), {directory_ / "b.ply"}, identity_motion()),
               InvalidInput);
  EXPECT_THROW(carry_product(directory_ / "absent.obj", {directory_ / "b.obj"}, identity_motion()),
               FileError);
  EXPECT_THROW(carry_product("/dev/null/a.obj", {directory_ / "b.obj"}, identity_motion()), FileError);
  EXPECT_TRUE(has_product_ending("A.OBJ"));
}

TEST_F(CarryProduct, LeavesNothingWhenItFails) {
  EXPECT_THROW(carried("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\n", identity_motion()), FormatError);
  PointMotion broken = identity_motion();
  broken.images = [](const Points&) -> std::vector<Points> { throw InvalidInput("no map here"); };
  EXPECT_THROW(carried("b.obj", "v 1 2 3\n", broken), InvalidInput);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory_.path()), {}), 2);
}

}  // namespace
}  // namespace bespoke

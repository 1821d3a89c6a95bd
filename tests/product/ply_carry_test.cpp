#include <gmock/gmock.h>

#include "product/product_files.h"

namespace bespoke {
namespace {

using CarryPly = test::ProductFiles;
using test::affine_motion;
using test::bend_motion;
using test::bytes;
using test::identity_motion;
using ::testing::HasSubstr;

// Elements, lists and properties that say nothing about geometry stand before, between and behind.
std::string odd_ply(const std::string& format, const std::string& body, const std::string& line = "\n") {
  std::string header =
      "ply|format " + format +
      " 1.0|comment by hand|obj_info none|element camera 1|property list uchar float view|element vertex 3|"
      "property list uchar short tags|property double y|property uchar red|property float x|property float z|"
      "property float ny|property float nx|property double nz|element face 2|property uchar flags|"
      "property list ushort uint vertex_indices|property list uchar double texcoord|element empty 0|"
      "property int none|end_header|";
  std::string text;
  for (const char c : header) text += c == '|' ? line : std::string(1, c);
  return text + body;
}

const std::string odd_lines =
    "2 9 9.5\r\n\r\n1 7 0.250 200 0 1e-3 0 0 1\r\n0 1 201 1 0 0 0 1\r\n0 0 202 0 2.5 0 0 1 \r\n"
    "1 3 0 1 2 0\r\n2 4 0 1 2 0 1 0.5\r\n\r\n";

std::string odd_bytes(bool big) {
  std::string body = bytes(std::uint8_t{2}) + bytes(9.0f, big) + bytes(9.5f, big);
  for (int i = 0; i < 3; ++i) {
    body += bytes(static_cast<std::uint8_t>(i));
    for (int k = 0; k < i; ++k) body += bytes(static_cast<short>(-7), big);
    body += bytes(0.1 * i, big) + bytes(static_cast<std::uint8_t>(200 + i)) +
            bytes(static_cast<float>(i), big) + bytes(0.3f, big);
    body += bytes(0.0f, big) + bytes(0.0f, big) + bytes(1.0, big);
  }
  for (const int corners : {3, 4}) {
    body += bytes(std::uint8_t{1}) + bytes(static_cast<std::uint16_t>(corners), big);
    for (int k = 0; k < corners; ++k) body += bytes(static_cast<std::uint32_t>(k % 3), big);
    body += bytes(std::uint8_t{1}) + bytes(0.25, big);
  }
  return body;
}

TEST_F(CarryPly, WithTheIdentityKeepsEveryByte) {
  for (const std::string line : {"\n", "\r\n"}) {
    const std::string ascii = odd_ply("ascii", odd_lines, line);
    EXPECT_EQ(carried("a.ply", ascii, identity_motion()), ascii);
    for (const bool big : {false, true}) {
      const std::string binary =
          odd_ply(big ? "binary_big_endian" : "binary_little_endian", odd_bytes(big), line);
      EXPECT_EQ(carried("a.ply", binary, identity_motion()), binary);
      EXPECT_EQ(summary_.points, 3u);
      EXPECT_EQ(summary_.directions, 3u);
    }
  }
}

TEST_F(CarryPly, MovesPointsAndNormalsAndNothingElse) {
  EXPECT_EQ(
      carried("a.ply", odd_ply("ascii", odd_lines), bend_motion()),
      odd_ply("ascii",
              "2 9 9.5\r\n\r\n1 7 0.250 200 0 1e-3 0 0 1\r\n0 1 201 1 0.5000000 0 -0.7071068 0.7071068\r\n"
              "0 0 202 0 2.5 0 0 1 \r\n1 3 0 1 2 0\r\n2 4 0 1 2 0 1 0.5\r\n\r\n"));
  for (const bool big : {false, true}) {
    const std::string format = big ? "binary_big_endian" : "binary_little_endian";
    std::string expected = odd_ply(format, odd_bytes(big));
    const std::string out = carried("a.ply", expected, bend_motion());
    const std::size_t body = odd_ply(format, "").size();
    for (int i = 0; i < 3; ++i) {
      // Behind the camera's 9 bytes and the records before, each of 34 bytes except for the tags of 2; behind
      // y, red and x.
      const std::size_t z = body + 9 + static_cast<std::size_t>(i * 34 + i * (i - 1) + 1 + 2 * i + 13);
      const double length = std::sqrt(1.0 + i * i);
      expected.replace(z, 4, bytes(static_cast<float>(static_cast<double>(0.3f) + 0.5 * i * i), big));
      expected.replace(z + 8, 4, bytes(static_cast<float>(-i / length), big));
      const double nz = 1 / length;
      std::string stored = out.substr(z + 12, 8);
      if (big) stored.assign(stored.rbegin(), stored.rend());
      double read = 0;
      std::memcpy(&read, stored.data(), 8);
      EXPECT_NEAR(read, nz, 1e-15);
      expected.replace(z + 12, 8, out.substr(z + 12, 8));
    }
    EXPECT_EQ(out, expected);
  }
}

TEST_F(CarryPly, OfManyBlocksIsThatOfOne) {
  for (const std::string format : {"ascii", "binary_little_endian"}) {
    const int count = 100000;
    const auto make = [&](int scale) {
      std::string text = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) +
                         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                         std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n";
      const std::string zeros = scale == 2 ? ".000" : "";
      for (int i = 1; i <= count; ++i)
        text += format == "ascii" ? std::to_string(scale * i) + zeros + " 0 0\n"
                                  : bytes(static_cast<float>(scale * i)) + bytes(0.0f) + bytes(0.0f);
      for (int i = 0; i < count; ++i) {
        if (format == "ascii")
          text += "3 0 1 " + std::to_string(i) + "\n";
        else
          text += bytes(std::uint8_t{3}) + bytes(0) + bytes(1) + bytes(i);
      }
      return text;
    };
    const std::string once = make(1);
    EXPECT_TRUE(carried("a.ply", once, identity_motion()) == once);
    EXPECT_TRUE(carried("a.ply", once, affine_motion(2 * Matrix3::Identity(), Vector3::Zero())) == make(2));
  }
}

TEST_F(CarryPly, RefusesEveryShorterFile) {
  for (const bool big : {false, true}) {
    const std::string whole = odd_ply(big ? "binary_big_endian" : "binary_little_endian", odd_bytes(big));
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_NE(complaint("short.ply", whole.substr(0, size)), "accepted") << size;
    EXPECT_THAT(complaint("a.ply", whole + "more"), HasSubstr("bytes behind the last element"));
  }
  EXPECT_THAT(complaint("a.ply", odd_ply("ascii", odd_lines.substr(0, odd_lines.find("2 4 0")))),
              HasSubstr("the file ends here: 1 of 2 elements 'face'"));
  EXPECT_THAT(complaint("a.ply", odd_ply("ascii", odd_lines + "1\n")), HasSubstr("behind the last element"));
}

TEST_F(CarryPly, NamesThePlaceOfWhatIsWrong) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_index\nend_header\n";
  EXPECT_THAT(complaint("a.ply", head + faces + "0 0 0\n3 0 0 1\n"),
              HasSubstr("a.ply:11: a face names vertex 1, outside 0 … 0"));
  EXPECT_THAT(complaint("a.ply", head + faces + "0 0 0\n3 0 0\n"), HasSubstr("a.ply:11: missing corner"));
  EXPECT_THAT(complaint("a.ply", head + faces + "0 0 0 1\n3 0 0 0\n"), HasSubstr("a.ply:10: more words"));
  EXPECT_THAT(complaint("a.ply", head + faces + "0 inf 0\n3 0 0 0\n"), HasSubstr("a.ply:10: y: 'inf'"));
  EXPECT_THAT(complaint("a.ply", head), HasSubstr("ends before end_header"));
  EXPECT_THAT(complaint("a.ply", "ply\nformat runes 1.0\n"), HasSubstr("a.ply:2: unknown format 'runes'"));
  EXPECT_THAT(complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n"),
              HasSubstr("a.ply:4: unknown type 'quad'"));
  EXPECT_THAT(
      complaint("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
      HasSubstr("vertices have no x, y and z"));
  EXPECT_THAT(complaint("a.ply",
                        "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty float y\n"
                        "property float z\nend_header\n1 2 3\n"),
              HasSubstr("whole-number type"));
  std::string binary = head + faces;
  binary.replace(binary.find("ascii"), 5, "binary_little_endian");
  EXPECT_THAT(complaint("a.ply", binary + bytes(0.0f) + bytes(std::nanf("")) + bytes(0.0f) + '\0'),
              HasSubstr("a.ply: vertex 0 of 1: y is not finite"));
  EXPECT_THAT(complaint("a.ply", binary + std::string(12, '\0') + '\x01' + bytes(-1)),
              HasSubstr("a.ply: face 0 of 1: a face names vertex -1"));
  EXPECT_THAT(complaint("a.ply", binary + std::string(12, '\0') + '\xff' + bytes(0)),
              HasSubstr("a.ply: face 0 of 1: the file ends here"));
  EXPECT_THROW(carried("a.ply", binary + std::string(12, '\0') + '\0',
                       affine_motion(Matrix3::Identity(), Vector3(1e39, 0, 0))),
               InvalidInput);
}

}  // namespace
}  // namespace bespoke

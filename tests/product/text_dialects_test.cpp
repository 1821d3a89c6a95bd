#include "product/text_dialects.h"

#include <gmock/gmock.h>

#include "bespoke/product/product_io.h"
#include "product/good_products.h"
#include "product/product_files.h"

namespace bespoke {
namespace {

using test::bend_motion;
using test::bom;
using test::identity_motion;
using test::with_each;
using ::testing::HasSubstr;

/// One plain text of every format.
const std::vector<test::GoodProduct> plain_products{
    {"a.obj",
     "# plain\nv 0 0 0\nv 2.0 0 0\nv 2.0 1.5 0\nv 0 1.5 1e-1\nvt 0 0.5\nf 1/1 2/1 3/1\nf -4 -2 -1\nl 1 2\n"
     "p 4\n"},
    {"a.off", "OFF\n4 2 0\n0 0 0\n2.0 0 0\n2.0 1.5 0\n0 1.5 1e-1\n3 0 1 2\n3 0 2 3\n"},
    {"a.ply",
     "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
     "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
     "0 0 0\n2.0 0 0\n2.0 1.5 0\n0 1.5 1e-1\n3 0 1 2\n3 0 2 3\n"},
    {"a.stl",
     "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2.0 0 0\nvertex 2.0 1.5 0\nendloop\n"
     "endfacet\nendsolid a\n"},
    {"a.xyz", "0 0 0\n2.0 0 0 7\n2.0 1.5 0\n0 1.5 1e-1\n"},
    {"a.csv", "id,x,y,z\nchin,0,0,0\n\"ear, left\",2.0,0,0\n,2.0,1.5,0\n,0,1.5,1e-1\n"}};

class TextDialects : public test::ProductFiles {
 protected:
  /// Carrying and writing in a dialect may change places.
  void expect_carried(const test::GoodProduct& plain, const test::TextDialect& dialect) {
    SCOPED_TRACE(plain.name + " with " + dialect.name);
    const std::string odd = dialect.of(plain.content);
    EXPECT_EQ(carried(plain.name, odd, identity_motion()), odd);
    const std::string bent = carried(plain.name, plain.content, bend_motion());
    EXPECT_NE(bent, plain.content);
    EXPECT_EQ(carried(plain.name, odd, bend_motion()), dialect.of(bent));
    expect_read(plain, odd);
  }
  void expect_read(const test::GoodProduct& plain, const std::string& odd) {
    if (!can_read_product(plain.name)) return;
    const Product read = read_product(file(plain.name, odd)),
                  wanted = read_product(file(plain.name, plain.content));
    EXPECT_EQ(read.vertices, wanted.vertices);
    EXPECT_EQ(read.corners, wanted.corners);
    EXPECT_EQ(read.polygon_start, wanted.polygon_start);
    EXPECT_EQ(read.line_edges, wanted.line_edges);
  }
};

TEST_F(TextDialects, OfLinesAreReadAndKept) {
  for (const test::GoodProduct& plain : plain_products)
    for (const test::TextDialect& dialect : test::line_dialects()) expect_carried(plain, dialect);
}

TEST_F(TextDialects, OfBlanksAreReadAndKept) {
  for (const test::GoodProduct& plain : plain_products)
    for (const test::TextDialect& dialect : test::blank_dialects())
      if (plain.name != "a.csv") expect_carried(plain, dialect);
}

TEST_F(TextDialects, OfObjAreReadAndKept) {
  const test::GoodProduct plain{"a.obj", "v 0 0 0\nv 2.0 0 0\nv 2.0 1.5 0\nvt 0 0\nf 1 2 3\nf 1/1 2/1 3/1\n"};
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::vector<test::TextDialect> dialects{
      {"empty corner parts",
       [=](const std::string& text) {
         return replaced(replaced(text, "f 1 2 3", "f 1// 2// 3//"), "f 1/1 2/1 3/1", "f 1/1/ 2/1/ 3/1/");
       }},
      {"one slash", [=](const std::string& text) { return replaced(text, "f 1 2 3", "f 1/ 2/ 3/"); }},
      {"continued lines",
       [=](const std::string& text) {
         return replaced(replaced(text, "f 1 2 3", "f 1 \\\n2 \\\r\n 3"), "f 1/1 2/1 3/1",
                         "f 1/1 2/1\\\r3/1");
       }},
      {"comments behind words", [](const std::string& text) { return with_each(text, '\n', "# v 1 2 3\n"); }},
      {"counted back", [=](const std::string& text) { return replaced(text, "f 1 2 3", "f -3 -2 -1"); }},
      {"a second byte order mark",
       [=](const std::string& text) { return replaced(text, "f 1 2 3", bom + "f 1 2 3"); }}};
  for (const test::TextDialect& dialect : dialects) expect_carried(plain, dialect);
}

TEST_F(TextDialects, OfSpreadsheetsAreReadAndKept) {
  const test::GoodProduct plain{"a.csv", "id,x,y,z\nchin,0,0,0\n,2.0,0,0\nx,2.0,1.5,0.25\n"};
  const auto separated = [](const std::string& separator) {
    return [separator](const std::string& text) { return with_each(text, ',', separator); };
  };
  const auto german = [=](const std::string& text) { return with_each(separated(";")(text), '.', ","); };
  const auto quoted = [=](const std::string& text) {
    return "\"" + with_each(with_each(text.substr(0, text.size() - 1), ',', "\",\""), '\n', "\"\n\"") +
           "\"\n";
  };
  for (const test::TextDialect& dialect : std::vector<test::TextDialect>{
           {"semicolons", separated(";")},
           {"tabs", separated("\t")},
           {"decimal commas", german},
           {"decimal commas between tabs",
            [=](const std::string& text) { return with_each(german(text), ';', "\t"); }},
           {"a named separator", [=](const std::string& text) { return "sep=;\r\n" + german(text); }},
           {"quotes", quoted},
           {"a byte order mark, semicolons and CR",
            [=](const std::string& text) { return bom + with_each(german(text), '\n', "\r"); }}})
    expect_carried(plain, dialect);
}

TEST_F(TextDialects, OfPointListsAreReadAndKept) {
  const test::GoodProduct plain{"a.xyz", "0 0 0\n2.0 0 0\n2.0 1.5 0.25\n"};
  const auto separated = [](const std::string& separator) {
    return [separator](const std::string& text) { return with_each(text, ' ', separator); };
  };
  for (const test::TextDialect& dialect : std::vector<test::TextDialect>{
           {"commas", separated(",")},
           {"commas and blanks", separated(", ")},
           {"semicolons", separated(";")},
           {"decimal commas", [](const std::string& text) { return with_each(text, '.', ","); }},
           {"decimal commas between semicolons",
            [=](const std::string& text) { return with_each(separated(";")(text), '.', ","); }}})
    expect_carried(plain, dialect);
}

TEST_F(TextDialects, MixedDecimalsAreRefusedByTheirLine) {
  EXPECT_THAT(complaint("a.csv", "x;y;z\n0,5;1,5;2,5\n0.5;1;2\n"), HasSubstr("a.csv:3: x: '0.5'"));
  EXPECT_THAT(complaint("a.xyz", "0,5 1,5 2,5\n0.5 1 2\n"), HasSubstr("a.xyz:1: x: '0,5'"));
  EXPECT_THAT(complaint("a.csv", "x,y,z\n0,5,1,5,2,5\n"), HasSubstr("a.csv:2: 6 fields"));
}

TEST_F(TextDialects, Utf16IsNamed) {
  std::vector<test::GoodProduct> products = plain_products;
  products.push_back({"a.gltf", test::gltf_scene().gltf("a.bin")});
  for (const test::GoodProduct& plain : products)
    for (const bool is_big : {false, true})
      for (const bool has_mark : {false, true}) {
        const std::string wide = test::utf16(plain.content, is_big, has_mark);
        EXPECT_THAT(complaint(plain.name, wide), HasSubstr(plain.name + ": is UTF-16; save as UTF-8"));
        if (can_read_product(plain.name)) {
          EXPECT_THAT(test::error_message<FormatError>([&] { read_product(file(plain.name, wide)); }),
                      HasSubstr("is UTF-16; save as UTF-8"));
        }
      }
}

TEST_F(TextDialects, LinesAreCountedInAllOfThem) {
  for (const test::TextDialect& dialect : test::line_dialects()) {
    if (dialect.name == "no last line break") continue;
    EXPECT_THAT(complaint("a.obj", dialect.of("v 0 0 0\nv 1 0 0\n\nv nan 1 0\n")),
                HasSubstr("a.obj:4: x: 'nan'"))
        << dialect.name;
    EXPECT_THAT(complaint("a.xyz", dialect.of("0 0 0\n\n0 inf 0\n")), HasSubstr("a.xyz:3: y: 'inf'"))
        << dialect.name;
    EXPECT_THAT(complaint("a.csv", dialect.of("x,y,z\n0,0,0\n0,0,-1.#IND\n")),
                HasSubstr("a.csv:3: z: '-1.#IND'"))
        << dialect.name;
    EXPECT_THAT(complaint("a.off", dialect.of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")),
                HasSubstr("a.off:6: "))
        << dialect.name;
  }
}

TEST_F(TextDialects, FilesThatEndWithinALineAreRefusedByIt) {
  EXPECT_THAT(complaint("a.obj", "v 0 0 0\nv 1 0"), HasSubstr("a.obj:2: missing z"));
  EXPECT_THAT(complaint("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2"), HasSubstr("a.obj:3: a face of 2 corners"));
  EXPECT_THAT(complaint("a.xyz", "0 0 0\r1 0"), HasSubstr("a.xyz:2: missing z"));
  EXPECT_THAT(complaint("a.csv", "x,y,z\n0,0,0\n1,0"), HasSubstr("a.csv:3: 2 fields"));
  EXPECT_THAT(complaint("a.csv", "x,y,z\n0,0,\"0"), HasSubstr("a.csv:2: a quote that does not end"));
  EXPECT_THAT(complaint("a.off", "OFF\n2 0 0\n0 0 0\n1 0"), HasSubstr("a.off:4: missing z"));
}

TEST_F(TextDialects, BinaryPlyBehindAHeaderOfAnyLineBreaksKeepsItsFirstByte) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  // A coordinate whose first byte looks like a line feed.
  std::string body = test::bytes(1.5f) + test::bytes(2.5f) + test::bytes(3.5f);
  body[0] = '\n';
  for (const std::string line_break : {"\n", "\r\n", "\r"})
    for (const std::string& mark : {std::string(), bom}) {
      const std::string ply = mark + with_each(header, '\n', line_break) + body;
      EXPECT_EQ(carried("a.ply", ply, identity_motion()), ply);
      EXPECT_EQ(summary_.points, 1u);
      EXPECT_NEAR(read_product(file("a.ply", ply)).vertices(0, 0), 1.5, 1e-5);
    }
}

TEST_F(TextDialects, DegenerateFacesAreToldOnceAndCarried) {
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const std::vector<test::GoodProduct> degenerate{
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 2 3\nf 1 3 3\n"},
      {"a.off", "OFF\n4 3 0\n" + points + "3 0 1 2\n4 0 1 1 2\n2 0 2\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 3\nproperty list uchar int vertex_indices\nend_header\n" +
           points + "3 0 1 2\n4 0 1 1 2\n3 0 2 2\n"}};
  for (const test::GoodProduct& product : degenerate) {
    EXPECT_EQ(carried(product.name, product.content, identity_motion()), product.content);
    ASSERT_EQ(summary_.warnings.size(), 1u);
    EXPECT_THAT(summary_.warnings[0], HasSubstr("2 degenerate faces, which were kept"));
    EXPECT_THAT(summary_.warnings[0], HasSubstr(" twice"));
    const Product read = read_product(file(product.name, product.content));
    EXPECT_EQ(read.polygon_start.size(), 4u);
    EXPECT_EQ(read.degenerate.count, 2u);
    // Of 1 2 2 3 the triangle stays, of 1 3 3 nothing.
    EXPECT_EQ(triangulated(read).cols(), 2);
  }
}

}  // namespace
}  // namespace bespoke

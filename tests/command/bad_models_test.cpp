#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "command/refusal.h"

// What the built command says of models that it cannot use: one line, the file's name and the fault.
namespace bespoke::test {
namespace {

using testing::HasSubstr;

template <class Value>
std::string bytes(Value value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

class BadModels : public testing::Test {
 protected:
  /// Every file as the source of a fit: exit code 2, the message and the name, no asset.
  void expect_refused(const std::vector<BadFile>& files) const {
    for (const BadFile& file : files) {
      write_text(pair_.file(file.name), file.content);
      const ProgramResult result =
          bespoke({"fit", pair_.file(file.name), pair_.file("target.obj"), "--anchors",
                   pair_.file("anchors.json"), "-o", pair_.file("map.vdb"), "-q"});
      expect_refusal(result, 2, file.message);
      EXPECT_THAT(result.err, HasSubstr(file.name));
      EXPECT_FALSE(pair_.has("map.vdb"));
    }
  }

  ExamplePair pair_;
};

TEST_F(BadModels, Obj) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\n";
  expect_refused({
      {"a.obj", "", "the file is empty"},
      {"a.obj", "# nothing\n", "the file has no vertices"},
      {"a.obj", "v 0 0 0\nv 1 abc 0\n", "a.obj:2: y: 'abc' is not a finite number"},
      {"a.obj", "v 0 0 0\nv 1 nan 0\n", "a.obj:2: y: 'nan' is not a finite number"},
      {"a.obj", "v 0 0 0\nv 1 0\n", "a.obj:2: missing z"},
      {"a.obj", corners + "f 1 2 9\n", "a.obj:6: a face names vertex 9 of 4"},
      {"a.obj", corners + "f 1/1 2/1 3/2\n", "a.obj:6: a face names texture coordinate 2 of 1"},
      {"a.obj", corners + "f 1//1 2//1 3//1\n", "a.obj:6: a face names normal 1 of 0"},
      {"a.obj", corners + "f 1 2 0\n", "a.obj:6: a face has the corner '0'"},
      {"a.obj", corners + "f 1 2\n", "a.obj:6: a face of 2 corners"},
      {"a.obj", corners + "f 1 2 2\n", "has no faces"},
      {"a.obj", corners + "f 1 2 x\n", "a.obj:6: a face has the corner 'x'"},
      {"a.obj", corners + "f 1 2 3///\n", "a.obj:6: a face has the corner '3///'"},
      {"a.obj", corners + "f 1/1 2/1 3\n", "a.obj:6: the corners of a face differ in form"},
      {"a.obj", corners, "has no faces"},
      {"a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "all vertices lie at one point"},
  });
}

TEST_F(BadModels, Off) {
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  expect_refused({
      {"a.off", "# nothing\n", "the file has no content"},
      {"a.off", "4OFF\n1 0 0\n", "a.off:1: an OFF file begins with OFF"},
      {"a.off", "OFF BINARY\n", "binary OFF is not read; save as PLY"},
      {"a.off", "OFF\n", "missing number of vertices"},
      {"a.off", "OFF\nmany 1 0\n", "a.off:2: number of vertices: 'many' is not a whole number"},
      {"a.off", "OFF\n3\n", "a.off:2: missing number of faces"},
      {"a.off", "OFF\n0 0 0\n", "the file has no vertices"},
      {"a.off", "OFF\n3 -1 0\n", "a negative number of faces"},
      {"a.off", "OFF\n4 1 0\n" + corners, "the file ends after 3 of 4 vertices"},
      {"a.off", "OFF\n3 2 0\n" + corners + "3 0 1 2\n", "the file ends after 1 of 2 faces"},
      {"a.off", "OFF\n3 1 0\n" + corners + "3 0 1 3\n", "a.off:6: a face names vertex 3, outside 0 … 2"},
  });
}

TEST_F(BadModels, Ply) {
  const std::string ascii = "ply\nformat ascii 1.0\n";
  const std::string axes = "property float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list char int vertex_indices\nend_header\n";
  const std::string three = "element vertex 3\n" + axes + faces + "0 0 0\n1 0 0\n0 1 0\n";
  const std::string binary = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + axes;
  expect_refused({
      {"a.ply", "plywood\n", "a.ply:1: a PLY file begins with ply"},
      {"a.ply", ascii, "the file ends before end_header"},
      {"a.ply", "ply\nformat runes 1.0\n", "a.ply:2: unknown format 'runes'"},
      {"a.ply", "ply\nend_header\n", "the header names no format"},
      {"a.ply", ascii + "element vertex -1\n", "a.ply:3: a negative number of elements"},
      {"a.ply", ascii + "property float x\n", "a.ply:3: a property before the first element"},
      {"a.ply", ascii + "element vertex 1\nproperty quad x\n", "a.ply:4: unknown type 'quad'"},
      {"a.ply", ascii + "element face 1\nproperty list float int a\n",
       "a.ply:4: the length of a list must be a whole number"},
      {"a.ply", ascii + "vertices 3\n", "a.ply:3: unknown word 'vertices' in the header"},
      {"a.ply", ascii + "end_header\n", "the file has no vertices"},
      {"a.ply", ascii + "element vertex 1\nproperty float x\nend_header\n0\n", "vertices have no x, y and z"},
      {"a.ply", ascii + three, "the file ends here"},
      {"a.ply", ascii + three + "-3 0 1 2\n", "a list of negative length"},
      {"a.ply", ascii + three + "3 0 1\n", "missing corner"},
      {"a.ply", ascii + three + "3 0 1 3\n", "a face names vertex 3, outside 0 … 2"},
      {"a.ply", binary + "end_header\n" + bytes(0.0f), "a.ply: vertex 0 of 1: the file ends here"},
      {"a.ply", binary + "end_header\n" + bytes(0.0f) + bytes(std::numeric_limits<float>::infinity()),
       "a.ply: vertex 0 of 1: the file ends here"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement note 1\nproperty list char int words\nelement vertex 1\n" + axes +
           "end_header\n2 7\n0 0 0\n",
       "missing words"},
  });
}

TEST_F(BadModels, Stl) {
  const std::string loop = "solid\nfacet normal 0 0 1\nouter loop\n";
  const auto binary = [](std::uint32_t facets) { return std::string(80, ' ') + bytes(facets); };
  const std::string infinite =
      std::string(12, '\0') + bytes(std::numeric_limits<float>::infinity()) + std::string(34, '\0');
  expect_refused({
      {"a.stl", "facet\n", "neither text that begins with \"solid\" nor as long as"},
      {"a.stl", "solid\nendsolid\n", "the file has no facets"},
      {"a.stl", binary(0), "the file has no facets"},
      {"a.stl", binary(2), "a binary STL file of 2 facets has 184 bytes, this one has 84"},
      {"a.stl", binary(1) + infinite, "facet 0 of 1 has a coordinate that is not finite"},
      {"a.stl", loop + "outer loop\n", "a.stl:4: 'outer' where vertex must stand"},
      {"a.stl", "solid\nvertex 0 0 0\n", "a.stl:2: the word 'vertex' in a wrong place"},
      {"a.stl", loop + "vertex 0 0 0\nendloop\n", "a.stl:5: 'endloop' where vertex must stand"},
      {"a.stl", loop + "vertex 0 0 0\n", "a.stl:4: the file ends before the facet's vertex"},
      {"a.stl", loop + "corner 0 0 0\n", "a.stl:4: 'corner' where vertex must stand"},
  });
}

TEST_F(BadModels, NotFilesAtAll) {
  const auto fit = [&](const std::string& source) {
    return bespoke({"fit", source, pair_.file("target.obj"), "--anchors", pair_.file("anchors.json"), "-o",
                    pair_.file("map.vdb"), "-q"});
  };
  std::filesystem::create_directory(pair_.file("folder.obj"));
  expect_refusal(fit(pair_.file("folder.obj")), 4, "folder.obj: not a regular file");
  expect_refusal(fit(pair_.file("none.obj")), 4, "none.obj: No such file");
  expect_refusal(fit(pair_.file("anchors.json")), 1,
                 "the name must end in .obj, .ply, .stl, .off, .gltf, .glb or .3mf");
  write_text(pair_.file("scan.usdz"), "PK");
  expect_refusal(fit(pair_.file("scan.usdz")), 1, "USD is not read: convert it to .glb");
  const ProgramResult applied =
      bespoke({"apply", pair_.file("map.vdb"), pair_.file("scan.usdz"), "-o", pair_.file("scan.obj")});
  expect_refusal(applied, 1, "USD is not read: convert it to .glb");
}

}  // namespace
}  // namespace bespoke::test

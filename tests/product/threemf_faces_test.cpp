#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/product/product_io.h"
#include "product/mesh_files.h"
#include "product/zip_archive.h"

namespace bespoke {
namespace {

using test::model_text, test::package_of, test::shown_once, test::tetrahedron, test::zip_archive;
using ::testing::AllOf;
using ::testing::HasSubstr;

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces.colwise())
    sum += mesh.vertices.col(face[0]).dot(mesh.vertices.col(face[1]).cross(mesh.vertices.col(face[2]))) / 6;
  return sum;
}

class ThreemfFaces : public test::MeshFiles {
 protected:
  std::string package(const std::string& model) const { return zip_archive(package_of(model)); }
  TriangleMesh read(const std::string& bytes) const { return read_triangle_mesh(file("a.3mf", bytes)); }
  std::string fault(const std::string& resources, const std::string& build = shown_once,
                    const std::string& attributes = "") const {
    return complaint("a.3mf", package(model_text(resources, build, attributes)));
  }
};

TEST_F(ThreemfFaces, AreTheMeshOfItsObjectInEveryFormOfArchive) {
  const auto files = package_of(model_text(tetrahedron(), shown_once));
  for (const bool deflate : {false, true})
    for (const bool wide : {false, true}) {
      const TriangleMesh mesh = read(zip_archive(files, {deflate, wide}));
      ASSERT_EQ(mesh.vertices.cols(), 4);
      EXPECT_EQ(mesh.vertices.col(3), Vector3(0, 0, 3));
      EXPECT_EQ(mesh.faces.col(3), Eigen::Vector3i(1, 2, 3));
      EXPECT_DOUBLE_EQ(volume(mesh), 1);
    }
}

TEST_F(ThreemfFaces, StandWhereItemsAndComponentsPutThem) {
  // A quarter turn about z, then a step along x: rows of the matrix, points multiplied from the left.
  const std::string turned = "transform=\"0 1 0 -1 0 0 0 0 1 5 0 0\"";
  const std::string both =
      "<object id=\"2\"><components><component objectid=\"1\"/><component objectid=\"1\" " + turned +
      "/></components></object>";
  const TriangleMesh mesh = read(package(
      model_text(tetrahedron() + both, "<item objectid=\"2\" transform=\"2 0 0 0 2 0 0 0 2 0 0 1\"/>")));
  ASSERT_EQ(mesh.vertices.cols(), 8);
  EXPECT_EQ(mesh.vertices.col(1), Vector3(2, 0, 1));
  EXPECT_EQ(mesh.vertices.col(5), Vector3(10, 2, 1)) << "(1, 0, 0) turns to (0, 1, 0)";
  EXPECT_EQ(mesh.vertices.col(6), Vector3(6, 0, 1)) << "(0, 2, 0) turns to (-2, 0, 0)";
  EXPECT_DOUBLE_EQ(volume(mesh), 16);
}

TEST_F(ThreemfFaces, KeepTheirOutsideInAMirror) {
  const TriangleMesh mesh = read(
      package(model_text(tetrahedron(), "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>")));
  EXPECT_EQ(mesh.vertices.col(1), Vector3(-1, 0, 0));
  EXPECT_DOUBLE_EQ(volume(mesh), 1);
}

TEST_F(ThreemfFaces, MayLieInOtherParts) {
  auto files =
      package_of(model_text("<object id=\"7\"><components><component objectid=\"1\" "
                            "p:path=\"/3D/Objects/one.model\"/></components></object>",
                            "<item objectid=\"7\"/>",
                            "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" "
                            "requiredextensions=\"p\""));
  files.push_back({"3D/Objects/one.model", model_text(tetrahedron(), "")});
  EXPECT_DOUBLE_EQ(volume(read(zip_archive(files))), 1);
  files.back().second = model_text(tetrahedron(), "", "unit=\"inch\"");
  EXPECT_THAT(complaint("a.3mf", zip_archive(files)), HasSubstr("3D/Objects/one.model: is in another unit"));
  files.pop_back();
  EXPECT_THAT(complaint("a.3mf", zip_archive(files)), HasSubstr("a.3mf: has no part '3D/Objects/one.model'"));
}

TEST_F(ThreemfFaces, NameTheLineAndTheElementAtFault) {
  const auto replaced = [](const std::string& from, const std::string& to) {
    std::string text = tetrahedron();
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(fault(replaced("y=\"2\"", "y=\"2,5\"")),
              HasSubstr("a.3mf: 3D/3dmodel.model:7: y: '2,5' is no finite number"));
  EXPECT_THAT(fault(replaced("y=\"2\"", "")), HasSubstr("3dmodel.model:7: <vertex> has no y"));
  EXPECT_THAT(fault(replaced("y=\"2\"", "y=\"1e39\"")), HasSubstr("y is not finite in single precision"));
  EXPECT_THAT(fault(replaced("v3=\"1\"", "v3=\"4\"")), HasSubstr(":11: v3 names vertex 4 of 4"));
  EXPECT_THAT(fault(replaced("v3=\"1\"", "v3=\"-1\"")), HasSubstr("v3: '-1' is no whole number from 0 on"));
  EXPECT_THAT(fault(replaced("v3=\"1\"", "v3=\"2\"")), HasSubstr(":11: a face names vertex 2 twice"));
  EXPECT_THAT(fault(replaced("</object>", "")), HasSubstr("is no XML: mismatched tag"));
  EXPECT_THAT(fault(tetrahedron() + tetrahedron()), HasSubstr("a second object with the id 1"));
  EXPECT_THAT(fault("<vertex x=\"0\" y=\"0\" z=\"0\"/>"), HasSubstr("<vertex> outside of an object"));
  EXPECT_THAT(fault(tetrahedron(), ""), HasSubstr("3D/3dmodel.model: its build shows no triangles"));
  EXPECT_THAT(fault(tetrahedron(), "<item objectid=\"3\"/>"),
              HasSubstr("names the object 3, which is not in"));
  EXPECT_THAT(fault(tetrahedron(), "<item objectid=\"1\" transform=\"1 0 0\"/>"),
              HasSubstr("transform has fewer than twelve numbers"));
  EXPECT_THAT(fault(tetrahedron(), "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 0 0 0 0\"/>"),
              HasSubstr("its transform flattens the object"));
  EXPECT_THAT(fault(tetrahedron(), shown_once, "unit=\"ell\""), HasSubstr(":2: unknown unit 'ell'"));
  EXPECT_THAT(fault(tetrahedron(), shown_once, "xmlns:b=\"http://b\" requiredextensions=\"b\""),
              HasSubstr("requires the extension 'http://b'"));
  EXPECT_THAT(complaint("a.3mf", package("<model/>")), HasSubstr("has no <model> of the 3MF core namespace"));
}

TEST_F(ThreemfFaces, NameAnExtensionInFull) {
  const std::string beams = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02";
  EXPECT_THAT(fault(tetrahedron(), shown_once, "xmlns:b=\"" + beams + "\" requiredextensions=\"b\""),
              HasSubstr("requires the extension '" + beams + "' (beam lattices)"));
  std::string unsaid = tetrahedron();
  unsaid.insert(unsaid.find("</mesh>"), "<b:beamlattice minlength=\"1\"><b:beams/></b:beamlattice>");
  EXPECT_THAT(fault(unsaid, shown_once, "xmlns:b=\"" + beams + "\""),
              HasSubstr("requires the extension '" + beams + "'"));
}

TEST_F(ThreemfFaces, AreWrittenAsTheyAreRead) {
  Product product = read_product(file("a.obj", test::square_obj + "f 1 2 3 4\n"));
  product.vertices.col(2) = Vector3(1 / 3.0f, -1e-20f, 12345.678f);
  for (const char* unit : {"", "mm", "inch", "m"}) {
    product.unit = unit;
    write_product(directory_ / "b.3mf", product);
    const Product again = read_product(directory_ / "b.3mf");
    EXPECT_EQ(again.vertices.cast<float>(), product.vertices.cast<float>());  // floats suffice here
    EXPECT_EQ(triangulated(again), triangulated(product));
    EXPECT_EQ(metres_per_unit(again.unit), metres_per_unit(*unit ? unit : "mm"));
    const std::string bytes = test::read_text(directory_ / "b.3mf");
    write_product(directory_ / "b.3mf", again);
    EXPECT_EQ(test::read_text(directory_ / "b.3mf"), bytes);
  }
  product.unit = "km";
  EXPECT_THAT(test::error_message<InvalidInput>([&] { write_product(directory_ / "c.3mf", product); }),
              HasSubstr("3MF has no name for the unit \"km\""));
  product.unit.clear();
  product.vertices *= 1 + 1e-9;  // too fine for floats about a middle far away
  product.vertices.colwise() += Vector3(1e6, 0, 0);
  write_product(directory_ / "d.3mf", product);
  EXPECT_EQ(read_product(directory_ / "d.3mf").vertices, product.vertices);
}

TEST_F(ThreemfFaces, OfPointsAloneAreNotWritten) {
  const Product points = read_product(file("a.obj", test::square_obj));
  EXPECT_THAT(test::error_message<InvalidInput>([&] { write_product(directory_ / "b.3mf", points); }),
              HasSubstr("3MF holds triangles only, and there are none"));
}

TEST_F(ThreemfFaces, AreWrittenWithTheSameBytesEveryTime) {
  const Product product = read_product(file("a.3mf", package(model_text(tetrahedron(), shown_once))));
  write_product(directory_ / "b.3mf", product);
  write_product(directory_ / "c.3mf", product);
  EXPECT_EQ(test::read_text(directory_ / "b.3mf"), test::read_text(directory_ / "c.3mf"));
}

TEST_F(ThreemfFaces, AreBoundedWhateverTheFileSays) {
  EXPECT_THAT(fault("<object id=\"1\"><components><component objectid=\"1\"/></components></object>"),
              HasSubstr("components nest too deep, or in a circle"));
  std::string doubling = tetrahedron();
  for (int id = 2; id < 50; ++id) {
    const std::string last = "<component objectid=\"" + std::to_string(id - 1) + "\"/>";
    doubling +=
        "<object id=\"" + std::to_string(id) + "\"><components>" + last + last + "</components></object>";
  }
  EXPECT_THAT(fault(doubling, "<item objectid=\"49\"/>"), HasSubstr("components show too many objects"));
  EXPECT_THAT(complaint("a.3mf", package(model_text(std::string(10'000'000, ' '), shown_once))),
              HasSubstr("3D/3dmodel.model would expand to 10000"));
  EXPECT_THAT(complaint("a.3mf", package("<!DOCTYPE model [<!ENTITY a \"b\">]>" + model_text("", ""))),
              HasSubstr("3D/3dmodel.model:1: has a document type"));
}

TEST_F(ThreemfFaces, OfDamagedArchivesAreRefused) {
  const std::string whole = package(model_text(tetrahedron(), shown_once));
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_THAT(complaint("a.3mf", whole.substr(0, size)), HasSubstr("a.3mf: is no ZIP archive, or cut off"));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const std::string found = complaint("a.3mf", damaged);
    EXPECT_TRUE(found == "accepted" || found.find("a.3mf: ") != std::string::npos) << found;
  }
  auto files = package_of(model_text(tetrahedron(), shown_once));
  EXPECT_THAT(complaint("a.3mf", zip_archive({files[1]})), HasSubstr("has no part '_rels/.rels'"));
  EXPECT_THAT(complaint("a.3mf", zip_archive({files[0]})), HasSubstr("has no part '3D/3dmodel.model'"));
  std::string stored = zip_archive(files, {.deflate = false});
  stored[stored.find("x=\"1\"") + 3] = '9';
  EXPECT_THAT(complaint("a.3mf", stored), HasSubstr("3D/3dmodel.model is damaged: CRC error"));
}

TEST_F(ThreemfFaces, HaveTheUnitThatTheFileSays) {
  const auto unit = [&](const std::string& attributes) {
    return unit_of_format(file("a.3mf", package(model_text(tetrahedron(), shown_once, attributes))));
  };
  EXPECT_EQ(unit(""), "mm");
  EXPECT_EQ(unit("unit=\"micron\""), "um");
  EXPECT_EQ(unit("unit=\"inch\""), "in");
  EXPECT_EQ(unit("unit=\"meter\""), "m");
  const auto refusal = [&](const std::string& anchors) {
    return test::error_message<InvalidInput>([&] { require_unit_of_format(directory_ / "a.3mf", anchors); });
  };
  unit("unit=\"centimeter\"");
  EXPECT_EQ(refusal("cm"), "accepted");
  EXPECT_EQ(refusal(""), "accepted");
  EXPECT_THAT(refusal("mm"), AllOf(HasSubstr("a.3mf: is in cm, as its file says, but the anchors are in mm"),
                                   HasSubstr("by 0.1 and say \"units\": \"cm\"")));
  EXPECT_THAT(refusal("ells"), HasSubstr("the anchors are in ells"));
}

}  // namespace
}  // namespace bespoke

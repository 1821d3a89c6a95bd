#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>

#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/asset/grids/grid_conversion.h"
#include "command/refusal.h"
#include "support/shapes.h"

// What the built command says of everything that it cannot use: one line, the file's name and the fault.
namespace bespoke::test {
namespace {

using testing::HasSubstr;

// ---- anchors

class BadAnchors : public testing::Test {
 protected:
  ProgramResult fit_with(const std::string& name, const std::string& content,
                         const std::vector<std::string>& extra = {}) const {
    write_text(pair_.file(name), content);
    std::vector<std::string> arguments{"fit",
                                       pair_.file("source.obj"),
                                       pair_.file("target.obj"),
                                       "--anchors",
                                       pair_.file(name),
                                       "-o",
                                       pair_.file("map.vdb"),
                                       "-q"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }
  void expect_refused(const std::vector<BadFile>& files) const {
    for (const BadFile& file : files) expect_refusal(fit_with(file.name, file.content), 2, file.message);
    EXPECT_FALSE(pair_.has("map.vdb"));
  }
  /// An anchor file whose pairs stand at the same points on both models.
  /// extra: of every pair, for instance ,"sigma":0.1
  static std::string json_of(const std::vector<Vector3>& points, const std::string& extra = "") {
    std::string pairs;
    for (const Vector3& p : points) {
      std::ostringstream point;
      point.precision(17);
      point << '[' << p.x() << ',' << p.y() << ',' << p.z() << ']';
      pairs += (pairs.empty() ? "" : ",") + ("{\"a\":" + point.str() + ",\"b\":" + point.str() + extra + "}");
    }
    return "{\"pairs\":[" + pairs + "]}";
  }

  ExamplePair pair_;
};

TEST_F(BadAnchors, Json) {
  const auto pairs = [](const std::string& pair) { return "{\"pairs\":[" + pair + "]}"; };
  expect_refused({
      {"a.json", "{", "a.json: not valid JSON"},
      {"a.json", "[]", "must be an object with a key \"pairs\""},
      {"a.json", "{}", "key \"pairs\" is missing"},
      {"a.json", R"({"pairs":{}})", "\"pairs\" is object, not an array"},
      {"a.json", R"({"units":7,"pairs":[]})", "\"units\" is number, not a string"},
      {"a.json", R"({"units":"c\nm","pairs":[]})", "holds a control character"},
      {"a.json", pairs("7"), "pair 0 is number, not an object"},
      {"a.json", pairs(R"({"name":7})"), "pair 0: \"name\" is number, not a string"},
      {"a.json", pairs("{\"name\":\"" + std::string(201, 'x') + "\"}"), "has 201 bytes, at most 200"},
      {"a.json", pairs(R"({"name":"p"})"), "pair 0 (\"p\"): key \"a\" is missing"},
      {"a.json", pairs(R"({"a":[0,0]})"), "\"a\" must be an array of three numbers"},
      {"a.json", pairs(R"({"a":[0,0,"x"]})"), "\"a\"[2] is string, not a number"},
      {"a.json", pairs(R"({"a":[0,0,0],"b":[0,0,0],"weight":0})"), "\"weight\" is 0, but must be > 0"},
      {"a.json", pairs(R"({"name":"p","a":[0,0,0],"b":[0,0,0]},{"name":"p","a":[0,0,1],"b":[0,0,0]})"),
       "two pairs are named \"p\""},
  });
}

TEST_F(BadAnchors, Csv) {
  expect_refused({
      {"a.csv", "\n", "a.csv: no rows"},
      {"a.csv", "p,0,0,0\n",
       "a.csv: line 1: 4 columns, but a row is name,ax,ay,az,bx,by,bz[,weight[,sigma]]"},
      {"a.csv", "p,0,0,0,0,x,0\n", "line 1: by is \"x\", not a finite number"},
      {"a.csv", "p,0,0,0,0,inf,0\n", "line 1: by is \"inf\", not a finite number"},
      {"a.csv", "p,0,0,0,0,0,0,-1\n", "line 1: weight is -1, but must be > 0"},
      {"a.csv", "p\x01,0,0,0,0,0,0\n", "holds a control character"},
  });
}

TEST_F(BadAnchors, NotAFile) {
  std::filesystem::create_directory(pair_.file("folder"));
  for (const char* name : {"folder", "none.json"})
    expect_refusal(bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors",
                            pair_.file(name), "-o", pair_.file("map.vdb"), "-q"}),
                   4, "cannot be opened for reading");
}

TEST_F(BadAnchors, ThatDoNotFixTheMap) {
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ(), o = Vector3::Zero();
  const std::string sigma = ",\"sigma\":0.1";  // else they are refused for lying beside the target
  expect_refusal(fit_with("a.json", json_of({})), 2,
                 "needs 3 anchor pairs that are not collinear; there are 0");
  expect_refusal(fit_with("a.json", json_of({o, x}, sigma)), 2, "there are 2");
  expect_refusal(fit_with("a.json", json_of({o, x, 2 * x}, sigma)), 2,
                 "the 3 anchor points on the source are collinear");
  expect_refusal(fit_with("a.json", json_of({o, o, o})), 2, "all at one place");
  expect_refusal(fit_with("a.json", json_of({o, o, o}, sigma)), 2, "all at one place");
  expect_refusal(fit_with("a.json", json_of({o, x, y}, sigma)), 2,
                 "the coarse warp needs 4 anchor pairs; there are 3");
  expect_refusal(fit_with("a.json", json_of({o, x, y, z, x}, sigma)), 2,
                 "pair 2 and pair 5 have the same place on the source; remove one");
  EXPECT_FALSE(pair_.has("map.vdb"));
}

TEST_F(BadAnchors, NamedAsTheCornersAre) {
  const std::string pairs =
      R"({"pairs":[{"name":"corner_011","a":[0,0,0],"b":[0,0,0]},{"a":[1,0,0],"b":[1,0,0]}]})";
  expect_refusal(fit_with("a.json", pairs, {"--add-corners"}), 2,
                 "an anchor is already named \"corner_011\"");
}

// ---- pairs of models

class BadPairs : public testing::Test {
 protected:
  ProgramResult fit_to(const std::string& fitted, const std::vector<std::string>& extra = {}) const {
    write_text(pair_.file("fitted.obj"), fitted);
    std::vector<std::string> arguments{"fit",
                                       pair_.file("source.obj"),
                                       pair_.file("target.obj"),
                                       "--fitted",
                                       pair_.file("fitted.obj"),
                                       "-o",
                                       pair_.file("map.vdb"),
                                       "-q"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  ExamplePair pair_;
};

TEST_F(BadPairs, AFittedSourceOfOtherConnectivity) {
  TriangleMesh fitted = shapes::icosphere(3);
  fitted.faces.col(5).swap(fitted.faces.col(6));
  expect_refusal(fit_to(obj_text(fitted.vertices, fitted.faces)), 2,
                 "face 5 of " + pair_.file("fitted.obj") + " has other vertices than the source's");
}

TEST_F(BadPairs, AMirrorImage) {
  const TriangleMesh sphere = shapes::icosphere(3);
  Points mirrored = read_obj_points(pair_.file("source.obj"));
  mirrored.row(0) *= -1;
  expect_refusal(fit_to(obj_text(mirrored, sphere.faces)), 2, "mirror it back first");
}

TEST_F(BadPairs, SourcesThatCannotBeInterpolated) {
  TriangleMesh flat = shapes::square_grid(5);
  write_text(pair_.file("source.obj"), obj_text(flat.vertices, flat.faces));
  expect_refusal(fit_to(obj_text(flat.vertices, flat.faces), {"--elastic", "csrbf"}), 2,
                 "csrbf: the sources are coplanar: none leaves their plane along (0, 0, 1)");
  // A needle: three points of a line.
  const std::string needle = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
  write_text(pair_.file("source.obj"), needle);
  expect_refusal(fit_to(needle), 2, "has no area");
}

TEST_F(BadPairs, ASourceWithoutArea) {
  write_text(pair_.file("source.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
  const auto fit = [&](const char* option, const char* method) {
    return bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors",
                    pair_.file("anchors.json"), "-o", pair_.file("map.vdb"), "-q", option, method});
  };
  expect_refusal(fit("--surface-fit", "deformation-graph"), 2, "source.obj has no area");
  expect_refusal(bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors",
                          pair_.file("anchors.json"), "-o", pair_.file("map.vdb"), "-q", "--surface-fit",
                          "laplacian", "--elastic", "pffd-smooth"}),
                 2, "source.obj has no area");
}

// ---- products

TEST(BadProducts, CannotBeWrittenInTheWantedFormat) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto apply = [&](const std::string& product, const char* out) {
    write_text(pair.file("in.obj"), product);
    return bespoke({"apply", pair.file("map.vdb"), pair.file("in.obj"), "-o", pair.file(out), "-q"});
  };
  expect_refusal(apply("v 0 0 0\nv 1 0 0\n", "out.stl"), 2, "STL holds triangles only, and there are none");
  // The map turns the axes, so that the largest float leaves its range.
  expect_refusal(apply("v 3.4e38 3.4e38 3.4e38\n", "out.ply"), 2, "not finite in single precision");
  EXPECT_FALSE(pair.has("out.stl"));
  EXPECT_FALSE(pair.has("out.ply"));
}

// ---- assets

class BadAssets : public testing::Test {
 protected:
  BadAssets() {
    EXPECT_EQ(pair_.fit("map.vdb", {"--voxel-size", "5%", "--keep-exact"}).exit_code, 0);
    sound_ = read_text(pair_.file("map.vdb"));
  }
  void expect_refused(const std::string& bytes, const std::string& text) const {
    write_text(pair_.file("bad.vdb"), bytes);
    for (const std::vector<std::string>& extra : {std::vector<std::string>{}, {"--untrusted"}}) {
      std::vector<std::string> arguments{"info", pair_.file("bad.vdb")};
      arguments.insert(arguments.end(), extra.begin(), extra.end());
      const ProgramResult result = bespoke(arguments);
      expect_refusal(result, 2, text);
      EXPECT_THAT(result.err, HasSubstr("bad.vdb"));
    }
  }

  ExamplePair pair_;
  std::string sound_;
};

TEST_F(BadAssets, DamagedOnTheWay) {
  expect_refused("", "not a bespoke asset");
  expect_refused(sound_.substr(0, sound_.size() / 2), "not a bespoke asset, or cut short");
  expect_refused(sound_ + "\n", "not a bespoke asset, or cut short");
  std::string changed = sound_;
  changed[sound_.size() / 3] ^= 1;
  expect_refused(changed, "SHA-256 does not match: the file was damaged or changed");
  // The trailer's fields: 8 bytes of magic, version, four of zero, two lengths, the digest.
  const std::size_t trailer = sound_.size() - trailer_size;
  changed = sound_;
  changed[trailer + 8] = 3;
  expect_refused(changed, "trailer version 3; this program reads versions 1 and 2");
  changed = sound_;
  changed[trailer + 12] = 1;
  expect_refused(changed, "trailer is damaged");
  changed = sound_;
  changed[trailer + 16] ^= 1;
  expect_refused(changed, "bytes long before its trailer, which says otherwise");
  expect_refused(std::string(unseal(sound_).vdb), "not a bespoke asset");
  expect_refusal(bespoke({"info", pair_.file("")}), 4, "not a regular file");
}

// Sealed anew after each change, so that only the reader's own checks stand in its way.
TEST_F(BadAssets, WellSealedButWrong) {
  const auto refuses = [&](const std::function<void(StoredFile&)>& spoil, const std::string& why) {
    StoredFile file = stored_file_from_vdb(unseal(sound_).vdb);
    spoil(file);
    expect_refused(seal({vdb_bytes(file), ""}), why);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  refuses([](StoredFile& f) { f.metadata.erase(version_key); }, "bespoke:format_version is missing");
  refuses([](StoredFile& f) { f.metadata[version_key] = std::int64_t{3}; },
          "format version 3; this program reads versions 1 and 2");
  refuses([](StoredFile& f) { f.metadata[version_key] = 1.0; }, "not a 64-bit integer");
  refuses([](StoredFile& f) { f.metadata.erase(record_key); }, "bespoke:record is missing");
  refuses([](StoredFile& f) { f.metadata[record_key] = std::string("{"); }, "the record is not JSON");
  refuses([](StoredFile& f) { f.metadata[record_key] = std::string(1000, '['); }, "nests deeper than");
  refuses([](StoredFile& f) { f.metadata[record_key] = std::string("{}"); }, "is missing");
  refuses([](StoredFile& f) { f.metadata.erase("bespoke:unit"); }, "bespoke:unit is missing");
  refuses([](StoredFile& f) { f.metadata["bespoke:unit"] = std::string("mile"); }, "contradicts the record");
  refuses([](StoredFile& f) { f.metadata["bespoke:more"] = 7.0; }, "unexpected metadata bespoke:more");
  refuses([](StoredFile& f) { std::swap(f.grids[0], f.grids[3]); }, "in the place of u_0");
  refuses([](StoredFile& f) { std::swap(f.grids[1], f.grids[2]); }, "in the place of source_distance");
  refuses([](StoredFile& f) { f.grids.resize(3); }, "3 grids, the record requires 4");
  refuses([](StoredFile& f) { f.grids[3] = f.grids[1], f.grids[3].name = "u_0"; }, "u_0 is no Vec3S grid");
  refuses([](StoredFile& f) { f.grids[3].voxel_size *= 2; }, "transform of grid u_0 contradicts the record");
  refuses([](StoredFile& f) { f.grids[3].background = 1; }, "background of grid u_0 is not 0");
  refuses([&](StoredFile& f) { f.grids[3].values[5] = nan; }, "not finite");
  refuses([&](StoredFile& f) { f.grids[0].values[5] = nan; }, "not finite");
  refuses([](StoredFile& f) { f.grids[0].leaves.clear(), f.grids[0].values.clear(); }, "holds no values");
  refuses([](StoredFile& f) { f.grids[1].grid_class = GridClass::unknown; }, "has the wrong class");
  refuses([](StoredFile& f) { f.grids[3].active.assign(f.grids[3].leaves.size(), LeafMask{}); },
          "inactive nodes");
  refuses(
      [](StoredFile& f) {
        f.grids[3].leaves.pop_back(), f.grids[3].values.resize(f.grids[3].leaves.size() * 3 * leaf_nodes);
      },
      "leaves, the record says");
}

TEST_F(BadAssets, WithAnExactMapThatIsNone) {
  const AssetSections sections = unseal(sound_);
  const std::string exact(sections.exact_map);
  const auto refuses = [&](const std::string& bytes, const std::string& why) {
    write_text(pair_.file("bad.vdb"), seal({sections.vdb, bytes}));
    expect_refusal(pair_.apply("bad.vdb", {"--exact", "-o", pair_.file("out.obj"), "-q"}), 2, why);
    EXPECT_FALSE(pair_.has("out.obj"));
  };
  ASSERT_EQ(exact.substr(0, 8), "BSPKEXCT");
  std::string other_version = exact, other_type = exact;
  other_version[8] = 7;
  other_type[12] = 7;
  refuses("EXACT MAP", "exact map: does not begin as one");
  refuses(exact.substr(0, exact.size() / 2), "the asset was damaged or written by another version");
  refuses(exact + "x", "exact map: 1 bytes too many");
  refuses(other_version, "exact map: version 7, only 1 is known");
  refuses(other_type, "exact map: unknown type 7");
}

}  // namespace
}  // namespace bespoke::test

#include "bespoke/product/gltf/document/gltf_json.h"

#include <gtest/gtest.h>

namespace bespoke {
namespace {

const std::string json_text = R"( {"a" : [ 1.50 , {"b": "x\"]" , "\u0063":[ ]}, 3],
  "d": {"e": 1e0, "f": [[1], [2]]} , "g":null } )";

std::string edited(const std::function<void(GltfJson&)>& edit) {
  const GltfJson before = GltfJson::parse(json_text);
  GltfJson now = before;
  edit(now);
  const std::string result = edited_json(json_text, before, now);
  EXPECT_EQ(GltfJson::parse(result), now) << result;
  return result;
}

std::string replaced(const std::string& old, const std::string& with) {
  std::string result = json_text;
  return result.replace(result.find(old), old.size(), with);
}

TEST(EditedJson, KeepsWhatIsTheSame) {
  EXPECT_EQ(edited([](GltfJson&) {}), json_text);
}

TEST(EditedJson, ReplacesSingleValues) {
  EXPECT_EQ(edited([](GltfJson& now) { now["a"][0] = 2; }), replaced("1.50", "2"));
  EXPECT_EQ(edited([](GltfJson& now) { now["a"][1]["b"] = "}"; }), replaced(R"("x\"]")", R"("}")"));
  EXPECT_EQ(edited([](GltfJson& now) { now["a"][1]["c"] = {1, 2}; }), replaced("[ ]", "[1,2]"));
  EXPECT_EQ(edited([](GltfJson& now) { now["d"]["f"][1][0] = 7; }), replaced("[2]", "[7]"));
  EXPECT_EQ(edited([](GltfJson& now) { now["g"] = true; }), replaced("null", "true"));
}

TEST(EditedJson, AppendsBehindTheLastElement) {
  EXPECT_EQ(edited([](GltfJson& now) { now["a"].push_back("new"); }), replaced(", 3]", ", 3,\"new\"]"));
  EXPECT_EQ(edited([](GltfJson& now) {
              now["a"][2] = 4;
              now["a"].push_back(5);
              now["a"].push_back(6);
            }),
            replaced(", 3]", ", 4,5,6]"));
}

TEST(EditedJson, WritesAnObjectWithOtherKeysAnew) {
  EXPECT_EQ(edited([](GltfJson& now) { now["d"].erase("e"); }),
            replaced(R"({"e": 1e0, "f": [[1], [2]]})", R"({"f":[[1],[2]]})"));
}

TEST(EditedJson, WritesAnObjectWithAKeyTwiceAnew) {
  const std::string twice = R"({"a": {"k": [1], "k": {"l": 2}}})";
  const GltfJson before = GltfJson::parse(twice);
  GltfJson now = before;
  now["a"]["k"]["l"] = 3;
  EXPECT_EQ(edited_json(twice, before, now), R"({"a": {"k":{"l":3}}})");
}

}  // namespace
}  // namespace bespoke

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class CatalogCommand : public testing::Test {
 protected:
  CatalogCommand() {
    std::filesystem::create_directories(file("maps/back"));
    EXPECT_EQ(pair_.fit("maps/forth.vdb").exit_code, 0);
    EXPECT_EQ(bespoke({"invert", file("maps/forth.vdb"), "-o", file("maps/back/map.vdb"), "-q"}).exit_code,
              0);
  }
  std::string file(const std::string& name) const { return pair_.file(name); }
  ProgramResult catalog() const { return bespoke({"catalog", file("maps")}); }
  ProgramResult apply(const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments{"apply", file("product.obj"), "--from", file("maps"),
                                       "-o",    file("out.obj")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  ExamplePair pair_;
};

TEST_F(CatalogCommand, FindsTheMapOfAProductsModel) {
  const ProgramResult made = catalog();
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("2 maps"));
  EXPECT_TRUE(pair_.has("maps/catalog.html"));
  const json index = json::parse(read_text(file("maps/catalog.json")));
  const std::string source = index["assets"][1]["source"]["hash"],
                    target = index["assets"][1]["target"]["hash"];
  EXPECT_EQ(index["assets"][1]["file"], "forth.vdb");
  EXPECT_EQ(index["assets"][0]["source"]["hash"], target);

  ASSERT_EQ(pair_.apply("maps/forth.vdb", {"-o", file("named.obj")}).exit_code, 0);
  const std::string named = read_text(file("named.obj"));
  for (const std::vector<std::string>& way :
       {std::vector<std::string>{"--source", file("source.obj")},
        {"--source-hash", source.substr(0, 8)},
        {"--source", file("source.obj"), "--target", file("target.obj")},
        {"--source-hash", source, "--target-hash", target}}) {
    const ProgramResult result = apply(way);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(read_text(file("out.obj")) == named);
    std::filesystem::remove(file("out.obj"));
  }
  write_text(file("jobs.jsonl"), json{{"command", "apply"},
                                      {"product", file("product.obj")},
                                      {"from", file("maps")},
                                      {"source", file("source.obj")},
                                      {"output", file("out.obj")}}
                                     .dump());
  const ProgramResult batch = bespoke({"batch", file("jobs.jsonl")});
  ASSERT_EQ(batch.exit_code, 0) << batch.err;
  EXPECT_TRUE(read_text(file("out.obj")) == named);
  EXPECT_THAT(bespoke({"batch", file("jobs.jsonl")}).err, HasSubstr("1 up to date"));
}

TEST_F(CatalogCommand, IsTheSameMadeAnew) {
  ASSERT_EQ(catalog().exit_code, 0);
  const std::string index = read_text(file("maps/catalog.json")), page = read_text(file("maps/catalog.html"));
  write_text(file("maps/catalog.json"), "damaged");
  std::filesystem::remove(file("maps/catalog.html"));
  ASSERT_EQ(bespoke({"catalog", file("maps"), "--threads", "1", "--untrusted", "-q"}).exit_code, 0);
  EXPECT_EQ(read_text(file("maps/catalog.json")), index);
  EXPECT_EQ(read_text(file("maps/catalog.html")), page);
}

TEST_F(CatalogCommand, NamesMapsThatAreDamaged) {
  std::string damaged = read_text(file("maps/forth.vdb"));
  damaged[damaged.size() / 2] ^= 1;
  write_text(file("maps/back/x.vdb"), damaged);
  const ProgramResult result = catalog();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr(file("maps/back/x.vdb") + ": "), HasSubstr("1 of 3 files")));
  EXPECT_EQ(json::parse(read_text(file("maps/catalog.json")))["assets"].size(), 2u);
  EXPECT_EQ(apply({"--source", file("source.obj")}).exit_code, 0);
}

TEST_F(CatalogCommand, SaysWhatItDoesNotFind) {
  EXPECT_THAT(apply({"--source", file("source.obj")}).err,
              HasSubstr("`bespoke catalog " + file("maps") + "`"));
  ASSERT_EQ(catalog().exit_code, 0);
  const ProgramResult unknown = apply({"--source", file("product.obj")});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("it has 2 maps"));
  EXPECT_EQ(apply({}).exit_code, 1);
  EXPECT_EQ(apply({"--source", file("source.obj"), "--source-hash", "aaaaaa"}).exit_code, 1);
  EXPECT_EQ(bespoke({"apply", file("maps/forth.vdb"), file("product.obj"), "-o", file("out.obj"), "--source",
                     file("source.obj")})
                .exit_code,
            1);
  EXPECT_EQ(bespoke({"apply", file("maps/forth.vdb"), "-o", file("out.obj")}).exit_code, 1);
  EXPECT_EQ(bespoke({"catalog", file("absent")}).exit_code, 4);
  EXPECT_FALSE(pair_.has("out.obj"));

  // Two maps of the same models, and one that is another since it was listed.
  ASSERT_EQ(pair_.fit("maps/finer.vdb", {"--tolerance", "0.4%"}).exit_code, 0);
  ASSERT_EQ(catalog().exit_code, 0);
  const ProgramResult two = apply({"--source", file("source.obj"), "--target", file("target.obj")});
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(two.err, AllOf(HasSubstr("finer.vdb"), HasSubstr("forth.vdb")));
  ASSERT_EQ(pair_.fit("maps/back/map.vdb").exit_code, 0);
  const ProgramResult changed = apply({"--source", file("target.obj")});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.err, HasSubstr("map.vdb: is not the file that"));
}

}  // namespace
}  // namespace bespoke::test

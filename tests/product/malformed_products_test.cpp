#include <gmock/gmock.h>

#include <chrono>
#include <random>
#include <vector>

#include "product/good_products.h"

namespace bespoke {
namespace {

using MalformedProducts = test::ProductFiles;
using test::good_products;
using test::GoodProduct;
using test::identity_motion;
using ::testing::HasSubstr;

/// One of the ways in which files are damaged.
std::string damaged(const std::string& good, int way, std::mt19937& random) {
  std::string text = good;
  const auto somewhere = [&](std::size_t size) { return std::size_t{random()} % size; };
  const std::size_t at = somewhere(text.size());
  switch (way % 6) {
    case 0:
      return text.substr(0, at);
    case 1:
      text[at] = static_cast<char>(text[at] ^ (1 << somewhere(8)));
      return text;
    case 2: {  // a word less
      const std::size_t begin = text.find_last_of(" \n,", at);
      if (begin == std::string::npos) return text.substr(at);
      return text.erase(begin, text.find_first_of(" \n,", begin + 1) - begin);
    }
    case 3: {  // a huge count or index
      const std::size_t begin = text.find_first_of("0123456789", at);
      if (begin == std::string::npos) return text.substr(0, at);
      return text.replace(begin, 1, way % 2 ? "99999999999999999999" : "4000000000");
    }
    case 4:  // a piece twice
      return text.insert(at, text.substr(at, 1 + somewhere(60)));
    default:  // a piece of nothing
      return text.replace(at, 1 + somewhere(16), std::string(1 + somewhere(16), way % 2 ? '\0' : '\xff'));
  }
}

// The identity shows what was carried: a file that is accepted comes out whole.
TEST_F(MalformedProducts, AreRefusedByNameOrCarriedWhole) {
  std::mt19937 random(20);
  int refused = 0, files = 0;
  for (const GoodProduct& good : good_products()) {
    EXPECT_EQ(carried(good.name, good.content, identity_motion()), good.content);
    for (int way = 0; way < 24; ++way, ++files) {
      const std::string bad = damaged(good.content, way, random);
      const auto start = std::chrono::steady_clock::now();
      try {
        EXPECT_EQ(carried(good.name, bad, identity_motion()), bad) << good.name << way;
      } catch (const FormatError& error) {
        EXPECT_THAT(error.what(), HasSubstr(good.name));
        ++refused;
      } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), HasSubstr(good.name));
        ++refused;
      }
      EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << good.name << way;
    }
  }
  EXPECT_GT(refused, files / 2);
}

}  // namespace
}  // namespace bespoke

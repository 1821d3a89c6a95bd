#include "bespoke/base64.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace bespoke {
namespace {

// RFC 4648, section 10.
const std::array<std::pair<std::string, std::string>, 7> vectors{{{"", ""},
                                                                  {"f", "Zg=="},
                                                                  {"fo", "Zm8="},
                                                                  {"foo", "Zm9v"},
                                                                  {"foob", "Zm9vYg=="},
                                                                  {"fooba", "Zm9vYmE="},
                                                                  {"foobar", "Zm9vYmFy"}}};

TEST(Base64, HasTheVectorsOfItsStandard) {
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(base64(bytes), text);
    EXPECT_EQ(bytes_of_base64(text), bytes);
    EXPECT_EQ(bytes_of_base64(text.substr(0, text.find('='))), bytes) << "without padding";
  }
}

TEST(Base64, ComesBackForEveryByteAndLength) {
  std::string bytes;
  for (int i = 0; i < 600; ++i) {
    bytes += static_cast<char>(i * 7);
    EXPECT_EQ(bytes_of_base64(base64(bytes)), bytes);
  }
}

TEST(Base64, RefusesWhatIsNone) {
  for (const char* text :
       {"Zg*=", "Z", "Zm9vY", "Zm9v YmFy", " Zm9v", "Zm9v\n", "Zm9vZg--", "Zg==Zg==", "Z=9v", "Zm\xc3\xa4"})
    EXPECT_EQ(bytes_of_base64(text), std::nullopt) << text;
}

}  // namespace
}  // namespace bespoke

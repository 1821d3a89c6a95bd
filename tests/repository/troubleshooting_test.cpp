#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <string>

#include "../../tools/bespoke/troubleshooting.h"
#include "support/file_text.h"

namespace bespoke {
namespace {

using ::testing::Contains;

/// What a link to the heading says after its #: lower case, hyphens for spaces, nothing else but letters.
std::string link_of(const std::string& heading) {
  std::string link;
  for (const unsigned char letter : heading)
    if (letter == ' ' || letter == '-')
      link += '-';
    else if (std::isalnum(letter))
      link += static_cast<char>(std::tolower(letter));
  return link;
}

std::multiset<std::string> links(const std::string& page) {
  std::multiset<std::string> found;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("### ")) found.insert(link_of(line.substr(4)));
  return found;
}

TEST(Troubleshooting, HasOneEntryForEveryOneThatAWarningNames) {
  const auto found =
      links(test::read_text(std::string(BESPOKE_SOURCE_DIR) + "/samples/cookbook/troubleshooting.md"));
  for (const auto& entry : command::entries)
    EXPECT_EQ(found.count(std::string(entry.name)), 1u) << entry.name;
}

TEST(Troubleshooting, LinksAreThoseOfHeadings) {
  EXPECT_THAT(links("# Page\n### Target uncovered\ntext\n"), Contains("target-uncovered"));
  EXPECT_EQ(links("## Target uncovered\n").size(), 0u);
  EXPECT_EQ(command::with_entry("it folds", command::Entry::not_proved),
            "it folds (see troubleshooting.md#not-proved)");
}

}  // namespace
}  // namespace bespoke

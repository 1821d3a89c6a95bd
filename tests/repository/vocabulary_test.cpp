#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "support/file_text.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;

/// A word that the field does not use, what it uses instead, and the files in which it means something else.
struct Word {
  std::string pattern;  ///< regular expression over lower-case text, of whole words
  std::string instead;
  std::vector<std::string> places;  ///< beginnings of paths
};

const std::vector<Word> words = {
    {"laid(?! out)|lays? (the|a|its) source|laying", "registered; placed", {}},
    {"slip(s|ped)?", "outlier; displaced", {}},
    {"disown\\w*|disavow\\w*", "reject", {}},
    {"stands? (by|out of)", "with a given sigma; outside", {}},
    {"linings?", "cavity", {}},
    {"leeway", "outlier scale gain", {}},
    {"crumpled", "folded, flipped", {}},
    {"turn(s|ed)? over", "flipped", {}},
    {"tak(en|es|e) back", "reset; reinstate", {}},
    {"drawn too far", "over-stretched", {}},
    {"h(e|o)lds? apart|held apart", "separated", {}},
    {"octaves?", "power-of-two scale", {}},
    {"for want of", "without enough, insufficient", {}},
    {"but for", "except", {}},
    {"heed(s|ed)?|unheeded", "supported, applicable", {}},
    {"shall not", "must not", {}},
    {"let be", "skipped", {}},
    {"there and back", "round trip", {}},
    {"way back", "inverse", {}},
    {"way through", "pipeline", {}},
    {"laws?", "property, contract", {}},
    {"mend(s|ed|ing)?", "repair", {}},
    {"bare", "uncovered", {}},
    {"rims?", "level boundary", {"samples/"}},  // of frames, sockets and shoes
    {"ask(s|ed)? for", "requires, requested", {}},
    {"asks|asked", "requires, queried", {}},
    {"answers?|answered", "returns, result", {}},
    {"speaks? for|silence", "sample weight", {}},
    {"claims?|claimed", "reciprocal correspondence", {"src/bespoke/asset/asset.cpp"}},  // of a damaged file
    {"rooms?(?! for| of)", "module", {}},
    {"from nothing", "clean build", {}},
    {"contact gap|contact-gap", "contact offset", {"CHANGELOG.md"}},
    {"unrated|rated", "with an estimated sigma", {}},
    {"most_\\w+|least_(?!squares|determinant)\\w+", "max_, min_", {}},
};

/// Words of code, comments and names alike.
const std::vector<Word> code_words = {
    {"\\w*claim(s|ed)?\\w*", "reciprocal correspondence, back distance", {"src/bespoke/asset/asset.cpp"}},
    {"asking|\\w+_asked(_\\w+)?|asked_\\w+|asks_\\w+", "query, queried, required", {}},
    {"answers?|answered|\\w+_answers?", "result, reply, returns", {}},
    {"\\w*hopeless\\w*|\\w*hopeful\\w*", "unusable; early exit", {}},
    {"rooms?|\\w+_room|room_\\w+", "module; space", {}},
    {"laid(?!_out| out)\\w*|\\w+_laid|lay_source", "registered; placed", {}},
    {"octaves?|\\w*_octave\\w*|octave_\\w+", "power-of-two scale", {}},
    {"\\w*leeways?\\w*", "outlier scale gain", {}},
    {"linings?|\\w+_linings?", "cavities", {}},
    {"crumpl\\w*", "folded, flipped", {}},
    {"held_apart|taken_back|drawn_too_far", "separated; reset; over-stretched", {}},
    // Keys of the record keep their names: mended_vertices, mend_models.
    {"mend|mends|mending|mended", "repair", {}},
    {"most_\\w+|least_(?!squares|determinant)\\w+", "max_, min_", {}},
};

const fs::path root = BESPOKE_SOURCE_DIR;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Files below a folder with one of the endings, by path; nothing that is built or installed there.
std::vector<fs::path> files(const fs::path& folder, const std::vector<std::string>& endings) {
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator entry(folder), end; entry != end; ++entry) {
    const std::string name = entry->path().filename();
    if (name == "node_modules" || name == "build" || name.starts_with('.'))
      entry.disable_recursion_pending();
    else if (std::find(endings.begin(), endings.end(), entry->path().extension()) != endings.end())
      found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool begins_with_one_of(const std::string& text, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](const std::string& beginning) { return text.starts_with(beginning); });
}

std::size_t line_of(const std::string& text, std::size_t place) {
  return 1 + static_cast<std::size_t>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

/// "path:line: word, the field's is …" for every word of the list in a text.
std::vector<std::string> found_words(const std::string& file, const std::string& text,
                                     const std::vector<Word>& list = words) {
  std::string any;
  for (const Word& word : list) any += (any.empty() ? "" : "|") + word.pattern;
  const std::regex expression("\\b(" + any + ")\\b", std::regex::optimize);
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match) {
    for (const Word& word : list) {
      if (!std::regex_match(match->str(), std::regex(word.pattern))) continue;
      if (!begins_with_one_of(file, word.places))
        found.push_back(file + ":" + std::to_string(line_of(text, match->position())) + ": \"" +
                        match->str() + "\", better: " + word.instead);
      break;
    }
  }
  return found;
}

/// The string literals of code that are sentences, messages and help, in their lines.
std::string sentences(const std::string& text) {
  static const std::regex literal("//[^\n]*|\n|\"((?:\\\\.|[^\"\\\\\n])*)\"");
  std::string result;
  for (std::sregex_iterator match(text.begin(), text.end(), literal), end; match != end; ++match) {
    if (match->str() == "\n")
      result += '\n';
    else if ((*match)[1].matched && match->str(1).find(' ') != std::string::npos)
      result += match->str(1) + ' ';
  }
  return result;
}

/// One line a word; empty when all is well.
std::string found_in(const std::vector<fs::path>& paths, bool of_code = false) {
  std::string found;
  for (const fs::path& path : paths) {
    const std::string file = fs::relative(path, root), text = test::read_text(path);
    for (const std::string& each : found_words(file, lower(of_code ? sentences(text) : text)))
      found += each + "\n";
  }
  return found;
}

TEST(Vocabulary, OfPagesIsTheFields) { EXPECT_EQ(found_in(files(root, {".md"})), ""); }

TEST(Vocabulary, OfPublicHeadersIsTheFields) {
  std::vector<fs::path> headers = files(root / "src" / "bespoke", {".h"});
  std::erase_if(headers, [](const fs::path& path) { return path.parent_path().filename() == "detail"; });
  ASSERT_GT(headers.size(), 100u);
  EXPECT_EQ(found_in(headers), "");
}

TEST(Vocabulary, OfMessagesAndHelpIsTheFields) {
  std::vector<fs::path> sources;
  for (const char* folder : {"src/bespoke", "src/python", "tools/bespoke"})
    for (const fs::path& path : files(root / folder, {".h", ".cpp"})) sources.push_back(path);
  EXPECT_EQ(found_in(sources, true), "");
}

TEST(Vocabulary, OfPythonIsTheFields) {
  EXPECT_EQ(found_in(files(root / "src" / "python", {".py", ".pyi"})), "");
}

TEST(Vocabulary, OfNamesInCodeIsTheFields) {
  std::string found;
  std::size_t read = 0;
  for (const char* folder : {"src", "tools", "tests", "samples"})
    for (const fs::path& path : files(root / folder, {".h", ".cpp", ".py", ".pyi", ".ts"})) {
      if (path.filename() == "vocabulary_test.cpp") continue;
      ++read;
      for (const std::string& each :
           found_words(fs::relative(path, root), lower(test::read_text(path)), code_words))
        found += each + "\n";
    }
  EXPECT_GT(read, 800u);
  EXPECT_EQ(found, "");
}

TEST(Vocabulary, SeesWordsInNames) {
  const std::string code =
      "int nearer_claim, claimed_share, is_asked_at_rest, claimed_as_far_as_asked;\n"
      "hopeless_fit(asking, room, laid_source);\nint laid_out, space, least_squares;\n";
  const std::vector<std::string> found = found_words("src/a.cpp", code, code_words);
  EXPECT_EQ(found.size(), 8u);
}

TEST(Vocabulary, SeesWordsInSentencesAlone) {
  EXPECT_EQ(found_words("page.md", "the source is laid onto the target\n").size(), 1u);
  EXPECT_EQ(found_words("page.md", "values are laid out in order; a sentence about claims").size(), 1u);
  EXPECT_THAT(found_words("samples/frame.md", "the rim of a frame"), IsEmpty());
  const std::string code = "// laid\nfail(\"the source is laid\"); key(\"laid\");\n";
  EXPECT_EQ(found_words("a.cpp", sentences(code)),
            std::vector<std::string>{"a.cpp:2: \"laid\", better: registered; placed"});
}

}  // namespace
}  // namespace bespoke

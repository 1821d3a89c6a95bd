#include <optional>
#include <random>
#include <sstream>

#include "product/product_files.h"
#include "product/text_dialects.h"

namespace bespoke {
namespace {

using Numbers = std::vector<std::array<std::string, 3>>;

/// A product as one program writes it. The same seed writes the same text but for the numbers.
class Writer {
 public:
  /// Without a seed plain: single blanks and LF.
  Writer(std::string ending, const Numbers& points, std::optional<unsigned> seed)
      : ending_(std::move(ending)), points_(points), is_odd_(seed), random_(seed.value_or(0)) {}

  std::string text() {
    separator_ = ending_ == ".csv"   ? pick({",", ";", "\t"})
                 : ending_ == ".xyz" ? pick({" ", ",", ";", "\t "})
                                     : " ";
    has_commas_ = (ending_ == ".csv" || ending_ == ".xyz") && separator_ != "," && chance(2);
    line_break_ = pick({"\n", "\r\n", "\r", ""});
    if (chance(3)) text_ += test::bom;
    if (ending_ == ".obj") write_obj();
    if (ending_ == ".off") write_off();
    if (ending_ == ".ply") write_ply();
    if (ending_ == ".stl") write_stl();
    if (ending_ == ".xyz") write_rows();
    if (ending_ == ".csv") write_csv();
    return text_;
  }

 private:
  /// One time of n, where the text may be odd.
  bool chance(unsigned n) {
    const bool is = random_() % n == 0;
    return is_odd_ && is;
  }
  std::string pick(const std::vector<std::string>& choices) {
    const std::size_t chosen = random_() % choices.size();
    return is_odd_ ? choices[chosen] : choices.front();
  }
  std::string number(const std::string& digits) const {
    return has_commas_ ? test::with_each(digits, '.', ",") : digits;
  }

  /// Words of a line, and how it ends.
  void line(const std::vector<std::string>& words) {
    const bool may_comment = ending_ == ".obj" || ending_ == ".off" || ending_ == ".xyz";
    if (ending_ != ".csv") text_ += pick({"", "", "", " ", "\t"});
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (i > 0) text_ += between();
      text_ += words[i];
    }
    if (ending_ != ".csv") text_ += pick({"", "", " ", "\t"});
    if (may_comment) text_ += pick({"", "", "", " # v 1 2 3", " # f 1 2"});
    text_ += line_break_.empty() ? pick({"\n", "\r\n", "\r"}) : line_break_;
    if (ending_ != ".ply" || !in_header_) text_ += pick({"", "", "", "", line_break_});
  }
  std::string between() {
    if (ending_ == ".csv") return separator_ + pick({"", "", " "});
    if (separator_ == "," || separator_ == ";") return separator_ + pick({"", " "});
    std::string blanks = pick({" ", " ", "\t", "  ", " \t "});
    if (ending_ == ".obj" && chance(8)) blanks += pick({"\\\n", "\\\r\n", "\\\r"});
    return blanks;
  }
  std::vector<std::string> point(std::size_t i) const {
    return {number(points_[i][0]), number(points_[i][1]), number(points_[i][2])};
  }
  static std::vector<std::string> joined(std::vector<std::string> words,
                                         const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  void write_rows() {
    for (std::size_t i = 0; i < points_.size(); ++i) line(point(i));
  }
  void write_faces(const std::string& count) {
    for (std::size_t i = 0; i + 2 < points_.size(); ++i)
      line({count, std::to_string(i), std::to_string(i + 1), std::to_string(i + 2)});
  }
  void write_obj() {
    for (std::size_t i = 0; i < points_.size(); ++i) line(joined({"v"}, point(i)));
    const auto count = static_cast<long>(points_.size());
    for (long i = 1; i + 2 <= count; ++i) {
      const std::string parts = pick({"", "", "//", "/"});
      const bool counts_back = chance(3);
      const bool is_degenerate = chance(6);
      std::vector<std::string> words{"f"};
      for (const long corner : {i, i + 1, i + 2})
        words.push_back(std::to_string(counts_back ? corner - count - 1 : corner) + parts);
      if (is_degenerate) words.push_back(words.back());
      line(words);
    }
    line({"l", "1", "2"});
  }
  void write_off() {
    line({"OFF"});
    line({std::to_string(points_.size()), std::to_string(points_.size() - 2), "0"});
    write_rows();
    write_faces("3");
  }
  void write_ply() {
    in_header_ = true;
    text_ += "ply" + (line_break_.empty() ? "\n" : line_break_);
    line({"format", "ascii", "1.0"});
    line({"element", "vertex", std::to_string(points_.size())});
    for (const char* axis : {"x", "y", "z"}) line({"property", "double", axis});
    line({"element", "face", std::to_string(points_.size() - 2)});
    line({"property", "list", "uchar", "int", "vertex_indices"});
    line({"end_header"});
    in_header_ = false;
    write_rows();
    write_faces("3");
  }
  void write_stl() {
    line({"solid", "a"});
    for (std::size_t i = 0; i + 2 < points_.size(); i += 3) {
      line({"facet", "normal", "0", "0", "0"});
      line({"outer", "loop"});
      for (std::size_t k = i; k < i + 3; ++k) line(joined({"vertex"}, point(k)));
      line({"endloop"});
      line({"endfacet"});
    }
    line({"endsolid"});
  }
  void write_csv() {
    line({"name", "x", "y", "z"});
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::vector<std::string> words{pick({"chin", "", "\"ear, left; \"\"a\"\"\""})};
      for (const std::string& own : point(i)) words.push_back(chance(4) ? "\"" + own + "\"" : own);
      line(words);
    }
  }

  std::string ending_;
  const Numbers& points_;
  bool is_odd_;
  std::mt19937 random_;
  std::string separator_, line_break_, text_;
  bool has_commas_ = false, in_header_ = false;
};

/// Numbers as programs spell them, never all whole.
Numbers random_numbers(std::mt19937& random) {
  Numbers numbers(3 + 3 * (random() % 4));
  for (auto& point : numbers)
    for (std::string& number : point) {
      const int value = static_cast<int>(random() % 4001) - 2000;
      const std::array spellings{std::to_string(value / 100) + "." + std::to_string(std::abs(value) % 100),
                                 std::to_string(0.001 * value), std::to_string(value % 10) + ".5e-1",
                                 "+" + std::to_string(std::abs(value)) + ".25"};
      number = spellings[random() % spellings.size()];
    }
  return numbers;
}

/// The first three words behind the keyword of every line of points in a plain text.
Numbers numbers_of(const std::string& ending, const std::string& text, std::size_t count) {
  std::istringstream lines(text);
  Numbers numbers;
  bool is_body = ending == ".xyz";
  for (std::string line; numbers.size() < count && std::getline(lines, line);) {
    std::istringstream words(test::with_each(line, ',', " "));
    const bool has_keyword = ending == ".obj" || ending == ".stl" || ending == ".csv";
    std::string keyword;
    if (has_keyword) words >> keyword;
    const bool is_point = ending == ".obj"   ? keyword == "v"
                          : ending == ".stl" ? keyword == "vertex"
                                             : is_body;
    if (line == "end_header" || line.ends_with(" 0") || line.starts_with("name")) is_body = true;
    if (!is_point) continue;
    numbers.emplace_back();
    for (std::string& number : numbers.back()) words >> number;
  }
  return numbers;
}

class RandomDialects : public test::ProductFiles, public ::testing::WithParamInterface<const char*> {};

TEST_P(RandomDialects, AreCarriedAsThePlainOne) {
  const std::string ending = GetParam(), name = "a" + ending;
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const Numbers points = random_numbers(random);
    const std::string odd = Writer(ending, points, seed).text(), plain = Writer(ending, points, {}).text();
    ASSERT_EQ(carried(name, odd, test::identity_motion()), odd) << seed;
    const std::string bent = carried(name, plain, test::bend_motion());
    const Numbers expected = numbers_of(ending, bent, points.size());
    ASSERT_EQ(carried(name, odd, test::bend_motion()), Writer(ending, expected, seed).text()) << seed << "\n"
                                                                                              << odd;
    EXPECT_EQ(summary_.points, points.size());
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryFormat, RandomDialects,
                         ::testing::Values(".obj", ".off", ".ply", ".stl", ".xyz", ".csv"));

}  // namespace
}  // namespace bespoke

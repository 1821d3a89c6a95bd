#include "bespoke/product/text/text_edits.h"

#include <algorithm>

namespace bespoke {
namespace {

// A number may carry more decimals than a double of its size can tell apart.
constexpr int max_decimals = 400;

template <class Edit, class Begin>
void sort_by(std::vector<Edit>& edits, const Begin& begin) {
  const auto before = [&](const Edit& a, const Edit& b) { return begin(a) < begin(b); };
  if (!std::is_sorted(edits.begin(), edits.end(), before)) std::sort(edits.begin(), edits.end(), before);
}

}  // namespace

Points values(const std::vector<NumberTriple>& triples) {
  Points points(3, static_cast<Eigen::Index>(triples.size()));
  for (std::size_t i = 0; i < triples.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)) = triples[i][axis].value;
  return points;
}

void add_edits(const std::vector<NumberTriple>& triples, const Points& moved, int decimals,
               std::vector<NumberEdit>& edits) {
  for (std::size_t i = 0; i < triples.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const NumberText& number = triples[i][axis];
      edits.push_back({number, moved(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)),
                       std::min(std::max<int>(decimals, number.decimals), max_decimals)});
    }
}

std::string edited(std::string_view text, std::vector<NumberEdit> numbers, std::vector<TextEdit> texts) {
  sort_by(numbers, [](const NumberEdit& edit) { return edit.number.begin; });
  sort_by(texts, [](const TextEdit& edit) { return edit.old.data(); });
  std::string result;
  result.reserve(text.size() + 4 * numbers.size());
  const char* at = text.data();
  const char* const end = at + text.size();
  auto next = texts.begin();
  const auto replace_texts_before = [&](const char* limit) {
    for (; next != texts.end() && next->old.data() < limit; ++next) {
      result.append(at, next->old.data()).append(next->text);
      at = next->old.data() + next->old.size();
    }
  };
  for (const NumberEdit& edit : numbers) {
    replace_texts_before(edit.number.begin);
    if (stays(edit.number.value, edit.value, edit.decimals)) continue;
    result.append(at, edit.number.begin);
    const std::size_t begin = result.size();
    append_number(result, edit.value, edit.decimals);
    if (edit.point != '.')
      std::replace(result.begin() + static_cast<std::ptrdiff_t>(begin), result.end(), '.', edit.point);
    at = edit.number.begin + edit.number.length;
  }
  replace_texts_before(end);
  return result.append(at, end);
}

}  // namespace bespoke

#include "bespoke/product/obj/obj_statements.h"

#include "bespoke/text_lines.h"

namespace bespoke {

ObjStatement obj_statement(std::string_view keyword) {
  if (keyword.size() == 1) {
    switch (keyword[0]) {
      case 'v':
        return ObjStatement::position;
      case 'f':
        return ObjStatement::face;
      case 'l':
        return ObjStatement::line;
      case 'p':
        return ObjStatement::point;
    }
    return ObjStatement::other;
  }
  if (keyword == "vt") return ObjStatement::texture;
  if (keyword == "vn") return ObjStatement::normal;
  if (keyword == "fo") return ObjStatement::face;  // what old programs call a face
  if (keyword == "vp" || keyword == "curv" || keyword == "curv2" || keyword == "surf")
    return ObjStatement::free_form;
  return ObjStatement::other;
}

namespace {

/// As TextWords reads lines, which is slower.
void count_word_by_word(std::string_view lines, std::array<std::uint64_t, 3>& sums) {
  TextBlock block;
  block.bytes = lines;
  const std::filesystem::path unnamed;
  TextWords words(block, unnamed, obj_syntax);
  while (words.next_line()) {
    if (*words.line_begin() != 'v') continue;
    switch (obj_statement(words.word())) {
      case ObjStatement::position:
        ++sums[0];
        break;
      case ObjStatement::texture:
        ++sums[1];
        break;
      case ObjStatement::normal:
        ++sums[2];
        break;
      default:
        break;
    }
  }
}

/// Whether a word is over before this character.
bool ends_word(const char* at, const char* end) {
  return at == end || static_cast<unsigned char>(*at) <= ' ' || *at == '\\' || *at == '#';
}

/// To the line's first word, or to its line break.
void skip_blanks(const char*& at, const char* end) {
  while (at != end && *at != '\n' && *at != '\r' && static_cast<unsigned char>(*at) <= ' ') ++at;
}

/// Behind the line break of the line at hand, or of the last one that it goes on in.
const char* behind_statement(const char* at, const char* end, bool may_continue) {
  while (at != end) {
    const char* const found = line_break(at, end);
    const bool goes_on = may_continue && found != at && found[-1] == '\\';
    at = behind_line_break(found, end);
    if (!goes_on) break;
  }
  return at;
}

}  // namespace

// A file's lines are counted in order, so every other thread waits for this.
void count_obj(std::string_view lines, std::array<std::uint64_t, 3>& sums) {
  const char* at = lines.data();
  const char* const end = at + lines.size();
  while (at != end) {
    const char* const begin = at;
    skip_blanks(at, end);
    if (std::string_view(at, static_cast<std::size_t>(end - at)).starts_with(byte_order_mark)) {
      at += byte_order_mark.size();
      skip_blanks(at, end);
    }
    if (at != end && *at == '\\')  // a statement that begins on the next line
      return count_word_by_word({begin, static_cast<std::size_t>(end - begin)}, sums);
    if (at != end && *at == 'v') {
      if (ends_word(at + 1, end))
        ++sums[0];
      else if (at[1] == 't' && ends_word(at + 2, end))
        ++sums[1];
      else if (at[1] == 'n' && ends_word(at + 2, end))
        ++sums[2];
    }
    at = behind_statement(at, end, at == end || *at != '#');
  }
}

std::optional<ObjCorner> read_corner(std::string_view word) {
  constexpr std::ptrdiff_t max_digits = 18;  // which a long long holds
  ObjCorner corner;
  const char* at = word.data();
  const char* const end = at + word.size();
  for (std::size_t kind = 0; kind < 3; ++kind) {
    const char* const begin = at;
    const bool counts_back = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    const char* const digits = at;
    long long& index = corner.index[kind];
    for (; at != end && *at >= '0' && *at <= '9'; ++at) {
      if (at - digits == max_digits) return std::nullopt;
      index = 10 * index + (*at - '0');
    }
    if (counts_back) index = -index;
    const bool is_left_out = kind > 0 && at == begin;
    if (index == 0 && !is_left_out) return std::nullopt;
    if (kind == 2) corner.normal = {begin, static_cast<std::size_t>(at - begin)};
    if (at == end) return corner;
    if (*at != '/') return std::nullopt;
    ++at;
  }
  return std::nullopt;
}

NumberTriple read_triple(TextWords& words) {
  return {words.number("x"), words.number("y"), words.number("z")};
}

}  // namespace bespoke

#include "page_output.h"

#include <algorithm>
#include <cctype>

#include "bespoke/error.h"
#include "bespoke/page/page_file.h"
#include "page_template.h"

namespace bespoke::command {
namespace {

std::vector<std::string>& arguments() {
  static std::vector<std::string> words;
  return words;
}

std::string quoted(const std::string& word) {
  const bool is_plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char letter) {
    return std::isalnum(letter) ||
           std::string("-_./%=:,+").find(static_cast<char>(letter)) != std::string::npos;
  });
  if (is_plain) return word;
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

}  // namespace

bool has_pages() { return !page_template().empty(); }

void require_pages() {
  if (!has_pages())
    throw FileError(
        "this bespoke was built without its pages, which need npm: install it (tools/setup --pages), "
        "configure "
        "and build again; `bespoke report` needs none");
}

std::string whole_page(const std::string& scene) {
  return page_with_scene(std::string(page_template()), scene);
}

void remember_arguments(int argc, const char* const* argv) { arguments().assign(argv + 1, argv + argc); }

std::string command_text(const std::vector<std::string>& arguments) {
  std::string text = "bespoke";
  for (const std::string& word : arguments) text += " " + quoted(word);
  return text;
}

std::string typed_command() { return command_text(arguments()); }

}  // namespace bespoke::command

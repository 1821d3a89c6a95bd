#include "nearest_name.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace bespoke::command {
namespace {

// Of two words that differ in more than a third of their letters, one is hardly the other mistyped.
constexpr std::size_t letters_per_mistake = 3;

// So many letters without the dashes are enough of a beginning.
constexpr std::size_t min_beginning = 3;

std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = std::exchange(last, row);
  }
  return last[b.size()];
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' &&
         (std::isalpha(static_cast<unsigned char>(word[1])) || (word[1] == '-' && word.size() > 2));
}

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  const std::string letters = word.substr(std::min(word.find_first_not_of('-'), word.size()));
  const std::string* nearest = nullptr;
  std::size_t least = letters.size() / letters_per_mistake + 1;
  for (const std::string& name : names) {
    const std::string other = name.substr(std::min(name.find_first_not_of('-'), name.size()));
    const bool begins = letters.size() >= min_beginning && other.starts_with(letters);
    const std::size_t mistakes = begins ? 0 : distance(letters, other);
    if (mistakes >= least) continue;
    least = mistakes;
    nearest = &name;
  }
  return nearest ? " (did you mean " + *nearest + "?)" : "";
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

void require_known_subcommands(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> known = command->get_subcommands([](const CLI::App*) { return true; });
    if (known.empty() || word.starts_with('-')) return;
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const CLI::App* subcommand) { return subcommand->check_name(word); });
    if (found == known.end()) {
      std::vector<std::string> names;
      for (const CLI::App* subcommand : known) names.push_back(subcommand->get_name());
      throw CLI::ParseError("there is no subcommand '" + word + "'" + suggestion(word, names),
                            CLI::ExitCodes::ExtrasError);
    }
    command = *found;
  }
}

std::string explanation(const CLI::App& command, const CLI::ParseError& error) {
  for (const std::string& word : command.remaining()) {
    if (!is_option(word)) continue;
    const std::string name = word.substr(0, word.find('='));
    return "there is no option " + name + suggestion(name, option_names(command));
  }
  return error.what();
}

}  // namespace bespoke::command

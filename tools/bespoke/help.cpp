#include "help.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>
#include <vector>

namespace bespoke::command {
namespace {

constexpr std::size_t help_width = 80;  // columns of a terminal as it opens
constexpr std::size_t name_width = 24;  // columns before an explanation
constexpr const char* other_group = "Options";

/// Characters, not bytes, of UTF-8.
std::size_t help_columns(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
}

/// The text in lines of the width, broken at spaces, each after the first behind the indent.
std::string help_lines(const std::string& text, std::size_t indent) {
  std::istringstream words(text);
  std::string lines;
  std::size_t column = indent;
  for (std::string word; words >> word;) {
    const bool is_first = column == indent;
    if (!is_first && column + 1 + help_columns(word) > help_width) {
      lines += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (!is_first) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += help_columns(word);
  }
  return lines + '\n';
}

std::string help_row(const std::string& name, const std::string& explanation) {
  const std::string start = "  " + name;
  const std::size_t used = help_columns(start);
  const std::string gap =
      used + 2 > name_width ? '\n' + std::string(name_width, ' ') : std::string(name_width - used, ' ');
  return start + (explanation.empty() ? "\n" : gap + help_lines(explanation, name_width));
}

/// A group's arguments before its options.
std::vector<const CLI::Option*> group_members(const CLI::App& app, const std::string& group) {
  std::vector<const CLI::Option*> options =
      app.get_options([&](const CLI::Option* option) { return option->get_group() == group; });
  std::stable_partition(options.begin(), options.end(),
                        [](const CLI::Option* option) { return option->get_positional(); });
  return options;
}

class GroupedHelp : public CLI::Formatter {
 public:
  explicit GroupedHelp(std::set<std::string> frequent = {}) : frequent_(std::move(frequent)) {
    label("SUBCOMMAND", "COMMAND");
    label("SUBCOMMANDS", "COMMAND");
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    const bool is_short = mode == CLI::AppFormatMode::Normal && !frequent_.empty();
    std::string help = help_lines(app->get_description(), 0) + '\n' + make_usage(app, std::move(name));
    for (const char* group : {input_group, output_group, quality_group, method_group, jobs_group})
      help += group_help(*app, group, is_short);
    help += make_subcommands(app, CLI::AppFormatMode::Normal);
    help += group_help(*app, other_group, false);
    if (is_short)
      help += "\nThese are the options that people set; `bespoke " + app->get_name() + " --help` has all.\n";
    return help + '\n' + make_footer(app);
  }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return help_row(make_option_name(option, is_positional) + make_option_opts(option),
                    make_option_desc(option));
  }

  /// Lines that begin with a space, examples, stay as they are.
  std::string make_footer(const CLI::App* app) const override {
    std::istringstream lines(app->get_footer());
    std::string footer;
    for (std::string line; std::getline(lines, line);)
      footer += line.starts_with(' ') ? line + '\n' : help_lines(line, 0);
    return footer;
  }

  std::string make_subcommand(const CLI::App* app) const override {
    return help_row(app->get_name(), app->get_description());
  }

  /// Usage has the arguments that are required; of their kinds there is nothing to say.
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_positional()) return option->get_expected_max() > 1 ? " ..." : "";
    std::string text;
    if (option->get_type_size() != 0) {
      const std::string type = kind_of(option->get_type_name());
      text += (type.empty() ? "" : " " + type);
      if (!option->get_default_str().empty()) text += "=" + option->get_default_str();
      if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
      if (option->get_required()) text += " (required)";
    }
    for (const CLI::Option* other : option->get_needs()) text += " (only with " + other->get_name() + ")";
    for (const CLI::Option* other : option->get_excludes()) text += " (not with " + other->get_name() + ")";
    return text;
  }

  std::string make_option_usage(const CLI::Option* option) const override {
    const std::string name = option->get_name(true) + (option->get_expected_max() > 1 ? "..." : "");
    return option->get_required() ? name : "[" + name + "]";
  }

 private:
  /// "N" of "N:INT in [1 - 100]": a value out of range is told so.
  static std::string kind_of(const std::string& type) {
    const std::size_t colon = type.find(':');
    return colon == std::string::npos || type.substr(colon, 2) == ":{" ? type : type.substr(0, colon);
  }

  std::string group_help(const CLI::App& app, const std::string& group, bool is_short) const {
    std::string rows;
    for (const CLI::Option* option : group_members(app, group))
      if (!is_short || option->get_positional() || frequent_.contains(option->get_lnames().front()))
        rows += make_option(option, option->get_positional());
    return rows.empty() ? "" : '\n' + group + ":\n" + rows;
  }

  std::set<std::string> frequent_;  ///< what the short help has; empty where there is none
};

}  // namespace

void begin_group(CLI::App& app, const char* group) { app.option_defaults()->group(group); }

void set_grouped_help(CLI::App& app) { app.formatter(std::make_shared<GroupedHelp>()); }

void set_short_help(CLI::App& app, const std::set<std::string>& frequent) {
  app.formatter(std::make_shared<GroupedHelp>(frequent));
  begin_group(app, other_group);
  app.set_help_flag("-h", "Show the options that people set");
  app.set_help_all_flag("--help", "Show all options");
}

}  // namespace bespoke::command

#include "length_option.h"

#include <cstdio>

namespace bespoke::command {

Length parse_length(const std::string& option, const std::string& text, LengthRange range) {
  const std::optional<Length> length = bespoke::parse_length(text, range);
  if (!length)
    throw CLI::ValidationError(option, "'" + text + "' is not a " +
                                           (range == LengthRange::positive ? "positive" : "non-negative") +
                                           " length; write mesh units (0.02) or a "
                                           "percentage of the source's bounding-box diagonal (10%)");
  return *length;
}

std::string percentage(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%g%%", fraction * 100);
  return text;
}

CLI::Option* add_length_option(CLI::App& app, const std::string& name, std::optional<Length>& length,
                               const std::string& description, LengthRange range) {
  return app
      .add_option_function<std::string>(
          name, [name, range, &length](const std::string& text) { length = parse_length(name, text, range); },
          description)
      ->type_name("LENGTH");
}

}  // namespace bespoke::command

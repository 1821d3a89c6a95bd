#include "length_option.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace bespoke::command {

Length parse_length(const std::string& option, const std::string& text, LengthRange range) {
  Length length;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, length.value);
  length.percent = stop != end && *stop == '%';
  const bool complete = error == std::errc() && stop + length.percent == end;
  const bool in_range = length.value > 0 || (range == LengthRange::not_negative && length.value == 0);
  if (!(complete && in_range && std::isfinite(length.value)))
    throw CLI::ValidationError(option, "'" + text + "' is not a " +
                                           (range == LengthRange::positive ? "positive" : "non-negative") +
                                           " length; write mesh units (0.02) or a "
                                           "percentage of the source's bounding-box diagonal (10%)");
  return length;
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

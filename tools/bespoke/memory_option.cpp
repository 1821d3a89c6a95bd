#include "memory_option.h"

namespace bespoke::command {

CLI::Option* add_memory_option(CLI::App& app, std::optional<std::uint64_t>& bytes,
                               const std::string& description) {
  return app.add_option("--max-memory", bytes, description)
      ->transform(CLI::AsSizeValue(false))
      // Runs first, although it comes second; "-1" would wrap to more than any machine has.
      ->transform(CLI::Validator(
          [](std::string& text) {
            return text.starts_with('-') ? "'" + text + "' is not a number of bytes" : std::string();
          },
          ""))
      ->type_name("BYTES");
}

}  // namespace bespoke::command

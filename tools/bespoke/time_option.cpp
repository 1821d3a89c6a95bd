#include "time_option.h"

#include <cmath>

namespace bespoke::command {

CLI::Option* add_time_option(CLI::App& app, double& t, const std::string& description) {
  const auto finite = [](std::string& text) {
    double value = 0;
    const bool holds = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    return holds ? std::string() : "'" + text + "' is not a finite number";
  };
  return app.add_option("--t", t, description)->check(CLI::Validator(finite, ""))->type_name("T");
}

}  // namespace bespoke::command

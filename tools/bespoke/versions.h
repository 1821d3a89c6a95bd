#pragma once

#include <string>

namespace bespoke::command {

/// The command's version and those of the libraries inside, as a JSON object. Of libraries that are linked at
/// run time the version is the one that was compiled for.
std::string versions_json();

}  // namespace bespoke::command

#pragma once

#include <string_view>

namespace bespoke {

/// The built page, with "{{scene}}" where the scene goes; empty in a build without pages.
std::string_view page_template();

}  // namespace bespoke

#pragma once

#include <string>

namespace bespoke {

/// A page with its scene (view_scene.h, pick_scene.h) inside, as base64 (RFC 4648): `page_template` is the
/// built front end of src/pages, with "{{scene}}" where the scene goes. Throws InvalidInput when it has no
/// such place, or more than one.
std::string page_with_scene(const std::string& page_template, const std::string& scene);

}  // namespace bespoke

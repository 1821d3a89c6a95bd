#include "bespoke/page/page_file.h"

#include <string_view>

#include "bespoke/base64.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::string_view scene_mark = "{{scene}}";

}  // namespace

std::string page_with_scene(const std::string& page_template, const std::string& scene) {
  const std::size_t at = page_template.find(scene_mark);
  if (at == std::string::npos || page_template.find(scene_mark, at + 1) != std::string::npos)
    throw InvalidInput("the template of a page needs exactly one place for the scene, \"{{scene}}\"");
  std::string page = page_template.substr(0, at);
  page += base64(scene);
  page += page_template.substr(at + scene_mark.size());
  return page;
}

}  // namespace bespoke

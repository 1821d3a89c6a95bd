#include "bespoke/page/page_file.h"

#include <array>
#include <cstdint>
#include <string_view>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::string_view scene_mark = "{{scene}}";

std::string base64(const std::string& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

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

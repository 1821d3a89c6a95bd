#include "bespoke/page/html_text.h"

#include <cctype>
#include <cstdio>

namespace bespoke {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text) switch (letter) {
      case '<':
        result += "&lt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += letter;
    }
  return result;
}

std::string link_address(const std::string& file) {
  std::string result;
  for (const char letter : file) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool plain = std::isalnum(byte) != 0 || std::string("/-_.~").find(letter) != std::string::npos;
    char code[8];
    std::snprintf(code, sizeof code, "%%%02X", byte);
    result += plain ? std::string(1, letter) : code;
  }
  return result;
}

}  // namespace bespoke

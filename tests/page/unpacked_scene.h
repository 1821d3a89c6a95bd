#pragma once

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bespoke/types.h"

namespace bespoke::test {

/// A scene as the page reads it.
struct UnpackedScene {
  nlohmann::json record;
  std::string bytes;

  std::vector<std::uint32_t> numbers(const nlohmann::json& reference) const {
    const auto at = reference.at("at").get<std::size_t>(), count = reference.at("count").get<std::size_t>();
    const int bits = reference.at("bits").get<int>();
    std::vector<std::uint32_t> values;
    std::uint32_t previous = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t code = 0;
      for (int plane = 0; plane < bits / 8; ++plane)
        code |= std::uint32_t{static_cast<unsigned char>(
                    bytes.at(at + static_cast<std::size_t>(plane) * count + i))}
                << (8 * plane);
      previous += (code >> 1) ^ (code & 1 ? ~std::uint32_t{0} : 0);
      if (bits == 16) previous &= 0xFFFF;
      values.push_back(previous);
    }
    return values;
  }

  Points points(const nlohmann::json& reference) const {
    const std::vector<std::uint32_t> codes = numbers(reference.at("array"));
    const std::size_t count = codes.size() / 3;
    Points points(3, static_cast<Eigen::Index>(count));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double low = reference.at("min").at(axis), high = reference.at("max").at(axis);
      for (std::size_t i = 0; i < count; ++i)
        points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)) =
            low + (high - low) / 65535 * codes[axis * count + i];
    }
    return points;
  }
};

inline UnpackedScene unpacked(const std::string& packed) {
  std::string plain(std::size_t{1} << 22, '\0');
  auto size = static_cast<uLongf>(plain.size());
  if (uncompress(reinterpret_cast<Bytef*>(plain.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                 static_cast<uLong>(packed.size())) != Z_OK)
    throw std::runtime_error("the scene is not deflated, or larger than 4 MiB");
  plain.resize(size);
  std::uint32_t length = 0;
  for (std::size_t byte = 0; byte < 4; ++byte)
    length |= std::uint32_t{static_cast<unsigned char>(plain.at(byte))} << (8 * byte);
  return {nlohmann::json::parse(plain.substr(4, length)), plain.substr(4 + length)};
}

}  // namespace bespoke::test

#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/carry/product_file.h"

namespace bespoke {

enum class PlyScalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes in a binary file.
constexpr std::size_t size(PlyScalar type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
constexpr bool is_real(PlyScalar type) { return type >= PlyScalar::float32; }

struct PlyProperty {
  std::string name;
  PlyScalar type;
  std::optional<PlyScalar> count;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  std::optional<std::size_t> record_size() const;  ///< bytes in a binary file; none with lists
};

struct PlyHeader {
  enum class Encoding { ascii, little_endian, big_endian } encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< bytes
  std::size_t lines = 0;

  std::size_t vertex = 0;                            ///< the element "vertex"
  std::array<std::size_t, 3> position{};             ///< its properties x, y, z
  std::optional<std::array<std::size_t, 3>> normal;  ///< nx, ny, nz
  std::optional<std::array<std::size_t, 2>> texture;
};

/// Throws FormatError naming the line at fault.
PlyHeader read_ply_header(const InputFile& file);

/// What is wrong with an index of a face's list in a file of `vertices`; empty when nothing is.
std::string ply_index_fault(double index, std::uint64_t vertices);

/// Whether the property is the list of a face's vertices.
bool is_face_list(const PlyElement& element, const PlyProperty& property);

/// The lines of a file: the element "edge" and its properties vertex1 and vertex2.
struct PlyEdges {
  std::size_t element = 0;
  std::array<std::size_t, 2> ends{};
};

/// None where there are no such.
std::optional<PlyEdges> ply_edges(const PlyHeader& header);

}  // namespace bespoke

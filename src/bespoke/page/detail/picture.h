#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Rows from the top, three bytes (red, green, blue) a pixel.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
};

/// As a PNG file: 8 bits a channel, no interlace (libpng).
std::string png(const Picture& picture);

/// A mesh to be drawn.
struct PaintedMesh {
  Points vertices;  ///< 3×n, mesh units
  Faces faces;
  std::vector<Vector3> colours;  ///< of every vertex, or one for all; red, green, blue in [0, 1]
};

enum class DrawnFrom { front, side };  ///< along −z or −x, y upwards

/// All meshes in parallel projection, filling the picture, lit from the eye: a z-buffer on the processor, so
/// that it needs no display, and gives the same bytes everywhere. size: pixels along each edge, > 0. Throws
/// InvalidInput for meshes without vertices, indices out of range, or a number of colours that is neither.
Picture draw(const std::vector<PaintedMesh>& meshes, DrawnFrom from, int size);

/// The colour of a value in [low, high], as the page `view` has it: diverging about the middle, or of
/// magnitudes. Grey for NaN.
Vector3 colour_of(double value, double low, double high, bool is_diverging);

}  // namespace bespoke

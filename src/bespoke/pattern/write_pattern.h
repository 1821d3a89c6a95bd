#pragma once

#include <filesystem>
#include <string>

#include "bespoke/pattern/pattern_sheet.h"

namespace bespoke {

enum class PaperSize {
  a4,
  letter,
  roll,  ///< one page of the sheet's own size
};

inline constexpr std::array paper_sizes{Named<PaperSize>{"a4", PaperSize::a4},
                                        Named<PaperSize>{"letter", PaperSize::letter},
                                        Named<PaperSize>{"roll", PaperSize::roll}};

struct PatternFileOptions {
  std::string name = {};             ///< of the garment: titles and the style in DXF
  PaperSize paper = PaperSize::a4;   ///< of PDF
  bool with_strain_colours = false;  ///< in SVG and PDF, under the lines: white at 0, red at `red_strain`
};

/// Strain that is drawn in full red.
inline constexpr double red_strain = 0.05;

/// ".svg, .dxf or .pdf", and with .json and .glb: these hold no sizes.
std::string sheet_endings();
std::string pattern_endings();
bool can_write_sheet(const std::filesystem::path& path);
bool can_write_pattern(const std::filesystem::path& path);

/// By the ending of the name: SVG in millimetres, a group a piece; DXF R12 with the layers of ASTM D6673, a
/// block a piece; PDF on tiled pages with marks, or on one. Several sizes: a layer a size. Same bytes for the
/// same sheet. Atomic. Throws FileError, and UnknownEnding.
void write_sheet(const std::filesystem::path& path, const Sheet& sheet, const PatternFileOptions& options);

/// The same, and JSON (vertices, faces, outlines, seams, strain) and GLB (the flat pieces on the sheet, with
/// the garment as a morph target). sheet: of the pattern.
void write_pattern(const std::filesystem::path& path, const FlatPattern& pattern, const Sheet& sheet,
                   const PatternFileOptions& options);

}  // namespace bespoke

#pragma once

#include <filesystem>
#include <string>

#include "bespoke/pattern/write_pattern.h"

namespace bespoke {

/// The formats of write_pattern.h: whole files as text, or written to `path`.
std::string svg_text(const Sheet& sheet, const PatternFileOptions& options);
std::string dxf_text(const Sheet& sheet, const PatternFileOptions& options);
std::string pattern_json(const FlatPattern& pattern, const Sheet& sheet, const PatternFileOptions& options);
void write_pdf_sheet(const std::filesystem::path& path, const Sheet& sheet,
                     const PatternFileOptions& options);
void write_glb_pieces(const std::filesystem::path& path, const FlatPattern& pattern, const Sheet& sheet,
                      const PatternFileOptions& options);

/// Millimetres in fixed notation, to a ten-thousandth, without zeros at the end.
std::string millimetres(double value);

/// Letters, digits and '-' of a name in small letters, for ids; never empty.
std::string identifier(const std::string& name);

/// Red, green, blue from 0 to 1 for a strain.
Eigen::Vector3d strain_colour(double strain);

/// What leads from the flat place of a piece to that on the sheet.
Eigen::Vector2d sheet_shift(const PatternPiece& piece, const SheetPiece& drawn);

}  // namespace bespoke

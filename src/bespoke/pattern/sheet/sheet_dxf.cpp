#include <cctype>
#include <cstdio>
#include <set>

#include "bespoke/pattern/sheet/sheet_formats.h"

namespace bespoke {
namespace {

/// Group codes and values of DXF R12.
class DxfText {
 public:
  void add(int code, const std::string& value) { text_ += std::to_string(code) + "\n" + value + "\n"; }
  void add(int code, int value) { add(code, std::to_string(value)); }
  void add(int code, double value) {
    std::string number = millimetres(value);
    if (number.find('.') == std::string::npos) number += ".0";
    add(code, number);
  }
  void point(int code, const Eigen::Vector2d& x) {
    add(code, x.x());
    add(code + 10, x.y());
    add(code + 20, 0.0);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// Letters, digits, '_' and '-' in capitals, as names of R12 may have.
std::string dxf_name(const std::string& name) {
  std::string result;
  for (const char c : identifier(name))
    result += c == ' ' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

/// ASCII, with other characters as "\U+1234".
std::string dxf_string(const std::string& utf8) {
  std::string result;
  for (std::size_t k = 0; k < utf8.size(); ++k) {
    const auto byte = static_cast<unsigned char>(utf8[k]);
    if (byte < 0x80) {
      result += utf8[k] == '\n' ? ' ' : utf8[k];
      continue;
    }
    const int more = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : 1;
    unsigned code = byte & (0x3fu >> more);
    for (int i = 0; i < more && k + 1 < utf8.size(); ++i)
      code = code << 6 | (static_cast<unsigned char>(utf8[++k]) & 0x3fu);
    char text[16];
    std::snprintf(text, sizeof text, "\\U+%04X", code);
    result += text;
  }
  return result;
}

class DxfWriter {
 public:
  DxfWriter(const Sheet& sheet, const PatternFileOptions& options) : sheet_(sheet), options_(options) {
    std::set<std::string> sizes;
    for (const SheetPiece& piece : sheet.pieces) sizes.insert(piece.size);
    has_sizes_ = sizes.size() > 1;
    for (const std::string& size : sizes)
      if (has_sizes_) size_layers_.insert(size_layer(size));
  }

  std::string run() {
    header();
    tables();
    blocks();
    section("ENTITIES");
    for (std::size_t k = 0; k < sheet_.pieces.size(); ++k) {
      dxf_.add(0, "INSERT");
      dxf_.add(8, has_sizes_ ? size_layer(sheet_.pieces[k].size) : "1");
      dxf_.add(2, block_name(k));
      dxf_.point(10, {0, 0});
    }
    line(sheet_.test_square);
    label(sheet_.test_text);
    const auto note = [&](int row, const std::string& text) {
      label({{sheet_.test_text.at.x(), sheet_.test_text.at.y() - 6.0 * row}, 3, text});
    };
    note(1, "Style: " + options_.name);
    note(2, "Units: METRIC");
    end_section();
    dxf_.add(0, "EOF");
    return dxf_.take();
  }

 private:
  static std::string size_layer(const std::string& size) { return "SIZE_" + dxf_name(size); }
  std::string block_name(std::size_t k) const {
    const SheetPiece& piece = sheet_.pieces[k];
    return "P" + std::to_string(k + 1) + "_" + dxf_name(piece.name) +
           (piece.size.empty() ? "" : "_" + dxf_name(piece.size));
  }
  static std::string layer_name(PatternLayer layer) { return std::to_string(static_cast<int>(layer)); }

  void section(const char* name) {
    dxf_.add(0, "SECTION");
    dxf_.add(2, name);
  }
  void end_section() { dxf_.add(0, "ENDSEC"); }

  void header() {
    section("HEADER");
    dxf_.add(9, "$ACADVER");
    dxf_.add(1, "AC1009");
    dxf_.add(9, "$EXTMIN");
    dxf_.point(10, {0, 0});
    dxf_.add(9, "$EXTMAX");
    dxf_.point(10, {sheet_.width, sheet_.height});
    end_section();
  }

  void table(const char* name, int entries) {
    dxf_.add(0, "TABLE");
    dxf_.add(2, name);
    dxf_.add(70, entries);
  }

  void layer(const std::string& name, int colour) {
    dxf_.add(0, "LAYER");
    dxf_.add(2, name);
    dxf_.add(70, 0);
    dxf_.add(62, colour);
    dxf_.add(6, "CONTINUOUS");
  }

  void tables() {
    section("TABLES");
    table("LTYPE", 1);
    dxf_.add(0, "LTYPE");
    dxf_.add(2, "CONTINUOUS");
    dxf_.add(70, 0);
    dxf_.add(3, "Solid line");
    dxf_.add(72, 65);
    dxf_.add(73, 0);
    dxf_.add(40, 0.0);
    dxf_.add(0, "ENDTAB");
    table("LAYER", static_cast<int>(pattern_layers.size() + size_layers_.size() + 1));
    layer("0", 7);
    int colour = 0;
    for (const auto& known : pattern_layers) layer(layer_name(known.value), ++colour);
    for (const std::string& name : size_layers_) layer(name, 7);
    dxf_.add(0, "ENDTAB");
    table("STYLE", 1);
    dxf_.add(0, "STYLE");
    dxf_.add(2, "STANDARD");
    dxf_.add(70, 0);
    dxf_.add(40, 0.0);
    dxf_.add(41, 1.0);
    dxf_.add(50, 0.0);
    dxf_.add(71, 0);
    dxf_.add(42, 1.0);
    dxf_.add(3, "txt");
    dxf_.add(4, "");
    dxf_.add(0, "ENDTAB");
    end_section();
  }

  void blocks() {
    section("BLOCKS");
    for (std::size_t k = 0; k < sheet_.pieces.size(); ++k) {
      const SheetPiece& piece = sheet_.pieces[k];
      dxf_.add(0, "BLOCK");
      dxf_.add(8, "0");
      dxf_.add(2, block_name(k));
      dxf_.add(70, 0);
      dxf_.point(10, {0, 0});
      dxf_.add(3, block_name(k));
      dxf_.add(1, "");
      for (const SheetLine& of : piece.lines) line(of);
      for (const SheetNotch& notch : piece.notches) {
        dxf_.add(0, "POINT");
        dxf_.add(8, layer_name(PatternLayer::notches));
        dxf_.point(10, notch.at);
      }
      for (const SheetText& of : piece.texts) label(of);
      notes(piece);
      dxf_.add(0, "ENDBLK");
      dxf_.add(8, "0");
    }
    end_section();
  }

  /// What D6673 has CAD programs read of a piece.
  void notes(const SheetPiece& piece) {
    const Eigen::Vector2d at = piece.texts.front().at;
    double row = 3;
    for (const std::string& text :
         {"Piece Name: " + piece.name, "Size: " + piece.size, "Quantity: " + std::to_string(piece.quantity)})
      label({at - Eigen::Vector2d(0, 4 * row++), 2, text});
  }

  void line(const SheetLine& of) {
    const std::string on = layer_name(of.layer);
    if (of.points.size() == 2 && !of.is_closed) {
      dxf_.add(0, "LINE");
      dxf_.add(8, on);
      dxf_.point(10, of.points[0]);
      dxf_.point(11, of.points[1]);
      return;
    }
    dxf_.add(0, "POLYLINE");
    dxf_.add(8, on);
    dxf_.add(66, 1);
    dxf_.point(10, {0, 0});
    dxf_.add(70, of.is_closed ? 1 : 0);
    for (const Eigen::Vector2d& x : of.points) {
      dxf_.add(0, "VERTEX");
      dxf_.add(8, on);
      dxf_.point(10, x);
    }
    dxf_.add(0, "SEQEND");
    dxf_.add(8, on);
  }

  void label(const SheetText& of) {
    dxf_.add(0, "TEXT");
    dxf_.add(8, layer_name(PatternLayer::annotation));
    const Eigen::Vector2d middle = of.at - Eigen::Vector2d(0, of.height / 2);
    dxf_.point(10, middle);
    dxf_.add(40, of.height);
    dxf_.add(1, dxf_string(of.text));
    dxf_.add(72, 1);  // centred about the second point
    dxf_.point(11, middle);
  }

  const Sheet& sheet_;
  const PatternFileOptions& options_;
  bool has_sizes_ = false;
  std::set<std::string> size_layers_;
  DxfText dxf_;
};

}  // namespace

std::string dxf_text(const Sheet& sheet, const PatternFileOptions& options) {
  return DxfWriter(sheet, options).run();
}

}  // namespace bespoke

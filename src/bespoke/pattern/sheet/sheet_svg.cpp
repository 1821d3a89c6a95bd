#include <algorithm>
#include <map>

#include "bespoke/pattern/sheet/sheet_formats.h"

namespace bespoke {
namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

class SvgWriter {
 public:
  SvgWriter(const Sheet& sheet, const PatternFileOptions& options) : sheet_(sheet), options_(options) {}

  std::string run() {
    const std::string width = millimetres(sheet_.width), height = millimetres(sheet_.height);
    text_ =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"" +
        width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n<title>" +
        escaped(options_.name) + "</title>\n" +
        "<style>path,polygon{fill:none;stroke:#000;stroke-width:.35}.sew{stroke-dasharray:3 "
        "2}.grain,.notches{"
        "stroke:#05a}.internal{stroke:#a50;stroke-dasharray:8 2 1 2}text{font-family:sans-serif;text-anchor:"
        "middle;fill:#000}.strain polygon{stroke:none}</style>\n";
    open("test-square", "test square", "annotation");
    line(sheet_.test_square);
    label(sheet_.test_text);
    close();
    std::vector<std::string> sizes;
    for (const SheetPiece& piece : sheet_.pieces)
      if (sizes.empty() || std::find(sizes.begin(), sizes.end(), piece.size) == sizes.end())
        sizes.push_back(piece.size);
    for (const std::string& size : sizes) {
      if (sizes.size() > 1) open(unique("size-" + identifier(size)), "size " + size, "size");
      for (const SheetPiece& piece : sheet_.pieces)
        if (piece.size == size) draw(piece);
      if (sizes.size() > 1) close();
    }
    return text_ + "</svg>\n";
  }

 private:
  std::string unique(const std::string& id) {
    const int count = ++ids_[id];
    return count == 1 ? id : unique(id + "-" + std::to_string(count));
  }
  void open(const std::string& id, const std::string& name, const std::string& kind) {
    text_ += "<g id=\"" + id + "\" class=\"" + kind + "\" inkscape:groupmode=\"layer\" inkscape:label=\"" +
             escaped(name) + "\">\n";
  }
  void close() { text_ += "</g>\n"; }

  std::string place(const Eigen::Vector2d& x) const {
    return millimetres(x.x()) + "," + millimetres(sheet_.height - x.y());
  }
  void line(const SheetLine& of) {
    text_ += "<path d=\"M";
    for (const Eigen::Vector2d& x : of.points) text_ += " " + place(x);
    text_ += of.is_closed ? " Z\"/>\n" : "\"/>\n";
  }
  void label(const SheetText& of) {
    constexpr double capitals = 0.72;  // of the size of a font
    text_ += "<text x=\"" + millimetres(of.at.x()) + "\" y=\"" +
             millimetres(sheet_.height - of.at.y() + of.height / 2) + "\" font-size=\"" +
             millimetres(of.height / capitals) + "\">" + escaped(of.text) + "</text>\n";
  }

  void draw(const SheetPiece& piece) {
    const std::string id =
        unique(identifier(piece.name) + (piece.size.empty() ? "" : "-" + identifier(piece.size)));
    open(id, piece.name, "piece");
    if (options_.with_strain_colours) strain(piece, id);
    for (const auto& [name, layer] : pattern_layers) {
      std::string before = std::move(text_);
      text_.clear();
      for (const SheetLine& of : piece.lines)
        if (of.layer == layer) line(of);
      if (layer == PatternLayer::notches) notches(piece);
      if (layer == PatternLayer::annotation)
        for (const SheetText& of : piece.texts) label(of);
      std::swap(before, text_);
      if (before.empty()) continue;
      open(id + "-" + std::string(name), std::string(name), std::string(name));
      text_ += before;
      close();
    }
    close();
  }

  void notches(const SheetPiece& piece) {
    constexpr double length = 5;
    for (const SheetNotch& notch : piece.notches)
      line({PatternLayer::notches, {notch.at, notch.at + length * notch.inward}, false});
  }

  void strain(const SheetPiece& piece, const std::string& id) {
    open(id + "-strain", "strain", "strain");
    for (const SheetFace& face : piece.faces) {
      text_ += "<polygon style=\"fill:rgb(";
      const Eigen::Vector3d colour = strain_colour(face.strain);
      for (int k = 0; k < 3; ++k)
        text_ += (k > 0 ? "," : "") + std::to_string(static_cast<int>(255 * colour[k]));
      text_ += ")\" points=\"" + place(face.corners[0]) + " " + place(face.corners[1]) + " " +
               place(face.corners[2]) + "\"/>\n";
    }
    close();
  }

  const Sheet& sheet_;
  const PatternFileOptions& options_;
  std::string text_;
  std::map<std::string, int> ids_;
};

}  // namespace

std::string svg_text(const Sheet& sheet, const PatternFileOptions& options) {
  return SvgWriter(sheet, options).run();
}

}  // namespace bespoke

#include <cairo/cairo-pdf.h>
#include <cairo/cairo.h>

#include <cmath>
#include <memory>

#include "bespoke/error.h"
#include "bespoke/pattern/sheet/sheet_formats.h"

namespace bespoke {
namespace {

constexpr double points_per_mm = 72 / 25.4;

// Millimetres that printers leave white.
constexpr double margin = 10;

struct PageSize {
  double width = 0, height = 0;  ///< millimetres
};

PageSize page_size(const Sheet& sheet, PaperSize paper) {
  if (paper == PaperSize::a4) return {210, 297};
  if (paper == PaperSize::letter) return {215.9, 279.4};
  return {sheet.width, sheet.height};
}

/// Draws in millimetres, y down.
class PdfWriter {
 public:
  PdfWriter(const std::filesystem::path& path, const Sheet& sheet, const PatternFileOptions& options)
      : sheet_(sheet),
        options_(options),
        page_(page_size(sheet, options.paper)),
        surface_(
            cairo_pdf_surface_create(path.c_str(), points_per_mm * page_.width, points_per_mm * page_.height),
            cairo_surface_destroy),
        cairo_(cairo_create(surface_.get()), cairo_destroy) {
    // A fixed date: cairo would write that of the clock.
    cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_TITLE, options.name.c_str());
    cairo_scale(cairo_.get(), points_per_mm, points_per_mm);
  }

  void run() {
    if (options_.paper == PaperSize::roll) {
      draw_sheet();
      cairo_show_page(cairo_.get());
    } else {
      tiles();
    }
    cairo_surface_finish(surface_.get());
    const cairo_status_t status = cairo_surface_status(surface_.get());
    if (status != CAIRO_STATUS_SUCCESS)
      throw FileError(std::string("PDF: ") + cairo_status_to_string(status));
  }

 private:
  void tiles() {
    const double width = page_.width - 2 * margin, height = page_.height - 2 * margin;
    const int columns = static_cast<int>(std::ceil(sheet_.width / width));
    const int rows = static_cast<int>(std::ceil(sheet_.height / height));
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        cairo_save(cairo_.get());
        cairo_rectangle(cairo_.get(), margin, margin, width, height);
        cairo_clip(cairo_.get());
        cairo_translate(cairo_.get(), margin - column * width, margin - row * height);
        draw_sheet();
        cairo_restore(cairo_.get());
        marks(width, height);
        label(margin + width / 2, margin / 2 + 1.5, 3,
              "row " + std::to_string(row + 1) + " of " + std::to_string(rows) + ", column " +
                  std::to_string(column + 1) + " of " + std::to_string(columns) + "  " + options_.name);
        cairo_show_page(cairo_.get());
      }
  }

  /// The frame to cut or fold along, and crosses in the middles of its sides, which meet those of the next
  /// page.
  void marks(double width, double height) {
    pen(0.15, 0.6);
    cairo_rectangle(cairo_.get(), margin, margin, width, height);
    cairo_stroke(cairo_.get());
    pen(0.3, 0);
    constexpr double arm = 4;
    for (const auto& [x, y] : {std::pair(margin + width / 2, margin),
                               {margin + width / 2, margin + height},
                               {margin, margin + height / 2},
                               {margin + width, margin + height / 2}}) {
      cairo_move_to(cairo_.get(), x - arm, y);
      cairo_line_to(cairo_.get(), x + arm, y);
      cairo_move_to(cairo_.get(), x, y - arm);
      cairo_line_to(cairo_.get(), x, y + arm);
    }
    cairo_stroke(cairo_.get());
  }

  void pen(double width, double grey) {
    cairo_set_line_width(cairo_.get(), width);
    cairo_set_source_rgb(cairo_.get(), grey, grey, grey);
  }

  void dashes(PatternLayer layer) {
    const double sew[] = {3, 2}, fold[] = {8, 2, 1, 2};
    if (layer == PatternLayer::sew_line)
      cairo_set_dash(cairo_.get(), sew, 2, 0);
    else if (layer == PatternLayer::internal)
      cairo_set_dash(cairo_.get(), fold, 4, 0);
    else
      cairo_set_dash(cairo_.get(), nullptr, 0, 0);
  }

  void line(const SheetLine& of) {
    dashes(of.layer);
    for (const Eigen::Vector2d& x : of.points) cairo_line_to(cairo_.get(), x.x(), sheet_.height - x.y());
    if (of.is_closed) cairo_close_path(cairo_.get());
    cairo_stroke(cairo_.get());
    cairo_set_dash(cairo_.get(), nullptr, 0, 0);
  }

  void label(double x, double y, double height, const std::string& text) {
    constexpr double capitals = 0.72;  // of the size of a font
    cairo_set_source_rgb(cairo_.get(), 0, 0, 0);
    cairo_set_font_size(cairo_.get(), height / capitals);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_.get(), text.c_str(), &extents);
    cairo_move_to(cairo_.get(), x - extents.width / 2 - extents.x_bearing, y);
    cairo_show_text(cairo_.get(), text.c_str());
    cairo_new_path(cairo_.get());
  }
  void label(const SheetText& of) {
    label(of.at.x(), sheet_.height - of.at.y() + of.height / 2, of.height, of.text);
  }

  void arrow(const SheetLine& grain) {
    constexpr double head = 4;
    for (std::size_t k = 0; k < 2; ++k) {
      const Eigen::Vector2d tip = grain.points[k], back = (grain.points[1 - k] - tip).normalized() * head;
      const Eigen::Vector2d side(-back.y() / 2, back.x() / 2);
      line({PatternLayer::grain, {tip + back + side, tip, tip + back - side}, false});
    }
  }

  void draw_sheet() {
    for (const SheetPiece& piece : sheet_.pieces) {
      if (options_.with_strain_colours) faces(piece);
      pen(0.35, 0);
      for (const SheetLine& of : piece.lines) {
        line(of);
        if (of.layer == PatternLayer::grain) arrow(of);
      }
      constexpr double notch_length = 5;
      for (const SheetNotch& notch : piece.notches)
        line({PatternLayer::notches, {notch.at, notch.at + notch_length * notch.inward}, false});
      for (const SheetText& of : piece.texts) label(of);
    }
    pen(0.35, 0);
    line(sheet_.test_square);
    label(sheet_.test_text);
  }

  void faces(const SheetPiece& piece) {
    for (const SheetFace& face : piece.faces) {
      const Eigen::Vector3d colour = strain_colour(face.strain);
      cairo_set_source_rgb(cairo_.get(), colour[0], colour[1], colour[2]);
      for (const Eigen::Vector2d& x : face.corners) cairo_line_to(cairo_.get(), x.x(), sheet_.height - x.y());
      cairo_close_path(cairo_.get());
      cairo_fill(cairo_.get());
    }
  }

  const Sheet& sheet_;
  const PatternFileOptions& options_;
  PageSize page_;
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo_;
};

}  // namespace

void write_pdf_sheet(const std::filesystem::path& path, const Sheet& sheet,
                     const PatternFileOptions& options) {
  PdfWriter(path, sheet, options).run();
}

}  // namespace bespoke

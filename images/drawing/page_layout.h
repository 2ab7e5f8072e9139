// Layout around a picture: title, warnings, caption, colour bar.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/provenance.h"
#include "images/drawing/axis.h"
#include "images/drawing/canvas.h"
#include "images/drawing/colour.h"
#include "images/drawing/style.h"

namespace photorque {

inline constexpr double page_margin = 16.0;

// Lines of one style.
struct TextBlock {
  std::vector<std::string> lines;
  TextStyle style;
  double line_height() const { return 1.3 * style.size; }
  double height() const { return line_height() * static_cast<double>(lines.size()); }
};

// `text` broken at spaces into at most `max_lines` lines of at most `width` points. If it does not
// fit, the letters shrink to `smallest_size`; if this is not sufficient, the text is cut with "…".
TextBlock fitted_text(const std::string& text, double width, TextStyle style, double smallest_size,
                      int max_lines);
void draw_text(Canvas& canvas, const TextBlock& block, const PagePoint& top_left);

// Texts of a page; the body is between title and caption.
struct PageText {
  TextBlock title;
  TextBlock warnings;  // below the title; empty without warnings
  TextBlock caption;
  double body_top() const;
  double page_height(double body_height) const;
};
// Title and caption depend on the style; warnings of the provenance are always included.
PageText page_text(const std::string& title, const std::string& caption,
                   const Provenance& provenance, double page_width,
                   PictureStyle style = PictureStyle::page);
void draw_page_text(Canvas& canvas, const PageText& text, double body_height);

// A page that can be drawn on every kind of canvas.
struct DrawnPage {
  double width = 0.0, height = 0.0;
  PictureStyle style = PictureStyle::page;
  PageBox grid = {};  // bins of a map, in whole points; empty for a plot
  // Draws the page; images have `per_point` pixels per point.
  std::function<void(Canvas&, double per_point)> draw;

  Picture pixels() const;
  std::string svg() const;
  std::string pdf(const PdfText& text) const;
};

// A vertical colour bar with numbers on its right and the unit above it.
struct ColourBar {
  ColourScale scale;
  Axis axis;
  std::string unit;
  double width() const;  // of bar, numbers and unit
};
inline constexpr double colour_bar_unit_height = 18.0;  // needed above the bar
ColourBar colour_bar(const ColourScale& scale, const std::string& unit, double height);
// `height` must be that of colour_bar(); `top_left` is the corner of the coloured part.
void draw_colour_bar(Canvas& canvas, const ColourBar& bar, const PagePoint& top_left,
                     double height);

}  // namespace photorque

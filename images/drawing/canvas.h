// A page for drawing with cairo: the same calls produce pixels, SVG or PDF.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "images/drawing/colour.h"

namespace photorque {

// An opaque 8-bit sRGB picture. Pixel (column, row) is at index 3·(row·width + column); row 0 is
// the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;

  std::array<uint8_t, 3> pixel(int column, int row) const {
    const size_t i = 3 * (static_cast<size_t>(row) * width + column);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

// Lengths on a page are in points; x points right, y down, from the top left corner.
struct PagePoint {
  double x = 0.0;
  double y = 0.0;
};
struct PageBox {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  PagePoint centre() const { return {x + 0.5 * width, y + 0.5 * height}; }
};

// Colour of text, frames and axes.
inline constexpr Rgb ink = {0.13, 0.13, 0.13};

struct Stroke {
  Rgb colour;
  double width = 1.0;
  double opacity = 1.0;
  std::vector<double> dashes = {};  // lengths on, off, on, …; empty: solid
};

// Point of a text that is placed at the given position.
enum class TextAlign { left, centre, right };
enum class TextLevel { baseline, middle };  // middle: of capital letters

struct TextStyle {
  double size = 11.0;
  Rgb colour = ink;
  bool bold = false;
  TextAlign align = TextAlign::left;
  TextLevel level = TextLevel::baseline;
  double turn_rad = 0.0;  // counter-clockwise
};
inline constexpr double quarter_turn_rad = std::numbers::pi / 2.0;

// Width of `text` in DejaVu Sans, in points; equal on every canvas. `text` is cleaned.
double text_width(const std::string& text, const TextStyle& style);

// Metadata of a PDF file.
struct PdfText {
  std::string title, subject, program;
};

// A page. Drawing outside the page is clipped. Throws NumericalError if cairo fails (out of
// memory).
class Canvas {
 public:
  // A white page of pixels, `scale` pixels per point.
  static Canvas of_pixels(double width, double height, double scale);
  // White vector pages. PDF letters are text; SVG letters can be outlines, which look equal on
  // machines without the font.
  enum class Letters { text, outlines };
  static Canvas of_svg(double width, double height, Letters letters = Letters::outlines);
  static Canvas of_pdf(double width, double height, const PdfText& text);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  // Coordinates and lengths of the drawing functions are in points.
  void fill(const PageBox& box, const Rgb& colour, double opacity = 1.0);
  void fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity = 1.0);
  void disc(const PagePoint& centre, double radius, const Rgb& colour);
  void discs(std::span<const PagePoint> centres, double radius, const Rgb& colour);
  void line(std::span<const PagePoint> points, const Stroke& stroke);
  void line(const PagePoint& from, const PagePoint& to, const Stroke& stroke);
  void outline(const PageBox& box, const Stroke& stroke);
  // `text` is cleaned.
  void text(const std::string& text, const PagePoint& at, const TextStyle& style);
  // Draws pixels 0xAARRGGBB without premultiplied alpha as sharp cells; row 0 is at the top of
  // `box`.
  void image(const PageBox& box, int width, int height, std::span<const uint32_t> argb);

  // Calls draw() with clipping to `box`.
  template <class Draw>
  void clipped(const PageBox& box, const Draw& draw) {
    begin_clip(box);
    draw();
    end_clip();
  }

  // Return the result: the pixels, or the bytes of an SVG or PDF file. Afterwards the canvas can
  // only be destroyed.
  Picture finish_pixels();
  std::string finish_file();
  // A page of SVG as an <img> element of an HTML page; `title` is for screen readers.
  std::string finish_html(const std::string& title);

 private:
  struct Page;
  explicit Canvas(std::unique_ptr<Page> page);
  void begin_clip(const PageBox& box);
  void end_clip();
  std::unique_ptr<Page> page_;
};

}  // namespace photorque

// A page to draw on: the same calls make pixels, SVG files or SVG inside of an HTML page.
#pragma once

#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "images/canvas/colour.h"
#include "images/canvas/picture.h"

namespace photorque {

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

// Of text, frames and axes.
inline constexpr Rgb ink = {0.13, 0.13, 0.13};

struct Stroke {
  Rgb colour;
  double width = 1.0;
  double opacity = 1.0;
  std::vector<double> dashes = {};  // lengths on, off, on, …; empty: solid
};

// Which point of a text is put at the given position.
enum class TextAlign { left, centre, right };
enum class TextLevel { baseline, middle };  // middle: of capital letters

struct TextStyle {
  double size = 11.0;
  Rgb colour = ink;
  bool bold = false;
  TextAlign align = TextAlign::left;
  TextLevel level = TextLevel::baseline;
  double turn_rad = 0.0;  // anticlockwise as seen
};
inline constexpr double quarter_turn_rad = std::numbers::pi / 2.0;

// The advance of `text` in DejaVu Sans, in points; the same on every canvas. `text` is cleaned.
double text_width(const std::string& text, const TextStyle& style);

// Everything drawn outside of the page is cut off. NumericalError if cairo fails (out of memory).
class Canvas {
 public:
  // A white page of pixels, `scale` pixels per point.
  static Canvas of_pixels(double width, double height, double scale);
  // A white page of vectors.
  static Canvas of_vectors(double width, double height);
  // Vectors on a transparent ground as an <svg> element for the inside of an HTML page: text stays
  // text, nothing has an id, so that one page can hold many. `title` is for screen readers.
  static Canvas of_html(double width, double height, const std::string& title);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  void fill(const PageBox& box, const Rgb& colour, double opacity = 1.0);
  void fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity = 1.0);
  void disc(const PagePoint& centre, double radius, const Rgb& colour);
  void discs(std::span<const PagePoint> centres, double radius, const Rgb& colour);
  void line(std::span<const PagePoint> points, const Stroke& stroke);
  void line(const PagePoint& from, const PagePoint& to, const Stroke& stroke);
  void outline(const PageBox& box, const Stroke& stroke);
  void text(const std::string& text, const PagePoint& at, const TextStyle& style);
  // Pixels of 0xAARRGGBB without premultiplication, row 0 at the top of `box`, in sharp cells.
  void image(const PageBox& box, int width, int height, std::span<const uint32_t> argb);

  // What `draw` does is confined to `box`.
  template <class Draw>
  void clipped(const PageBox& box, const Draw& draw) {
    begin_clip(box);
    draw();
    end_clip();
  }

  // The result, once; the canvas can then only be destroyed. NumericalError for what this canvas
  // is not made of.
  Picture finish_pixels();
  std::string finish_svg();

  struct Page;  // what a kind of canvas can draw: page.h

 private:
  explicit Canvas(std::unique_ptr<Page> page);
  void begin_clip(const PageBox& box);
  void end_clip();
  std::unique_ptr<Page> page_;
};

}  // namespace photorque

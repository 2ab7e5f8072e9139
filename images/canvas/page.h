// What a kind of canvas has to be able to draw; see Canvas for the meaning of every call.
#pragma once

#include "images/canvas/canvas.h"

namespace photorque {

struct Canvas::Page {
  virtual ~Page() = default;
  virtual void fill(const PageBox& box, const Rgb& colour, double opacity) = 0;
  virtual void fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity) = 0;
  virtual void discs(std::span<const PagePoint> centres, double radius, const Rgb& colour) = 0;
  virtual void line(std::span<const PagePoint> points, const Stroke& stroke) = 0;
  virtual void outline(const PageBox& box, const Stroke& stroke) = 0;
  virtual void text(const std::string& clean, const PagePoint& at, const TextStyle& style) = 0;
  virtual void image(const PageBox& box, int width, int height, std::span<const uint32_t> argb) = 0;
  virtual void begin_clip(const PageBox& box) = 0;
  virtual void end_clip() = 0;
  virtual Picture finish_pixels() = 0;
  virtual std::string finish_svg() = 0;
};

// A PNG file of pixels, row 0 on top, not premultiplied.
std::string png_of(int width, int height, std::span<const uint32_t> argb);

}  // namespace photorque

#include "images/canvas/canvas.h"

#include "core/text/format.h"
#include "images/canvas/page.h"

namespace photorque {

Canvas::Canvas(std::unique_ptr<Page> page) : page_(std::move(page)) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

void Canvas::fill(const PageBox& box, const Rgb& colour, double opacity) {
  page_->fill(box, colour, opacity);
}

void Canvas::fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity) {
  page_->fill(polygon, colour, opacity);
}

void Canvas::disc(const PagePoint& centre, double radius, const Rgb& colour) {
  page_->discs({&centre, 1}, radius, colour);
}

void Canvas::discs(std::span<const PagePoint> centres, double radius, const Rgb& colour) {
  page_->discs(centres, radius, colour);
}

void Canvas::line(std::span<const PagePoint> points, const Stroke& stroke) {
  page_->line(points, stroke);
}

void Canvas::line(const PagePoint& from, const PagePoint& to, const Stroke& stroke) {
  page_->line(std::array{from, to}, stroke);
}

void Canvas::outline(const PageBox& box, const Stroke& stroke) {
  page_->outline(box, stroke);
}

void Canvas::text(const std::string& text, const PagePoint& at, const TextStyle& style) {
  page_->text(clean_text(text), at, style);
}

void Canvas::image(const PageBox& box, int width, int height, std::span<const uint32_t> argb) {
  page_->image(box, width, height, argb);
}

void Canvas::begin_clip(const PageBox& box) {
  page_->begin_clip(box);
}

void Canvas::end_clip() {
  page_->end_clip();
}

Picture Canvas::finish_pixels() {
  return page_->finish_pixels();
}

std::string Canvas::finish_svg() {
  return page_->finish_svg();
}

}  // namespace photorque

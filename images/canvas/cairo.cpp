// Pages of pixels and of vectors, drawn by cairo. The only file that knows it.
#include <cairo-svg.h>
#include <cairo.h>

#include "core/errors.h"
#include "core/text/format.h"
#include "images/canvas/page.h"

namespace photorque {
namespace {

struct CairoDelete {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_pattern_t* pattern) const { cairo_pattern_destroy(pattern); }
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
template <class T>
using CairoOwner = std::unique_ptr<T, CairoDelete>;

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw NumericalError(std::string("drawing failed: ") + cairo_status_to_string(status));
  }
}

void set_colour(cairo_t* context, const Rgb& colour, double opacity) {
  cairo_set_source_rgba(context, colour.red, colour.green, colour.blue, opacity);
}

// Fixed, so that the defaults of a user's font configuration change no bits. (Rules that force a
// rendering on programs still can.)
void set_font(cairo_t* context, const TextStyle& style) {
  const CairoOwner<cairo_font_options_t> options(cairo_font_options_create());
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options.get());
  cairo_select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, style.size);
}

double width_of(cairo_t* context, const std::string& clean) {
  cairo_text_extents_t extents{};
  cairo_text_extents(context, clean.c_str(), &extents);
  check(cairo_status(context));
  return extents.x_advance;
}

void trace_path(cairo_t* context, std::span<const PagePoint> points) {
  cairo_new_path(context);
  for (const PagePoint& point : points) cairo_line_to(context, point.x, point.y);
}

void stroke_path(cairo_t* context, const Stroke& stroke) {
  set_colour(context, stroke.colour, stroke.opacity);
  cairo_set_line_width(context, stroke.width);
  cairo_set_dash(context, stroke.dashes.data(), static_cast<int>(stroke.dashes.size()), 0.0);
  cairo_stroke(context);
}

cairo_status_t append_bytes(void* text, const unsigned char* bytes, unsigned count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

CairoOwner<cairo_surface_t> surface_of(int width, int height, std::span<const uint32_t> argb) {
  CairoOwner<cairo_surface_t> cells(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height));
  check(cairo_surface_status(cells.get()));
  unsigned char* const bytes = cairo_image_surface_get_data(cells.get());
  const int stride = cairo_image_surface_get_stride(cells.get());
  for (int row = 0; row < height; ++row) {
    auto* const out = reinterpret_cast<uint32_t*>(bytes + static_cast<ptrdiff_t>(row) * stride);
    for (int column = 0; column < width; ++column) {
      const uint32_t pixel = argb[static_cast<size_t>(row) * width + column];
      const uint32_t alpha = pixel >> 24;
      const auto channel = [&](int bits) {
        return ((((pixel >> bits) & 0xFFu) * alpha + 127u) / 255u) << bits;
      };
      out[column] = (alpha << 24) | channel(16) | channel(8) | channel(0);
    }
  }
  cairo_surface_mark_dirty(cells.get());
  return cells;
}

// cairo numbers surfaces through the life of the process; here from 1 in every document.
std::string with_own_surface_numbers(const std::string& svg) {
  constexpr std::string_view stem = "surface";
  std::map<std::string, size_t> numbers;
  std::string result;
  size_t position = 0;
  for (size_t found = svg.find(stem); found != std::string::npos;
       found = svg.find(stem, position)) {
    const size_t digits = found + stem.size();
    const size_t end = std::min(svg.size(), svg.find_first_not_of("0123456789", digits));
    result.append(svg, position, digits - position);
    if (end > digits) {
      const auto entry = numbers.try_emplace(svg.substr(digits, end - digits), numbers.size() + 1);
      result += std::to_string(entry.first->second);
    }
    position = end;
  }
  return result.append(svg, position);
}

class CairoPage final : public Canvas::Page {
 public:
  // A white page of pixels, `scale` pixels per point.
  CairoPage(double width, double height, double scale);
  // A white page of vectors.
  CairoPage(double width, double height);

  void fill(const PageBox& box, const Rgb& colour, double opacity) override;
  void fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity) override;
  void discs(std::span<const PagePoint> centres, double radius, const Rgb& colour) override;
  void line(std::span<const PagePoint> points, const Stroke& stroke) override;
  void outline(const PageBox& box, const Stroke& stroke) override;
  void text(const std::string& clean, const PagePoint& at, const TextStyle& style) override;
  void image(const PageBox& box, int width, int height, std::span<const uint32_t> argb) override;
  void begin_clip(const PageBox& box) override;
  void end_clip() override;
  Picture finish_pixels() override;
  std::string finish_svg() override;

 private:
  void start(double width, double height);

  std::string svg_;  // outlives the surface that writes to it
  CairoOwner<cairo_surface_t> surface_;
  CairoOwner<cairo_t> context_;
};

CairoPage::CairoPage(double width, double height, double scale)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                          static_cast<int>(std::lround(width * scale)),
                                          static_cast<int>(std::lround(height * scale)))) {
  cairo_surface_set_device_scale(surface_.get(), scale, scale);
  start(width, height);
}

CairoPage::CairoPage(double width, double height)
    : surface_(cairo_svg_surface_create_for_stream(&append_bytes, &svg_, width, height)) {
  start(width, height);
}

void CairoPage::start(double width, double height) {
  check(cairo_surface_status(surface_.get()));
  context_.reset(cairo_create(surface_.get()));
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
  set_colour(context_.get(), {1.0, 1.0, 1.0}, 1.0);
  cairo_rectangle(context_.get(), 0.0, 0.0, width, height);
  cairo_fill(context_.get());
}

void CairoPage::fill(const PageBox& box, const Rgb& colour, double opacity) {
  set_colour(context_.get(), colour, opacity);
  cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
  cairo_fill(context_.get());
}

void CairoPage::fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity) {
  trace_path(context_.get(), polygon);
  cairo_close_path(context_.get());
  set_colour(context_.get(), colour, opacity);
  cairo_fill(context_.get());
}

void CairoPage::discs(std::span<const PagePoint> centres, double radius, const Rgb& colour) {
  set_colour(context_.get(), colour, 1.0);
  for (const PagePoint& centre : centres) {
    cairo_new_path(context_.get());
    cairo_arc(context_.get(), centre.x, centre.y, radius, 0.0, 2.0 * std::numbers::pi);
    cairo_fill(context_.get());
  }
}

void CairoPage::line(std::span<const PagePoint> points, const Stroke& stroke) {
  trace_path(context_.get(), points);
  stroke_path(context_.get(), stroke);
}

void CairoPage::outline(const PageBox& box, const Stroke& stroke) {
  cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
  stroke_path(context_.get(), stroke);
}

void CairoPage::text(const std::string& clean, const PagePoint& at, const TextStyle& style) {
  cairo_t* const context = context_.get();
  set_font(context, style);
  constexpr double capital_height = 0.729;  // of DejaVu Sans, in ems
  const double shift = style.align == TextAlign::left    ? 0.0
                       : style.align == TextAlign::right ? 1.0
                                                         : 0.5;
  cairo_save(context);
  cairo_translate(context, at.x, at.y);
  cairo_rotate(context, -style.turn_rad);
  cairo_move_to(context, shift == 0.0 ? 0.0 : -shift * width_of(context, clean),
                style.level == TextLevel::middle ? 0.5 * capital_height * style.size : 0.0);
  set_colour(context, style.colour, 1.0);
  cairo_show_text(context, clean.c_str());
  cairo_restore(context);
  cairo_new_path(context);
}

void CairoPage::image(const PageBox& box, int width, int height, std::span<const uint32_t> argb) {
  const CairoOwner<cairo_surface_t> cells = surface_of(width, height, argb);
  cairo_t* const context = context_.get();
  cairo_save(context);
  cairo_translate(context, box.x, box.y);
  cairo_scale(context, box.width / width, box.height / height);
  cairo_set_source_surface(context, cells.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_NEAREST);
  cairo_rectangle(context, 0.0, 0.0, width, height);
  cairo_fill(context);
  cairo_restore(context);
}

void CairoPage::begin_clip(const PageBox& box) {
  cairo_save(context_.get());
  cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
  cairo_clip(context_.get());
}

void CairoPage::end_clip() {
  cairo_restore(context_.get());
}

Picture CairoPage::finish_pixels() {
  check(cairo_status(context_.get()));
  cairo_surface_t* const surface = surface_.get();
  cairo_surface_flush(surface);
  const unsigned char* const bytes = cairo_image_surface_get_data(surface);
  if (bytes == nullptr) throw NumericalError("drawing failed: not a canvas of pixels");
  const int stride = cairo_image_surface_get_stride(surface);
  Picture picture{
      cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface), {}};
  picture.rgb.reserve(size_t{3} * picture.width * picture.height);
  for (int row = 0; row < picture.height; ++row) {
    const auto* const in =
        reinterpret_cast<const uint32_t*>(bytes + static_cast<ptrdiff_t>(row) * stride);
    for (int column = 0; column < picture.width; ++column) {
      for (const int bits : {16, 8, 0}) {
        picture.rgb.push_back(static_cast<uint8_t>(in[column] >> bits));
      }
    }
  }
  return picture;
}

std::string CairoPage::finish_svg() {
  check(cairo_status(context_.get()));
  context_.reset();
  cairo_surface_finish(surface_.get());
  check(cairo_surface_status(surface_.get()));
  return with_own_surface_numbers(svg_);
}

}  // namespace

std::string png_of(int width, int height, std::span<const uint32_t> argb) {
  const CairoOwner<cairo_surface_t> cells = surface_of(width, height, argb);
  std::string png;
  check(cairo_surface_write_to_png_stream(cells.get(), &append_bytes, &png));
  return png;
}

double text_width(const std::string& text, const TextStyle& style) {
  const CairoOwner<cairo_surface_t> surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const CairoOwner<cairo_t> context(cairo_create(surface.get()));
  set_font(context.get(), style);
  return width_of(context.get(), clean_text(text));
}

Canvas Canvas::of_pixels(double width, double height, double scale) {
  return Canvas(std::make_unique<CairoPage>(width, height, scale));
}

Canvas Canvas::of_vectors(double width, double height) {
  return Canvas(std::make_unique<CairoPage>(width, height));
}

}  // namespace photorque

// The only file that uses cairo.
#include "images/drawing/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fontconfig/fontconfig.h>

#include <map>

#include "core/errors.h"
#include "core/files.h"
#include "core/text/format.h"

namespace photorque {

struct CairoDelete {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_pattern_t* pattern) const { cairo_pattern_destroy(pattern); }
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
template <class T>
using CairoOwner = std::unique_ptr<T, CairoDelete>;

namespace {

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw NumericalError(std::string("drawing failed: ") + cairo_status_to_string(status));
  }
}

void set_colour(cairo_t* context, const Rgb& colour, double opacity) {
  cairo_set_source_rgba(context, colour.red, colour.green, colour.blue, opacity);
}

// Uses the fonts of an archive or wheel, which contain a font configuration, so that pictures have
// letters on a machine without fonts. Other installations use the machine's configuration.
void use_bundled_fonts() {
  const std::filesystem::path folder = own_file().parent_path();
  for (const std::filesystem::path& prefix : {folder, folder / ".."}) {
    const std::filesystem::path file = prefix / "share/photorque/fonts/fonts.conf";
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(file, unreadable)) continue;
    FcConfig* const config = FcConfigCreate();
    const auto* const name = reinterpret_cast<const FcChar8*>(file.c_str());
    if (FcConfigParseAndLoad(config, name, FcTrue) && FcConfigBuildFonts(config)) {
      FcConfigSetCurrent(config);
    }
    FcConfigDestroy(config);
    return;
  }
}

// Sets all font options, so that the defaults of a user's font configuration do not change the
// result. (Rules that force a rendering on programs still can.)
void set_font(cairo_t* context, const TextStyle& style) {
  [[maybe_unused]] static const bool has_fonts = (use_bundled_fonts(), true);
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

bool is_on_file(cairo_t* context) {
  return cairo_surface_get_type(cairo_get_target(context)) != CAIRO_SURFACE_TYPE_IMAGE;
}

// Files store coordinates rounded to an eighth of a point, which halves their size.
void trace_path(cairo_t* context, std::span<const PagePoint> points) {
  const bool rounds = is_on_file(context);
  const auto placed = [&](double x) { return rounds ? std::round(8.0 * x) / 8.0 : x; };
  cairo_new_path(context);
  for (const PagePoint& point : points) cairo_line_to(context, placed(point.x), placed(point.y));
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

// Renumbers surfaces and images from 1 in every document: cairo numbers them throughout the
// process.
std::string with_own_numbers(const std::string& svg) {
  std::map<std::string, size_t> numbers;
  std::string result;
  size_t done = 0;
  for (size_t mark = svg.find_first_of("\"#"); mark != std::string::npos;
       mark = svg.find_first_of("\"#", mark + 1)) {
    for (const std::string_view stem : {"surface", "image"}) {
      if (svg.compare(mark + 1, stem.size(), stem) != 0) continue;
      const size_t digits = mark + 1 + stem.size();
      const size_t end = std::min(svg.size(), svg.find_first_not_of("0123456789", digits));
      if (end == digits) continue;
      const auto entry = numbers.try_emplace(svg.substr(digits, end - digits), numbers.size() + 1);
      result.append(svg, done, digits - done).append(std::to_string(entry.first->second));
      done = end;
    }
  }
  return result.append(svg, done);
}

constexpr double capital_height = 0.729;  // of DejaVu Sans, in ems

// An SVG text element, with the width of the font used for the layout.
std::string text_element(const std::string& clean, const PagePoint& at, const TextStyle& style,
                         double width) {
  const auto [red, green, blue] = rgb_bytes(style.colour);
  const char* const anchor = style.align == TextAlign::left    ? "start"
                             : style.align == TextAlign::right ? "end"
                                                               : "middle";
  const double down = style.level == TextLevel::middle ? 0.5 * capital_height * style.size : 0.0;
  if (clean.empty()) return "";
  return printed(
             "<text transform=\"translate(%.2f %.2f) rotate(%.2f)\" y=\"%.2f\" "
             "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"%.2f\"%s "
             "fill=\"#%02x%02x%02x\" text-anchor=\"%s\" textLength=\"%.2f\" "
             "lengthAdjust=\"spacingAndGlyphs\">",
             at.x, at.y, -style.turn_rad * 180.0 / std::numbers::pi, down, style.size,
             style.bold ? " font-weight=\"bold\"" : "", red, green, blue, anchor, width) +
         xml_text(clean) + "</text>\n";
}

// Inserts elements before the end of the root element.
std::string with_text(std::string svg, const std::string& elements) {
  const size_t end = svg.rfind("</svg>");
  return end == std::string::npos ? svg : svg.insert(end, elements);
}

}  // namespace

double text_width(const std::string& text, const TextStyle& style) {
  const CairoOwner<cairo_surface_t> surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const CairoOwner<cairo_t> context(cairo_create(surface.get()));
  set_font(context.get(), style);
  return width_of(context.get(), clean_text(text));
}

struct Canvas::Page {
  std::string bytes;  // of a file; must outlive the surface that writes to it
  Letters letters = Letters::outlines;
  std::string text_elements = {};  // texts of an SVG page, above all other elements
  CairoOwner<cairo_surface_t> surface;
  CairoOwner<cairo_t> context;

  void start(double width, double height) {
    check(cairo_surface_status(surface.get()));
    context.reset(cairo_create(surface.get()));
    cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
    set_colour(context.get(), {1.0, 1.0, 1.0}, 1.0);
    cairo_rectangle(context.get(), 0.0, 0.0, width, height);
    cairo_fill(context.get());
  }
};

Canvas::Canvas(std::unique_ptr<Page> page) : page_(std::move(page)) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

Canvas Canvas::of_pixels(double width, double height, double scale) {
  auto page = std::make_unique<Page>();
  page->surface.reset(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                                 static_cast<int>(std::lround(width * scale)),
                                                 static_cast<int>(std::lround(height * scale))));
  cairo_surface_set_device_scale(page->surface.get(), scale, scale);
  page->start(width, height);
  return Canvas(std::move(page));
}

Canvas Canvas::of_svg(double width, double height, Letters letters) {
  auto page = std::make_unique<Page>();
  page->letters = letters;
  page->surface.reset(
      cairo_svg_surface_create_for_stream(&append_bytes, &page->bytes, width, height));
  page->start(width, height);
  return Canvas(std::move(page));
}

Canvas Canvas::of_pdf(double width, double height, const PdfText& text) {
  auto page = std::make_unique<Page>();
  page->surface.reset(
      cairo_pdf_surface_create_for_stream(&append_bytes, &page->bytes, width, height));
  for (const auto& [what, value] : {std::pair{CAIRO_PDF_METADATA_TITLE, text.title},
                                    {CAIRO_PDF_METADATA_SUBJECT, text.subject},
                                    {CAIRO_PDF_METADATA_CREATOR, text.program},
                                    {CAIRO_PDF_METADATA_CREATE_DATE, std::string()}}) {
    cairo_pdf_surface_set_metadata(page->surface.get(), what, clean_text(value).c_str());
  }
  page->start(width, height);
  return Canvas(std::move(page));
}

void Canvas::fill(const PageBox& box, const Rgb& colour, double opacity) {
  set_colour(page_->context.get(), colour, opacity);
  cairo_rectangle(page_->context.get(), box.x, box.y, box.width, box.height);
  cairo_fill(page_->context.get());
}

void Canvas::fill(std::span<const PagePoint> polygon, const Rgb& colour, double opacity) {
  trace_path(page_->context.get(), polygon);
  cairo_close_path(page_->context.get());
  set_colour(page_->context.get(), colour, opacity);
  cairo_fill(page_->context.get());
}

void Canvas::disc(const PagePoint& centre, double radius, const Rgb& colour) {
  discs({&centre, 1}, radius, colour);
}

void Canvas::discs(std::span<const PagePoint> centres, double radius, const Rgb& colour) {
  cairo_t* const context = page_->context.get();
  set_colour(context, colour, 1.0);
  if (!is_on_file(context)) {
    for (const PagePoint& centre : centres) {
      cairo_new_path(context);
      cairo_arc(context, centre.x, centre.y, radius, 0.0, 2.0 * std::numbers::pi);
      cairo_fill(context);
    }
    return;
  }
  // Lines of zero length with round ends: a fifth of the bytes of circles in a file.
  cairo_new_path(context);
  for (const PagePoint& centre : centres) {
    const double x = std::round(8.0 * centre.x) / 8.0, y = std::round(8.0 * centre.y) / 8.0;
    cairo_move_to(context, x, y);
    cairo_line_to(context, x, y);
  }
  cairo_set_line_cap(context, CAIRO_LINE_CAP_ROUND);
  stroke_path(context, {colour, 2.0 * radius});
  cairo_set_line_cap(context, CAIRO_LINE_CAP_BUTT);
}

void Canvas::line(std::span<const PagePoint> points, const Stroke& stroke) {
  trace_path(page_->context.get(), points);
  stroke_path(page_->context.get(), stroke);
}

void Canvas::line(const PagePoint& from, const PagePoint& to, const Stroke& stroke) {
  line(std::array{from, to}, stroke);
}

void Canvas::outline(const PageBox& box, const Stroke& stroke) {
  cairo_rectangle(page_->context.get(), box.x, box.y, box.width, box.height);
  stroke_path(page_->context.get(), stroke);
}

void Canvas::text(const std::string& text, const PagePoint& at, const TextStyle& style) {
  const std::string clean = clean_text(text);
  cairo_t* const context = page_->context.get();
  set_font(context, style);
  if (page_->letters == Letters::text) {
    page_->text_elements += text_element(clean, at, style, width_of(context, clean));
    return;
  }
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

void Canvas::image(const PageBox& box, int width, int height, std::span<const uint32_t> argb) {
  const CairoOwner<cairo_surface_t> cells = surface_of(width, height, argb);
  cairo_t* const context = page_->context.get();
  cairo_save(context);
  cairo_translate(context, box.x, box.y);
  cairo_scale(context, box.width / width, box.height / height);
  cairo_set_source_surface(context, cells.get(), 0.0, 0.0);
  cairo_pattern_set_filter(cairo_get_source(context), CAIRO_FILTER_NEAREST);
  cairo_rectangle(context, 0.0, 0.0, width, height);
  cairo_fill(context);
  cairo_restore(context);
}

void Canvas::begin_clip(const PageBox& box) {
  cairo_save(page_->context.get());
  cairo_rectangle(page_->context.get(), box.x, box.y, box.width, box.height);
  cairo_clip(page_->context.get());
}

void Canvas::end_clip() {
  cairo_restore(page_->context.get());
}

Picture Canvas::finish_pixels() {
  check(cairo_status(page_->context.get()));
  cairo_surface_t* const surface = page_->surface.get();
  cairo_surface_flush(surface);
  const unsigned char* const bytes = cairo_image_surface_get_data(surface);
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

std::string Canvas::finish_file() {
  check(cairo_status(page_->context.get()));
  page_->context.reset();
  cairo_surface_finish(page_->surface.get());
  check(cairo_surface_status(page_->surface.get()));
  return cairo_surface_get_type(page_->surface.get()) == CAIRO_SURFACE_TYPE_SVG
             ? with_text(with_own_numbers(page_->bytes), page_->text_elements)
             : page_->bytes;
}

std::string Canvas::finish_html(const std::string& title) {
  const std::string svg = finish_file();
  return "<img class=\"drawn\" alt=\"" + xml_text(title) + "\" src=\"data:image/svg+xml;base64," +
         base64(std::as_bytes(std::span(svg))) + "\">\n";
}

}  // namespace photorque

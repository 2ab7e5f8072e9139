#include "images/drawing/page_layout.h"

#include "core/text/format.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr double colour_bar_thickness = 16.0;
constexpr double caption_gap = 10.0;
constexpr Rgb alarm = {0.78, 0.1, 0.05};

// Longest beginning of `text`, at least one character, that is at most `width` wide.
std::string longest_fitting_prefix(const std::string& text, double width, const TextStyle& style) {
  std::string beginning;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string longer = beginning + std::string(rest.substr(0, first_character_bytes(rest)));
    if (!beginning.empty() && text_width(longer, style) > width) break;
    rest.remove_prefix(longer.size() - beginning.size());
    beginning = longer;
  }
  return beginning;
}

std::vector<std::string> broken_lines(const std::string& text, double width,
                                      const TextStyle& style) {
  std::vector<std::string> lines;
  std::string line;
  for (const std::string_view next : words_of(text)) {
    std::string word(next);
    const std::string longer = line.empty() ? word : line + " " + word;
    if (text_width(longer, style) <= width) {
      line = longer;
      continue;
    }
    if (!line.empty()) lines.push_back(line);
    while (text_width(word, style) > width) {  // a word wider than a line, such as a path
      lines.push_back(longest_fitting_prefix(word, width, style));
      word.erase(0, lines.back().size());
    }
    line = word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::string ended_by_ellipsis(std::string line, double width, const TextStyle& style) {
  const double room = width - text_width("…", style);
  if (text_width(line, style) > room) line = longest_fitting_prefix(line, room, style);
  return line + "…";
}

}  // namespace

TextBlock fitted_text(const std::string& text, double width, TextStyle style, double smallest_size,
                      int max_lines) {
  const std::string clean = clean_text(text);
  std::vector<std::string> lines = broken_lines(clean, width, style);
  const auto most = static_cast<size_t>(max_lines);
  while (lines.size() > most && style.size > smallest_size) {
    style.size = std::max(smallest_size, style.size - 0.5);
    lines = broken_lines(clean, width, style);
  }
  if (lines.size() > most) {
    lines.resize(most);
    lines.back() = ended_by_ellipsis(lines.back(), width, style);
  }
  if (lines.empty()) lines.emplace_back();
  return {lines, style};
}

void draw_text(Canvas& canvas, const TextBlock& block, const PagePoint& top_left) {
  double y = top_left.y + block.style.size;
  for (const std::string& line : block.lines) {
    canvas.text(line, {top_left.x, y}, block.style);
    y += block.line_height();
  }
}

double PageText::body_top() const {
  const double text = title.height() + warnings.height();
  return page_margin + (text > 0.0 ? text + 9.0 : 0.0);
}

double PageText::page_height(double body_height) const {
  const double below = caption.lines.empty() ? 0.0 : caption_gap + caption.height();
  return body_top() + body_height + below + 0.7 * page_margin;
}

PageText page_text(const std::string& title, const std::string& caption,
                   const Provenance& provenance, double page_width, PictureStyle style) {
  const double width = page_width - 2.0 * page_margin;
  std::string warnings;
  for (const std::string& warning : provenance.warnings) {
    warnings += (warnings.empty() ? "WARNING: " : "; ") + warning;
  }
  const TextStyle loud = {.size = 10.5, .colour = alarm, .bold = true};
  PageText page{fitted_text(title, width, {.size = 15.0, .bold = true}, 10.0, 2),
                fitted_text(warnings, width, loud, 7.5, 4),
                fitted_text(caption, width, {.size = 10.5}, 8.5, 3)};
  if (style == PictureStyle::paper) page.title.lines.clear();
  if (caption.empty() || style != PictureStyle::page) page.caption.lines.clear();
  if (warnings.empty()) page.warnings.lines.clear();
  return page;
}

void draw_page_text(Canvas& canvas, const PageText& text, double body_height) {
  draw_text(canvas, text.title, {page_margin, page_margin});
  draw_text(canvas, text.warnings, {page_margin, page_margin + text.title.height() + 2.0});
  draw_text(canvas, text.caption, {page_margin, text.body_top() + body_height + caption_gap});
}

Picture DrawnPage::pixels() const {
  const double per_point = pixels_per_point(style);
  Canvas canvas = Canvas::of_pixels(width, height, per_point);
  draw(canvas, per_point);
  return canvas.finish_pixels();
}

// Pixels per point of the images of a vector page.
constexpr double vector_pixels = 3.0;

std::string DrawnPage::svg() const {
  Canvas canvas = Canvas::of_svg(width, height, Canvas::Letters::text);
  draw(canvas, vector_pixels);
  return canvas.finish_file();
}

std::string DrawnPage::pdf(const PdfText& text) const {
  Canvas canvas = Canvas::of_pdf(width, height, text);
  draw(canvas, vector_pixels);
  return canvas.finish_file();
}

double ColourBar::width() const {
  return std::max(colour_bar_thickness + tick_labels_width(axis),
                  text_width(unit_with_power(unit, axis.ticks.exponent), tick_style));
}

ColourBar colour_bar(const ColourScale& scale, const std::string& unit, double height) {
  return {scale, vertical_axis({scale.low, scale.high}, false, "", height), unit};
}

void draw_colour_bar(Canvas& canvas, const ColourBar& bar, const PagePoint& top_left,
                     double height) {
  std::vector<uint32_t> colours;
  for (size_t i = bar.scale.map.colours.size(); i-- > 0;) {
    colours.push_back(opaque_argb(rgb_bytes(bar.scale.map.colours[i])));
  }
  const PageBox box{top_left.x, top_left.y, colour_bar_thickness, height};
  canvas.image(box, 1, static_cast<int>(colours.size()), colours);
  canvas.outline(box, {ink, 0.8});
  TextStyle style = tick_style;
  canvas.text(unit_with_power(bar.unit, bar.axis.ticks.exponent), {box.x, box.y - 0.6 * style.size},
              style);
  style.level = TextLevel::middle;
  for (size_t i = 0; i < bar.axis.ticks.values.size(); ++i) {
    const double y = box.bottom() - height * bar.axis.fraction(bar.axis.ticks.values[i]);
    canvas.line({box.right(), y}, {box.right() + tick_length, y}, {ink, 0.8});
    canvas.text(bar.axis.ticks.labels[i], {box.right() + tick_length + 3.0, y}, style);
  }
}

}  // namespace photorque

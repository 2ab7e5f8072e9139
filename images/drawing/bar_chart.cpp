#include "images/drawing/plot.h"

#include "core/text/format.h"
#include "images/drawing/curves.h"
#include "images/drawing/page_layout.h"

namespace photorque {
namespace {

constexpr double row_height = 27.0;
constexpr double bar_thickness = 18.0;
constexpr double text_gap = 6.0;  // between a bar and the texts beside it
constexpr TextStyle text_style{.size = 12.0, .level = TextLevel::middle};
constexpr Rgb plain_bar = rgb_from_hex(0x9AA7B5);
constexpr Rgb note_colour = rgb_from_hex(0x4A525B);

TextStyle style_of(const BarChart::Bar& bar, TextAlign align) {
  TextStyle style = text_style;
  style.bold = bar.highlighted;
  style.align = align;
  return style;
}

std::string number_of(const BarChart::Bar& bar) {
  return readable_number(bar.value, 3);
}

// Columns of the chart: labels, numbers of negative bars, bars, numbers of positive bars, notes.
struct BarLayout {
  double label_width = 0.0;
  double from = 0.0, to = 0.0;  // range of the bars
  double note_x = 0.0;
  AxisRange range{0.0, 0.0};

  double x(double value) const {
    return from + (to - from) * (value - range.low) / (range.high - range.low);
  }
};

BarLayout layout_of(const BarChart& chart) {
  constexpr double widest_label = 390.0, narrowest_bars = 120.0;
  BarLayout layout;
  double note_width = 0.0, left_number = 0.0, right_number = 0.0;
  for (const BarChart::Bar& bar : chart.bars) {
    const TextStyle style = style_of(bar, TextAlign::left);
    layout.label_width = std::max(layout.label_width, text_width(bar.label, style));
    note_width = std::max(note_width, text_width(bar.note, text_style));
    double& number_width = bar.value < 0.0 ? left_number : right_number;
    number_width = std::max(number_width, text_width(number_of(bar), style) + 2.0 * text_gap);
    if (!std::isfinite(bar.value)) continue;
    layout.range.low = std::min(layout.range.low, bar.value);
    layout.range.high = std::max(layout.range.high, bar.value);
  }
  if (layout.range.low == layout.range.high) layout.range.high = 1.0;
  layout.label_width = std::min(layout.label_width, widest_label);
  layout.from = layout.label_width + 2.0 * text_gap + left_number;
  const double right = html_chart_width - right_number;
  layout.to = std::max(layout.from + narrowest_bars, right - note_width - 2.0 * text_gap);
  layout.to = std::min(layout.to, std::max(layout.from, right));
  layout.note_x = layout.to + right_number + text_gap;
  return layout;
}

void draw_bar(Canvas& canvas, const BarChart::Bar& bar, const BarLayout& layout, double middle) {
  const double zero = layout.x(0.0);
  const double end = std::isfinite(bar.value) ? layout.x(bar.value) : zero;
  const TextBlock label = fitted_text(bar.label, layout.label_width + 1.0,
                                      style_of(bar, TextAlign::right), text_style.size, 1);
  canvas.text(label.lines.front(), {layout.label_width + 1.0, middle}, label.style);
  canvas.fill(PageBox{std::min(zero, end), middle - 0.5 * bar_thickness, std::abs(end - zero),
                      bar_thickness},
              bar.highlighted ? curve_stroke(0).colour : plain_bar);
  const bool negative = bar.value < 0.0;
  canvas.text(number_of(bar), {negative ? end - text_gap : end + text_gap, middle},
              style_of(bar, negative ? TextAlign::right : TextAlign::left));
  if (bar.note.empty()) return;
  TextStyle note = text_style;
  note.colour = note_colour;
  const TextBlock fitted = fitted_text(bar.note, html_chart_width - layout.note_x, note, 9.5, 1);
  canvas.text(fitted.lines.front(), {layout.note_x, middle}, fitted.style);
}

// Text alternative of the bars for screen readers.
std::string bars_in_words(const BarChart& chart) {
  std::string words = chart.title + " (" + chart.x_label + ")";
  for (const BarChart::Bar& bar : chart.bars) {
    words += "; " + bar.label + ": " + number_of(bar) + (bar.note.empty() ? "" : ", " + bar.note);
  }
  return words;
}

}  // namespace

std::string bar_chart_html(const BarChart& chart) {
  const BarLayout layout = layout_of(chart);
  const double bottom = row_height * static_cast<double>(chart.bars.size()) + 4.0;
  Canvas canvas = Canvas::of_svg(html_chart_width, bottom + 26.0);
  for (size_t i = 0; i < chart.bars.size(); ++i) {
    draw_bar(canvas, chart.bars[i], layout, 4.0 + row_height * (static_cast<double>(i) + 0.5));
  }
  const double zero = layout.x(0.0);
  canvas.line({zero, 2.0}, {zero, bottom}, {ink, 1.0});
  TextStyle style = label_style;
  style.align = TextAlign::centre;
  const double half = 0.5 * text_width(chart.x_label, style);
  const double middle = std::max(half, 0.5 * (layout.from + layout.to));
  canvas.text(chart.x_label, {middle, bottom + 18.0}, style);
  return canvas.finish_html(bars_in_words(chart));
}

}  // namespace photorque

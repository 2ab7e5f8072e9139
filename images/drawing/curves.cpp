#include "images/drawing/curves.h"

#include <set>

#include "core/text/format.h"
#include "images/drawing/page_layout.h"

namespace photorque {
namespace {

constexpr double marker_radius = 2.4;
constexpr double legend_row = 16.0;
constexpr double legend_sample = 24.0;
constexpr double legend_padding = 7.0;

bool drawable_point(const PagePoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y);
}

// Continuous pieces of the curve on the page, separated by values that cannot be shown. `errors`
// shifts the curve by this multiple of its errors.
std::vector<std::vector<PagePoint>> pieces_of(const ChartPanel& panel, const Plot::Curve& curve,
                                              double errors) {
  std::vector<std::vector<PagePoint>> pieces(1);
  for (size_t i = 0; i < curve.x.size(); ++i) {
    const double shift = errors == 0.0 ? 0.0 : errors * curve.y_error[i];
    const PagePoint point = panel.at(curve.x[i], curve.y[i] + shift);
    if (drawable_point(point)) {
      pieces.back().push_back(point);
    } else if (!pieces.back().empty()) {
      pieces.emplace_back();
    }
  }
  std::erase_if(pieces, [](const std::vector<PagePoint>& piece) { return piece.empty(); });
  return pieces;
}

void draw_band(Canvas& canvas, const ChartPanel& panel, const Plot::Curve& curve,
               const Rgb& colour) {
  const auto upper = pieces_of(panel, curve, 1.0);
  const auto lower = pieces_of(panel, curve, -1.0);
  if (upper.size() != lower.size()) return;  // one side exceeds a logarithmic axis
  for (size_t i = 0; i < upper.size(); ++i) {
    std::vector<PagePoint> polygon = thinned(upper[i], panel.resolution);
    const std::vector<PagePoint> back = thinned(lower[i], panel.resolution);
    polygon.insert(polygon.end(), back.rbegin(), back.rend());
    canvas.fill(polygon, colour, 0.22);
  }
}

void draw_error_bar(Canvas& canvas, const PagePoint& low, const PagePoint& high,
                    const Rgb& colour) {
  const Stroke stroke{colour, 1.0};
  canvas.line(low, high, stroke);
  canvas.line({low.x - 2.0, low.y}, {low.x + 2.0, low.y}, stroke);
  canvas.line({high.x - 2.0, high.y}, {high.x + 2.0, high.y}, stroke);
}

// Draws at most one marker per cell of the resolution, because others would cover an earlier one.
void draw_markers(Canvas& canvas, const ChartPanel& panel, const Plot::Curve& curve,
                  const Rgb& colour) {
  std::set<std::pair<int64_t, int64_t>> taken;
  for (size_t i = 0; i < curve.x.size(); ++i) {
    const PagePoint point = panel.at(curve.x[i], curve.y[i]);
    if (!drawable_point(point) || std::abs(point.x) > 1e6 || std::abs(point.y) > 1e6) continue;
    const auto cell = [&](double x) { return std::llround(x / panel.resolution); };
    if (!taken.emplace(cell(point.x), cell(point.y)).second) continue;
    if (!curve.y_error.empty()) {
      const PagePoint low = panel.at(curve.x[i], curve.y[i] - curve.y_error[i]);
      const PagePoint high = panel.at(curve.x[i], curve.y[i] + curve.y_error[i]);
      if (drawable_point(low) && drawable_point(high)) draw_error_bar(canvas, low, high, colour);
    }
    canvas.disc(point, marker_radius, colour);
  }
}

// Isolated points between gaps are drawn as dots, runs of them together.
void draw_lines(Canvas& canvas, const ChartPanel& panel, const Plot::Curve& curve,
                const Stroke& stroke) {
  std::vector<PagePoint> lone;
  const auto draw_lone = [&] {
    if (!lone.empty())
      canvas.discs(thinned(lone, panel.resolution), 0.8 * stroke.width, stroke.colour);
    lone.clear();
  };
  for (const std::vector<PagePoint>& piece : pieces_of(panel, curve, 0.0)) {
    if (piece.size() == 1) {
      lone.push_back(piece.front());
    } else {
      draw_lone();
      canvas.line(thinned(piece, panel.resolution), stroke);
    }
  }
  draw_lone();
}

// Draws a curve as dots, which need no continuous pieces.
void draw_dots(Canvas& canvas, const ChartPanel& panel, const Plot::Curve& curve,
               const Stroke& stroke) {
  std::vector<PagePoint> points;
  for (const std::vector<PagePoint>& piece : pieces_of(panel, curve, 0.0)) {
    points.insert(points.end(), piece.begin(), piece.end());
  }
  canvas.discs(thinned(points, panel.resolution), stroke.width, stroke.colour);
}

// Whether a bar extends between two values instead of from zero.
bool is_vertical_bar(const Plot::Curve& curve) {
  return curve.bars && curve.x.size() == 2 && curve.x[0] == curve.x[1];
}

// Whether bars are drawn without gaps: many bars at equal steps.
bool is_histogram(const Plot::Curve& curve) {
  constexpr size_t many = 30;
  return curve.x.size() >= many;
}
double half_width_of(const Plot::Curve& curve) {
  return is_histogram(curve) ? 0.5 * (curve.x[1] - curve.x[0]) : bar_half_width;
}

// The bar at the i-th point; empty for values that cannot be shown.
std::optional<PageBox> bar_of(const ChartPanel& panel, const Plot::Curve& curve, size_t i) {
  const double from = is_vertical_bar(curve) ? curve.y[0] : panel.y.log ? panel.y.range.low : 0.0;
  if (is_vertical_bar(curve)) i = 1;
  const double half = half_width_of(curve);
  const PagePoint top = panel.at(curve.x[i] - half, curve.y[i]);
  const PagePoint foot = panel.at(curve.x[i] + half, from);
  if (!drawable_point(top) || !drawable_point(foot)) return std::nullopt;
  return PageBox{top.x, std::min(top.y, foot.y), foot.x - top.x, std::abs(foot.y - top.y)};
}

void draw_bars(Canvas& canvas, const ChartPanel& panel, const Plot::Curve& curve,
               const Rgb& colour) {
  for (size_t i = 0; i < curve.x.size(); ++i) {
    auto bar = bar_of(panel, curve, i);
    if (!bar) continue;
    // Slightly wider than the step, so that no seams appear between adjacent bars.
    if (is_histogram(curve)) bar->width += 0.4;
    canvas.fill(*bar, colour);
  }
}

bool overlap(const PageBox& a, const PageBox& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

// Whether the segment from `a` to `b` meets `box` (Liang and Barsky, 1984).
bool meets(const PageBox& box, const PagePoint& a, const PagePoint& b) {
  double enter = 0.0;
  double leave = 1.0;
  const auto clip = [&](double start, double step, double low, double high) {
    if (step == 0.0) return start >= low && start <= high;
    const auto [first, second] = std::minmax({(low - start) / step, (high - start) / step});
    enter = std::max(enter, first);
    leave = std::min(leave, second);
    return enter <= leave;
  };
  return clip(a.x, b.x - a.x, box.x, box.right()) && clip(a.y, b.y - a.y, box.y, box.bottom());
}

// Draws the value of each vertical bar above it.
void draw_bar_numbers(Canvas& canvas, const ChartPanel& panel) {
  TextStyle style = tick_style;
  style.align = TextAlign::centre;
  for (const Plot::Curve& curve : panel.curves) {
    if (!is_vertical_bar(curve)) continue;
    const auto bar = bar_of(panel, curve, 1);
    if (!bar) continue;
    double size = curve.y[1] - curve.y[0];
    // Values within rounding errors are zero.
    if (std::abs(size) < 1e-9 * std::max(std::abs(curve.y[0]), std::abs(curve.y[1]))) size = 0.0;
    std::string text = readable_number(std::abs(size), 3);
    if (size < 0.0) text = "−" + text;
    canvas.text(text, {bar->centre().x, bar->y - 5.0}, style);
  }
}

bool covers_a_curve(const ChartPanel& panel, const PageBox& box) {
  for (const Plot::Curve& curve : panel.curves) {
    for (size_t i = 0; curve.bars && i < curve.x.size(); ++i) {
      if (const auto bar = bar_of(panel, curve, i); bar && overlap(*bar, box)) return true;
    }
    for (const double errors : {0.0, 1.0, -1.0}) {
      if (errors != 0.0 && curve.y_error.empty()) continue;
      for (const std::vector<PagePoint>& piece : pieces_of(panel, curve, errors)) {
        const std::vector<PagePoint> line =
            curve.markers ? piece : thinned(piece, panel.resolution);
        for (size_t i = 0; i < line.size(); ++i) {
          const PagePoint& from = curve.markers || i == 0 ? line[i] : line[i - 1];
          if (meets(box, from, line[i])) return true;
        }
      }
    }
  }
  return false;
}

// Draws the sample beside a curve's name in the legend; `left` is the middle of its left side.
void draw_sample(Canvas& canvas, const Plot::Curve& curve, const Stroke& stroke,
                 const PagePoint& left) {
  const double middle_x = left.x + 0.5 * legend_sample;
  if (curve.bars) {
    constexpr double side = 10.0;
    canvas.fill(PageBox{left.x + 0.5 * (legend_sample - side), left.y - 0.5 * side, side, side},
                stroke.colour);
  } else if (curve.markers) {
    canvas.disc({middle_x, left.y}, marker_radius, stroke.colour);
  } else if (curve.dots) {
    canvas.disc({middle_x, left.y}, stroke.width, stroke.colour);
  } else {
    canvas.line(left, {left.x + legend_sample, left.y}, stroke);
  }
}

}  // namespace

Stroke curve_stroke(size_t index) {
  constexpr std::array<uint32_t, 7> colours = {0x0072B2, 0xD55E00, 0x009E73, 0xCC79A7,
                                               0xE69F00, 0x56B4E9, 0x000000};
  const std::array<std::vector<double>, 3> dashes = {{{}, {6.0, 3.0}, {1.5, 2.5}}};
  return {rgb_from_hex(colours[index % colours.size()]), 1.6, 1.0,
          dashes[(index / colours.size()) % dashes.size()]};
}

Stroke curve_stroke(const Plot::Curve& curve, size_t index) {
  Stroke stroke = curve_stroke(index);
  switch (curve.colour) {
    case Plot::Colour::in_order:
      break;
    case Plot::Colour::blue:
      stroke = curve_stroke(0);
      break;
    case Plot::Colour::vermilion:
      stroke = curve_stroke(1);
      break;
    case Plot::Colour::green:
      stroke = curve_stroke(2);
      break;
    case Plot::Colour::grey:
      stroke.colour = rgb_from_hex(0x5C5C5C);
      stroke.dashes.clear();
      break;
  }
  stroke.width = curve.width;
  if (curve.dashed) stroke.dashes = {6.0, 4.0};
  return stroke;
}

PagePoint ChartPanel::at(double x_value, double y_value) const {
  return {frame.x + frame.width * x.fraction(x_value),
          frame.bottom() - frame.height * y.fraction(y_value)};
}

std::vector<PagePoint> thinned(std::span<const PagePoint> line, double resolution_points) {
  std::vector<PagePoint> result;
  const auto left_of = [](const PagePoint& a, const PagePoint& b) { return a.x < b.x; };
  const auto above = [](const PagePoint& a, const PagePoint& b) { return a.y < b.y; };
  const bool ordered = std::ranges::is_sorted(line, left_of);
  const double columns =
      line.empty() ? 0.0 : (line.back().x - line.front().x) / resolution_points + 1.0;
  if (!ordered || static_cast<double>(line.size()) <= 4.0 * columns) {
    return {line.begin(), line.end()};
  }
  const auto column = [&](const PagePoint& p) { return std::floor(p.x / resolution_points); };
  for (auto begin = line.begin(); begin != line.end();) {
    const auto end = std::find_if(begin, line.end(),
                                  [&](const PagePoint& p) { return column(p) != column(*begin); });
    const auto [low, high] = std::minmax_element(begin, end, above);
    std::array kept = {begin, std::min(low, high), std::max(low, high), end - 1};
    const auto last = std::unique(kept.begin(), kept.end());
    for (auto i = kept.begin(); i != last; ++i) result.push_back(**i);
    begin = end;
  }
  return result;
}

void draw_curves(Canvas& canvas, const ChartPanel& panel) {
  canvas.clipped(panel.frame, [&] {
    for (size_t i = 0; i < panel.curves.size(); ++i) {
      const Plot::Curve& curve = panel.curves[i];
      if (!curve.bars && !curve.markers && !curve.dots && !curve.y_error.empty()) {
        draw_band(canvas, panel, curve, curve_stroke(curve, i).colour);
      }
    }
    for (size_t i = 0; i < panel.curves.size(); ++i) {
      const Plot::Curve& curve = panel.curves[i];
      const Stroke stroke = curve_stroke(curve, i);
      if (curve.bars) {
        draw_bars(canvas, panel, curve, stroke.colour);
      } else if (curve.markers) {
        draw_markers(canvas, panel, curve, stroke.colour);
      } else if (curve.dots) {
        draw_dots(canvas, panel, curve, stroke);
      } else {
        draw_lines(canvas, panel, curve, stroke);
      }
    }
    draw_bar_numbers(canvas, panel);
  });
}

bool has_names_under_bars(const std::vector<Plot::Curve>& curves) {
  return !curves.empty() && std::ranges::all_of(curves, is_vertical_bar);
}

Legend legend_of(const std::vector<Plot::Curve>& curves, double widest) {
  Legend legend;
  if (has_names_under_bars(curves)) return legend;
  for (size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].label.empty() || curves[i].x.empty()) continue;
    legend.curves.push_back(i);
    legend.width = std::max(legend.width, text_width(curves[i].label, tick_style));
  }
  if (legend.curves.empty()) return {};
  legend.width = std::min(widest, legend.width + legend_sample + 3.0 * legend_padding);
  legend.rows = legend.curves.size();
  legend.height = legend_row * static_cast<double>(legend.rows) + 1.2 * legend_padding;
  return legend;
}

Legend in_columns(const Legend& legend, double room) {
  if (legend.curves.empty()) return legend;
  Legend wide = legend;
  const size_t count = legend.curves.size();
  const auto most = std::clamp<size_t>(static_cast<size_t>(room / legend.width), 1, count);
  wide.rows = (count + most - 1) / most;
  wide.width = legend.width * static_cast<double>((count + wide.rows - 1) / wide.rows);
  wide.height = legend_row * static_cast<double>(wide.rows) + 1.2 * legend_padding;
  return wide;
}

std::optional<PagePoint> free_corner(const ChartPanel& panel, const Legend& legend) {
  constexpr double inset = 6.0;
  const PageBox& frame = panel.frame;
  if (legend.width > 0.6 * frame.width || legend.height > 0.7 * frame.height) return std::nullopt;
  const double right = frame.right() - inset - legend.width;
  const double bottom = frame.bottom() - inset - legend.height;
  for (const PagePoint corner :
       {PagePoint{right, frame.y + inset}, PagePoint{frame.x + inset, frame.y + inset},
        PagePoint{right, bottom}, PagePoint{frame.x + inset, bottom}}) {
    if (!covers_a_curve(panel, {corner.x, corner.y, legend.width, legend.height})) return corner;
  }
  return std::nullopt;
}

void draw_legend(Canvas& canvas, const ChartPanel& panel, const Legend& legend,
                 const PagePoint& top_left) {
  canvas.fill(PageBox{top_left.x, top_left.y, legend.width, legend.height}, {1.0, 1.0, 1.0}, 0.85);
  const auto columns = static_cast<double>((legend.curves.size() + legend.rows - 1) / legend.rows);
  const double column_width = legend.width / columns;
  const double before_text = legend_sample + 2.0 * legend_padding;
  const double room = column_width - 0.5 * legend_padding - before_text;
  TextStyle style = tick_style;
  style.level = TextLevel::middle;
  // All labels use the size of the longest.
  for (const size_t index : legend.curves) {
    style.size = std::min(style.size,
                          fitted_text(panel.curves[index].label, room, style, 8.0, 1).style.size);
  }
  for (size_t i = 0; i < legend.curves.size(); ++i) {
    const size_t index = legend.curves[i];
    const double x = top_left.x + column_width * static_cast<double>(i / legend.rows);
    const double y = top_left.y + 0.6 * legend_padding +
                     legend_row * (static_cast<double>(i % legend.rows) + 0.5);
    const Plot::Curve& curve = panel.curves[index];
    draw_sample(canvas, curve, curve_stroke(curve, index), {x + legend_padding, y});
    const TextBlock label = fitted_text(curve.label, room, style, 8.0, 1);
    canvas.text(label.lines.front(), {x + before_text, y}, label.style);
  }
}

}  // namespace photorque

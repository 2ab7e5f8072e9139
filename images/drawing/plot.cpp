#include "images/drawing/plot.h"

#include "core/errors.h"
#include "core/text/parse.h"

namespace photorque {
namespace {

constexpr double gap_between_panels = 12.0;
constexpr double widest_legend = 170.0;
constexpr double gap_right_of_frame = 6.0;
constexpr Rgb grid_grey = {0.87, 0.87, 0.87};
constexpr Rgb shade = rgb_from_hex(0xE6EDF5);

// Range with a margin on both sides.
AxisRange padded(const Extent& extent, bool log, double margin) {
  if (extent.low > extent.high) return log ? AxisRange{1.0, 10.0} : AxisRange{0.0, 1.0};
  if (log) {
    // Within these limits the ratio of two values is finite.
    constexpr double least = 1e-150, most = 1e150;
    const double low = std::clamp(extent.low, least, most);
    const double high = std::clamp(extent.high, least, most);
    // As in drawable(), values that differ only by rounding count as equal.
    const bool is_constant = high <= (1.0 + 1e-9) * low;
    const double factor = is_constant ? std::sqrt(10.0) : std::pow(high / low, margin);
    return {low / factor, high * factor};
  }
  const AxisRange range = drawable({extent.low, extent.high});
  const double room = margin * (range.high - range.low);
  return {range.low - room, range.high + room};
}

AxisRange x_range(const std::vector<Plot::Panel>& panels, bool log) {
  Extent extent;
  bool markers = false;
  for (const Plot::Panel& panel : panels) {
    for (const Plot::Curve& curve : panel.curves) {
      // The space beside the outer bars equals that between two bars at 1, 2, …
      const double beside = !curve.bars           ? 0.0
                            : curve.x.size() < 30 ? 1.0 - bar_half_width
                                                  : 0.5 * (curve.x[1] - curve.x[0]);
      for (const double x : curve.x) {
        extent.include(x - beside, log);
        extent.include(x + beside, log);
      }
      markers = markers || curve.markers;
    }
  }
  return padded(extent, log, markers ? 0.03 : 0.0);
}

// Range of all shown values, or of the central 99.6 % if the panel requires it.
Extent curves_extent(const Plot::Panel& panel) {
  std::vector<double> values;
  for (const Plot::Curve& curve : panel.curves) {
    if (curve.bars) values.push_back(0.0);
    for (size_t i = 0; i < curve.y.size(); ++i) {
      const double error = curve.y_error.empty() ? 0.0 : curve.y_error[i];
      values.insert(values.end(), {curve.y[i], curve.y[i] - error, curve.y[i] + error});
    }
  }
  std::erase_if(values, [&](double v) { return !std::isfinite(v) || (panel.y_log && v <= 0.0); });
  Extent extent;
  if (values.empty()) return extent;
  std::ranges::sort(values);
  const size_t left_out = panel.robust_range ? values.size() / 500 : 0;
  extent.include(values[left_out], panel.y_log);
  extent.include(values[values.size() - 1 - left_out], panel.y_log);
  return extent;
}

AxisRange y_range(const Plot::Panel& panel) {
  const bool log = panel.y_log;
  Extent extent = curves_extent(panel);
  for (const double level : panel.levels) extent.include(level, log);
  // The values of vertical bars are written above them.
  AxisRange range = padded(extent, log, has_names_under_bars(panel.curves) ? 0.1 : 0.06);
  // If the quantity starts at zero, the axis does too.
  if (extent.low == 0.0 && extent.high > 0.0) range.low = 0.0;
  return range;
}

// Height of every panel, with space for the tallest legend. It decreases with the number of panels.
double usual_height(const std::vector<Plot::Panel>& panels, double scale) {
  constexpr std::array<double, 4> usual = {330.0, 200.0, 150.0, 120.0};
  double height = scale * usual[std::min(panels.size(), usual.size()) - 1];
  for (const Plot::Panel& panel : panels) {
    height = std::max(height, legend_of(panel.curves, widest_legend).height);
  }
  return height;
}

constexpr double smallest_name = 7.5;  // points

// Largest style in which every word of the names fits below its bar; empty if none does.
std::optional<TextStyle> style_of_words(const std::vector<Plot::Curve>& curves, double room,
                                        TextStyle style) {
  double widest = 0.0;
  for (const Plot::Curve& curve : curves) {
    for (const std::string_view word : words_of(curve.label)) {
      widest = std::max(widest, text_width(std::string(word), style));
    }
  }
  constexpr double rounding = 0.99;
  if (widest > rounding * room) style.size *= rounding * room / widest;
  return style.size >= smallest_name ? std::optional(style) : std::nullopt;
}

// Names below bars, within the width of the bar; rotated if words are wider.
std::vector<TextBlock> names_of(const ChartPanel& panel) {
  if (!has_names_under_bars(panel.curves)) return {};
  TextStyle style = tick_style;
  const double room = panel.frame.width / (panel.x.range.high - panel.x.range.low) - 6.0;
  const std::optional<TextStyle> of_words = style_of_words(panel.curves, room, style);
  const bool fits = of_words.has_value();
  if (fits) style = *of_words;
  style.align = fits ? TextAlign::centre : TextAlign::right;
  style.turn_rad = fits ? 0.0 : quarter_turn_rad;
  constexpr double longest = 130.0;
  std::vector<TextBlock> names;
  for (const Plot::Curve& curve : panel.curves) {
    names.push_back(fits ? fitted_text(curve.label, room, style, smallest_name, 5)
                         : fitted_text(curve.label, longest, style, smallest_name, 2));
  }
  return names;
}

double names_height(const ChartPanel& panel) {
  double height = 0.0;
  for (const TextBlock& name : names_of(panel)) {
    double length = name.height();
    if (name.style.turn_rad != 0.0) {
      length = 0.0;
      for (const std::string& line : name.lines) {
        length = std::max(length, text_width(line, name.style));
      }
    }
    height = std::max(height, length + 8.0);
  }
  return height;
}

void draw_names(Canvas& canvas, const ChartPanel& panel) {
  for (size_t i = 0; const TextBlock& name : names_of(panel)) {
    const double centre =
        panel.frame.x + panel.frame.width * panel.x.fraction(panel.curves[i++].x.front());
    const double top = panel.frame.bottom() + 4.0;
    for (size_t k = 0; k < name.lines.size(); ++k) {
      const double down = static_cast<double>(k) * name.line_height();
      const double middle = 0.5 * static_cast<double>(name.lines.size() - 1) * name.line_height();
      const PagePoint place = name.style.turn_rad == 0.0
                                  ? PagePoint{centre, top + name.style.size + down}
                                  : PagePoint{centre + 0.35 * name.style.size + down - middle, top};
      canvas.text(name.lines[k], place, name.style);
    }
  }
}

// Places the frames; their right side leaves `legend_width` free.
void place_frames(PlotLayout& layout, const PlotRoom& room, const Axis& x_axis,
                  double legend_width) {
  const double left = room.left + layout.axis_width;
  const double width = room.right - legend_width - left - gap_right_of_frame;
  double y = room.top;
  for (ChartPanel& panel : layout.panels) {
    panel.frame = {left, y, width, panel.frame.height};
    panel.x = x_axis;
    y += panel.frame.height + gap_between_panels;
  }
  layout.bottom = y - gap_between_panels +
                  std::max(horizontal_axis_height(x_axis), names_height(layout.panels.back()));
}

// Draws a horizontal line through the frame at a value of y.
void draw_level(Canvas& canvas, const ChartPanel& panel, double value, const Stroke& stroke) {
  const double y = panel.frame.bottom() - panel.frame.height * panel.y.fraction(value);
  if (std::isfinite(y)) canvas.line({panel.frame.x, y}, {panel.frame.right(), y}, stroke);
}

// Draws the grid and the zero line of a signed quantity, which the light grid does not emphasise.
void draw_grid(Canvas& canvas, const ChartPanel& panel) {
  const PageBox& frame = panel.frame;
  for (const double value : panel.x.ticks.values) {
    const double x = frame.x + frame.width * panel.x.fraction(value);
    canvas.line({x, frame.y}, {x, frame.bottom()}, {grid_grey, 0.7});
  }
  for (const double value : panel.y.ticks.values) {
    draw_level(canvas, panel, value, {grid_grey, 0.7});
  }
  const bool has_zero_inside = !panel.y.log && panel.y.range.low < 0.0 && panel.y.range.high > 0.0;
  if (has_zero_inside) draw_level(canvas, panel, 0.0, {{0.6, 0.6, 0.6}, 0.9});
}

// Draws shaded intervals. The label is at the top, or at the bottom if the legend covers the top.
void draw_shaded(Canvas& canvas, const ChartPanel& panel, const Plot& plot, bool with_label,
                 const PageBox& legend) {
  bool labelled = !with_label || plot.shaded_label.empty();
  for (const Plot::Interval& interval : plot.shaded) {
    const auto x_of = [&](double value) {
      const PageBox& frame = panel.frame;
      return std::clamp(frame.x + frame.width * panel.x.fraction(value), frame.x, frame.right());
    };
    const double from = x_of(interval.from), to = x_of(interval.to);
    if (!(to > from)) continue;
    canvas.fill(PageBox{from, panel.frame.y, to - from, panel.frame.height}, shade);
    if (labelled || to - from < text_width(plot.shaded_label, tick_style) + 12.0) continue;
    TextStyle style = tick_style;
    style.align = TextAlign::right;
    const double left = to - 6.0 - text_width(plot.shaded_label, style);
    const double top = panel.frame.y + 1.4 * style.size;
    const bool is_covered =
        legend.width > 0.0 && legend.x < to && left < legend.right() && legend.y < top;
    canvas.text(plot.shaded_label,
                {to - 6.0, is_covered ? panel.frame.bottom() - 0.7 * style.size : top}, style);
    labelled = true;
  }
}

constexpr double page_width = 640.0;

std::string caption_of(const Plot& plot) {
  const bool any = std::ranges::any_of(panels_of(plot), [](const Plot::Panel& panel) {
    return std::ranges::any_of(panel.curves,
                               [](const Plot::Curve& curve) { return !curve.y_error.empty(); });
  });
  return any ? "Bars and bands: ±1 standard error." : "";
}

}  // namespace

void require_consistent(const Plot& plot) {
  for (const Plot::Panel& panel : panels_of(plot)) {
    for (const Plot::Curve& curve : panel.curves) {
      const auto require = [&](const std::string& what, size_t found) {
        if (found == curve.x.size()) return;
        throw InputError({}, plot.name + "." + curve.label, std::to_string(found) + " " + what,
                         std::to_string(curve.x.size()) + " of them");
      };
      require("values of y", curve.y.size());
      if (!curve.y_error.empty()) require("errors of y", curve.y_error.size());
    }
  }
}

std::vector<Plot::Panel> panels_of(const Plot& plot) {
  std::vector<Plot::Panel> panels = {
      {plot.y_label, plot.curves, plot.y_log, plot.levels, plot.robust_range}};
  panels.insert(panels.end(), plot.below.begin(), plot.below.end());
  return panels;
}

PlotLayout plot_layout(const Plot& plot, const PlotRoom& room) {
  const std::vector<Plot::Panel> panels = panels_of(plot);
  PlotLayout layout;
  layout.axis_width = room.min_axis_width;
  for (const Plot::Panel& panel : panels) {
    const double wanted = layout.panels.empty() ? room.first_height : room.height_below;
    const double height = wanted > 0.0 ? wanted : usual_height(panels, room.scale);
    ChartPanel chart{{0.0, 0.0, 0.0, height}, {}, {}, panel.curves, room.resolution};
    chart.y = vertical_axis(y_range(panel), panel.y_log, panel.y_label, height);
    layout.axis_width = std::max(layout.axis_width, std::ceil(vertical_axis_width(chart.y)));
    layout.legends.push_back(legend_of(panel.curves, widest_legend));
    layout.panels.push_back(std::move(chart));
  }
  const AxisRange range = x_range(panels, plot.x_log);
  const auto place = [&](double legend_width) {
    const double length =
        room.right - legend_width - (room.left + layout.axis_width) - gap_right_of_frame;
    Axis x_axis = horizontal_axis(range, plot.x_log, plot.x_label, length);
    if (has_names_under_bars(panels.front().curves)) x_axis.ticks = {};
    place_frames(layout, room, x_axis, legend_width);
  };
  place(0.0);
  double legend_width = 0.0;
  for (size_t i = 0; i < layout.panels.size(); ++i) {
    if (!free_corner(layout.panels[i], layout.legends[i])) {
      legend_width = std::max(legend_width, layout.legends[i].width);
    }
  }
  constexpr double most_beside = 0.36;  // of the room, so that curves keep their width
  const double width = room.right - room.left - layout.axis_width;
  const auto has_curves = [](const Legend& legend) { return !legend.curves.empty(); };
  if (std::ranges::count_if(layout.legends, has_curves) == 1 &&
      legend_width > most_beside * width) {
    Legend& legend = *std::ranges::find_if(layout.legends, has_curves);
    legend = in_columns(legend, room.right - room.left);
    layout.below = PagePoint{room.left, layout.bottom + 6.0};
    layout.bottom = layout.below->y + legend.height;
  } else if (legend_width > 0.0) {
    place(legend_width);
  }
  return layout;
}

void draw_plot(Canvas& canvas, const Plot& plot, const PlotLayout& layout) {
  const std::vector<Plot::Panel> panels = panels_of(plot);
  for (size_t i = 0; i < layout.panels.size(); ++i) {
    const ChartPanel& panel = layout.panels[i];
    const Legend& legend = layout.legends[i];
    const PagePoint outside{panel.frame.right() + 6.0, panel.frame.y};
    const PagePoint corner = layout.below.value_or(free_corner(panel, legend).value_or(outside));
    draw_shaded(canvas, panel, plot, i == 0, {corner.x, corner.y, legend.width, legend.height});
    draw_grid(canvas, panel);
    draw_curves(canvas, panel);
    for (const double level : panels[i].levels) {
      draw_level(canvas, panel, level, {ink, 0.9, 1.0, {2.0, 4.0}});
    }
    canvas.outline(panel.frame, {ink, 0.8});
    draw_vertical_axis(canvas, panel.frame, panel.y, layout.axis_width);
    if (i + 1 == layout.panels.size()) draw_horizontal_axis(canvas, panel.frame, panel.x);
    draw_names(canvas, panel);
    if (!legend.curves.empty()) draw_legend(canvas, panel, legend, corner);
  }
}

namespace {

struct TimeUnit {
  std::string_view name;
  double seconds;
  double shortest_axis_s;  // shortest axis for this unit
};
constexpr TimeUnit long_units[] = {
    {"d", 86400.0, 259200.0}, {"h", 3600.0, 7200.0}, {"min", 60.0, 600.0}};

bool is_time_in(const std::string& label, std::string_view unit) {
  return label.ends_with("time [" + std::string(unit) + "]");
}

}  // namespace

Plot with_readable_time_unit(Plot plot) {
  if (plot.x_log || !is_time_in(plot.x_label, "s")) return plot;
  const AxisRange range = x_range(panels_of(plot), false);
  const auto* const unit = std::ranges::find_if(
      long_units, [&](const TimeUnit& u) { return range.high - range.low >= u.shortest_axis_s; });
  if (unit == std::end(long_units)) return plot;
  plot.x_label.replace(plot.x_label.size() - 2, 1, unit->name);
  const auto scale = [&](std::vector<Plot::Curve>& curves) {
    for (Plot::Curve& curve : curves) {
      for (double& x : curve.x) x /= unit->seconds;
    }
  };
  scale(plot.curves);
  for (Plot::Panel& panel : plot.below) scale(panel.curves);
  for (Plot::Interval& interval : plot.shaded) {
    interval = {interval.from / unit->seconds, interval.to / unit->seconds};
  }
  return plot;
}

double seconds_of_unit(const Plot& plot) {
  for (const TimeUnit& unit : long_units) {
    if (is_time_in(plot.x_label, unit.name)) return unit.seconds;
  }
  return 1.0;
}

DrawnPage page_of(const Plot& of, const Provenance& provenance, PictureStyle style) {
  require_consistent(of);
  const Plot plot = with_readable_time_unit(of);
  const double width = std::round(page_width * page_scale(style));
  const PageText text = page_text(plot.title, caption_of(plot), provenance, width, style);
  const PlotLayout layout = plot_layout(plot, {.left = page_margin,
                                               .right = width - page_margin,
                                               .top = std::ceil(text.body_top()),
                                               .scale = page_scale(style)});
  const double body_height = layout.bottom - text.body_top();
  return {width,
          std::ceil(text.page_height(body_height)),
          style,
          {},
          [plot, layout, text, body_height](Canvas& canvas, double) {
            draw_plot(canvas, plot, layout);
            draw_page_text(canvas, text, body_height);
          }};
}

std::string plot_html(const Plot& of) {
  require_consistent(of);
  const Plot plot = with_readable_time_unit(of);
  // Half of the last tick's label extends beyond the frame.
  constexpr double half_label = 12.0;
  const PlotLayout layout = plot_layout(plot, {.left = 2.0,
                                               .right = html_chart_width - half_label,
                                               .top = 8.0,
                                               .min_axis_width = 64.0,
                                               .resolution = 1.0,
                                               .first_height = 160.0,
                                               .height_below = 105.0});
  Canvas canvas = Canvas::of_svg(html_chart_width, std::ceil(layout.bottom + 6.0));
  draw_plot(canvas, plot, layout);
  return canvas.finish_html(plot.title);
}

}  // namespace photorque

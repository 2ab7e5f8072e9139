#include "images/drawing/plot_picture.h"

#include "images/drawing/consistency.h"
#include "images/drawing/page_layout.h"
#include "images/drawing/plot_curves.h"

namespace photorque {
namespace {

constexpr double page_width = 640.0;
constexpr double gap_between_panels = 12.0;
constexpr double widest_legend = 170.0;
constexpr Rgb ink = {0.13, 0.13, 0.13};
constexpr Rgb grid_grey = {0.87, 0.87, 0.87};

struct Layout {
  std::vector<ChartPanel> panels;
  std::vector<Legend> legends;
  double axis_room = 0.0;  // left of the frames
  PageText text;
  double body_height = 0.0;
};

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value, bool log) {
    if (!std::isfinite(value) || (log && value <= 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// With a margin on both sides.
AxisRange padded(const Extent& extent, bool log, double margin) {
  if (extent.low > extent.high) return log ? AxisRange{1.0, 10.0} : AxisRange{0.0, 1.0};
  if (log) {
    const double factor =
        extent.low == extent.high ? std::sqrt(10.0) : std::pow(extent.high / extent.low, margin);
    return {extent.low / factor, extent.high * factor};
  }
  const AxisRange range = drawable({extent.low, extent.high});
  const double room = margin * (range.high - range.low);
  return {range.low - room, range.high + room};
}

AxisRange x_range(const std::vector<ChartPanel>& panels, bool log) {
  Extent extent;
  bool markers = false;
  for (const ChartPanel& panel : panels) {
    for (const Plot::Curve& curve : panel.curves) {
      // As much room beside the outer bars as between two that stand at 1, 2, …
      const double beside = curve.bars ? 1.0 - bar_half_width : 0.0;
      for (const double x : curve.x) {
        extent.include(x - beside, log);
        extent.include(x + beside, log);
      }
      markers = markers || curve.markers;
    }
  }
  return padded(extent, log, markers ? 0.03 : 0.0);
}

AxisRange y_range(const ChartPanel& panel, bool log) {
  Extent extent;
  for (const Plot::Curve& curve : panel.curves) {
    if (curve.bars) extent.include(0.0, log);
    for (size_t i = 0; i < curve.y.size(); ++i) {
      const double error = curve.y_error.empty() ? 0.0 : curve.y_error[i];
      extent.include(curve.y[i], log);
      extent.include(curve.y[i] - error, log);
      extent.include(curve.y[i] + error, log);
    }
  }
  AxisRange range = padded(extent, log, 0.06);
  // A quantity that starts at zero stands on the axis.
  if (extent.low == 0.0 && extent.high > 0.0) range.low = 0.0;
  return range;
}

std::string caption_of(const Plot& plot) {
  const auto with_errors = [](const std::vector<Plot::Curve>& curves) {
    return std::ranges::any_of(curves, [](const auto& curve) { return !curve.y_error.empty(); });
  };
  const bool any = with_errors(plot.curves) || std::ranges::any_of(plot.below, [&](const auto& p) {
                     return with_errors(p.curves);
                   });
  return any ? "Bars and bands: ±1 standard error." : "";
}

// Of every panel: room for the tallest legend, and less of it the more panels there are.
double common_height(const Plot& plot) {
  constexpr std::array<double, 4> usual = {330.0, 200.0, 150.0, 120.0};
  double height = usual[std::min(plot.below.size(), usual.size() - 1)];
  height = std::max(height, legend_of(plot.curves, widest_legend).height);
  for (const Plot::Panel& panel : plot.below) {
    height = std::max(height, legend_of(panel.curves, widest_legend).height);
  }
  return height;
}

// Puts the frames `legend_room` short of the page's right edge.
void place_frames(Layout& layout, const Plot& plot, double legend_room, double height) {
  const double left = page_margin + layout.axis_room;
  const double width = page_width - page_margin - legend_room - left - 6.0;
  const Axis x =
      horizontal_axis(x_range(layout.panels, plot.x_log), plot.x_log, plot.x_label, width);
  double y = std::ceil(layout.text.body_top());
  for (ChartPanel& panel : layout.panels) {
    panel.frame = {left, y, width, height};
    panel.x = x;
    y += height + gap_between_panels;
  }
  layout.body_height = y - gap_between_panels + horizontal_axis_height(x) - layout.text.body_top();
}

Layout layout_of(const Plot& plot, const Provenance& provenance) {
  Layout layout;
  layout.text = page_text(plot.title, caption_of(plot), provenance.one_line(), page_width);
  const double height = common_height(plot);
  const auto add = [&](const std::string& label, bool log, const std::vector<Plot::Curve>& curves) {
    ChartPanel panel{{}, {}, {}, curves};
    panel.y = vertical_axis(y_range(panel, log), log, label, height);
    layout.axis_room = std::max(layout.axis_room, std::ceil(vertical_axis_width(panel.y)));
    layout.legends.push_back(legend_of(curves, widest_legend));
    layout.panels.push_back(std::move(panel));
  };
  add(plot.y_label, plot.y_log, plot.curves);
  for (const Plot::Panel& panel : plot.below) add(panel.y_label, panel.y_log, panel.curves);

  place_frames(layout, plot, 0.0, height);
  double legend_room = 0.0;
  for (size_t i = 0; i < layout.panels.size(); ++i) {
    if (!free_corner(layout.panels[i], layout.legends[i])) {
      legend_room = std::max(legend_room, layout.legends[i].width);
    }
  }
  if (legend_room > 0.0) place_frames(layout, plot, legend_room, height);
  return layout;
}

void draw_grid(Canvas& canvas, const ChartPanel& panel) {
  const PageBox& frame = panel.frame;
  for (const double value : panel.x.ticks.values) {
    const double x = frame.x + frame.width * panel.x.fraction(value);
    canvas.line({x, frame.y}, {x, frame.bottom()}, {grid_grey, 0.7});
  }
  for (const double value : panel.y.ticks.values) {
    const double y = frame.bottom() - frame.height * panel.y.fraction(value);
    canvas.line({frame.x, y}, {frame.right(), y}, {grid_grey, 0.7});
  }
}

// Without the grid's ink a signed quantity would hide where it is zero.
void draw_zero_line(Canvas& canvas, const ChartPanel& panel) {
  if (panel.y.log || panel.y.range.low >= 0.0 || panel.y.range.high <= 0.0) return;
  const double y = panel.frame.bottom() - panel.frame.height * panel.y.fraction(0.0);
  canvas.line({panel.frame.x, y}, {panel.frame.right(), y}, {{0.6, 0.6, 0.6}, 0.9});
}

void draw(Canvas& canvas, const Layout& layout) {
  for (size_t i = 0; i < layout.panels.size(); ++i) {
    const ChartPanel& panel = layout.panels[i];
    draw_grid(canvas, panel);
    draw_zero_line(canvas, panel);
    draw_curves(canvas, panel);
    canvas.outline(panel.frame, {ink, 0.8});
    draw_vertical_axis(canvas, panel.frame, panel.y, layout.axis_room);
    if (i + 1 == layout.panels.size()) draw_horizontal_axis(canvas, panel.frame, panel.x);
    if (layout.legends[i].curves.empty()) continue;
    const PagePoint outside{panel.frame.right() + 6.0, panel.frame.y};
    draw_legend(canvas, panel, layout.legends[i],
                free_corner(panel, layout.legends[i]).value_or(outside));
  }
  draw_page_text(canvas, layout.text, layout.body_height);
}

double page_height(const Layout& layout) {
  return std::ceil(layout.text.page_height(layout.body_height));
}

}  // namespace

Picture plot_picture(const Plot& plot, const Provenance& provenance) {
  require_consistent(plot);
  const Layout layout = layout_of(plot, provenance);
  Canvas canvas = Canvas::of_pixels(page_width, page_height(layout), pixels_per_point);
  draw(canvas, layout);
  return canvas.finish_pixels();
}

std::string plot_svg(const Plot& plot, const Provenance& provenance) {
  require_consistent(plot);
  const Layout layout = layout_of(plot, provenance);
  Canvas canvas = Canvas::of_vectors(page_width, page_height(layout));
  draw(canvas, layout);
  return canvas.finish_svg();
}

}  // namespace photorque

// Curves inside the frame of a chart, and where their legend may stand.
#pragma once

#include <span>
#include <vector>

#include "core/product.h"
#include "images/drawing/axis.h"
#include "images/drawing/canvas.h"

namespace photorque {

// The colour and dashes of the i-th curve. Seven colours that are distinct for colour-blind
// readers, then these with dashes. Source: M. Okabe and K. Ito, "Color Universal Design" (2008);
// their yellow is left out because it is lost on white.
Stroke curve_stroke(size_t index);
// The stroke of a curve that may have its own colour, width and dashes; `index` is its place.
Stroke curve_stroke(const Plot::Curve& curve, size_t index);

// One pair of axes on the page.
struct ChartPanel {
  PageBox frame;
  Axis x, y;
  std::vector<Plot::Curve> curves;
  double resolution = 0.5;  // points on the page: the error of the drawing is smaller

  // The place of a pair of values on the page; NaN for values that cannot be shown.
  PagePoint at(double x_value, double y_value) const;
};

// A line thinned to at most four points per `resolution` of x: first, lowest, highest, last. Only
// where x never falls and there are more points than that; other lines return unchanged. What is
// drawn differs by less than `resolution`; a million samples stay a small SVG file.
std::vector<PagePoint> thinned(std::span<const PagePoint> line, double resolution);

// Half the width of a bar, in units of x.
inline constexpr double bar_half_width = 0.4;

// Curves with their error bands or bars, clipped to the frame.
void draw_curves(Canvas& canvas, const ChartPanel& panel);

// Whether a bar goes from one value to another instead of from zero: two points at one x. It shows
// its number.
bool is_vertical_bar(const Plot::Curve& curve);

// Whether all curves are such bars: then their labels stand under them, and no legend is needed.
bool has_names_under_bars(const std::vector<Plot::Curve>& curves);

// The box of a legend. Empty when no curve has a label.
struct Legend {
  std::vector<size_t> curves;  // those with labels and points
  double width = 0.0;
  double height = 0.0;
  size_t rows = 0;  // in one column, or more beside each other
};
Legend legend_of(const std::vector<Plot::Curve>& curves, double widest);
// In as many columns as have room beside each other.
Legend in_columns(const Legend& legend, double room);

// A corner of the frame where the legend covers no curve: the top left of the legend there, or
// nothing if every corner is taken.
std::optional<PagePoint> free_corner(const ChartPanel& panel, const Legend& legend);
void draw_legend(Canvas& canvas, const ChartPanel& panel, const Legend& legend,
                 const PagePoint& top_left);

}  // namespace photorque

// Curves inside the frame of a chart, and the position of their legend.
#pragma once

#include <span>
#include <vector>

#include "core/product.h"
#include "images/drawing/axis.h"
#include "images/drawing/canvas.h"

namespace photorque {

// Colour and dashes of the i-th curve: seven colours that colour-blind readers can distinguish,
// then these with dashes. Source: M. Okabe and K. Ito, "Color Universal Design" (2008), without
// their yellow, which is invisible on white.
Stroke curve_stroke(size_t index);
// Stroke of a curve, which may state its own colour, width and dashes; `index` is its position.
Stroke curve_stroke(const Plot::Curve& curve, size_t index);

// One pair of axes on the page.
struct ChartPanel {
  PageBox frame;
  Axis x, y;
  std::vector<Plot::Curve> curves;
  double resolution = 0.5;  // in points: error limit of the drawing

  // Position of a pair of values on the page; NaN for values that cannot be shown.
  PagePoint at(double x_value, double y_value) const;
};

// A line thinned to at most four points per `resolution` of x: first, lowest, highest, last. The
// drawing changes by less than `resolution`, and a million samples give a small SVG file. Lines
// whose x falls, or which have no more points than that, are returned unchanged.
std::vector<PagePoint> thinned(std::span<const PagePoint> line, double resolution);

// Half the width of a bar, in units of x.
inline constexpr double bar_half_width = 0.4;

// Draws curves with their error bands or bars, clipped to the frame.
void draw_curves(Canvas& canvas, const ChartPanel& panel);

// Whether all curves are bars between two values (two points at one x), whose numbers are shown.
// Then their labels are below them, and no legend is needed.
bool has_names_under_bars(const std::vector<Plot::Curve>& curves);

// Size of a legend; empty if no curve has a label.
struct Legend {
  std::vector<size_t> curves;  // those with labels and points
  double width = 0.0;
  double height = 0.0;
  size_t rows = 0;  // in one column, or in several
};
Legend legend_of(const std::vector<Plot::Curve>& curves, double widest);
// The legend in as many columns as fit into `room`.
Legend in_columns(const Legend& legend, double room);

// Top left of the legend in a corner of the frame where it covers no curve; empty if there is none.
std::optional<PagePoint> free_corner(const ChartPanel& panel, const Legend& legend);
void draw_legend(Canvas& canvas, const ChartPanel& panel, const Legend& legend,
                 const PagePoint& top_left);

}  // namespace photorque

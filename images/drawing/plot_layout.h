// Where the panels of a plot and their legends stand, and the drawing of them.
#pragma once

#include "core/product.h"
#include "images/drawing/plot_curves.h"

namespace photorque {

// The room that a plot has on its page; the height follows from that of the panels.
struct PlotRoom {
  double left = 0.0, right = 0.0, top = 0.0;
  double min_axis_width = 0.0;  // left of the frames, so that frames of several plots line up
  double resolution = 0.5;      // of thinned lines
  // Heights of the first panel and of those below it. Zero: the usual one for so many panels.
  double first_height = 0.0, height_below = 0.0;
};

struct PlotLayout {
  std::vector<ChartPanel> panels;
  std::vector<Legend> legends;  // of every panel
  double axis_width = 0.0;      // left of the frames
  double bottom = 0.0;          // of the x axis and its label
};

// All pairs of axes of a plot, from the top.
std::vector<Plot::Panel> panels_of(const Plot& plot);

PlotLayout plot_layout(const Plot& plot, const PlotRoom& room);

// Shaded intervals, grids, curves, levels, frames, axes and legends.
void draw_plot(Canvas& canvas, const Plot& plot, const PlotLayout& layout);

}  // namespace photorque

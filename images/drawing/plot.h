// Line charts and bar charts.
#pragma once

#include <optional>
#include <string>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/curves.h"
#include "images/drawing/page_layout.h"

namespace photorque {

// Throws InputError with the name of the plot if sizes of its curves disagree.
void require_consistent(const Plot& plot);

// Space for a plot on its page; the height follows from that of the panels.
struct PlotRoom {
  double left = 0.0, right = 0.0, top = 0.0;
  double min_axis_width = 0.0;  // minimum, so that the frames of several plots are aligned
  double resolution = 0.5;      // of thinned lines
  // Heights of the first panel and of those below it; 0: the usual height for this number of
  // panels, times `scale`.
  double first_height = 0.0, height_below = 0.0, scale = 1.0;
};

struct PlotLayout {
  std::vector<ChartPanel> panels;
  std::vector<Legend> legends;     // one per panel
  double axis_width = 0.0;         // left of the frames
  double bottom = 0.0;             // bottom of the x axis with its label, or of a legend below it
  std::optional<PagePoint> below;  // top left of a legend below the x axis
};

// All panels of a plot, from the top.
std::vector<Plot::Panel> panels_of(const Plot& plot);

// Places panels, axes and legends in `room`.
PlotLayout plot_layout(const Plot& plot, const PlotRoom& room);

// Draws shaded intervals, grids, curves, levels, frames, axes and legends.
void draw_plot(Canvas& canvas, const Plot& plot, const PlotLayout& layout);

// Converts an x axis "time [s]" to minutes (from ten minutes on), hours (from two hours) or days
// (from three days).
Plot with_readable_time_unit(Plot plot);
// Seconds per unit of the x axis: 60 for "time [min]"; 1 for axes other than time.
double seconds_of_unit(const Plot& plot);

// Panels are stacked and share the x axis; time is converted by with_readable_time_unit(). Errors
// are drawn as ±1 standard error: bars on markers, bands around lines. The legend is in a free
// corner, or outside if there is none. Values that are not finite, or not positive on a logarithmic
// axis, leave gaps. Throws InputError for inconsistent sizes.
DrawnPage page_of(const Plot& plot, const Provenance& provenance,
                  PictureStyle style = PictureStyle::page);

// Width of charts in HTML pages, in units of the chart: full width on the page scales them.
inline constexpr double html_chart_width = 920.0;
// Axes and curves as an <img> element of an HTML page.
std::string plot_html(const Plot& plot);

// Bar chart as an <img> element as wide as those of plot_html(). Labels are left of the bars, cut
// if they would leave no space for the bars; each bar's number is at its end; notes are at the
// right edge.
std::string bar_chart_html(const BarChart& chart);

}  // namespace photorque

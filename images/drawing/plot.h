// Line charts and bar charts.
#pragma once

#include <optional>
#include <string>

#include "core/product.h"
#include "core/provenance.h"
#include "images/drawing/canvas.h"
#include "images/drawing/curves.h"
#include "images/drawing/style.h"

namespace photorque {

// InputError that names the plot if sizes of its curves disagree.
void require_consistent(const Plot& plot);

// The room that a plot has on its page; the height follows from that of the panels.
struct PlotRoom {
  double left = 0.0, right = 0.0, top = 0.0;
  double min_axis_width = 0.0;  // left of the frames, so that frames of several plots line up
  double resolution = 0.5;      // of thinned lines
  // Heights of the first panel and of those below it. Zero: the usual one for so many panels,
  // times `scale`.
  double first_height = 0.0, height_below = 0.0, scale = 1.0;
};

struct PlotLayout {
  std::vector<ChartPanel> panels;
  std::vector<Legend> legends;     // of every panel
  double axis_width = 0.0;         // left of the frames
  double bottom = 0.0;             // of the x axis and its label, or of a legend below them
  std::optional<PagePoint> below;  // top left of such a legend
};

// All pairs of axes of a plot, from the top.
std::vector<Plot::Panel> panels_of(const Plot& plot);

PlotLayout plot_layout(const Plot& plot, const PlotRoom& room);

// Shaded intervals, grids, curves, levels, frames, axes and legends.
void draw_plot(Canvas& canvas, const Plot& plot, const PlotLayout& layout);

// A plot whose x is "time [s]", in minutes from ten minutes on, hours from two hours, days from
// three days.
Plot with_readable_time_unit(Plot plot);
// Seconds in the unit of its x axis: 60 of "time [min]", 1 where it is no other time.
double seconds_of_unit(const Plot& plot);

// Panels are stacked and share the x axis, of time as by with_readable_time_unit(). Errors are
// drawn as ±1 standard error: bars on markers, bands around lines. The legend stands in a free
// corner, or outside if there is none. Values that are not finite, or not positive on a logarithmic
// axis, leave gaps. InputError if sizes disagree.
Picture plot_picture(const Plot& plot, const Provenance& provenance,
                     PictureStyle style = PictureStyle::page);
std::string svg_of(const Plot& plot, const Provenance& provenance,
                   PictureStyle style = PictureStyle::page);
std::string pdf_of(const Plot& plot, const Provenance& provenance, const PdfText& text,
                   PictureStyle style = PictureStyle::page);

// Width of charts in HTML pages, in the page's own units: a style of full width scales them.
inline constexpr double html_chart_width = 920.0;
// The axes and curves alone as an <img> element of an HTML page.
std::string plot_html(const Plot& plot);

// Labels left of the bars, cut where they would leave the bars no room; each bar's number at its
// end; notes at the right edge. An <img> element as wide as those of plot_html().
std::string bar_chart_html(const BarChart& chart);

}  // namespace photorque

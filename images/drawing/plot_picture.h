// Line charts, as pixels or as vectors from the same drawing.
#pragma once

#include <string>

#include "core/product.h"
#include "core/provenance.h"
#include "images/canvas/picture.h"

namespace photorque {

// Panels are stacked and share the x axis. Errors are drawn as ±1 standard error: bars on markers,
// bands around lines. The legend stands in a free corner, or outside if there is none. Values that
// are not finite, or not positive on a logarithmic axis, leave gaps. InputError if sizes disagree.
Picture plot_picture(const Plot& plot, const Provenance& provenance);
std::string plot_svg(const Plot& plot, const Provenance& provenance);

// Width of charts in HTML pages, in the page's own units: a style of full width scales them.
inline constexpr double html_chart_width = 920.0;
// The axes and curves alone as an <svg> element for the inside of an HTML page.
std::string plot_html(const Plot& plot);

}  // namespace photorque

// Horizontal bars, such as a ranking, inside of HTML pages.
#pragma once

#include <string>

#include "core/product.h"

namespace photorque {

// Labels left of the bars, cut where they would leave the bars no room; each bar's number at its
// end; notes at the right edge. An <svg> element as wide as those of plot_html().
std::string bar_chart_html(const BarChart& chart);

}  // namespace photorque

// report.html: a diagnosis for people.
#pragma once

#include <functional>
#include <string>

#include "core/product.h"
#include "core/provenance.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Draws a chart as an element of a page: inline SVG without ids. Whoever has a drawing engine gives
// it; this folder has none.
struct ChartDrawer {
  std::function<std::string(const Plot&)> plot;
  std::function<std::string(const BarChart&)> bars;
  std::function<std::string(const Map&)> map;
};

// One page that needs nothing else (pictures are inline SVG, no scripts): the finding in one
// sentence, what acts with its numbers and where on the array, where recording and nominal model
// part, the ranking of the alternatives, readings beside predictions with the part that was never
// fitted shaded, and the quality of the data. `title` names the experiment. Long series are thinned
// so that what is drawn differs by less than a pixel.
std::string report_html(const Diagnosis& diagnosis, const std::string& title,
                        const Provenance& provenance, const ChartDrawer& draw);

}  // namespace photorque

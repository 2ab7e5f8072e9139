// report.html: a diagnosis for people.
#pragma once

#include <string>

#include "core/provenance.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// One page that needs nothing else (pictures are inline SVG, no scripts): the finding in one
// sentence, what acts with its numbers, where recording and nominal model part, the ranking of the
// alternatives, readings beside predictions with the part that was never fitted shaded, and the
// quality of the data. `title` names the experiment. Long series are thinned so that what is drawn
// differs by less than a pixel.
std::string report_html(const Diagnosis& diagnosis, const std::string& title,
                        const Provenance& provenance);

}  // namespace photorque

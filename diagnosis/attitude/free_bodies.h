// Findings from the rates of free bodies: recordings of different bodies, a wrong clock.
#pragma once

#include <vector>

#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Whether recordings of a free body are of one body at all.

// Groups the recordings, fitted and held out, by body. Each recording alone gives its moments of
// inertia up to their scale (attitude/estimation/free_inertia.h). Two recordings are of different
// bodies where a moment differs by five standard errors and by a tenth of the mean moment; other
// recordings belong together. Recordings that do not determine their moments to a twentieth are not
// compared. Empty where all are of one body, or where the platform is not free: then other torques
// act.
std::vector<BodyOfRecordings> different_bodies(const Platform& platform, const RecordedData& data);

// One sentence that names the recordings of each; empty without bodies.
std::string sentence_of(const std::vector<BodyOfRecordings>& bodies);

// Whether the rates of a free body and the clock beside them agree.

// Rates change as ω' = −I⁻¹ (ω × I ω): in proportion to their square. Rates that are all too large
// by a factor, or a clock that runs too fast by it, match no inertia, unless the body has an axis
// of symmetry. For every recording the factor is fitted by which its rates would have to be
// multiplied. It is reported where it differs from one by a twentieth and leaves at most a third of
// the residual (free_inertia.h) of the readings as they are. Nothing for platforms that are carried
// by something.
std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data);

}  // namespace photorque

// Findings from the rates of free bodies: recordings of different bodies, a wrong clock.
#pragma once

#include <vector>

#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Groups the recordings, both fitted and held out, by body. Each recording alone determines moments
// of inertia up to their scale (attitude/estimation/free_inertia.h). Two recordings are of
// different bodies if a moment differs by five standard errors and by a tenth of the mean moment.
// Recordings whose moments have errors above a twentieth are not compared. Empty if all are of one
// body, or if the platform is not free, because other torques then act.
std::vector<BodyOfRecordings> different_bodies(const Platform& platform, const RecordedData& data);

// One sentence that lists the recordings of each body; empty without bodies.
std::string sentence_of(const std::vector<BodyOfRecordings>& bodies);

// Rates obey ω' = −I⁻¹ (ω × I ω), which is quadratic in ω. If all rates are too large by a factor,
// or the clock is too fast by it, no inertia fits. The exception is a body with an axis of
// symmetry. For every recording the correction factor of its rates is fitted. It is reported if it
// differs from one by a twentieth and reduces the residual (free_inertia.h) to below 0.05 and to at
// most a third. Empty with attitude readings and for platforms on a bearing.
std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data);

}  // namespace photorque

// What the rates of free bodies say of the recordings: different bodies, a wrong clock.
#pragma once

#include <vector>

#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Whether recordings of a free body are of one body at all.

// The bodies that the recordings, fitted and held out, are of: each recording alone gives its
// moments of inertia up to their scale (attitude/estimation/free_inertia.h), and two recordings are
// of different bodies where a moment differs by five standard errors and by a tenth of the mean
// moment; recordings that are not told apart belong together. Recordings that do not determine
// their moments to a twentieth are not compared. Empty where all are of one body, or where the
// platform is not free: then other torques act.
std::vector<BodyOfRecordings> different_bodies(const Platform& platform, const RecordedData& data);

// One sentence for people that names the recordings of each; empty without bodies.
std::string sentence_of(const std::vector<BodyOfRecordings>& bodies);

// Whether the rates of a free body and the clock beside them agree.

// Rates change as ω' = −I⁻¹ (ω × I ω): in proportion to their square. Rates that are all too large
// by a factor, or a clock that runs too fast by it, follow no inertia, unless the body has an axis
// of symmetry. For every recording the factor by which its rates would have to be multiplied is
// looked for; it is told where what is left over (free_inertia.h) is at most a third of what the
// readings leave as they are, and where it differs from one by a twentieth. Nothing for platforms
// that are carried by something.
std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data);

}  // namespace photorque

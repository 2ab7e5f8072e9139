// Whether the rates of a free body and the clock beside them agree.
#pragma once

#include <vector>

#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"

namespace photorque {

// Rates change as ω' = −I⁻¹ (ω × I ω): in proportion to their square. Rates that are all too large
// by a factor, or a clock that runs too fast by it, follow no inertia, unless the body has an axis
// of symmetry. For every recording the factor by which its rates would have to be multiplied is
// looked for; it is told where what is left over (free_inertia.h) is at most a third of what the
// readings leave as they are, and where it differs from one by a twentieth. Nothing for platforms
// that are carried by something.
std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data);

}  // namespace photorque

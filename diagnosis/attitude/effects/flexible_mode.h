// Flexible appendages: screening, and starts for their frequency and axis.
#pragma once

#include "attitude/observation/prediction.h"
#include "diagnosis/attitude/effects/screen.h"

namespace photorque {

// One run propagated along a fit.
struct PropagatedRun {
  const Observation& seen;
  const Prediction& propagated;  // with residuals
};

// The score of light appendages about these axes [body, unit vectors], one strength J [kg m²] each,
// all of one frequency and damping (fraction of critical), without a propagation for each. The
// motion of each appendage under the fitted motion is exact. The platform is assumed to be free
// within a swing: δω = −J I⁻¹ a φ'. Instead of a projection of the fitted parameters, parts slower
// than a swing are removed from readings and responses.
Score score_of_ringing(const std::vector<PropagatedRun>& runs, const Mat3& inertia_kg_m2,
                       const std::vector<Vec3>& axes, double frequency_Hz, double damping);

// The best flexible modes to add to `fit`: some that the motion drives, and one that was deflected
// at the start of a run if it explains more. `start` is the disturbance with its expected strength;
// `slow_runs` are averages of the runs, sufficient for slow motion; `lines_Hz` are the lines of the
// residual.
std::vector<Start> flexible_mode_starts(const Disturbance& start, const Fit& fit,
                                        const std::vector<Observation>& runs,
                                        const std::vector<Observation>& slow_runs,
                                        const std::vector<double>& lines_Hz,
                                        const Thresholds::Scoring& limits);

}  // namespace photorque

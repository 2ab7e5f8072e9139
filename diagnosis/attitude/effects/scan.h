// Forecasts of the gain of effects that a model lacks (inference/estimator/score.h), and starts for
// effects with nonlinear parameters (a frequency, an instant, an axis), which a fit finds only from
// a nearby start.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/fit.h"
#include "attitude/observation/prediction.h"
#include "diagnosis/attitude/effects/trial.h"
#include "inference/estimator/score.h"

namespace photorque {

using inference::Score;
using inference::solve_score;

// A group of parameters that are added together.
struct ScoreGroup {
  std::vector<Disturbance> disturbances;
  std::vector<int> parameters = {};  // indices in each disturbance; empty: all
};

// Scores all groups in one pass, or in several to limit memory. A group that cannot be propagated
// has gain 0.
std::vector<Score> score(const Fit& at, const std::vector<Observation>& runs,
                         const std::vector<ScoreGroup>& groups);

// At most `most` frequencies [Hz] at which the residual of a fit has power, strongest first, above
// those of the platform's motion.
std::vector<double> line_frequencies_Hz(const Fit& at, const std::vector<Observation>& runs,
                                        const Thresholds::Scoring& limits, size_t most = 4);

// Starts for a candidate added to `parent`: one, or the best of a scan. `slow_runs` are averages of
// the runs, sufficient for slow effects; `lines_Hz` are the parent's line_frequencies_Hz().
std::vector<Start> starts_of(const Candidate& candidate, const Trial& parent,
                             const std::vector<Observation>& runs,
                             const std::vector<Observation>& slow_runs,
                             const std::vector<double>& lines_Hz,
                             const Thresholds::Scoring& limits);

// Time from the first to the last reading of all pieces and recordings [s], on their common clock:
// an effect of one frequency stays in phase across pieces.
inline double span_s(const std::vector<Observation>& runs) {
  double start_s = runs.front().time_s.front(), end_s = runs.front().time_s.back();
  for (const Observation& seen : runs) {
    start_s = std::min(start_s, seen.time_s.front());
    end_s = std::max(end_s, seen.time_s.back());
  }
  return end_s - start_s;
}

// Indices of the `most` largest local maxima.
inline std::vector<size_t> peaks(const std::vector<double>& value, size_t most) {
  std::vector<size_t> found;
  for (size_t i = 0; i < value.size(); ++i) {
    const bool rises = i == 0 || value[i] >= value[i - 1];
    const bool falls = i + 1 == value.size() || value[i] > value[i + 1];
    if (rises && falls) found.push_back(i);
  }
  std::sort(found.begin(), found.end(), [&](size_t a, size_t b) { return value[a] > value[b]; });
  if (found.size() > most) found.resize(most);
  return found;
}

// A copy of a disturbance with another value of one scalar parameter.
inline Disturbance with_parameter(const Disturbance& like, std::string_view key, double value) {
  Disturbance d = like;
  parameter_of(d, key).value = value;
  return d;
}

// Indices of the parameters of a key with `components` components.
inline std::vector<int> indices_of(const Disturbance& d, std::string_view key, size_t components) {
  const auto first = static_cast<int>(index_of(d, key));
  std::vector<int> all;
  for (size_t k = 0; k < components; ++k) all.push_back(first + static_cast<int>(k));
  return all;
}

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

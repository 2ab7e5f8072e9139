// Strengths of laws of rotation about one axis, computed from the recorded curve without a fit.
// They are a start that is near the readings over the whole recording.
#pragma once

#include <vector>

#include "diagnosis/attitude/domain.h"

namespace photorque {

// Local cubics through the readings give angle θ and rate ω. The equation of motion, integrated
// over time,
//
//   ω(t) = ω₀ + Σ_k s_k ∫ a_k(θ, ω) dt,
//
// is linear in the strengths s_k of the laws (accelerations a_k per unit) and in one ω₀ per run. A
// strength beyond its physical bounds is set to zero, and the others are recomputed.
struct LawsOfCurve {
  inference::Members<Start> members;  // with a strength that is not zero
  std::vector<RunStart> starts;
};

// `nominal`: trial of the nominal model; its parameters are set to the values that the experiment
// states. `candidates`: indices of the laws. The result has no members if a run has too few
// readings.
LawsOfCurve laws_of_curve(const Trial& nominal, const Candidates& all,
                          const std::vector<size_t>& candidates,
                          const std::vector<Observation>& runs);

// The trial with its parameters set to the values that the experiment states.
Trial as_stated(Trial nominal);

}  // namespace photorque

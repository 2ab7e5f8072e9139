// What an experiment says of light and power before anything is fitted: the effects that it states,
// and the numbers that it knows to within an error.
#pragma once

#include <functional>

#include "diagnosis/light/trials/candidate.h"
#include "scenes/experiment/uncertain.h"

namespace photorque {

// `reread` is the experiment of the lab again with one more key assigned. The lab must outlive the
// result. InputError for an error of what cannot be any other number.
LightBelief light_belief(const LightLab& lab, const std::vector<UncertainKey>& uncertain,
                         const std::function<Experiment(const std::string&)>& reread);

// The key of the prior on how the body stands in the light, among the refined ones; no experiment
// has it.
constexpr const char* tilt_belief = "attitude_bias.bias_deg";

// A prior: the body stands turned against its recorded attitude by a rotation vector about lab x
// and y, to within errors. The lab must outlive it.
void believe_tilt(const LightLab& lab, const Vec2& bias_rad, const Vec2& sigma_rad,
                  LightBelief& belief);

}  // namespace photorque

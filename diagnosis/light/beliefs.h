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

}  // namespace photorque

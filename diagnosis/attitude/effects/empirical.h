// Torques without a law: smooth functions of one variable with free coefficients. They compete with
// the catalogue, so that an effect outside it is not mistaken for one inside.
#pragma once

#include <string>
#include <vector>

#include "attitude/model/disturbance.h"

namespace photorque {

struct EmpiricalLaw {
  std::string variable;     // "heading", "tilt", "rate", "time", "charge", "command"
  std::string description;  // "three periods a turn of heading"
  Disturbance disturbance;  // all coefficients 0; linear in them
  double scale = 1.0;       // size to be expected of a coefficient
};

// The laws that compete on a run of this length and charge. `torque_N_m` is a typical torque.
std::vector<EmpiricalLaw> empirical_laws(double duration_s, double charge_C, bool has_commands,
                                         double torque_N_m);

}  // namespace photorque

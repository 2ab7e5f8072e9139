// `budget`: the torque of every disturbance at one state, ranked and compared with the paper's
// figures.
#pragma once

#include <string>
#include <vector>

#include "attitude/model/dynamics.h"
#include "attitude/studies/paper_figures.h"
#include "core/product.h"
#include "core/settings/keys.h"

namespace photorque {

struct BudgetEntry {
  std::string kind;
  std::string name;  // the kind, with a number if it occurs twice
  // The largest torque within the second after the state, at constant attitude and rate: the
  // amplitude of a vibration. For a disturbance that changes the conditions of others
  // (gravity_tilt, helmholtz_cage, inertia_error, …) it is the change of their torques.
  Vec3 torque_body_N_m = Vec3::Zero();
  // The angle by which the mean torque T of that second would rotate the platform if it were
  // constant in body axes, ½ |I⁻¹ T| t² [rad]. An oscillating or braking torque has a smaller
  // effect.
  double angle_after_minute_rad = 0.0;
  double angle_after_hour_rad = 0.0;
  double angle_after_day_rad = 0.0;
};

struct Budget {
  AttitudeModel model;  // the experiment's [platform], [environment] and [[disturbance]]
  PlatformState state;
  std::vector<BudgetEntry> entries;  // largest torque first
  std::vector<BearingDatasheet> catalogue;
  PaperLight light = {};
  bool beside_paper = true;        // whether the paper's figures are shown
  std::vector<AirPart> air_parts;  // parts of air_friction and air_pressure_drag
};

// Reads the experiment and [budget], whose keys are budget_table(). The paper's figures are
// reported only with [[budget.bearing]] or [budget.light], because they do not apply to other
// platforms. The load on the bearing is the platform's weight. InputError for missing or unknown
// keys in these tables.
Budget read_budget(const Settings& root);

// The budget of a model at a state. NumericalError if a torque is not finite.
Budget make_budget(AttitudeModel model, const PlatformState& state);

// The results. Table "budget" by rank. Table "external_air" for the parts of the experiment, if
// any: Reynolds number and validity of the laws at the state's rate. With the paper's figures, the
// tables of paper_product(). Plot "torque_by_tilt": every disturbance from upright to the tilt
// limit (30 deg without one) towards the state's heading. The paper's figure 5. Quantities: the
// total torque and, with a catalogue, its comparison.
Product budget_product(const Budget& budget);

// The keys of [budget].
Key budget_table();

}  // namespace photorque

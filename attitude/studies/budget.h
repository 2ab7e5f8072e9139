// `budget`: every disturbance's torque at one state, ranked, beside the paper's figures.
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
  std::string name;  // the kind, numbered where it acts twice
  // The largest within the second that begins with the state, attitude and rate held: of what
  // shakes, the amplitude. Of what changes the conditions of others (gravity_tilt, helmholtz_cage,
  // inertia_error, …), what it adds to their torques.
  Vec3 torque_body_N_m = Vec3::Zero();
  // The angle that its mean over that second, T, would turn the platform by if it stayed constant
  // in body axes, ½ |I⁻¹ T| t² [rad]. A torque that swings or brakes accumulates less.
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
  bool beside_paper = true;        // the paper's figures belong to the tables: this is its platform
  std::vector<AirPart> air_parts;  // of the experiment's air_friction and air_pressure_drag
};

// Reads the experiment and [budget], whose keys are budget_table(). Only with [[budget.bearing]] or
// [budget.light] are the paper's figures reported: other platforms are not its own. The load on the
// bearing is the platform's weight. InputError for missing or unknown keys in these tables.
Budget read_budget(const Settings& root);

// The budget from values.
Budget make_budget(AttitudeModel model, const PlatformState& state);

// The tables "budget" (by rank), "external_air" (Reynolds number and validity of the experiment's
// own parts at the state's rate, where it has any) and, beside the paper, those of
// paper_product(), the plots "torque_by_tilt" (every disturbance from upright to the tilt limit, 30
// deg without one, towards the state's heading) and the paper's figure 5, and as quantities the
// total torque and, with a catalogue, its comparison.
Product budget_product(const Budget& budget);

// [budget] as it is declared.
Key budget_table();

}  // namespace photorque

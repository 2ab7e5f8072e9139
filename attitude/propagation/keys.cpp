#include "attitude/propagation/keys.h"

#include "attitude/propagation/propagator.h"
#include "core/constants.h"

namespace photorque {

Key propagate_table() {
  const PropagationOptions usual;
  return Key::table(
      "propagate",
      {Key::number_or("duration_s", 600.0, {0.0, 1e10, true, false}, "of the run"),
       Key::number_or("output_rate_Hz", 10.0, Range::positive(),
                      "rows of the recording, at most 2e7 in all"),
       Key::integer_or("history_rows", 20000, 2, 20'000'000, "rows of `time_history.csv` at most"),
       Key::number_or("tolerance", usual.tolerance, {1e-13, 1e-3, false, false}, "of a step"),
       Key::number("longest_step_s", Range::positive(), "of the integrator").usually_is("none"),
       Key::number_or(
           "tick_rate_Hz", 0.0, {0.0, 1e6, false, false},
           "steps end at these ticks too and begin afresh, as those of a run in real time "
           "do; 0: no ticks"),
       Key::integer_or("seed", 1, 0, INT64_MAX, "of the sensors' noise; also `--seed`"),
       Key::number_or("initial_tilt_deg", 0.0, {0.0, pi, false, false},
                      "leans by the tilt towards the heading; *or*"),
       Key::number_or("initial_heading_deg", 0.0, {}, "where it leans to"),
       Key::numbers("initial_attitude", {}, "[w, x, y, z], lab from body, unit to 1e-3")
           .of_size(4)
           .optional(),
       Key::vector3_or("initial_rate_rad_s", Vec3::Zero(), "body axes"),
       Key::numbers("initial_position_m", {}, "of a planar platform, lab x and y")
           .of_size(2)
           .usually_is("0, 0"),
       Key::numbers("initial_velocity_m_s", {}, "the same").of_size(2).usually_is("0, 0"),
       Key::number_or("initial_charge_Ah", 0.0, {}, "drawn before"),
       Key::number_or("initial_time_s", 0.0, {},
                      "of the first row; commands, measured series and laws in time count in it"),
       Key::text("commands",
                 "CSV: `t_s` and any of `command_x_N_m`, `…_y_…`, `…_z_…`, `battery_current_A`, "
                 "`led_current_A`, each row held until the next (zero-order hold); *or*")
           .usually_is("none"),
       Key::tables("command",
                   {Key::number("time_s", {}, "rising"),
                    Key::vector3_or("torque_N_m", Vec3::Zero(), "commanded, body axes"),
                    Key::number_or("battery_current_A", 0.0, {}, "drawn"),
                    Key::number("led_current_A", Range::not_negative(),
                                "of lamps; not given: they shine as ever")
                        .optional()},
                   "each held until the next"),
       Key::text_or("epoch", "2000-01-01T00:00:00",
                    "calendar time of t = 0, for `attitude.aem`; does not move `igrf` or `orbit`")},
      "a run of the motion");
}

}  // namespace photorque

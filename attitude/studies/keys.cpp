#include "attitude/studies/keys.h"

#include "attitude/disturbances/mass/moving_masses.h"
#include "attitude/studies/budget.h"
#include "core/constants.h"

namespace photorque {
namespace {

Key catalogue_key() {
  const BearingDatasheet usual;
  const auto size = [](const char* name, const char* what) {
    return Key::number(name, Range::positive(), what);
  };
  return Key::tables(
      "bearing",
      {Key::text("name", "of the bearing"), size("radius_m", "of the ball"),
       Key::number("half_angle_deg", {0.0, 0.5 * pi, true, false}, "of the socket"),
       size("gap_m", "of the film"), size("inlet_Pa", "absolute"), size("load_N", "rated"),
       Key::number_or("drag_N_m", 0.0, Range::not_negative(), "0: not printed"),
       Key::number_or("drag_rate_rpm", usual.drag_rate_rad_s, Range::positive(),
                      "at which the drag was measured")},
      "a catalogue's bearing beside the paper's model");
}

Key light_key() {
  const auto fraction = [](const char* name, const char* what) {
    return Key::number(name, Range::fraction(), what).usually_is("the paper's");
  };
  const auto power = [](const char* name, const char* what) {
    return Key::number(name, Range::positive(), what).usually_is("the paper's");
  };
  return Key::table("light",
                    {fraction("source_to_cell", "light on the cells over what is emitted"),
                     fraction("conversion", "of light on the cells to power"),
                     power("power_W", "of the array at zero tilt"),
                     power("power_at_30_deg_W", "of the array at 30 deg"),
                     Key::vector3("torque_at_30_deg_N_m", "of the light at 30 deg, body axes")
                         .usually_is("the paper's")},
                    "what `power` printed, beside the paper's");
}

}  // namespace

Key budget_table() {
  return Key::table(
      "budget",
      {Key::number_or("tilt_deg", 0.0, {0.0, pi, false, false}, "attitude, as in `[propagate]`"),
       Key::number_or("heading_deg", 0.0, {}, "where it leans to"),
       Key::number_or("spin_rpm", 0.0, {}, "about the lab's vertical"),
       Key::vector3_or("rate_rad_s", Vec3::Zero(), "body axes, added"),
       Key::number("state_of_charge", Range::fraction(),
                   "below 1 needs `platform.battery_capacity_Ah`; *or*")
           .usually_is("1"),
       Key::number_or("charge_drawn_Ah", 0.0, Range::not_negative(), "since the battery was full"),
       Key::number_or("time_s", 0.0, {}, "of laws in time"), catalogue_key(), light_key()},
      "the state at which torques are compared");
}

Key balance_table() {
  return Key::table("balance", moving_mass_keys(), "the masses that balance the platform");
}

}  // namespace photorque

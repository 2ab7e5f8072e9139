// [supply_trade].
#include "attitude/studies/cable.h"
#include "core/constants.h"
#include "tools/keys/tables.h"
#include "tools/supply/options.h"

namespace photorque {
namespace {

constexpr Range conversion_range{0.0, 1.0, true, false};

// With the program's own error of the default, in the unit of the key.
Key assumed(const char* name, double value_SI, Range range, const char* what) {
  return Key::uncertain_or(name, value_SI, range, what);
}

Key battery_table() {
  return Key::table(
      "battery",
      {assumed("specific_energy_Wh_kg", 150.0 * 3600.0, Range::positive(),
               "of the pack; the default is ± 50"),
       assumed("usable_fraction", 0.9, conversion_range, "of its energy"),
       assumed("electrodes_m", 3.2e-4, {}, "how far the lithium migrates along body x")},
      "carried");
}

Key cable_table() {
  const PowerCable usual;
  return Key::table(
      "cable",
      {assumed("voltage_V", 24.0, Range::positive(), "at the source"),
       assumed("length_m", usual.length_m, Range::positive(), "of the loop"),
       Key::integer_or("strands", usual.strands, 1, 10000, "of each wire"),
       assumed("strand_diameter_m", usual.strand_diameter_m, Range::positive(), "of one"),
       assumed("insulation_diameter_m", usual.insulation_diameter_m, Range::positive(),
               "outside, of a wire"),
       assumed("insulation_modulus_Pa", 1e6, Range::not_negative(),
               "Young's; the default is ± 3e5"),
       assumed("attached_below_m", 0.0, {}, "of the centre of rotation; the default is ± 0.005")},
      "tethered");
}

Key microwave_table() {
  return Key::tables(
      "microwave",
      {Key::number("frequency_GHz", Range::positive(), "of the beam"),
       Key::choice_or("plane", words({"E", "H"}), 0, "in which it tilts"),
       assumed("transmitter_diameter_m", 0.4, Range::positive(), "of the aperture"),
       assumed("rectenna_side_m", 0.322, Range::positive(), "of the square on the platform"),
       assumed("distance_m", 1.0, Range::positive(), "between them"),
       assumed("height_m", 0.0238, {}, "of the rectenna over the centre of rotation"),
       assumed("rectifier_efficiency", 0.82, conversion_range, "of its elements"),
       assumed("transmitter_efficiency", 0.6, conversion_range,
               "of mains to beam; the default is ± 0.1"),
       assumed("mass_kg_m2", 2.0, Range::not_negative(),
               "of the rectenna per area; the default is ± 0.5")},
      "a microwave beam");
}

Key coil_table(const char* name, const char* what) {
  return Key::table(
      name,
      {Key::number_or("inner_radius_m", 0.06, Range::positive(), "of the spiral"),
       Key::number_or("outer_radius_m", 0.1, Range::positive(), "of it, beyond the inner"),
       Key::integer_or("turns", 12, 1, 200, "of it"),
       Key::number_or("copper_area_mm2", 3e-6, Range::positive(), "of the wire"),
       Key::number_or("ac_factor", 1.5, {1.0, 1e3}, "resistance over that of direct current")},
      what);
}

Key induction_table() {
  return Key::table(
      "induction",
      {coil_table("transmitter", "the coil in the lab"),
       coil_table("receiver", "that on the platform"),
       Key::number_or("transmitter_height_m", -0.085, {}, "lab"),
       Key::number_or("receiver_height_m", -0.02, {}, "body"),
       Key::number_or("frequency_kHz", 1e5, Range::positive(), "of the current"),
       assumed("detuning", 0.0, {}, "of the frequency; the default is ± 0.005"),
       assumed("inverter_efficiency", 0.93, conversion_range, "the default is ± 0.02"),
       assumed("rectifier_efficiency", 0.95, conversion_range, "the default is ± 0.02"),
       Key::number_or("ball_radius_m", 0.03175, Range::positive(), "of the bearing"),
       Key::number_or("ball_conductivity_S_m", 2.5e7, Range::positive(), "of its metal")},
      "two coils");
}

Key beam_table() {
  const BeamSettings usual;
  return Key::tables(
      "beam",
      {Key::text("name", "of the way"),
       Key::text("experiment", "beside this one; with `[scene]`, sources and `[array]`"),
       Key::number_or("lamp_efficiency", usual.lamp_efficiency, conversion_range,
                      "light over mains"),
       Key::number_or("converter_efficiency", usual.converter_efficiency, conversion_range,
                      "after the array"),
       Key::number_or("array_mass_kg", usual.array_mass_kg, Range::not_negative(), "carried"),
       Key::integer("rays", 256, int64_t{1} << 40, "of the trace")
           .usually_is("those of that experiment")},
      "light on an array");
}

}  // namespace

Key supply_table() {
  const SupplyTask usual;
  return Key::table(
      "supply_trade",
      {Key::number_or("load_W", usual.load_W, Range::positive(), "what is delivered"),
       Key::number_or("duration_h", usual.duration_s, Range::positive(), "of the task"),
       Key::number("tilt_max_deg", {0.0, 80.0 * degree_rad, true, false}, "the largest tilt")
           .usually_is("the platform's stop, else 30"),
       Key::integer_or("tilts", 7, 2, 181, "from zero to it"), battery_table(), cable_table(),
       microwave_table(), induction_table(), beam_table()},
      "the ways to feed a platform side by side: battery, cable and induction are compared always, "
      "with the defaults where they have no table");
}

}  // namespace photorque

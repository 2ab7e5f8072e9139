// Supplies without transmission through air: the battery and the cable, which the others would
// replace.
#include <cmath>

#include "attitude/disturbances/mass/battery.h"
#include "attitude/studies/cable.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "tools/supply/trade.h"

namespace photorque {
namespace {

namespace cable_key {
constexpr PowerCable usual;
constexpr UncertainNumberKey voltage("voltage_V", {24.0, 0.0}, Range::positive(),
                                     "voltage at the source");
constexpr UncertainNumberKey length("length_m", {usual.length_m, 0.0}, Range::positive(),
                                    "free length of the cable, from the platform to its fixed end");
constexpr IntegerKey strands("strands", usual.strands, 1, 10000, "number of strands per wire");
constexpr UncertainNumberKey strand_diameter("strand_diameter_m", {usual.strand_diameter_m, 0.0},
                                             Range::positive(), "diameter of one strand");
constexpr UncertainNumberKey insulation_diameter("insulation_diameter_m",
                                                 {usual.insulation_diameter_m, 0.0},
                                                 Range::positive(),
                                                 "outer diameter of an insulated wire");
constexpr UncertainNumberKey insulation_modulus(
    "insulation_modulus_Pa", {usual.insulation_modulus_Pa, 0.3 * usual.insulation_modulus_Pa},
    Range::not_negative(), "Young's modulus of the insulation; the default is ± 3e5");
constexpr UncertainNumberKey attached_below(
    "attached_below_m", {0.0, 0.005}, {},
    "distance of the attachment below the centre of rotation; the default is ± 0.005");
constexpr TableKey cable("cable", "cable to the platform");
}  // namespace cable_key

namespace battery_key {
constexpr UncertainNumberKey specific_energy(
    "specific_energy_Wh_kg", {150.0 * 3600.0, 50.0 * 3600.0}, Range::positive(),
    "specific energy of the battery pack; the default is ± 50");
constexpr UncertainNumberKey usable_fraction("usable_fraction", {0.9, 0.0},
                                             Range{0.0, 1.0, true, false},
                                             "usable fraction of the energy");
constexpr UncertainNumberKey electrodes("electrodes_m", {3.2e-4, 0.0}, {},
                                        "displacement of the lithium along body x");
constexpr TableKey battery("battery", "battery on the platform");
}  // namespace battery_key

struct BatteryInputs {
  UncertainInputs inputs;
  size_t specific_energy_J_kg = 0, usable = 0, electrodes_m = 0;
};

BatteryInputs read_battery(const Settings& s) {
  BatteryInputs battery;
  UncertainInputs& in = battery.inputs;
  battery.specific_energy_J_kg = in.add(s, battery_key::specific_energy);
  battery.usable = in.add(s, battery_key::usable_fraction);
  battery.electrodes_m = in.add(s, battery_key::electrodes);
  return battery;
}

double drawn_C(const SupplyTask& task, double fraction) {
  return fraction * task.load_W * task.duration_s / task.model.platform.battery_voltage_V;
}

double lithium_torque_N_m(const SupplyTask& task, double electrodes_m, double charge_C,
                          double tilt_rad) {
  const BatteryCell cell{Vec3(electrodes_m, 0.0, 0.0), 1.0};
  const double shift_m_C = com_shift_m_C({&cell, 1}, task.model.platform.mass_kg).x();
  // The disturbance's key is per ampere-hour.
  return disturbance_torque_N_m(task, "battery_discharge",
                                {{"shift_m_per_Ah", {3600.0 * shift_m_C, 0.0, 0.0}}}, tilt_rad,
                                charge_C);
}

}  // namespace

SupplyOption battery_option(const Settings& settings, const SupplyTask& task) {
  const BatteryInputs battery = read_battery(settings);
  const double load_J = task.duration_s * task.load_W;
  SupplyOption option =
      option_from(battery.inputs, task,
                  [&](const std::vector<double>& at) {
                    PlainOption plain;
                    const double stored_J = load_J / at[battery.usable];
                    plain.mass_kg = stored_J / at[battery.specific_energy_J_kg];
                    for (const double tilt_rad : task.tilt_rad) {
                      plain.delivered_W.push_back(task.load_W);
                      plain.torque_N_m.push_back(lithium_torque_N_m(task, at[battery.electrodes_m],
                                                                    drawn_C(task, 1.0), tilt_rad));
                    }
                    plain.figures = {load_J / 3600.0, stored_J / 3600.0};
                    return plain;
                  },
                  {"energy_Wh", "capacity_Wh"});
  option.name = option.symbol = "battery";
  option.remarks = {
      "on the platform; the torque is that of the displaced lithium in the empty battery"};
  return option;
}

double battery_torque_N_m(const Settings& settings, const SupplyTask& task, double fraction) {
  const BatteryInputs battery = read_battery(settings);
  return battery.inputs
      .evaluate([&](const std::vector<double>& at) {
        return std::vector{
            lithium_torque_N_m(task, at[battery.electrodes_m], drawn_C(task, fraction), 0.0)};
      })[0]
      .value;
}

SupplyOption cable_option(const Settings& s, const SupplyTask& task) {
  UncertainInputs in;
  PowerCable fixed;
  fixed.strands = static_cast<int>(s.get(cable_key::strands));
  const size_t volts = in.add(s, cable_key::voltage);
  const size_t length = in.add(s, cable_key::length);
  const size_t strand = in.add(s, cable_key::strand_diameter);
  const size_t outer = in.add(s, cable_key::insulation_diameter);
  const size_t modulus = in.add(s, cable_key::insulation_modulus);
  const size_t below = in.add(s, cable_key::attached_below);
  SupplyOption option = option_from(
      in, task,
      [&](const std::vector<double>& at) {
        PowerCable cable = fixed;
        cable.length_m = at[length];
        cable.strand_diameter_m = at[strand];
        cable.insulation_diameter_m = at[outer];
        cable.insulation_modulus_Pa = at[modulus];
        PlainOption plain;
        plain.mass_kg = 0.5 * cable_mass_kg(cable);
        // The smaller of the two currents that satisfy V I = P + R I².
        const double ohm = loop_resistance_ohm(cable);
        const double square_V2 = at[volts] * at[volts] - 4.0 * ohm * task.load_W;
        if (square_V2 < 0.0) {
          throw s.error(cable_key::voltage, shortest(at[volts]) + " V",
                        "at least " + readable_number(2.0 * std::sqrt(ohm * task.load_W)) +
                            " V for this load through this cable");
        }
        const double current_A = 2.0 * task.load_W / (at[volts] + std::sqrt(square_V2));
        plain.source_W = task.load_W + current_A * current_A * ohm;
        const double bending = bending_stiffness_N_m_rad(cable);
        // Half of the cable is carried by the platform, half by the fixed end.
        const double hanging_N =
            0.5 * cable_mass_kg(cable) * task.model.environment.gravity_lab_m_s2.norm();
        for (const double tilt_rad : task.tilt_rad) {
          plain.delivered_W.push_back(task.load_W);
          plain.torque_N_m.push_back(disturbance_torque_N_m(task, "tether",
                                                            {{"stiffness_N_m_per_rad", {bending}}},
                                                            tilt_rad) -
                                     hanging_N * at[below] * std::sin(tilt_rad));
        }
        plain.figures = {bending, twisting_stiffness_N_m_rad(cable), cable_mass_kg(cable)};
        return plain;
      },
      {"bending_N_m_per_rad", "twisting_N_m_per_rad", "cable_kg"});
  option.name = option.symbol = "cable";
  option.remarks = {"a tether: it restores zero tilt and winds up with the yaw"};
  return option;
}

Key cable_table() {
  using namespace cable_key;
  return cable.of({voltage, cable_key::length, strands, strand_diameter, insulation_diameter,
                   insulation_modulus, attached_below});
}

Key battery_table() {
  using namespace battery_key;
  return battery.of({specific_energy, usable_fraction, electrodes});
}

}  // namespace photorque

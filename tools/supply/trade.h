// Comparison of power supplies: power over the tilt, mass, and disturbance.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "attitude/model/dynamics.h"
#include "core/product.h"
#include "core/settings/typed_keys.h"
#include "tools/runs/console.h"
#include "tools/runs/options.h"

namespace photorque {

// Task of every supply.
struct SupplyTask {
  double load_W = 0.0;
  double duration_s = 0.0;
  std::vector<double> tilt_rad;  // from 0, rising
  AttitudeModel model;           // [platform] and [environment], without disturbances

  double level_moment_kg_m2() const { return model.platform.inertia_kg_m2(1, 1); }
};

// Results at one tilt; the torque is about the axis of the tilt.
struct SupplyPoint {
  Estimate delivered_W;  // to the load
  // Mean torque. A fast alternating torque, which has no effect on the motion, is stated separately
  // by its amplitude.
  Estimate torque_N_m;
  Estimate alternating_N_m;
};

struct SupplyOption {
  std::string name;                // as in tables: "microwave 5.8 GHz"
  std::string symbol;              // name in quantities: "microwave_5_8_GHz"
  Estimate mass_kg;                // mass on the platform
  Estimate source_W;               // electric power drawn in the laboratory at zero tilt
  std::vector<SupplyPoint> curve;  // at SupplyTask::tilt_rad
  std::vector<std::string> remarks;
  // Further figures: name with unit, and value.
  std::vector<std::pair<std::string, Estimate>> figures;
};

// Numbers with the user's uncertainties. Results are evaluated at the central values. Their errors
// are the changes when each input is moved by its sigma to either side, added in quadrature (first
// order).
class UncertainInputs {
 public:
  // Reads a key that may be { value, sigma }; returns its index.
  size_t add(const Settings& settings, const UncertainNumberKey& key);
  std::vector<Estimate> evaluate(
      const std::function<std::vector<double>(const std::vector<double>& at)>& f) const;

 private:
  std::vector<Uncertain> inputs_;
};

// Results of a supply's formulas for plain numbers.
struct PlainOption {
  double mass_kg = 0.0, source_W = 0.0;
  std::vector<double> delivered_W, torque_N_m, alternating_N_m;  // by tilt
  std::vector<double> figures;
};
SupplyOption option_from(const UncertainInputs& inputs, const SupplyTask& task,
                         const std::function<PlainOption(const std::vector<double>& at)>& f,
                         const std::vector<std::string>& figure_names = {});

// Torque of a disturbance of this kind on the platform at rest at a tilt, about the axis of the
// tilt (positive: increases the tilt).
double disturbance_torque_N_m(const SupplyTask& task, const std::string& kind,
                              const std::vector<std::pair<std::string, std::vector<double>>>& keys,
                              double tilt_rad, double charge_drawn_C = 0.0);

// Torque and torque per delivered power, and the angle per delivered power by which it would rotate
// the platform within the task's duration if it were constant, ½ T t²/I; the largest over the
// tilts.
struct SupplyDisturbance {
  Estimate torque_N_m, torque_N_m_W, angle_rad_W;
  double alternating_N_m = 0.0;
};
SupplyDisturbance disturbance_of(const SupplyOption& option, const SupplyTask& task);

// ---- The power supplies, each from its table of [supply_trade].

// Range of an efficiency.
inline constexpr Range conversion_range{0.0, 1.0, true, false};

// [supply_trade.battery]
SupplyOption battery_option(const Settings& settings, const SupplyTask& task);
// Torque due to its lithium at zero tilt, at a drawn charge given as a fraction of the task's
// charge.
double battery_torque_N_m(const Settings& settings, const SupplyTask& task, double fraction);

// [supply_trade.cable]
SupplyOption cable_option(const Settings& settings, const SupplyTask& task);

// [[supply_trade.microwave]]
SupplyOption microwave_option(const Settings& settings, const SupplyTask& task);

// [supply_trade.induction]
SupplyOption induction_option(const Settings& settings, const SupplyTask& task);

// [[supply_trade.beam]]: traces its experiment at every tilt and evaluates its array.
struct BeamSettings {
  std::string name, experiment;
  RunOptions run;
  double lamp_efficiency = 0.0, converter_efficiency = 0.0, array_mass_kg = 0.0;
};
BeamSettings read_beam(const Settings& settings, const RunOptions& options);
SupplyOption beam_option(const BeamSettings& beam, const SupplyTask& task, const Console& console);

// Declarations of the tables, and of [supply_trade] with all of them.
Key battery_table();
Key cable_table();
Key microwave_table();
Key induction_table();
Key beam_table();
Key supply_table();

// Task of the supplies in [supply_trade].
SupplyTask read_supply_task(const Settings& root, const Settings& supply_trade);

// ---- The comparison as tables and pictures, and comparison with the paper's figures.

struct SupplyTrade {
  SupplyTask task;
  std::vector<SupplyOption> options;
  // Torque due to the battery's lithium at zero tilt, by the drawn fraction of its charge.
  std::vector<double> charge_fraction, battery_torque_N_m;
};

// Tables "supply" (a row per supply), "supply_by_tilt", "supply_figures", "battery_by_charge" and
// "paper_supply"; plots "supply_over_tilt" and "battery_torque_by_charge"; quantities NAME_….
Product supply_product(const SupplyTrade& trade);
void print_supply(const Console& console, const Product& product, const SupplyTrade& trade);

// Section III.B of the paper: each figure with the computed value and the reason for the
// difference; NaN if the comparison does not compute it.
Table paper_supply_table(const SupplyTrade& trade);

// Maximum fraction of monochromatic light that a single-junction cell can convert to electric
// power: every photon is absorbed, and recombination is purely radiative, into the front hemisphere
// only. Source: W. Shockley, H. J. Queisser, J. Appl. Phys. 32 (1961) 510, with the blackbody
// integral over photons above the gap; for one wavelength M. A. Green, Prog. Photovolt. 9 (2001)
// 257.
double radiative_limit(double wavelength_m, double irradiance_W_m2, double gap_J,
                       double temperature_K);

}  // namespace photorque

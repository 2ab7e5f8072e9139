// Comparison of power supplies: power over the tilt, mass, and disturbance.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "attitude/model/dynamics.h"
#include "core/product.h"
#include "core/settings/typed_keys.h"

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

}  // namespace photorque

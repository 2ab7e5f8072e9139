// Comparison of power supplies: power over the tilt, mass, and disturbance.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "attitude/model/dynamics.h"
#include "core/product.h"
#include "core/settings/typed_keys.h"

namespace photorque {

// The task of every supply.
struct SupplyTask {
  double load_W = 0.0;
  double duration_s = 0.0;
  std::vector<double> tilt_rad;  // from 0, rising
  AttitudeModel model;           // [platform] and [environment], no disturbances

  double level_moment_kg_m2() const { return model.platform.inertia_kg_m2(1, 1); }
};

// The results at one tilt; the torque is about the axis of the tilt.
struct SupplyPoint {
  Estimate delivered_W;  // to the load
  // Mean torque; fast alternating torque without effect is separate, as an amplitude.
  Estimate torque_N_m;
  Estimate alternating_N_m;
};

struct SupplyOption {
  std::string name;                // as in tables: "microwave 5.8 GHz"
  std::string symbol;              // of the same in quantities: "microwave_5_8_GHz"
  Estimate mass_kg;                // carried for it
  Estimate source_W;               // electric power that the laboratory gives at zero tilt
  std::vector<SupplyPoint> curve;  // at SupplyTask::tilt_rad
  std::vector<std::string> remarks;
  // Further figures, name with unit and value.
  std::vector<std::pair<std::string, Estimate>> figures;
};

// Numbers with the user's errors, and their results: values at the middle, errors from each input
// moved by its sigma to either side, added in squares (to first order).
class UncertainInputs {
 public:
  // Reads a key that may be { value, sigma }; gives its index.
  size_t add(const Settings& settings, const UncertainNumberKey& key);
  std::vector<Estimate> evaluate(
      const std::function<std::vector<double>(const std::vector<double>& at)>& f) const;

 private:
  std::vector<Uncertain> inputs_;
};

// Results of an option's formulas from plain numbers.
struct PlainOption {
  double mass_kg = 0.0, source_W = 0.0;
  std::vector<double> delivered_W, torque_N_m, alternating_N_m;  // by tilt
  std::vector<double> figures;
};
SupplyOption option_from(const UncertainInputs& inputs, const SupplyTask& task,
                         const std::function<PlainOption(const std::vector<double>& at)>& f,
                         const std::vector<std::string>& figure_names = {});

// The torque of a disturbance of this kind on the platform at rest at a tilt, about the axis that
// tilts (positive: tilts further).
double disturbance_torque_N_m(const SupplyTask& task, const std::string& kind,
                              const std::vector<std::pair<std::string, std::vector<double>>>& keys,
                              double tilt_rad, double charge_drawn_C = 0.0);

// Torque over delivered power, and the angle that it would turn the platform by in the task's
// duration were it constant, ½ T t²/I; the largest over the tilts.
struct SupplyDisturbance {
  Estimate torque_N_m, torque_N_m_W, angle_rad_W;
  double alternating_N_m = 0.0;
};
SupplyDisturbance disturbance_of(const SupplyOption& option, const SupplyTask& task);

}  // namespace photorque

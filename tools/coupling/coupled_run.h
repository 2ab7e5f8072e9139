// Simulation of light and power that is coupled to the motion.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "attitude/propagation/power_history.h"
#include "attitude/propagation/run.h"
#include "photovoltaics/array/supply.h"
#include "tools/coupling/light_model.h"

namespace photorque {

// Output of one group of lamps over time, and its channels.
struct GroupOutput {
  LightModel::Group group;
  std::shared_ptr<const LampOutput> output;
  // Weight of the group: that of a joint's position, which may be negative; empty: 1.
  std::function<double(double time_s)> weight = {};
  std::vector<double> corners_s = {};  // corners of the weight over time

  double at(double time_s) const { return output->at(time_s) * weight_at(time_s); }
  double weight_at(double time_s) const { return weight ? weight(time_s) : 1.0; }
};
// Output of every group of lamps over time, with its switches and warm-up droop.
std::vector<GroupOutput> group_outputs(const LightModel& light, const LightSettings& settings,
                                       double start_s);

// Means over one exchange interval that ends at time_s; charge and temperature are those at its
// end.
struct PowerRow {
  double time_s = 0.0;
  double light_W = 0.0;  // on the cells
  double best_W = 0.0, array_W = 0.0, load_W = 0.0;
  double voltage_V = 0.0;
  double battery_current_A = 0.0;
  double stored_J = 0.0;
  double temperature_K = 0.0;
  double output = 0.0;  // of all lamps, relative to full power
};

// Difference between the extrapolated torque of light and the next trace.
struct ContinuationError {
  double max_N_m = 0.0, sum_squares = 0.0;
  size_t count = 0;
};

// Exchanges data with the motion every LightSettings::step_s and at every switch of lamps. Between
// two exchanges the motion advances with the last battery current. Then light and power are
// simulated over the same interval, at their own steps, along the computed attitudes. Finally the
// charge in the motion is corrected. The error of the current during an interval moves the centre
// of mass by less than 1e-12 m for one interval, so that no iteration is needed.
class CoupledRun {
 public:
  // `table` null: light is traced at every exchange. Without `supply` only light is simulated. All
  // arguments must outlive the run.
  CoupledRun(const LightModel& light, std::shared_ptr<const RotationTable> table,
             std::vector<GroupOutput> outputs, std::optional<PowerSupply> supply,
             const LightSettings& settings, const PropagationRun& run, double battery_voltage_V);

  // Call it before the first step of the motion, unless the run continues from a snapshot.
  void begin(Propagator& motion);
  bool has_begun() const { return begun_; }
  // Call it after every step of the motion: processes the instants within the step and, at the end
  // of a segment, the exchange.
  void follow(Propagator& motion);
  void keep(Snapshot& snapshot);

  // History of battery and array so far.
  const PowerHistory& power() const { return power_; }
  const std::vector<PowerRow>& rows() const { return rows_; }
  const std::optional<PowerSupply>& supply() const { return supply_; }
  // Events of light and lamps; those of the battery belong to the power system.
  const std::vector<Event>& events() const { return events_; }
  const ContinuationError& continuation() const { return continuation_; }
  double emitted_J() const { return emitted_.value(); }
  size_t traces() const { return traces_; }
  // Largest correction of the charge at an exchange.
  double max_correction_C() const { return max_correction_C_; }

 private:
  // All channels at one instant, with the lamps at full output.
  struct Traced {
    double time_s = 0.0;
    std::vector<double> channels;
  };
  // A step of the power system; its channels are those at the middle of the step.
  struct Instant {
    double from_s = 0.0, length_s = 0.0;
    std::vector<double> channels;
    double illumination = 1.0;
    double middle_s() const { return from_s + 0.5 * length_s; }
  };
  void add_trace(double time_s, std::vector<double> channels);
  void plan(double from_s);
  void collect(Propagator& motion);
  void exchange(Propagator& motion);
  void run_supply();
  void look_for_light(double time_s, double light_W);
  ContinuedTorque continued(double illumination) const;
  std::vector<double> channels_at(const Quat& lab_from_body) const;
  PowerSupply::Light light_of(const Instant& instant) const;
  double output(const GroupOutput& group, double time_s, double illumination) const;
  double charge_C(const PowerSupply& supply) const;
  static Quat attitude_of(const std::vector<Lanes>& y, int lane);

  const LightModel& light_;
  std::shared_ptr<const RotationTable> table_;
  std::vector<GroupOutput> outputs_;
  std::optional<PowerSupply> supply_;
  double step_s_, start_s_, end_s_, battery_voltage_V_;
  double start_charge_C_ = 0.0, max_correction_C_ = 0.0;
  bool begun_ = false, has_sun_ = false;
  double segment_from_s_ = 0.0, segment_end_s_ = 0.0;
  double max_light_W_ = 0.0, last_light_W_ = 0.0, last_light_s_ = 0.0;
  bool is_lit_ = true;
  std::vector<double> switches_s_;
  std::vector<Instant> instants_;  // of the segment
  size_t collected_ = 0;
  std::vector<Traced> traced_;  // the last three
  size_t traces_ = 0;
  ContinuedTorque held_;
  PowerHistory power_;
  std::vector<PowerRow> rows_;
  std::vector<Event> events_;
  ContinuationError continuation_;
  EnergySum emitted_;
};

}  // namespace photorque

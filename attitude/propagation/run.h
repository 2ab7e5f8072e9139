// `propagate`: from an experiment file to a propagated platform, its recording and its plots.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "attitude/model/dynamics.h"
#include "attitude/propagation/live.h"
#include "attitude/propagation/propagator.h"
#include "attitude/recordings/recording.h"
#include "attitude/recordings/sensors.h"
#include "core/product.h"
#include "core/settings/settings.h"

namespace photorque {

struct PropagationRun {
  AttitudeModel model;  // the sensors' errors included, after the file's disturbances
  Sensors sensors;
  PlatformState initial;
  double duration_s = 0.0;
  double output_rate_Hz = 10.0;  // rows of the recording
  size_t history_rows = 5000;    // at most so many, evenly from the recording's, and its last
  PropagationOptions options;
  uint64_t seed = 1;
  std::string epoch;  // calendar time of t = 0, ISO 8601, for files that need one
  // Commands the run tick by tick, instead of the model's schedule. Needs options.tick_rate_Hz, and
  // a recording at the same rate.
  LiveCommander commander = {};
};

// The table `key` of an experiment with its own record of the keys read, so that finish() reports
// keys of this table alone. Empty where there is none and none is required.
Settings own_table(const Settings& root, const std::string& key, bool required);

// The nominal model of the platform and its laboratory: [platform], [environment],
// [[disturbance]] and [sensors] of an experiment file. InputError for wrong or unknown keys in
// them.
struct NominalModel {
  AttitudeModel model;
  Sensors sensors;
  // The disturbance by which the sigmas of [platform] inertia_kg_m2 stand in the model.
  std::optional<size_t> uncertain_inertia = {};

  // The context for readers of more disturbances; for as long as this lives.
  DisturbanceContext context() const;
};
NominalModel read_attitude_model(const Settings& root);

// Reads the model and [propagate], which may be absent; its keys are propagate_table().
PropagationRun read_propagation(const Settings& root);
Key propagate_table();

struct PropagationResult {
  Recording recording;  // as the sensors saw it
  // Time history (table), tilt, heading, rates, charge and torques (plots), headline figures.
  Product product;
  std::vector<PlatformState> states;  // the truth at the recording's times
  std::vector<Event> events;
  Propagator::Statistics statistics;
};

// Propagates the run. It ends early at the bearing's stop (Platform::tilt_limit_rad). `progress` is
// called now and then with the fraction of the duration that is done. What runs beside the motion
// needs the loop in plain view: RecordedRun (recorded.h).
PropagationResult propagate(const PropagationRun& run,
                            const std::function<void(double)>& progress = {});

// Reads initial_position_m[2] and initial_velocity_m_s[2] of [propagate], both zero by default;
// nothing of a platform that does not slide.
void read_initial_place(const Settings& settings, const AttitudeModel& model,
                        PlatformState& initial);

// Place (x, y) and velocity in a state vector; none where the platform does not slide.
std::optional<std::array<double, 4>> place_of(const Dynamics& dynamics,
                                              const std::vector<double>& y);

}  // namespace photorque

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
  AttitudeModel model;  // includes the errors of the sensors, after the file's disturbances
  Sensors sensors;
  PlatformState initial;
  double duration_s = 0.0;
  double output_rate_Hz = 10.0;  // rows of the recording
  size_t history_rows = 5000;    // maximum; evenly spaced rows of the recording, and its last
  PropagationOptions options;
  uint64_t seed = 1;
  std::string epoch;  // calendar time of t = 0, ISO 8601, for files that need one
  // Returns the commands at every tick and replaces the schedule of the model. It requires
  // options.tick_rate_Hz and a recording at the same rate.
  LiveCommander commander = {};
};

// The table `key` of an experiment with a separate record of the keys read, so that its finish()
// reports keys of this table alone. An absent table is empty, or an InputError if it is `required`.
Settings own_table(const Settings& root, const std::string& key, bool required);

// The nominal model of the platform and its laboratory: [platform], [environment],
// [[disturbance]] and [sensors] of an experiment file. InputError for wrong or unknown keys in
// them.
struct NominalModel {
  AttitudeModel model;
  Sensors sensors;
  // Index of the disturbance that has the sigmas of [platform] inertia_kg_m2.
  std::optional<size_t> uncertain_inertia = {};

  // Context for readers of further disturbances. It is valid as long as this object.
  DisturbanceContext context() const;
};
NominalModel read_attitude_model(const Settings& root);

// Reads the model and [propagate], which may be absent; its keys are propagate_table().
PropagationRun read_propagation(const Settings& root);
Key propagate_table();

struct PropagationResult {
  Recording recording;  // readings of the sensors
  // Time history (table), tilt, heading, rates, charge and torques (plots), headline figures.
  Product product;
  PlatformState end;                  // of the last row, or at the event that ended the run
  std::vector<PlatformState> states;  // the truth at the recording's times
  std::vector<Event> events;
  Propagator::Statistics statistics;
};

// Propagates the run. It ends early at the bearing's stop (Platform::tilt_limit_rad). `progress` is
// called from time to time with the fraction of the duration that is done. A simulation that is
// coupled to the motion needs access to the loop and uses RecordedRun (recorded.h).
PropagationResult propagate(const PropagationRun& run,
                            const std::function<void(double)>& progress = {});

}  // namespace photorque

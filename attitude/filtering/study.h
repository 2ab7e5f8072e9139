// `estimate`: the contribution of each instrument to the attitude, in recordings or simulated runs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "attitude/filtering/consistency.h"
#include "attitude/propagation/run.h"
#include "core/product.h"
#include "core/settings/keys.h"

namespace photorque {

struct EstimateStudy {
  NominalModel nominal;
  FilterSettings filter;  // of the written estimate; its random walk: see below
  // Random walk of the rate [rad/s per √s], for filters without torques and in addition to the
  // modelled torques; if empty, the maximum-likelihood value.
  std::optional<double> rate_walk, disturbed_rate_walk;
  size_t search_readings = 2000;  // for the maximum-likelihood search
  int runs = 20;                  // simulated runs if there is no recording
  int threads = 0;
};

// [estimate], which may be absent; its keys are estimate_table().
EstimateStudy read_estimate(const Settings& root);

// InputError if an instrument of the model has no noise: the filter weights by the noise.
void require_noise(const Sensors& sensors);
// The instruments, with noise levels from the recording (attitude/observation/noise_levels.h) where
// the experiment states none. `found`: a line about each of these levels.
struct RecordingNoise {
  Sensors sensors;
  std::vector<std::string> found;
};
RecordingNoise with_noise_of(const Sensors& sensors, const Recording& recording,
                             const std::string& name, const Platform& platform);

// One combination of instruments and motion model, and its estimates.
struct Ingredients {
  std::string name;  // as printed, "camera and gyro, disturbances"
  FilterSettings settings;
  Estimation estimation;
};

struct EstimateResult {
  std::vector<Ingredients> methods;
  size_t chosen = 0;  // index of the written method
  Product product;
  // One line for each quantity that the recording does not determine.
  std::vector<std::string> unseen;
};

// Estimates with every combination that the channels permit. `truth` may be empty.
EstimateResult estimate_by_all_methods(const EstimateStudy& study, const Readings& readings,
                                       const TruthTrack& truth,
                                       const std::function<void(double)>& progress = {});

// The recording with attitude and gyro replaced by an estimate. The gyro reading is the inertial
// rate without bias, scale error and noise. Commands, currents and other channels are unchanged.
Recording recording_of(const std::vector<AttitudeEstimate>& estimates, const Recording& source);

// A run whose uncertain parameters are drawn from their sigmas, with its true values.
struct SimulatedRun {
  Recording recording;
  TruthTrack truth;
};
SimulatedRun simulate_run(const PropagationRun& nominal, uint64_t seed);
// Attitudes and rates of the recording `known` (q_w …, rate_x_rad_s …) at the rows of `rows`. Rows
// that differ by more than 1 ms from a time of `known` are empty. InputError without attitude.
TruthTrack truth_from(const Recording& known, const Recording& rows);

// Results of the chosen method over many simulated runs.
struct ConsistencyResult {
  RunEnsemble ensemble;
  double part_filtered = 0.0, part_smoothed = 0.0;  // fraction of rows in the 95 % band
  double worst_gain = 0.0;  // largest ratio of smoothed to filtered rms error of all rows
  Product product;
};
ConsistencyResult consistency_of(const EstimateStudy& study, const PropagationRun& run,
                                 const FilterSettings& settings,
                                 const std::function<void(double)>& progress = {});

// The keys of [estimate].
Key estimate_table();

}  // namespace photorque

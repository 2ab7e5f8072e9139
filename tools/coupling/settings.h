// What an experiment says about light in a run of the attitude: the table [light].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/experiment/experiment.h"

namespace photorque {

// [light]
struct LightSettings {
  enum class Mode {
    table,  // traced once over the attitudes, then interpolated
    trace,  // traced at every exchange of the run
    off,    // left out, as if the file had no scene
  };
  Mode mode = Mode::table;
  double tolerance = 1e-3;  // of the table, relative to the largest value
  double step_s = 1.0;      // between exchanges of motion and power
  uint64_t rays = 0;        // per attitude
  size_t max_traces = 20000;
  std::optional<double> max_tilt_rad;          // that the table holds
  std::optional<std::filesystem::path> cache;  // a folder; none: tables are not kept
  // [[light.switch]]: lamps of one source, or of all.
  struct Switch {
    double time_s = 0.0;
    std::string source;  // empty: all
    bool on = true;
  };
  std::vector<Switch> switches;  // in order of time
};

// Whether `propagate` couples light and motion: the file has a scene, sources and a platform.
bool has_light(const ExperimentFile& file);

// Reads [light], which may be absent: mode ("table"), tolerance (1e-3), step_s (1), rays (of the
// trace, at most 2^18), max_traces (20000), max_tilt_deg (the platform's limit, or 180), cache (the
// user's cache folder; "" for none); [[light.switch]] with time_s, on and source (all). InputError
// as usual, and for switches out of order.
LightSettings read_light(const ExperimentFile& file);

}  // namespace photorque

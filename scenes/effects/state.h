// Effects on light and power in addition to the experiment.
//
// A plain value that every effect writes into and the forward model reads; as it is constructed,
// nothing acts. Effects of several kinds combine by writing into one state after the other.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/transform.h"

namespace photorque {

// An opaque box. It dims passing light by `opacity`, 1 where it is fully opaque.
struct ShadowBox {
  bool on_body = false;  // its axes and corners are those of the body; otherwise of the lab
  Vec3 low_m = Vec3::Zero(), high_m = Vec3::Zero();
  double opacity = 1.0;  // 0 to 1

  bool operator==(const ShadowBox&) const = default;
};

// Light reflected by a part of the scene that is assumed black.
struct WallReflection {
  size_t wall = 0;        // which of LightParts::walls
  double diffuse = 0.0;   // share that leaves by Lambert's law, 0 to 1
  double specular = 0.0;  // share that leaves as from a mirror, 0 to 1

  bool operator==(const WallReflection&) const = default;
};

// Conditions of a sample: the variables of empirical laws.
struct SampleConditions {
  double u = 0.0, v = 0.0;  // on the receiver, −1 to 1 over its extent
  double irradiance = 0.0;  // by the nominal model, over the largest of the run
  double time_s = 0.0;
  double temperature_K = 0.0;
  double tilt_rad = 0.0, heading_rad = 0.0;
  double voltage = 0.0;  // over the largest of the run
};

struct LightState {
  // For each lamp, in the order of Experiment::beams:
  std::vector<double> lamp_power;  // factor on its power
  std::vector<Vec2> lamp_aim;      // tangents of the rotation angles of its axis
  double power = 1.0;              // of all lamps
  double divergence = 1.0;         // of all beams' angular width
  Vec3 shift_m = Vec3::Zero();     // of all lamps
  double droop_depth = 0.0, droop_time_s = 1.0;
  double ambient_W_m2 = 0.0;
  Vec2 attitude_bias_rad = Vec2::Zero();  // rotation vector about lab x and y
  std::vector<ShadowBox> boxes;
  std::vector<WallReflection> walls;
  // A factor on all light, at least 0: laws outside of the catalogue.
  std::vector<std::function<double(const SampleConditions&)>> light_laws;

  double detector_gain = 1.0;
  double soiling = 1.0;
  std::optional<double> glass_index;  // of a cover over the cells
  // For each cell:
  std::vector<double> cell_current;  // factor on its photocurrent
  std::vector<double> cell_light;    // factor on the light over its rectangle
  std::vector<bool> string_open, bypass_shorted;
  double series_ohm = 0.0;  // of the whole array
  double shunt_S = 0.0;     // across every cell
  double photocurrent_per_K = 0.0, voltage_V_per_K = 0.0;
  // Added to the array's current, over the largest short-circuit current of the run.
  std::vector<std::function<double(const SampleConditions&)>> current_laws;
  struct Interval {
    double from_s = 0.0, to_s = 0.0;
    int recording = 0;  // in which
  };
  std::vector<Interval> trapped;  // the tracker stands at a maximum that is not the highest

  // No effects.
  LightState(size_t lamps, size_t cells, size_t strings, size_t bypasses)
      : lamp_power(lamps, 1.0),
        lamp_aim(lamps, Vec2::Zero()),
        cell_current(cells, 1.0),
        cell_light(cells, 1.0),
        string_open(strings, false),
        bypass_shorted(bypasses, false) {}
};

}  // namespace photorque

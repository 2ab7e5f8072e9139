// Effects on light and power in addition to the experiment.
//
// A plain value: every effect writes into it, and the forward model reads it. The initial state has
// no effects. Several effects are combined by writing into one state in turn.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/transform.h"

namespace photorque {

// A box that blocks the fraction `opacity` of the light through it.
struct ShadowBox {
  bool on_body = false;  // axes and corners in the body frame; if false, in the lab frame
  Vec3 low_m = Vec3::Zero(), high_m = Vec3::Zero();
  double opacity = 1.0;  // 0 to 1

  bool operator==(const ShadowBox&) const = default;
};

// Light reflected by a part of the scene that is assumed black.
struct WallReflection {
  size_t wall = 0;        // index in LightParts::walls
  double diffuse = 0.0;   // fraction that leaves by Lambert's law, 0 to 1
  double specular = 0.0;  // fraction that is reflected as by a mirror, 0 to 1

  bool operator==(const WallReflection&) const = default;
};

// Conditions of a sample; variables of empirical laws.
struct SampleConditions {
  double u = 0.0, v = 0.0;  // position on the receiver, −1 to 1 over its extent
  double irradiance = 0.0;  // by the nominal model, relative to the largest of the run
  double time_s = 0.0;
  double temperature_K = 0.0;
  double tilt_rad = 0.0, heading_rad = 0.0;
  double voltage = 0.0;  // relative to the largest of the run
};

struct LightState {
  // Per lamp, in the order of Experiment::beams:
  std::vector<double> lamp_power;  // factor on its power
  std::vector<Vec2> lamp_aim;      // tangents of the rotation angles of its axis
  double power = 1.0;              // factor for all lamps
  double divergence = 1.0;         // factor on the angular width of all beams
  Vec3 shift_m = Vec3::Zero();     // displacement of all lamps
  double droop_depth = 0.0, droop_time_s = 1.0;
  double ambient_W_m2 = 0.0;
  Vec2 attitude_bias_rad = Vec2::Zero();  // rotation vector about lab x and y
  std::vector<ShadowBox> boxes;
  std::vector<WallReflection> walls;
  // Factors on all light, each at least 0: empirical laws outside the catalogue.
  std::vector<std::function<double(const SampleConditions&)>> light_laws;

  double detector_gain = 1.0;
  double soiling = 1.0;
  std::optional<double> glass_index;  // of a cover over the cells
  // Per cell:
  std::vector<double> cell_current;  // factor on the photocurrent
  std::vector<double> cell_light;    // factor on the light on the cell's rectangle
  std::vector<bool> string_open, bypass_shorted;
  double series_ohm = 0.0;  // in series with the whole array
  double shunt_S = 0.0;     // across every cell
  double photocurrent_per_K = 0.0, voltage_V_per_K = 0.0;
  // Terms added to the array's current, relative to the largest short-circuit current of the run.
  std::vector<std::function<double(const SampleConditions&)>> current_laws;
  struct Interval {
    double from_s = 0.0, to_s = 0.0;
    int recording = 0;  // index of the recording
  };
  std::vector<Interval> trapped;  // intervals in which the tracker holds a local maximum

  // State without effects.
  LightState(size_t lamps, size_t cells, size_t strings, size_t bypasses)
      : lamp_power(lamps, 1.0),
        lamp_aim(lamps, Vec2::Zero()),
        cell_current(cells, 1.0),
        cell_light(cells, 1.0),
        string_open(strings, false),
        bypass_shorted(bypasses, false) {}
};

}  // namespace photorque

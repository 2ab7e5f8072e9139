// One kind of effect on light and power: stated by an experiment, or found by a diagnosis.
//
// A kind states its parameters as differences from what leaves everything as it is, and writes them
// into a LightState. Adding one is one entry in the table of its family.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scenes/effects/state.h"

namespace photorque {

// A number, or several of one key. What is fitted is x, which is 0 where nothing acts.
struct EffectParameter {
  // Value of the key from x, in SI.
  enum class Form {
    offset,      // neutral + x
    reciprocal,  // 1/x
    slant,       // the refractive index of a glass that takes x of what one of index 2 takes of
                 // light at 45°; beyond 2 glass takes less again
    tangent,     // atan x, of an angle
  };
  std::string key;           // as diagnosis.json and experiments name it, with its unit
  std::string meaning = {};  // a phrase for the tables of keys
  size_t count = 1;
  double neutral = 0.0;
  double scale = 1.0;  // expected size of x, > 0
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  Form form = Form::offset;
  // False: no strength. It means nothing without the others and is looked for over `starts`.
  bool is_strength = true;
  std::vector<double> starts = {};
  bool is_fitted = true;  // false: the value of a scan of the recording is kept
  double step = 0.0;      // of the differences that give derivatives; 0: a fiftieth of the scale
};

struct LightEffectKind {
  std::string name;
  std::string explanation;  // a sentence of physics without a full stop
  // `frame`: 0 fixed in the lab, 1 fixed on the body.
  enum class Index { none, lamp, cell, string, bypass, wall, frame };
  Index index = Index::none;
  std::vector<EffectParameter> parameters;
  // Which recordings can show it.
  bool in_scans = true, in_sweeps = true, in_runs = true;
  // Whether it acts on the array's circuit, and not on light or photocurrents alone.
  bool in_circuit = false;
  // Whether a trace of the experiment shows it.
  bool is_traced = false;
  // Initial values of nonlinear parameters from the recordings.
  enum class Scan { none, shadow, trapped, wave };
  Scan scan = Scan::none;
  // Writes x into the state; `x` holds all parameters' numbers in order.
  std::function<void(LightState& state, size_t index, std::span<const double> x)> act;
};

// The value of a key from x, in SI, and dvalue/dx.
double value_of(const EffectParameter& parameter, double x);
double slope_of(const EffectParameter& parameter, double x);
// And back.
double x_of(const EffectParameter& parameter, double value);

// Which values the key can have, in its own unit: "from 0 to 1"; empty where any number will do.
std::string range_of(const EffectParameter& parameter);

// The families, each a table in the file of its name.
std::vector<LightEffectKind> lamp_effect_kinds();
std::vector<LightEffectKind> surroundings_effect_kinds();
std::vector<LightEffectKind> array_effect_kinds();
// All of them, in that order.
std::vector<LightEffectKind> all_light_effect_kinds();

}  // namespace photorque

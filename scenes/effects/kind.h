// One kind of effect on light and power, stated by an experiment or found by a diagnosis.
//
// A kind states its parameters as deviations from the values without effect, and writes them into a
// LightState. To add a kind, add one entry to the table of its family.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scenes/effects/state.h"

namespace photorque {

// One parameter of an effect: a number, or several numbers of one key. The fitted variable is x;
// x = 0 means no effect.
struct EffectParameter {
  // Value of the key from x, in SI.
  enum class Form {
    offset,      // neutral + x
    reciprocal,  // 1/x
    // Refractive index of a glass with the loss x at 45° relative to a glass of index 2. (Glass
    // above index 2 loses less again.)
    slant,
    tangent,  // atan x, of an angle
  };
  std::string key;           // name in diagnosis.json and in experiments, with its unit
  std::string meaning = {};  // a phrase for the tables of keys
  size_t count = 1;
  double neutral = 0.0;
  double scale = 1.0;  // expected size of x, > 0
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  Form form = Form::offset;
  // False: the parameter has no effect unless another one is nonzero. It is then searched from
  // `starts`.
  bool is_strength = true;
  std::vector<double> starts = {};
  bool is_fitted = true;  // false: the value of the scan of the recording is kept
  double step = 0.0;      // step of numerical derivatives; 0: a fiftieth of the scale
};

struct LightEffectKind {
  std::string name;
  std::string explanation;  // a sentence of physics without a full stop
  // Object to which `index` refers. `frame`: 0 fixed in the lab, 1 fixed on the body.
  enum class Index { none, lamp, cell, string, bypass, wall, frame };
  Index index = Index::none;
  // Whether the effect acts on one of several equal objects.
  bool is_numbered() const { return index != Index::none && index != Index::frame; }
  std::vector<EffectParameter> parameters;
  // Types of recordings that show the effect.
  bool in_scans = true, in_sweeps = true, in_runs = true;
  // Whether it acts on the array's circuit, not only on light or photocurrents.
  bool in_circuit = false;
  // Whether a trace of the experiment shows it.
  bool is_traced = false;
  // Method for initial values of nonlinear parameters from the recordings.
  enum class Scan { none, shadow, trapped, wave };
  Scan scan = Scan::none;
  // Writes x into the state; `x` contains the numbers of all parameters in order.
  using Act = std::function<void(LightState& state, size_t index, std::span<const double> x)>;
  Act act;
};

// Frequent parameters of the families. `factor` from 0 to 1, and from 0.05 to 5; 1 has no effect.
EffectParameter remaining_fraction(const std::string& meaning, double scale,
                                   const std::vector<double>& starts = {});
EffectParameter gain_factor(const std::string& meaning);
// From 0, which has no effect, to `highest`.
EffectParameter from_zero(const std::string& key, const std::string& meaning, double scale,
                          double highest);

// Effects with one parameter x: multiply a factor of the state by 1 + x, or add x to a term.
LightEffectKind::Act multiplies(double LightState::*factor);
LightEffectKind::Act multiplies_one(std::vector<double> LightState::*factors);
LightEffectKind::Act adds_to(double LightState::*term);

// Value of a key from x, in SI units, and its derivative with respect to x.
double value_of(const EffectParameter& parameter, double x);
double slope_of(const EffectParameter& parameter, double x);
// Inverse of value_of().
double x_of(const EffectParameter& parameter, double value);

// Range of the key in its own unit, such as "from 0 to 1"; empty if any number is allowed.
std::string range_of(const EffectParameter& parameter);

// The families; each is a table in the file of the same name.
std::vector<LightEffectKind> lamp_effect_kinds();
std::vector<LightEffectKind> surroundings_effect_kinds();
std::vector<LightEffectKind> array_effect_kinds();
// All kinds, in the order of the families.
std::vector<LightEffectKind> all_light_effect_kinds();

}  // namespace photorque

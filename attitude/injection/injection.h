// What `prove` knows about a kind: its law once more in plain arithmetic, and how its examples are
// drawn.
//
// The second law shares nothing with the first but the formula and the conventions of its keys, so
// that `diagnose` is not tried on its own equations: plain doubles, one instant at a time, no
// derivatives.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "attitude/injection/draw.h"
#include "attitude/injection/vectors.h"

namespace photorque {

using injected::Triple;

// An effect with its numbers in SI units, keys as in an experiment file.
struct InjectedEffect {
  std::string kind;
  std::map<std::string, std::vector<double>> parameters;

  // NumericalError where the effect has no such key, or another number of numbers.
  double number(const std::string& key) const { return numbers(key, 1)[0]; }
  Triple triple(const std::string& key) const;
  const std::vector<double>& numbers(const std::string& key, size_t count) const;
};

namespace injected {

// What a law may look at. Vectors in body axes.
struct Surroundings {
  double time_s = 0.0;
  Quaternion attitude = {1, 0, 0, 0};
  Triple rate = {};
  double charge_Ah = 0.0;
  double mass_kg = 0.0;
  Triple offset_m = {};
  Matrix inertia = {};
  Triple gravity = {}, field = {}, up = {};
  Triple gravity_level = {};  // in body axes at zero attitude
  double gravity_m_s2 = 0.0;
  Triple command_N_m = {};

  // The torque of a centre of mass there.
  Triple weight_at(const Triple& offset) const { return times(mass_kg, cross(offset, gravity)); }
};

// The torque of an effect whose numbers are already known.
using PlainTorque = std::function<Triple(const Surroundings&)>;

// An appendage on a spring.
struct Appendage {
  Triple axis = {};
  double angular_frequency_1_s = 0.0, damping = 0.0, inertia_kg_m2 = 0.0;
};

// What an effect may change instead of adding a torque: the body, its laboratory, its instruments.
struct PlainPlatform {
  Matrix inertia = {};
  Triple gravity_lab = {}, earth_lab = {};
  double latitude_rad = 0.0;
  Triple gyro_bias = {}, gyro_scale = {}, gyro_turn = {}, camera_turn = {};
  double camera_latency_s = 0.0;
  std::optional<Appendage> appendage = {};
};

// What the size of an example may depend on.
struct ExampleConditions {
  double duration_s = 0.0;  // of the recording
  Matrix inertia_kg_m2 = {};
  double max_tone_Hz = 0.0;  // four readings of the slowest instrument a period
};

using EffectNumbers = std::map<std::string, std::vector<double>>;
using DrawExample = std::function<EffectNumbers(RandomDraw&, const ExampleConditions&)>;

struct Injection {
  // How the effect is drawn at a size that is plausible in a laboratory; its strength is then
  // fitted to what the readings shall show. Null: never, for the reason that follows.
  DrawExample draw = nullptr;
  std::string reason_against = {};

  // The second law: a torque, or a change of the platform, or both.
  PlainTorque (*torque)(const InjectedEffect& effect) = nullptr;
  void (*alter)(const InjectedEffect& effect, PlainPlatform& platform) = nullptr;
  // Where the torque jumps, at least all instants within.
  std::vector<double> (*jumps_s)(const InjectedEffect& effect, double from_s,
                                 double to_s) = nullptr;

  std::string strength = {};    // the key that makes it strong; empty: it has no numbers
  double step = 0.0;            // of the strength, SI, small enough for differences; 0: too rough
  double max_factor = 30.0;     // times the size that was drawn
  bool needs_commands = false;  // shows only where torques are commanded
  bool needs_small_turns = false;  // the law jumps where the platform turns far
  bool pairs = false;              // may stand beside another effect
};

// Draws of a vector of random direction, of one number, and of an effect without numbers.
DrawExample random_direction(const std::string& key, double size);
DrawExample fixed_size(const std::string& key, double size);
DrawExample either_sign(const std::string& key, double size);
DrawExample nothing_to_draw();
std::vector<double> list(const Triple& v);
// Of a tone, slow enough to be read.
double tone_Hz(RandomDraw& draw, const ExampleConditions& conditions);

}  // namespace injected
}  // namespace photorque

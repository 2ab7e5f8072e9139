// The catalogue of light and power once more, as acts on an injected world, and laws outside it.
#pragma once

#include "tools/proof/light/readings.h"

namespace photorque::injected {

// An effect with numbers as in truth.json; of a strength from 0 (nothing) to 1 where it has one.
struct LightEffect {
  std::string kind;
  int index = -1;  // of a lamp, cell, string or diode; −1: none
  std::map<std::string, std::vector<double>> numbers;
};

// What a drawing leaves open, and the effect at a strength.
struct LightRecipe {
  std::string kind;
  bool has_strength = true;
  std::function<LightEffect(double strength)> at;
};

// Acts on the world. NumericalError for an unknown kind.
void act(const LightEffect& effect, LightWorld& world);

// The numbers of a kind as a rival fits them: those at which nothing happens, their steps and
// bounds; empty where there is nothing to fit.
struct RivalNumbers {
  std::vector<double> neutral, step, low, high;
};
struct Rival {
  std::string kind;
  int index = -1;
  RivalNumbers numbers;
  std::function<void(LightWorld&, const std::vector<double>&)> act;
};
// All that could act in the place of something else, on a world with such recordings.
std::vector<Rival> light_rivals(const LightWorld& world, bool has_scans, bool has_circuit,
                                bool has_runs);

// A recipe of a kind for a world, drawn at random. `duration_s` of the run.
LightRecipe draw_light_effect(RandomDraw& draw, const LightWorld& world, const std::string& kind,
                              double duration_s);

}  // namespace photorque::injected

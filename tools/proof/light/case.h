// Injected cases of light and power: lamps, plate and array of the nominal model, what acts beside
// them, and what was read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/proof/light/effects.h"

namespace photorque {

struct LightPlan {
  uint64_t seed = 1;
  int per_kind = 4;          // of every kind of the catalogue
  int none = 10;             // nothing missing
  int pairs = 10;            // two effects
  int outside = 3;           // of every law outside the catalogue
  int below = 10;            // one effect below what shows
  double dirty_share = 0.2;  // of the cases: comments, lost rows, wild readings
};

struct LightCase {
  std::string name, family;  // none | single | pair | outside | below
  uint64_t seed = 0;
  std::string sources;  // their tables of the experiment
  injected::LightWorld believed;
  std::vector<injected::LightEffect> effects;
  injected::LightNoiseStated noise;
  struct Recording {
    std::string name;  // "scan1"
    injected::LightRows rows;
  };
  std::vector<Recording> recordings;  // those to fit, "…1", and those held out, "…2"
  bool has_array = true, dirty = false;

  std::string verdict;
  std::vector<std::vector<std::string>> accept;  // sets of names that count as right
  std::map<std::string, std::vector<int>> accept_index;
  std::vector<std::string> depends_on;
  bool below = false;
  double chi2_gain = 0.0;

  injected::LightWorld truth() const;
  bool voltage_is_set() const { return noise.tracker_step_V > 0.0; }
};

// Kinds of the catalogue that are injected, and laws outside it.
const std::vector<std::string>& injected_light_kinds();
const std::vector<std::string>& injected_light_laws();

size_t light_case_count(const LightPlan& plan);
// The i-th case of a plan; the same in whatever order they are drawn. NumericalError where none
// that shows is found.
LightCase draw_light_case(const LightPlan& plan, size_t index);

namespace injected {

// Lamps, plate, array, noise and recordings such that `kinds` can act.
void draw_light_setting(RandomDraw& draw, LightCase& c, const std::vector<std::string>& kinds);

// What the recordings can show of a case: chi² of the nominal model, and which other effects
// explain them as well.
class LightJudge {
 public:
  explicit LightJudge(const LightCase& c);
  // chi² of the nominal model where these act.
  double gain(const std::vector<LightEffect>& effects) const;
  // Fills accept and accept_index with what leaves less than `near` of chi², and returns what the
  // best single effect leaves; of laws outside the catalogue alone what all its numbers together
  // leave, to first order.
  double judge(LightCase& c, double near) const;

 private:
  std::vector<double> whitened(const LightWorld& world) const;
  // The chi² that remains of `target` when `rivals` are fitted beside `kept`.
  double left(const LightWorld& kept, const std::vector<const Rival*>& rivals,
              const std::vector<double>& target) const;
  double left_by_all(const std::vector<Rival>& rivals, const std::vector<double>& target) const;

  LightWorld believed_;
  bool voltage_is_set_;
  LightNoiseStated noise_;
  std::vector<LightRows> rows_;  // thinned
  std::vector<double> scale_;    // of chi², for what was left out
  std::vector<std::vector<double>> errors_;
};

}  // namespace injected
}  // namespace photorque

// Candidate effects of light and power: every kind of effect for every lamp, cell, string or diode
// that it can concern, and competing smooth laws without physics.
#pragma once

#include <memory>

#include "diagnosis/light/beliefs.h"
#include "diagnosis/light/model/run.h"
#include "inference/estimator/thresholds.h"
#include "scenes/effects/kind.h"

namespace photorque {

// A recording with the data that all trials share: the fields of the nominal model, and the
// derivatives of its residuals by the uncertain nominal numbers, in units of their errors.
struct FittedRun {
  std::shared_ptr<const LightRun> run;
  std::shared_ptr<const LightFields> nominal;
  std::shared_ptr<const Eigen::MatrixXd> prior_slopes;  // ∂(predicted/noise), a column each
};

FittedRun prepared_run(LightRun run, const LightBelief& nominal);
// The rows chosen alone.
FittedRun part_of(const FittedRun& whole, const std::vector<size_t>& rows,
                  const LightBelief& nominal);

struct LightCandidate {
  LightEffectKind kind;
  size_t index = 0;   // of the lamp, cell …
  std::string label;  // "led_derated[3]", "unknown in position"
  // Of an empirical law: its variable; else empty.
  std::string variable = {};

  bool is_empirical() const { return !variable.empty(); }
  // Number by number, in the order of the kind's parameters.
  struct Number {
    size_t parameter;
    double start, scale, lowest, highest, step;
    bool is_strength, is_fitted;
  };
  std::vector<Number> numbers;
  std::vector<double> start() const;
  size_t fitted() const;
  bool has_strength() const;
  // Whether all that is fitted is a strength, and nothing has to be scanned.
  bool is_linear() const;
  // Whether circuits of cells make the readings bend with it.
  bool bends = false;
};

struct LightCandidates {
  std::vector<LightCandidate> list;
  Thresholds limits;
  const LightLab* lab = nullptr;
  LightBelief nominal;

  const LightCandidate& operator[](size_t i) const { return list[i]; }
};

// All that these recordings can show.
LightCandidates light_candidates(const LightLab& lab, const LightBelief& nominal,
                                 const std::vector<FittedRun>& runs, const Thresholds& limits);

// Smooth laws of position, irradiance, time, temperature, attitude and voltage.
std::vector<LightCandidate> empirical_light_candidates(const std::vector<FittedRun>& runs);

}  // namespace photorque

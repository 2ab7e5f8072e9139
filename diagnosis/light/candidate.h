// Candidate effects of light and power: every kind of effect for every lamp, cell, string or diode
// that it can concern, and competing empirical laws.
#pragma once

#include <memory>

#include "diagnosis/light/model/run.h"
#include "diagnosis/light/nominal_light.h"
#include "inference/estimator/thresholds.h"
#include "scenes/effects/kind.h"

namespace photorque {

// A recording with the data that all trials share: the fields of the nominal model, and the
// derivatives of its residuals with respect to the uncertain nominal values, in units of their
// errors.
struct FittedRun {
  std::shared_ptr<const LightRun> run;
  std::shared_ptr<const LightFields> nominal;
  std::shared_ptr<const Eigen::MatrixXd> prior_slopes;  // ∂(predicted/noise), one column per prior
};

// Prepares a recording for the fits of all trials.
FittedRun prepared_run(LightRun run, const NominalLight& nominal);
// Selects rows of a prepared run.
FittedRun part_of(const FittedRun& whole, const std::vector<size_t>& rows,
                  const NominalLight& nominal);

struct LightCandidate {
  LightEffectKind kind;
  size_t index = 0;   // number of the lamp, cell …
  std::string label;  // "led_derated[3]", "unknown in position"
  // Variable of an empirical law; otherwise empty.
  std::string variable = {};

  bool is_empirical() const { return !variable.empty(); }
  // Fitted or scanned numbers, in the order of the kind's parameters.
  struct Number {
    size_t parameter;
    double start, scale, lowest, highest, step;
    bool is_strength, is_fitted;
  };
  std::vector<Number> numbers;
  std::vector<double> start() const;
  size_t fitted() const;
  bool has_strength() const;
  // Whether all fitted numbers are strengths and no scan is required.
  bool is_linear() const;
  // Whether cell circuits make the readings a nonlinear function of its numbers.
  bool bends = false;
};

struct LightCandidates {
  std::vector<LightCandidate> list;
  Thresholds limits;
  const LightLab* lab = nullptr;
  NominalLight nominal;

  const LightCandidate& operator[](size_t i) const { return list[i]; }
};

// All candidates that these recordings can reveal.
LightCandidates light_candidates(const LightLab& lab, const NominalLight& nominal,
                                 const std::vector<FittedRun>& runs, const Thresholds& limits);

// Smooth laws of position, irradiance, time, temperature, attitude and voltage.
std::vector<LightCandidate> empirical_light_candidates(const std::vector<FittedRun>& runs);

}  // namespace photorque

// Candidate effects of light and power: every kind of effect for every lamp, cell, string or diode
// that it can concern, and competing empirical laws.
#pragma once

#include <memory>

#include "diagnosis/light/model/run.h"
#include "diagnosis/light/nominal_light.h"
#include "inference/domain.h"
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

// An effect on light, or an empirical law, with the traits that the search uses. Its name is
// printed: "led_derated[3]", "unknown in position".
struct LightCandidate : inference::CandidateTraits {
  LightEffectKind kind;
  size_t index = 0;  // number of the lamp, cell …
  // Variable of an empirical law; otherwise empty.
  std::string variable = {};

  // Fitted or scanned numbers, in the order of the kind's parameters.
  struct Number {
    size_t parameter;
    double start, scale, lowest, highest, step;
    bool is_strength, is_fitted;
  };
  std::vector<Number> numbers;
  std::vector<double> start() const;
};

// Start of a candidate's fit.
struct LightStart {
  std::vector<double> x;
  double gain = inference::infinity;  // predicted fall of χ² from a scan; infinite without one
};

struct LightTrial;

// All candidates, with the lab and its nominal model: the domain of the search for effects on light
// and power.
struct LightCandidates {
  std::vector<LightCandidate> list;
  Thresholds limits;
  const LightLab* lab = nullptr;
  NominalLight nominal;

  const LightCandidate& operator[](size_t i) const { return list[i]; }

  // inference/domain.h describes the types and functions below.
  using Trial = LightTrial;
  using Run = FittedRun;
  struct Begin {};  // recordings have no nuisance parameters
  using Start = LightStart;
  using Runs = std::vector<FittedRun>;
  using Terms = std::vector<inference::Term<Start>>;
  using Effort = inference::Effort;

  Start start_of(size_t candidate) const { return {list[candidate].start()}; }
  Trial extend(const Trial& parent, size_t candidate, const Start& start, const Runs& runs,
               const Effort& effort) const;
  // Fits the candidates of the trial with the priors, starting from its numbers.
  Trial fit(const Trial& start, const Runs& runs, int max_iterations) const;
  Trial refit(const Trial& trial, const Runs& runs, const std::vector<Begin>& begins,
              const Effort& effort) const;
  Trial refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                   const Effort& effort) const;
  Trial predict(const Trial& trial, const Runs& runs) const;
  std::vector<Begin> initial_conditions_of(const Trial& trial) const;
  std::vector<Begin> initial_conditions_from_data(const Trial&, const Runs& runs) const {
    return std::vector<Begin>(runs.size());
  }
  Trial with_initial_conditions(Trial trial, const std::vector<Begin>& begins) const;
  std::vector<double> gains(const Trial& at, const std::vector<size_t>& candidates,
                            const Runs& runs) const;
  Terms terms_of(const Trial& trial) const;
  inference::LinearProblem linear_problem(const Trial& at, const Terms& terms,
                                          const Runs& runs) const;
  Trial assemble(const Trial& from, const inference::Members<Start>& members, const Runs& runs,
                 const Effort& effort) const;
  std::vector<std::vector<Start>> starts(const Trial& parent, const std::vector<size_t>& candidates,
                                         const Runs& runs, const Runs& averages, int threads) const;
  // Rows are never averaged, because neighbours receive different light: a long run over time is
  // thinned to every n-th row.
  Runs average(const Trial& about, const Runs& runs, size_t count) const;
  // A wrong model of light is wrong in every part of a recording, so shorter parts do not help.
  Runs cut(const Runs&, size_t) const { return {}; }
  double excess_sigma(const Trial& trial, const Runs& runs) const;
};

// All candidates that these recordings can reveal.
LightCandidates light_candidates(const LightLab& lab, const NominalLight& nominal,
                                 const std::vector<FittedRun>& runs, const Thresholds& limits);

// Smooth laws of position, irradiance, time, temperature, attitude and voltage.
std::vector<LightCandidate> empirical_light_candidates(const std::vector<FittedRun>& runs);

}  // namespace photorque

// Recordings of light and power as a domain of the search for missing effects (inference/domain.h).
#pragma once

#include "diagnosis/light/trial.h"
#include "inference/domain.h"

namespace photorque {

class LightDomain {
 public:
  using Trial = LightTrial;
  using Run = FittedRun;
  struct Begin {};  // recordings have no nuisance parameters
  using Start = LightStart;
  using Runs = std::vector<FittedRun>;
  using Effort = inference::Effort;

  // `all` must outlive this.
  explicit LightDomain(const LightCandidates& all);

  const std::vector<inference::CandidateTraits>& candidates() const { return traits_; }
  const Thresholds& limits() const { return all_.limits; }
  Start start_of(size_t candidate) const { return {all_[candidate].start()}; }

  Trial extend(const Trial& parent, size_t candidate, const Start& start, const Runs& runs,
               const Effort& effort) const;
  Trial refit(const Trial& trial, const Runs& runs, const std::vector<Begin>& begins,
              const Effort& effort) const;
  Trial refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                   const Effort& effort) const;
  Trial predict(const Trial& trial, const Runs& runs) const;
  std::vector<Begin> initial_conditions_of(const Trial& trial) const {
    return std::vector<Begin>(trial.fit.run_chi2.size());
  }
  std::vector<Begin> initial_conditions_from_data(const Trial&, const Runs& runs) const {
    return std::vector<Begin>(runs.size());
  }
  Trial with_initial_conditions(Trial trial, const std::vector<Begin>&) const { return trial; }

  std::vector<double> gains(const Trial& at, const std::vector<size_t>& candidates,
                            const Runs& runs) const;
  std::vector<inference::Term<Start>> terms_of(const Trial& trial) const;
  inference::LinearProblem linear_problem(const Trial& at,
                                          const std::vector<inference::Term<Start>>& terms,
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

 private:
  Start profiled(const Trial& parent, size_t candidate, Start start, const Runs& runs) const;

  const LightCandidates& all_;
  std::vector<inference::CandidateTraits> traits_;
};

}  // namespace photorque

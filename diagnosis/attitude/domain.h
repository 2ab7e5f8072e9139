// The domain of attitude motion for the search for missing effects. It implements the interface of
// inference/domain.h, where the functions are described. Runs are observations of recordings of
// motion. Candidates are the effects of the catalogue and empirical torques.
#pragma once

#include "diagnosis/attitude/effects/screen.h"
#include "diagnosis/attitude/effects/trial.h"
#include "inference/domain.h"

namespace photorque {

class AttitudeDomain {
 public:
  using Trial = photorque::Trial;
  using Run = Observation;
  using Begin = RunStart;
  using Start = photorque::Start;
  using Runs = std::vector<Observation>;
  using Effort = inference::Effort;

  // `all` must outlive this object.
  explicit AttitudeDomain(const Candidates& all);

  const std::vector<inference::CandidateTraits>& candidates() const { return traits_; }
  const Thresholds& limits() const { return all_.limits; }
  Start start_of(size_t candidate) const { return {all_[candidate].start}; }

  Trial extend(const Trial& parent, size_t candidate, const Start& start, const Runs& runs,
               const Effort& effort) const {
    return photorque::extend(parent, all_, candidate, start, runs, effort);
  }
  Trial refit(const Trial& trial, const Runs& runs, const std::vector<Begin>& begins,
              const Effort& effort) const {
    return photorque::refit(trial, all_, runs, begins, effort);
  }
  Trial refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                   const Effort& effort) const {
    return photorque::refit_near(trial, other, all_, runs, effort);
  }
  Trial predict(const Trial& trial, const Runs& runs) const;
  std::vector<Begin> initial_conditions_of(const Trial& trial) const { return trial.fit.best.runs; }
  std::vector<Begin> initial_conditions_from_data(const Trial& trial, const Runs& runs) const {
    return starts_from_data(trial.fit.best, runs);
  }
  Trial with_initial_conditions(Trial trial, const std::vector<Begin>& begins) const {
    trial.fit.best.runs = begins;
    return trial;
  }

  std::vector<double> gains(const Trial& at, const std::vector<size_t>& candidates,
                            const Runs& runs) const;
  std::vector<inference::Term<Start>> terms_of(const Trial& trial) const {
    return photorque::terms_of(trial);
  }
  inference::LinearProblem linear_problem(const Trial& at,
                                          const std::vector<inference::Term<Start>>& terms,
                                          const Runs& runs) const {
    return photorque::linear_problem(at, all_, terms, runs);
  }
  Trial assemble(const Trial& from, const inference::Members<Start>& members, const Runs& runs,
                 const Effort& effort) const {
    return photorque::assemble(from, all_, members, runs, effort);
  }
  std::vector<std::vector<Start>> starts(const Trial& parent, const std::vector<size_t>& candidates,
                                         const Runs& runs, const Runs& averages, int threads) const;

  Runs average(const Trial& about, const Runs& runs, size_t blocks) const {
    return averaged_about(about.fit, runs, blocks);
  }
  // Cuts each run into `pieces` parts. Parts with too few complete attitudes for fitting initial
  // conditions are omitted.
  Runs cut(const Runs& runs, size_t pieces) const;
  double excess_sigma(const Trial& trial, const Runs& runs) const {
    return photorque::excess_sigma(trial.fit, runs, limits());
  }

 private:
  const Candidates& all_;
  std::vector<inference::CandidateTraits> traits_;
};

}  // namespace photorque

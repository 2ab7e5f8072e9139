#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/attitude/domain.h"
#include "diagnosis/attitude/findings/account.h"
#include "diagnosis/attitude/findings/locate.h"
#include "diagnosis/attitude/holdout.h"
#include "diagnosis/attitude/refine.h"
#include "inference/search.h"
#include "inference/weigh.h"

namespace photorque {
namespace {

double held_chi2_per_sample(const Trial& trial, const RecordedData& data,
                            const Thresholds& limits) {
  const double found = propagate_model(trial.fit, data.held, limits).chi2_per_sample();
  return std::isfinite(found) ? found : inference::infinity;
}

// A law that bends to what was fitted and leads away from what was held out describes nothing: the
// likeliest explanation that predicts better than the nominal model stands in its place, or, where
// none does, the nominal model.
void keep_what_predicts(const RecordedData& data, const Thresholds& limits, Answer& a) {
  if (data.held.empty()) return;
  const double nominal = held_chi2_per_sample(a.trials.front(), data, limits);
  size_t kept = 0;
  if (held_chi2_per_sample(a.chosen(), data, limits) <= nominal) return;
  for (const size_t i : inference::by_evidence(a.trials)) {
    const Trial& t = a.trials[i];
    if (i == a.decision.chosen || !t.objection.empty() || !t.holdout_chi2_per_sample) continue;
    if (held_chi2_per_sample(t, data, limits) <= nominal) {
      kept = i;
      break;
    }
  }
  a.decision.chosen = kept;
  const std::vector<size_t>& acts = a.trials[kept].candidates;
  std::erase_if(a.decision.beside_law,
                [&](size_t c) { return std::find(acts.begin(), acts.end(), c) == acts.end(); });
  a.decision.because = kept == 0 ? "nothing that was tried predicts what was held out"
                                 : "what explains the recording best does not predict what was "
                                   "held out";
}

}  // namespace

void tell(const DiagnoseOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

Answer explain(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
               const DiagnoseOptions& options, Among among) {
  Answer a;
  a.all = all_candidates(nominal, data.train, options.limits);
  if (among == Among::unscanned) {
    std::erase_if(a.all.list, [](const Candidate& c) { return !c.is_linear(); });
  }
  if (among == Among::plain_physics) {
    std::erase_if(a.all.list, [](const Candidate& c) {
      return c.empirical() || !c.is_linear() || c.start.stage == Stage::measurement;
    });
  }
  const AttitudeDomain domain(a.all);
  tell(options, "fitting every effect of the catalogue");
  a.trials =
      inference::search(domain, nominal_trial(nominal_fit, a.all), data.train, options.threads);
  a.depends_on = dependences(a.trials, a.all);
  tell(options, "comparing with what was held out");
  inference::weigh_with_held_out(domain, data.train, data.held, options.threads, a.trials);
  const auto excess = [&](size_t trial) {
    return domain.excess_sigma(a.trials[trial], data.train);
  };
  a.decision = inference::decide({a.trials.begin(), a.trials.end()}, domain.candidates(), excess,
                                 options.limits.decision);
  if (among == Among::all && a.decision.finding == inference::Finding::unknown) {
    Trial& chosen = a.trials[a.decision.chosen];
    chosen = refined_in_time(chosen, a.all, data.train);
    keep_what_predicts(data, options.limits, a);
  }
  return a;
}

Answer unexplained(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                   const Thresholds& limits) {
  Answer a;
  a.all = all_candidates(nominal, data.train, limits);
  a.trials = {nominal_trial(nominal_fit, a.all)};
  a.decision.finding = inference::Finding::unknown;
  a.decision.confidence = limits.decision.structure_confidence;
  a.decision.because = "the nominal model leaves structure in the recording";
  a.decision.probability = {1.0};
  return a;
}

}  // namespace photorque

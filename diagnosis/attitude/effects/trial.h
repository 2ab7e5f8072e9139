// The effects that may be missing, and fully fitted models with some of them.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "attitude/disturbances/kind.h"
#include "attitude/estimation/fit.h"
#include "diagnosis/attitude/effects/empirical.h"
#include "inference/domain.h"

namespace photorque {

// One parametrisation of a kind of disturbance; the file of the kind defines its priors.
struct Effect {
  std::string kind;
  std::vector<EffectKey> keys;  // scaled to the platform
  std::string explanation;      // one sentence for the report
  Screening how = {};           // further search options of the kind
  bool of_free_bodies = false;  // as in its parametrisation
};

// All effects that can be missing from the model of this platform, scaled to its mass and inertia.
std::vector<Effect> catalogue(const DisturbanceContext& context);

// The disturbance with every parameter at its start.
Disturbance disturbance_of(const Effect& effect, const DisturbanceContext& context);

struct NominalModel;  // attitude/propagation/run.h

// An effect of the catalogue, or an empirical law.
struct Candidate {
  std::string label;     // "magnetic_dipole", "unknown in yaw: 3 periods a turn"
  std::string variable;  // variable of an empirical law; empty for the catalogue
  Effect effect;         // empty kind for an empirical law
  EmpiricalLaw law;      // empty for an effect of the catalogue
  Disturbance start;
  std::vector<double> scale;  // one per parameter
  std::vector<double> lowest, highest;
  std::vector<bool> searched;

  bool empirical() const { return !variable.empty(); }
  // The disturbance with the expected size added to every strength.
  Disturbance at_expected_size() const;
  // The disturbance whose only strength is that of parameter `p`, at its expected size.
  Disturbance with_strength_alone(size_t p) const;
  bool is_fitted(size_t p) const { return scale[p] > 0.0; }
  // Whether it is linear with unknown strength.
  bool is_strength(size_t p) const { return is_fitted(p) && !searched[p]; }
  // Whether any parameter requires no search.
  bool has_linear_strength() const {
    return std::any_of(searched.begin(), searched.end(), [](bool b) { return !b; });
  }
  // Whether a score test can predict the gain of its fit.
  bool is_linear() const {
    return !start.parameters.empty() &&
           std::none_of(searched.begin(), searched.end(), [](bool b) { return b; });
  }
};

// The power of the rate (sliding body: speed) with which a candidate brakes; 0 is friction. Nothing
// if it has another action. `model` is that of the platform.
std::optional<double> braking_power(const Candidate& candidate, AttitudeModel model);

// Whether a candidate on a one-axis platform exerts a restoring torque towards an angle, as a
// weight or twisted line does. The torque must be independent of the rate and keep its sign up to a
// third of a turn away from that angle.
bool is_restoring(const Candidate& candidate, AttitudeModel model);

// Start of a candidate's fit.
struct Start {
  Disturbance disturbance;
  // Predicted fall of χ² from a scan; infinite without a scan.
  double gain = std::numeric_limits<double>::infinity();
};

// All candidates, and the limits of their evaluation.
struct Candidates {
  std::vector<Candidate> list;
  Thresholds limits;
  double longest_run_s = 0.0;
  std::string remark = {};  // on omitted effects; empty: none

  const Candidate& operator[](size_t i) const { return list[i]; }
  size_t size() const { return list.size(); }
};
// An empirical law as a candidate.
Candidate candidate_of(const EmpiricalLaw& law);
// All candidates that these runs can reveal, with scales for the machine.
Candidates all_candidates(const NominalModel& nominal, const std::vector<Observation>& runs,
                          const Thresholds& limits = {});

// The nominal model and some candidates. The evidence is Laplace's approximation (MacKay,
// Information Theory, Inference, and Learning Algorithms, 2003, eq. 28.5).
struct Trial : inference::Explanation {
  std::vector<size_t> disturbances;  // index of each candidate's disturbance in the model
  Fit fit;
};

// The fitted nominal model as a trial without candidates.
Trial nominal_trial(const Fit& nominal, const Candidates& all);

// The trial with all parameters of its candidates within physical bounds. If one is beyond, the
// others are refitted; if that fit diverges, the trial is returned unchanged. The evidence is
// unchanged.
Trial within_physics(const Trial& trial, const Candidates& all,
                     const std::vector<Observation>& runs);

// Adds a candidate whose parameters start from `start`, and fits.
Trial extend(const Trial& parent, const Candidates& all, size_t candidate, const Start& start,
             const std::vector<Observation>& runs, const inference::Options& options = {});

// Replaces the `which`-th candidate by another that starts from `start`, and fits. Neither may have
// states.
Trial exchange(const Trial& trial, const Candidates& all, size_t which, size_t candidate,
               const Disturbance& start, const std::vector<Observation>& runs,
               const inference::Options& options = {});

// Refits the trial to other or more runs: shared parameters start from the fitted ones.
Trial refit(const Trial& trial, const Candidates& all, const std::vector<Observation>& runs,
            const std::vector<RunStart>& starts, const inference::Options& options = {});

// Refits the trial on the same runs, starting from the result of another trial: from its initial
// conditions and its values of all common parameters. The fit of a long tumbling run may end in one
// of many local minima; results of other trials give another start.
Trial refit_near(const Trial& trial, const Trial& other, const Candidates& all,
                 const std::vector<Observation>& runs, const inference::Options& options = {});

// The nominal model with exactly these members. The fit starts from the result of `from`, which may
// have other candidates.
Trial assemble(const Trial& from, const Candidates& all, const inference::Members<Start>& members,
               const std::vector<Observation>& runs, const inference::Options& options = {});

// The candidates of the trial with their fitted values.
std::vector<inference::Term<Start>> terms_of(const Trial& trial);

// The fitted parameters of the trial's `which`-th candidate.
inline std::vector<SharedParameter> fitted_numbers(const Trial& trial, size_t which) {
  return trial.fit.best.shared(trial.disturbances[which]);
}

}  // namespace photorque

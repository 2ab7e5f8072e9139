// The effects that may be missing, and fully fitted models with some of them.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "attitude/disturbances/kind.h"
#include "attitude/disturbances/unknown/shape.h"
#include "attitude/estimation/fit.h"
#include "inference/domain.h"

namespace photorque {

// Empirical torques (empirical.cpp): smooth functions of the motion with free coefficients, as
// disturbances of the kind empirical_torque. They compete with the catalogue, so that an effect
// outside the catalogue is not attributed to one inside.
struct EmpiricalLaw {
  std::string variable;     // "yaw", "tilt", "rate", "time", "charge", "command"
  std::string description;  // "3 periods a turn"
  EmpiricalShape shape;
  Disturbance disturbance;  // all coefficients 0; linear in them
  double scale = 1.0;       // expected size of a coefficient
  // Exponent or time constant that is fitted too: its starts, bounds and prior width. Empty: none.
  std::vector<double> starts = {};
  double lowest = 0.0, highest = 0.0, own_scale = 0.0;
};

// Ranges of the recorded motion, which scale the laws.
struct CoveredMotion {
  double duration_s = 0.0;
  double tilt_rad = 0.0;      // maximum
  double rate_rad_s = 0.0;    // maximum; 0: no rates are recorded
  double charge_C = 0.0;      // 0: no current is recorded
  bool has_commands = false;  // commanded torques
  bool has_forces = false;    // commanded forces
  bool has_wheel = false;     // recorded wheel speed
  // Lamp current: the maximum of all recordings, and whether it changes within one.
  double led_current_A = 0.0;
  bool has_lamps = false;
};

// The laws that compete for such recordings. `torque_N_m` is a typical torque.
std::vector<EmpiricalLaw> empirical_laws(const CoveredMotion& covered, double torque_N_m);

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

// An effect of the catalogue, or an empirical law, with the traits that the search uses.
struct Candidate : inference::CandidateTraits {
  std::string variable;  // variable of an empirical law; empty for the catalogue
  Effect effect;         // empty kind for an empirical law
  EmpiricalLaw law;      // empty for an effect of the catalogue
  Disturbance start;
  std::vector<double> scale;  // one per parameter
  std::vector<double> lowest, highest;
  std::vector<bool> searched;

  // The disturbance with the expected size added to every strength.
  Disturbance at_expected_size() const;
  // The disturbance whose only strength is that of parameter `p`, at its expected size.
  Disturbance with_strength_alone(size_t p) const;
  bool is_fitted(size_t p) const { return scale[p] > 0.0; }
  // Whether it is linear with unknown strength.
  bool is_strength(size_t p) const { return is_fitted(p) && !searched[p]; }
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

struct Trial;

// All candidates, and the limits of their evaluation: the domain of the search for effects on the
// motion. Runs are observations of recordings.
struct Candidates {
  std::vector<Candidate> list;
  Thresholds limits;
  double longest_run_s = 0.0;
  std::string remark = {};  // on omitted effects; empty: none

  const Candidate& operator[](size_t i) const { return list[i]; }
  size_t size() const { return list.size(); }

  // inference/domain.h describes the types and functions below.
  using Trial = photorque::Trial;
  using Run = Observation;
  using Begin = RunStart;
  using Start = photorque::Start;
  using Runs = std::vector<Observation>;
  using Terms = std::vector<inference::Term<Start>>;
  using Effort = inference::Effort;

  Start start_of(size_t candidate) const { return {list[candidate].start}; }
  Trial extend(const Trial& parent, size_t candidate, const Start& start, const Runs& runs,
               const Effort& effort = {}) const;
  Trial refit(const Trial& trial, const Runs& runs, const std::vector<RunStart>& begins,
              const Effort& effort = {}) const;
  // The fit of a long tumbling run may end in one of many local minima; results of other trials
  // give another start.
  Trial refit_near(const Trial& trial, const Trial& other, const Runs& runs,
                   const Effort& effort) const;
  Trial predict(const Trial& trial, const Runs& runs) const;
  std::vector<RunStart> initial_conditions_of(const Trial& trial) const;
  std::vector<RunStart> initial_conditions_from_data(const Trial& trial, const Runs& runs) const;
  Trial with_initial_conditions(Trial trial, const std::vector<RunStart>& begins) const;
  std::vector<double> gains(const Trial& at, const std::vector<size_t>& candidates,
                            const Runs& runs) const;
  Terms terms_of(const Trial& trial) const;
  // Fast effects are omitted. All parameters are evaluated in one pass, for runs of some thousand
  // blocks.
  inference::LinearProblem linear_problem(const Trial& at, const Terms& terms,
                                          const Runs& runs) const;
  Trial assemble(const Trial& from, const inference::Members<Start>& members, const Runs& runs,
                 const Effort& effort = {}) const;
  std::vector<std::vector<Start>> starts(const Trial& parent, const std::vector<size_t>& candidates,
                                         const Runs& runs, const Runs& averages, int threads) const;
  Runs average(const Trial& about, const Runs& runs, size_t blocks) const;
  // Parts with too few complete attitudes for fitting initial conditions are omitted.
  Runs cut(const Runs& runs, size_t pieces) const;
  double excess_sigma(const Trial& trial, const Runs& runs) const;
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

// Replaces the `which`-th candidate by another that starts from `start`, and fits. Neither may have
// states.
Trial exchange(const Trial& trial, const Candidates& all, size_t which, size_t candidate,
               const Disturbance& start, const std::vector<Observation>& runs,
               const inference::Options& options = {});

// The fitted parameters of the trial's `which`-th candidate.
inline std::vector<SharedParameter> fitted_numbers(const Trial& trial, size_t which) {
  return trial.fit.best.shared(trial.disturbances[which]);
}

// Laplace's approximation of the evidence. The prior of the fit, which is far too wide, is replaced
// by one with the expected size of the effect.
double log_evidence(const Trial& trial, const Candidates& all);

// Sets the significance of each candidate of the trial, its evidence, and its physical objection.
void judge(Trial& trial, const Candidates& all);

// Whether a disturbance is a change of the inertia.
bool changes_inertia(const Disturbance& d);

// The scales of the catalogue are those of platforms on air bearings. For a bicycle wheel or a
// spacecraft they are wrong by many decades. For such machines the scale of every strength is set
// from the recorded rates: its torque over the recorded motion then equals the mean moment of
// inertia times the range of the rates over the duration. Platforms on air bearings and effects
// without a torque are unchanged.
void scale_to_machine(const NominalModel& nominal, const std::vector<Observation>& runs,
                      std::vector<Candidate>& candidates);

}  // namespace photorque

// The effects that may be missing, and models that contain some of them, fitted in full.
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

// The effects that may be missing: every kind of disturbance that a recording can reveal, with the
// priors of its parameters. The priors stand in the kinds' own files.

// One parametrisation of a kind.
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

// Candidates that may explain the residual, and models that contain some of them, fitted in full.

struct NominalModel;  // attitude/propagation/run.h

// An effect of the catalogue, or an empirical law.
struct Candidate {
  std::string label;     // "magnetic_dipole", "unknown in yaw: 3 periods a turn"
  std::string variable;  // of an empirical law; empty: an effect of the catalogue
  Effect effect;         // empty kind for an empirical law
  EmpiricalLaw law;      // empty for an effect of the catalogue
  Disturbance start;
  std::vector<double> scale;  // of each parameter
  std::vector<double> lowest, highest;
  std::vector<bool> searched;

  bool empirical() const { return !variable.empty(); }
  bool is_fitted(size_t p) const { return scale[p] > 0.0; }
  // Enters linearly, with unknown strength.
  bool is_strength(size_t p) const { return is_fitted(p) && !searched[p]; }
  // Whether a parameter need not be searched.
  bool has_linear_strength() const {
    return std::any_of(searched.begin(), searched.end(), [](bool b) { return !b; });
  }
  // Whether a score test can predict the gain of its fit.
  bool is_linear() const {
    return !start.parameters.empty() &&
           std::none_of(searched.begin(), searched.end(), [](bool b) { return b; });
  }
};

// The power of the rate, or of the speed of a sliding body, by which a candidate brakes (0:
// friction). Nothing where it does anything else. `model`: of the platform.
std::optional<double> braking_power(const Candidate& candidate, AttitudeModel model);

// Whether a candidate pulls what turns about one axis back to an angle, as a weight or a twisted
// line does, whatever the rate: alike a sixth of a turn and a third of a turn away from it.
bool pulls_back(const Candidate& candidate, AttitudeModel model);

// Where the fit of a candidate starts.
struct Start {
  Disturbance disturbance;
  // Fall of χ² that a scan predicts; infinite where nothing was scanned.
  double gain = std::numeric_limits<double>::infinity();
};

// All candidates, and the limits of their evaluation.
struct Candidates {
  std::vector<Candidate> list;
  Thresholds limits;
  double longest_run_s = 0.0;
  std::string remark = {};  // on effects that are not tried; empty: none

  const Candidate& operator[](size_t i) const { return list[i]; }
  size_t size() const { return list.size(); }
};
// A law without a name as a candidate.
Candidate candidate_of(const EmpiricalLaw& law);
Candidates all_candidates(const NominalModel& nominal, const std::vector<Observation>& runs,
                          const Thresholds& limits = {});

// The nominal model and some candidates. The evidence is Laplace's approximation (MacKay,
// Information Theory, Inference, and Learning Algorithms, 2003, eq. 28.5).
struct Trial : inference::Explanation {
  std::vector<size_t> disturbances;  // where each candidate stands in the model
  Fit fit;
};

Trial nominal_trial(const Fit& nominal, const Candidates& all);

// The trial with every number of its candidates within its physical bounds. If one was beyond, the
// others are refitted; if that fit diverges, the trial is returned as it is. Its evidence is
// unchanged.
Trial within_physics(const Trial& trial, const Candidates& all,
                     const std::vector<Observation>& runs);

// Adds a candidate, its parameters starting from `start`, and fits.
Trial extend(const Trial& parent, const Candidates& all, size_t candidate, const Disturbance& start,
             const std::vector<Observation>& runs, const FitSettings& settings = {});

// Fits the trial with another candidate in the place of its `which`-th, from `start`. Neither may
// have states.
Trial exchange(const Trial& trial, const Candidates& all, size_t which, size_t candidate,
               const Disturbance& start, const std::vector<Observation>& runs,
               const FitSettings& settings = {});

// Refits the trial to other or more runs: shared parameters start from the fitted ones.
Trial refit(const Trial& trial, const Candidates& all, const std::vector<Observation>& runs,
            const std::vector<RunStart>& starts, const FitSettings& settings = {});

// Refits the trial from the end of another trial on the same runs: from its starts, and its values
// of all parameters that both have. The fit of a long tumbling run may end in one of many local
// minima; the results of others are a second chance.
Trial refit_near(const Trial& trial, const Trial& other, const Candidates& all,
                 const std::vector<Observation>& runs, const FitSettings& settings = {});

// The nominal model with these members alone, from where `from`, which has any others, ended.
Trial assemble(const Trial& from, const Candidates& all, const inference::Members<Start>& members,
               const std::vector<Observation>& runs, const FitSettings& settings = {});

// The trial's own candidates as they were fitted.
std::vector<inference::Term<Start>> terms_of(const Trial& trial);

// Indices of a candidate's parameters among the shared ones of the fit.
std::vector<Eigen::Index> shared_indices(const Trial& trial, size_t which);

}  // namespace photorque

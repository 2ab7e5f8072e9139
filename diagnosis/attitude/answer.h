// Result of search and decision for recordings of motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/attitude/recorded_data.h"
#include "diagnosis/diagnosis.h"
#include "inference/decide.h"

namespace photorque {

// All fits, and the decision about them.
struct Answer {
  Candidates all;
  std::vector<Trial> trials;
  // Variables on which the nominal model's residual depends. Computed before the held-out runs are
  // used, because all explanations of a diverged run differ by chance.
  std::vector<Where::Dependence> depends_on;
  inference::Decision decision;
  // Whether the decision treated the unexplained residual as noise.
  bool rest_is_noise = false;
  // Set if `rest_is_noise` and effects are named: the evidence for each name of the chosen trial.
  // `sigma` is the improvement of the prediction of segments by a name, in standard errors.
  struct WithDiscrepancy {
    size_t segments = 0;
    std::vector<double> sigma;                     // for each candidate of the chosen trial
    std::vector<std::vector<std::string>> rivals;  // for each: indistinguishable names
    std::vector<std::string> tied;                 // sets of names that predict as well
  };
  std::optional<WithDiscrepancy> beside = {};

  const Trial& chosen() const { return trials[decision.chosen]; }
};

// Explains recordings to which the nominal model is fitted. Every effect is scored; the best sets
// are fitted, compared and weighed with the held-out data. The decision first uses the noise of the
// readings. A residual above it then counts as noise at the level of the best explanation, and the
// search is repeated while that level falls. Names must then predict segments, each from fits to
// other segments. `data` receives the noise estimate about the best explanation, and `nominal_fit`
// is fitted with it.
Answer explain(const NominalModel& nominal, RecordedData& data, const DiagnoseOptions& options,
               Fit& nominal_fit);

// Compares two explanations that differ in one name. A positive result means that the name of the
// first is simpler. Two kinds of drag are compared by the power of the speed (braking_power()), two
// steady forces by the number of parameters (a spring without stiffness is a slope); others give 0.
// The more complex name is kept only if the simpler one fits worse (marginality: J. A. Nelder, J.
// R. Statist. Soc. A 140 (1977) 48).
std::optional<double> simpler_by(const Trial& first, const Trial& second, const Answer& answer);

// Reports the name of a step to `options.progress`, if that is set.
void report_step(const DiagnoseOptions& options, const std::string& what);

// model_discrepancy.cpp: names in the presence of an unexplained residual, which counts as noise
// (model discrepancy).

// Candidates to search, each a subset of the previous: all; those whose start requires no scan;
// those of the catalogue; torques and the bias of a gyro; torques only, because large instrument
// errors can mimic any effect.
enum class Among { all, unscanned, catalogue, torques_and_bias, torques };

// The chosen candidates, those of narrower choices first, so that indices of a trial remain valid
// among more candidates.
Candidates candidates_among(Among among, const NominalModel& nominal,
                            const std::vector<Observation>& runs, const Thresholds& limits);

// Candidates of the search in which the residual counts as noise. If angle and rate about one axis
// are both measured, each reveals errors of the other instrument independently of the torque. Of
// rates alone, the bias is revealed by a swing, whose mean rate is zero.
Among among_with_discrepancy(const NominalModel& nominal, const RecordedData& data);

// Whether the machine has textbook torques only: no commands, fields, wheels or light.
bool is_of_textbook(const Candidates& all);

// One search and its decision with the noise of `data`. It starts from the trial `near`, unless
// that is null. The candidates of `near` must be among those searched.
Answer searched(const NominalModel& nominal, const Fit& nominal_fit, const RecordedData& data,
                const DiagnoseOptions& options, Among among, const Trial* near);

// Searches for effects in the presence of an unexplained residual, which counts as noise. With the
// noise of the readings alone, the residual would bias every uncertain parameter. The noise is
// first the residual of the nominal model. As long as effects are named, it is then the residual of
// the best explanation. Every name must improve the prediction of segments from fits to other
// segments, and must differ significantly from zero under correlated noise. `data` keeps the noise
// of the last search. `laws`, if not null, is a fit of torques to the same runs: its residual is
// the first noise, and each search starts from it. Returns nothing if no effect is named.
std::optional<Answer> identify_with_discrepancy(const NominalModel& nominal, RecordedData& data,
                                                const DiagnoseOptions& options, const Trial* laws);

// Whether a fit agrees with recordings whose noise is that of the readings alone.
bool is_consistent_with_noise(const Fit& fit, const RecordedData& data);

// textbook_laws.cpp: fit of a body that turns about one axis, with all textbook torques together.

// Fits several laws together: friction and drag by every power of the rate, a steady torque, a
// restoring torque (a weight, a twisted line), and errors of the instruments where `all` has them.
// The fit starts in pieces in which the nominal model stays near the readings, and grows to the
// whole recordings. A nominal model without these torques miscounts the swings, so it is no start
// for predictions. This fit allows each law to be left out. Returns nothing for other machines, or
// if the fit is no nearer to the readings than the nominal model.
std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data);

// Fits every set of friction and drag laws in place of those of `found`, whose other laws remain.
// The sets are each power of the rate alone, and dry, viscous and quadratic friction in pairs and
// together. A search that adds laws one by one misses sets, because friction and drag imitate each
// other. Fits start from `found` and from the strengths along the recorded curve (laws_of_curve()).
// Sets that are unphysical, and those whose χ² is far above that of the best, are omitted.
// `nominal` is fitted to the same runs.
std::vector<Trial> fit_sets_of_brakes(const Trial& nominal, const Trial& found,
                                      const Candidates& all, const RecordedData& data, int threads);

// refine.cpp: refinement of an empirical torque over time when no known effect explains it.

// The laws in time that compete with physics are few and coarse, so that they cost little if a
// known effect acts. This function refines the chosen one by a smooth table over the recording and
// by a periodic torque whose period comes from the table. Returns the trial of largest evidence,
// possibly `chosen`, and adds its candidate to `all`.
Trial refined_in_time(const Trial& chosen, Candidates& all, const std::vector<Observation>& runs);

// cross_validation.cpp: predictions of segments of recordings by explanations that are fitted to
// other segments.
//
// For a real machine the residual is not white noise. No distribution then gives the fall of χ²
// that distinguishes a missing effect from a curve that follows the residual. Left-out segments
// decide: they show whether an effect predicts, and how much the gain varies between segments.

class CrossValidation {
 public:
  // Cuts the runs into about `wanted` segments with about equal numbers of blocks. If there are as
  // many runs, each is one segment, and only its initial conditions are fitted to it.
  // `all` must outlive this object.
  CrossValidation(const Candidates& all, std::vector<Observation> train,
                  std::vector<Observation> held, size_t wanted, int threads);

  size_t count() const { return segments_.size(); }

  // χ² of every segment, as predicted by the trial (fitted to the train runs) after a refit to
  // other segments; each refit leaves out a fifth of them. Infinite where it cannot be evaluated.
  std::vector<double> chi2(const Trial& trial) const;

 private:
  struct Segment {
    size_t run, first, last;  // blocks [first, last)
  };
  std::vector<double> predicted(const Trial& trial, const std::vector<RunStart>& begins,
                                size_t fold) const;

  const Candidates& all_;
  int threads_;
  std::vector<Observation> runs_;
  size_t train_;  // number of train runs, which come first
  std::vector<Segment> segments_;
};

// laws_of_curve.cpp: strengths of laws of rotation about one axis, computed from the recorded curve
// without a fit. They are a start that is near the readings over the whole recording.

// Local cubics through the readings give angle θ and rate ω. The equation of motion, integrated
// over time,
//
//   ω(t) = ω₀ + Σ_k s_k ∫ a_k(θ, ω) dt,
//
// is linear in the strengths s_k of the laws (accelerations a_k per unit) and in one ω₀ per run. A
// strength beyond its physical bounds is set to zero, and the others are recomputed.
struct LawsOfCurve {
  inference::Members<Start> members;  // with a strength that is not zero
  std::vector<RunStart> starts;
};

// `nominal`: trial of the nominal model; its parameters are set to the values that the experiment
// states. `candidates`: indices of the laws. The result has no members if a run has too few
// readings.
LawsOfCurve laws_of_curve(const Trial& nominal, const Candidates& all,
                          const std::vector<size_t>& candidates,
                          const std::vector<Observation>& runs);

// The trial with its parameters set to the values that the experiment states.
Trial as_stated(Trial nominal);

}  // namespace photorque

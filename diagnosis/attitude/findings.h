// Findings of a diagnosis of motion as sentences and numbers. Each section names its source file.
#pragma once

#include <string>
#include <vector>

#include "attitude/disturbances/unknown/shape.h"
#include "core/transform.h"
#include "diagnosis/attitude/effects/trial.h"
#include "diagnosis/attitude/recorded_data.h"
#include "inference/decide.h"

namespace photorque {

// findings.cpp: effects, alternatives, priors and sentences.

// For three values with their covariance (in the squared unit), each within twice its standard
// error: the principal combination that is furthest from zero in standard errors. Its largest
// coefficient is scaled to 1, as "x − 0.99 z = (4.4 ± 0.1)×10⁻¹⁰". Empty if no combination exceeds
// four standard errors, or if a single value exceeds two.
std::string known_together(const Vec3& value, const Mat3& covariance);

// The effects of the chosen trial, each with the probability of its kind.
std::vector<FoundEffect> found_effects(const inference::Decision& decision,
                                       const std::vector<Trial>& trials, const Candidates& all);

// Adds the effects of the chosen trial beside its empirical law: those that are certain are named,
// the others are unnamed.
void add_effects_beside_law(const inference::Decision& decision, const std::vector<Trial>& trials,
                            const Candidates& all, Diagnosis& d);

// Values and standard errors of one disturbance of a trial, by key, in the units of the keys and in
// the order of the law.
std::vector<FittedParameter> fitted_parameters(const Trial& trial, size_t disturbance);

// The best trial of every set of names, best first, relative to the nominal model.
std::vector<Alternative> alternatives(const inference::Decision& decision,
                                      const std::vector<Trial>& trials, const Candidates& all);

// One sentence for each nominal value that the recording contradicts.
std::vector<std::string> contradicted_priors(const Trial& chosen,
                                             const Thresholds::Decision& limits);
// Parameters with a prior, with their values in the chosen trial.
std::vector<FittedParameter> refined_priors(const Trial& chosen);
// An uncertain disturbance with its parameters in the chosen trial, for an experiment that has no
// table for it.
FoundEffect as_fitted(const Trial& chosen, size_t disturbance);

// One sentence that states the verdict, for the top of the report.
std::string sentence_of(const Diagnosis& diagnosis);

// locate.cpp: location of the differences between recording and nominal model: channels, intervals,
// band, and the variables on which they depend.

// Misfit of each channel relative to noise; residuals that are not finite are omitted.
std::vector<Where::ChannelMisfit> misfits(const std::vector<Prediction>& residuals);

// Location in the residuals of the nominal model. Empty if the model cannot be propagated: the two
// then differ from the start. `depends_on` remains empty.
Where locate(const Fit& nominal, const std::vector<Observation>& runs,
             const Thresholds::Location& limits);

// For each variable, the fraction of the nominal model's misfit that an empirical law in it
// explains, largest first; small fractions are omitted. `trials` are those with one candidate,
// after the nominal model.
std::vector<Where::Dependence> dependences(const std::vector<Trial>& trials, const Candidates& all);

// Dependences for an unknown law: the variable of the chosen law comes first; at least one is
// returned.
std::vector<Where::Dependence> of_unknown_law(std::vector<Where::Dependence> depends_on,
                                              const Trial& chosen, const Candidates& all);

// holdout.cpp: prediction of held-out recordings.

// χ² per sample and RMS residual of each channel for two fits to the same held-out runs.
Holdout compare_holdout(const Fit& before, const Fit& after, const std::vector<Observation>& runs);

// Readings and models over time for plots, of run number `run` in two fits to equal runs.
RecordingSeries series_of(const Fit& before, const Fit& after, const Observation& seen, size_t run);

// empirical_torque.cpp: a fitted empirical law as a table over its variable and as a short formula.

// "(4.41 ± 0.02)×10⁻⁶": the value and its error with the digits that the error permits. If the
// error is not positive and finite, the value alone.
std::string with_error(double value, double sigma);

struct EmpiricalFormula {
  std::string text;  // with standard errors of its constants; empty if there is no short formula
  std::string looks_like;  // weak evidence: physics that commonly has this form
};

// `parameters` are the fitted ones of empirical_torque(shape); `covariance` is theirs in SI units,
// in equal order. The text omits components below three standard errors, except for the largest.
EmpiricalFormula formula_of(const EmpiricalShape& shape,
                            const std::vector<FittedParameter>& parameters,
                            const Eigen::MatrixXd& covariance);

// The empirical parts of a trial along its first run: means over bins of the variable, with
// standard errors from the covariance of the coefficients.
std::vector<EmpiricalTorque> empirical_torques(const Trial& chosen, const Candidates& all,
                                               const std::vector<Observation>& runs);

// manoeuvre.cpp: proposed experiments that distinguish effects which the recordings do not.

// One manoeuvre for every pair of a found effect and a kind that is indistinguishable from it. The
// chosen trial predicts exact readings for four other initial states of the first run. The rival is
// fitted to these together with the existing recordings. Half of the growth of χ² is the expected
// lead in log evidence. The initial state with the largest lead is proposed.
std::vector<Manoeuvre> manoeuvres(const std::vector<FoundEffect>& effects,
                                  const inference::Decision& decision,
                                  const std::vector<Trial>& trials, const Candidates& all,
                                  const std::vector<Observation>& runs, int threads);

// free_bodies.cpp: findings from the rates of free bodies: recordings of different bodies, a wrong
// clock.

// Groups the recordings, both fitted and held out, by body. Each recording alone determines moments
// of inertia up to their scale (attitude/estimation/free_inertia.h). Two recordings are of
// different bodies if a moment differs by five standard errors and by a tenth of the mean moment.
// Recordings whose moments have errors above a twentieth are not compared. Empty if all are of one
// body, or if the platform is not free, because other torques then act.
std::vector<BodyOfRecordings> different_bodies(const Platform& platform, const RecordedData& data);

// One sentence that lists the recordings of each body; empty without bodies.
std::string sentence_of(const std::vector<BodyOfRecordings>& bodies);

// Rates obey ω' = −I⁻¹ (ω × I ω), which is quadratic in ω. If all rates are too large by a factor,
// or the clock is too fast by it, no inertia fits. The exception is a body with an axis of
// symmetry. For every recording the correction factor of its rates is fitted. It is reported if it
// differs from one by a twentieth and reduces the residual (free_inertia.h) to below 0.05 and to at
// most a third. Empty with attitude readings and for platforms on a bearing.
std::vector<InstrumentFinding> clock_findings(const Platform& platform, const RecordedData& data);

}  // namespace photorque

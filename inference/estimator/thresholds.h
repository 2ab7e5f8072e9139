// Thresholds of search and decision: all numbers that decide about fits, convergence and names.
//
// Unless stated otherwise, a number is set by hand and validated by the cases of docs/proof.md:
// twelve by another author and the generated ones, some with nothing missing. A change requires a
// recomputed page. Where a number follows from statistics, the law is given. χ² and log evidence
// (natural logarithms) have no unit; sigmas are standard errors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace photorque {

struct Thresholds {
  // Noise of the readings, and residual structure.
  struct Noise {
    // Number of neighbouring residuals per mean. Longer residual structure raises the means; white
    // noise does not.
    size_t neighbours = 20;
    // Minimum number of differences of a channel to measure its noise: error of 20 %.
    size_t min_differences = 50;
    // A noise level is corrected only if it is off by more than this fraction, which no decision
    // depends on. It must also be off by this many standard errors, because six channels are
    // tested.
    double min_correction = 0.05, correction_sigma = 5.0;
    // Minimum of twice the gain in log likelihood of correlated noise over white noise of the best
    // level. By chance one parameter gains 25 once in 2 million.
    double min_colour_gain = 25.0;
    // Minimum of twice the gain in log likelihood of a white part added to the correlated noise.
    double min_mixture_gain = 16.0;
    // Minimum number of spectral frequencies whose median measures the gyro noise.
    size_t min_frequencies = 16;
    // Outlier limit [standard deviations from the value expected from the neighbours]. White noise
    // exceeds it in one of five million readings (Monte Carlo).
    double outlier_sigma = 9.0;
    // Median deviation of white noise from the prediction by its neighbours [standard deviations]
    // (Monte Carlo).
    double usual_surprise = 0.93;
    // Minimum number of readings of a channel, so that neighbours exist on both sides.
    size_t min_neighbourhood = 5;
    // Heavy tails: minimum number of readings of a channel; minimum of twice the gain in log
    // likelihood of Student's t over the normal distribution, as for correlated noise; degrees of
    // freedom above which t counts as normal.
    size_t min_tail_readings = 200;
    double min_tail_gain = 25.0, max_tail_degrees = 30.0;
    // A burst: more than half of this many consecutive readings are off by more than this many
    // standard deviations. Independent errors of Student's t with three degrees of freedom do that
    // once in a hundred thousand; losing a few readings does no harm. If bursts exceed this
    // fraction of all readings, the cause is motion or another noise.
    size_t burst_readings = 7;
    double burst_sigma = 4.0, max_burst_fraction = 0.05;
    // Excess of a fit that cannot be propagated [sigma], above every threshold.
    double excess_unknown = 1e9;
  } noise;

  // χ² per sample of a fit above which the prediction has diverged, so that its derivatives are
  // useless. Score tests are trusted below it, and starts are recomputed above it. Their forecast
  // of a gain is within 5 % where it is near 1 (tests/diagnosis, Score).
  double diverged_chi2_per_sample = 20.0;

  // Convergence options of fits.
  struct Fitting {
    // Fractions of each recording that are fitted in turn, so that a poor start does not diverge:
    // for the nominal model and held-out data; for explanations whose parent diverged; for a
    // recording added to fitted ones.
    std::vector<double> first_windows = {0.05, 0.2, 1.0};
    std::vector<double> diverged_windows = {0.06, 0.25, 1.0};
    std::vector<double> added_windows = {0.1, 0.4, 1.0};
    // Maximum iterations: of a first fit; of a repeated fit, enough to test whether it reaches
    // another local minimum; of a leader, which must converge.
    int trial_iterations = 12, brief_iterations = 10, leader_iterations = 60;
    // Relative fall of χ² per step below which a bad fit counts as stalled. It is equivalent to
    // some tens in χ², whereas the χ² of such leaders differ by thousands.
    double min_relative_decrease = 5e-4;
    // Maximum ratio of χ² at a predicted start to that of the trial behind the prediction.
    double max_start_growth = 10.0;
    // Number of blocks into which recordings are averaged for slow effects: several times faster
    // than all readings, and fine enough for every slow law of the catalogue.
    size_t slow_blocks = 1000;
  } fitting;

  // Forecasts of the score test: the predicted fall of χ² if a candidate is added.
  struct Scoring {
    // Minimum gain for a fit, beyond one per parameter (the mean under noise alone): a third of the
    // 2 (4.5 + 3.4) that a name requires at least, so that a crude forecast loses none.
    double min_gain = 5.0;
    // Minimum fraction of the best candidate's gain for a fit.
    double min_fraction = 0.02;
    // Minimum gain at the peaks of a scan over frequencies or instants. By noise alone, three
    // strengths at one instant gain as much once in 340, six at one frequency once in 34.
    double min_scan_gain = 14.0;
    // Minimum gain beyond one per parameter, of a candidate scored on all recordings including the
    // held-out ones.
    double min_joint_gain = 14.0;
    // Cost per parameter in the ranking of subsets: the 95 % quantile of χ² for one parameter is
    // 3.8.
    double cost_per_parameter = 4.0;
    // Minimum power of a line in the spectrum of the residuals, where noise has 1 in each of nine
    // channels: a sum of nine exponentials exceeds it once in 600,000 frequencies.
    double min_line_power = 30.0;
    // Minimum fraction of the best frequency's gain for another start.
    double min_line_fraction = 0.1;
    // Minimum fraction of the best start's gain for a second start of a candidate.
    double min_start_fraction = 0.3;
  } scoring;

  // Limits of the search.
  struct Search {
    size_t max_effects = 4;  // maximum combined
    // Minimum gain in log evidence of one candidate more before the search continues from it. Two
    // explanations that differ by this much are distinguishable: odds of 20 to 1.
    double min_log_evidence_gain = 3.0;
    // Numbers of pieces into which diverged recordings are cut, in turn; minimum number of complete
    // readings per piece, for its initial conditions.
    std::array<size_t, 4> pieces = {6, 20, 60, 180};
    size_t min_readings_of_piece = 10;
    // Maximum number of fits to averages or pieces that are repeated on all readings.
    size_t max_refits_of_averages = 4, max_refits_of_pieces = 6;
    // Beam width: sets of candidates of each size that a forecast keeps for enlargement.
    size_t beam = 40;
    // Residual structure of a single effect [sigma] below which it does not mimic a fast one.
    double explained_sigma = 3.0;
    // Maximum rounds of forecast and fit; predicted sets that a round fits; log evidence below the
    // best forecast within which a set is fitted.
    int max_rounds = 6;
    size_t max_fits_of_round = 6;
    // Maximum sets without an empirical law, with any predicted gain, if the best trial has such a
    // law.
    size_t max_known_fits_of_round = 3;
    double forecast_within = 12.0;
  } search;

  // The best trials, which are fitted with more iterations.
  struct Leaders {
    size_t max_leaders = 6;
    // A near explanation has a χ² below this fraction of the best one's plus this difference.
    double near_fraction = 1.3, near_chi2 = 100.0;
    // Difference of χ² to the best above which a refit is worthwhile.
    double worth_a_fit = 10.0;
  } leaders;

  // Limits of the weighing with the held-out data.
  struct HeldOut {
    size_t max_leaders = 12;
    // Difference in log evidence to the best within which an explanation is a leader: odds of 3e6
    // to 1, which the held-out recordings can reverse.
    double within = 15.0;
    // Maximum candidates that are added because they are significant only on all recordings
    // together.
    size_t max_effects = 4, max_empirical = 2;
    // Maximum χ² per sample that counts as noise if the train runs reach it too: the noise level is
    // known to a few per cent.
    double max_noise = 1.15;
  } held_out;

  // Priors of the evidence.
  struct Evidence {
    // Log prior odds of one effect of the catalogue among some thirty, and of one empirical law (1
    // : 150).
    double log_prior_effect = -3.4, log_prior_empirical = -5.0;
    // Width of the prior in the fit over the expected size: it only keeps undetermined parameters
    // from diverging.
    double fit_prior_widths = 300.0;
    // The prior width of an effect's strengths over the expected size is log-uniform: this many
    // steps of half a decade from 10^−6.
    int strength_widths = 19;
    double first_log10_width = -6.0, step_log10_width = 0.5;
    // Standard deviation of the initial value of a candidate's state in its unit (an appendage
    // starts near rest relative to the body).
    double own_state_sigma = 0.01;
  } evidence;

  // Physical limits beyond which a trial is forbidden.
  struct Objection {
    // Violation of a physical bound that its standard error does not explain [sigma].
    double bound_sigma = 2.0;
    // Maximum relative change of a principal moment of inertia: platforms are measured more
    // accurately.
    double max_inertia_change = 0.4;
    // Minimum periods of a tone within the longest recording: a slower one mimics any torque that
    // varies slowly.
    double min_periods = 3.0;
  } objection;

  // Limits of the verdict.
  struct Decision {
    // Minimum log evidence over the nominal model to report an explanation: odds of 90 to 1, in
    // addition to the prior odds against each name. An empirical law must exceed the best physics
    // by as much.
    double min_log_odds = 4.5;
    // Minimum significance of every named effect [sigma].
    double min_significance = 4.0;
    // Minimum of |value|/error of the clearest number of a named effect. Three independent numbers
    // of that significance have one above 2.3; where all are below, only a combination is known.
    double min_component_sigma = 2.2;
    // Log odds by which such an explanation must be better than every other one. Example: the scale
    // of a free body's inertia is not identifiable, but an error of the stated inertia is.
    double min_log_odds_of_combination = 20.0;
    // Maximum excess of the held-out runs over the predictive distribution of an accepted model
    // [sigma].
    double max_predictive_sigma = 5.0;
    // Maximum log evidence that a name may lose in predicting the held-out runs: an effect that
    // appears in the train runs alone predicts nothing.
    double max_predictive_loss = 2.0;
    // Ratio of the held-out χ², for fixed fitted parameters, to that without the name (or to noise)
    // above which the name is rejected.
    double max_held_out_growth = 1.5;
    // Minimum log evidence that a known effect must add to an empirical law to be named. An effect
    // may absorb the error of an inaccurate law, and an undetected error may contribute some
    // tens.
    double min_log_odds_beside_law = 100.0;
    // Maximum ratio of the held-out χ² to that of the nominal model for an empirical law to be
    // accepted.
    double max_held_out_fraction = 0.5;
    // Deviation of a nominal value from its stated value [sigma] above which it is doubtful or
    // contradicted.
    double doubtful_prior_sigma = 3.0, contradicted_prior_sigma = 5.0;
    // Minimum probability of reported names or of effects indistinguishable from them.
    double min_probability = 0.7;
    // Minimum probability, among the significant explanations, that nothing is missing. Below it
    // the data are unexplained, even if no name passes.
    double min_probability_of_nothing = 1e-3;
    // Residual structure [sigma] above which the best physics is insufficient; minimum confidence
    // of the verdict "unexplained" in that case.
    double max_excess_sigma = 6.0, structure_confidence = 0.95;
  } decision;

  // Names in the presence of an unexplained residual, which counts as noise (model discrepancy).
  struct Discrepancy {
    // Approximate number of segments into which all recordings are cut; standard errors by which
    // each name must improve their prediction; and those that distinguish two explanations (95 %).
    size_t segments = 16;
    double min_sigma = 3.0, min_rival_sigma = 1.645;
    // Ratio of the held-out χ² to that without the name above which the name is rejected.
    double max_held_growth = 1.1;
    // Explanations that are compared on the segments: the most likely, and the best predictors of
    // the held-out data.
    size_t max_probable = 4, max_predicting = 3;
    // Ratio of χ² per sample of an empirical law to that of known physics, below which the law is
    // the better description, however significant known physics is.
    double max_fraction_of_law = 0.25;
    // Rounds that treat the residual as noise and search for effects that exceed it.
    int max_rounds = 4;
  } discrepancy;

  // Location of differences between recording and nominal model, for the report only.
  struct Location {
    // Minimum excess of an interval's χ² over noise [sigma] and minimum readings to list it.
    double interval_sigma = 5.0;
    int min_readings = 20;
    // Maximum power of a line that counts as noise (four times its mean), and minimum sum of the
    // excesses of a band. The band contains all but this fraction at each end.
    double noise_power = 4.0, min_band_power = 50.0, band_edge = 0.05;
    // Minimum fraction of the misfit that a listed variable explains.
    double min_dependence = 0.1;
  } location;
};

}  // namespace photorque

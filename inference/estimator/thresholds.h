// Thresholds of search and decision: every number that decides about fits, their end, names and
// noise, once each.
//
// Unless a number says otherwise, it was set by hand and stands as long as the cases of
// docs/proof.md (twelve of another maker, 203 of our own, with nothing missing among them) come out
// as that page says: a change needs a new page. Where a number follows from statistics,
// the law is given. χ² and log evidence (natural logarithms) have no unit; sigmas are standard
// errors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace photorque {

struct Thresholds {
  // Noise of the readings, and the residual of a fit beside it.
  struct Noise {
    // Neighbours that make a mean: structure longer than this shows in the means, white noise does
    // not.
    size_t neighbours = 20;
    // Differences of a channel, to measure its noise at all: 20 % of error at this number.
    size_t min_differences = 50;
    // A noise level is corrected only where it is off by more than this fraction, which no decision
    // feels, and by more than so many standard errors: six channels are asked.
    double min_correction = 0.05, correction_sigma = 5.0;
    // Twice the logarithm of the likelihood that a correlated noise must gain over white noise of
    // the best level, to be used: by chance one parameter gains 25 once in 2 million.
    double min_colour_gain = 25.0;
    // Twice the gain in log likelihood of a white part beside the correlated one, to be used.
    double min_mixture_gain = 16.0;
    // Frequencies of a spectrum whose median measures the gyro's noise, at the least.
    size_t min_frequencies = 16;
    // Standard deviations from the value expected by its neighbours, for a reading to be dropped.
    // White noise reaches it in one of five million readings (drawn).
    double outlier_sigma = 9.0;
    // By how much the median reading of white noise differs from its neighbours' prediction
    // (drawn).
    double usual_surprise = 0.93;
    // Readings of a channel, to have neighbours on both sides.
    size_t min_neighbourhood = 5;
    // Readings of a channel, for the shape of their distribution; twice the logarithm of the
    // likelihood that Student's t must gain over the normal distribution, as for a correlated
    // noise; degrees of freedom beyond which it is as good as normal.
    size_t min_tail_readings = 200;
    double min_tail_gain = 25.0, max_tail_degrees = 30.0;
    // A burst: more than half of so many readings in a row are off by more than so many standard
    // deviations. Independent errors of Student's t with three degrees of freedom do that once in a
    // hundred thousand; a few readings less do no harm. More than such a fraction of all readings
    // is no burst but motion, or another noise.
    size_t burst_readings = 7;
    double burst_sigma = 4.0, max_burst_fraction = 0.05;
    // Excess of a fit that cannot be propagated [sigma]: beyond every threshold.
    double excess_unknown = 1e9;
  } noise;

  // Of a fit: χ² per sample beyond which its derivatives are useless, because the prediction is
  // elsewhere. Score tests are trusted below it, and starts are recomputed above it. Their forecast
  // of a gain is within 5 % where it is near 1 (tests/diagnosis, Score).
  double diverged_chi2_per_sample = 20.0;

  // How patiently is fitted.
  struct Fitting {
    // Fractions of each recording that are fitted in turn, so that a start that is off grows into
    // the whole instead of diverging: of the nominal model and of the held-out data; of an
    // explanation whose parent diverged; of one recording more beside some that are fitted.
    std::vector<double> first_windows = {0.05, 0.2, 1.0};
    std::vector<double> diverged_windows = {0.06, 0.25, 1.0};
    std::vector<double> added_windows = {0.1, 0.4, 1.0};
    // Iterations of a fit: of a first try; of a second chance, enough to see whether it falls into
    // another local minimum; of a leader, which is to converge.
    int trial_iterations = 12, brief_iterations = 10, patient_iterations = 60;
    // Fall of χ² in a step, as a fraction, that is too slow for a bad fit: the differences
    // between such leaders are thousands, and this is some tens.
    double creep = 5e-4;
    // χ² at a predicted start over that of the trial from which it was predicted.
    double max_start_growth = 10.0;
    // Blocks into which recordings are averaged for slow changes: several times faster than
    // all, and fine enough for every slow law of the catalogue.
    size_t slow_blocks = 1000;
  } fitting;

  // Forecasts of the score test: the fall of χ² if a candidate were added.
  struct Scoring {
    // Beyond one for each parameter (the mean under noise alone), to be worth a fit: a third of the
    // 2 (4.5 + 3.4) that a name needs at the least, so that a crude forecast loses none.
    double min_gain = 5.0;
    // Of the best candidate's gain, to be worth a fit beside it.
    double min_fraction = 0.02;
    // Of a scan over frequencies or instants, at its peaks. Of noise alone, three strengths at one
    // instant gain as much once in 340, six at one frequency once in 34.
    double min_scan_gain = 14.0;
    // Of a candidate scored on all recordings, those held out among them, beyond one a parameter.
    double min_joint_gain = 14.0;
    // To rank subsets, the cost of each parameter: χ² of 95 % for one is 3.8.
    double cost_per_parameter = 4.0;
    // Power of a line in the spectrum of the residuals, noise having 1 in each of nine channels: a
    // sum of nine exponentials exceeds it once in 600,000 frequencies.
    double min_line_power = 30.0;
    // Of the best frequency's gain, for another to be worth a start.
    double min_line_fraction = 0.1;
    // Of the best start of all candidates, for more than a candidate's best one to be fitted.
    double min_start_fraction = 0.3;
  } scoring;

  // How far the search goes.
  struct Search {
    size_t max_effects = 4;  // that may act together
    // Log evidence that one candidate more must gain, before anything is built on it. The same
    // makes two explanations distinguishable: odds of 20 to 1.
    double min_log_evidence_gain = 3.0;
    // Pieces into which diverged recordings are cut, in turn; and complete readings that a piece
    // needs for its own initial conditions.
    std::array<size_t, 4> pieces = {6, 20, 60, 180};
    size_t min_readings_of_piece = 10;
    // Fits to averages or pieces that are repeated on all readings.
    size_t max_refits_of_averages = 4, max_refits_of_pieces = 6;
    // Sets of candidates that a forecast keeps of each size, to be enlarged.
    size_t beam = 40;
    // Residual structure of a single effect [sigma], below which it is no stand-in for a fast one.
    double explained_sigma = 3.0;
    // Rounds of forecast and fit; the predicted sets that a round fits; and the log evidence below
    // the best forecast within which a set is worth that.
    int max_rounds = 6;
    size_t max_fits_of_round = 6;
    // Of sets without an empirical law, with any predicted gain, where the best has one.
    size_t max_known_fits_of_round = 3;
    double forecast_within = 12.0;
  } search;

  // The best of many, which are fitted with more iterations.
  struct Leaders {
    size_t max_leaders = 6;
    // χ² of a near explanation is below this fraction of the best one's and so much more.
    double near_fraction = 1.3, near_chi2 = 100.0;
    // χ² over the best one's, to be worth a second chance.
    double worth_a_fit = 10.0;
  } leaders;

  // Weighing with the held-out data.
  struct HeldOut {
    size_t max_leaders = 12;
    // Log evidence below the best, within which an explanation is a leader: odds of 3e6 to 1, which
    // the recordings held out can turn.
    double within = 15.0;
    // Candidates that are added because only all recordings together show them.
    size_t max_effects = 4, max_empirical = 2;
    // χ² per sample that may be noise alone where the train runs have it too: the level of the
    // noise is known to a few per cent.
    double max_noise = 1.15;
  } held_out;

  // Priors of the evidence.
  struct Evidence {
    // Logarithm of the prior odds: of one effect of the catalogue among some thirty, and of one
    // empirical law (1 : 150).
    double log_prior_effect = -3.4, log_prior_empirical = -5.0;
    // Widths of the fit's own prior over those expected: keeps undetermined parameters from
    // running away, no more.
    double fit_prior_widths = 300.0;
    // The width of the prior of an effect's strengths, over the expected one, is uniform in its
    // logarithm: so many steps of half a decade from 10^−6.
    int strength_widths = 19;
    double first_log10_width = -6.0, step_log10_width = 0.5;
    // Standard deviation of the start of a candidate's own state in its unit (an appendage starts
    // near rest against the body).
    double own_state_sigma = 0.01;
  } evidence;

  // Limits beyond which physics forbids a trial.
  struct Objection {
    // Beyond a bound of physics: more than its standard error explains.
    double bound_sigma = 2.0;
    // Largest change of a principal moment of inertia, as a fraction: platforms are weighed more
    // accurately.
    double max_inertia_change = 0.4;
    // Periods of a tone within the longest recording: one that is slower stands in for any torque
    // that changes slowly.
    double min_periods = 3.0;
  } objection;

  // The verdict.
  struct Decision {
    // Log evidence over the nominal model that an explanation needs to be reported: odds of 90 to
    // 1, on top of the prior odds against each name. An empirical law must beat the best physics by
    // as much.
    double min_log_odds = 4.5;
    // Significance of every named effect [sigma].
    double min_significance = 4.0;
    // Of the held-out runs beyond the predictive distribution [sigma], for a model to be accepted.
    double max_predictive_sigma = 5.0;
    // Log evidence that a name may cost in predicting them: an effect that shows in the train runs
    // alone predicts nothing.
    double max_predictive_loss = 2.0;
    // χ² of the held-out data, as the fitted parameters alone predict them, over that without a
    // name (or over noise), beyond which it is no name.
    double max_held_out_growth = 1.5;
    // Log evidence by which a law without a name needs the help of a known effect before that is
    // named: where the law is not quite right, an effect may take up what it leaves, and what it
    // can leave without being seen as structure is some tens.
    double min_log_odds_beside_law = 100.0;
    // χ² of the held-out data over that of the nominal model, for a law without a name to describe
    // it.
    double max_held_out_fraction = 0.5;
    // Distance of a nominal value from its stated value [sigma], to be doubted and to be
    // contradicted.
    double doubtful_belief_sigma = 3.0, contradicted_belief_sigma = 5.0;
    // Probability of the names, or of effects not distinguished from them, to be reported.
    double min_probability = 0.7;
    // Residual structure [sigma], before the best physics is called insufficient; and the
    // confidence, at least, that something unknown acts then.
    double max_excess_sigma = 6.0, structure_confidence = 0.95;
  } decision;

  // Names beside something that stays unexplained, which counts as noise.
  struct Discrepancy {
    // Number of segments into which all recordings are cut, about; standard errors by which each
    // name must predict them better than its absence; and those by which two explanations differ
    // (95 %).
    size_t stretches = 16;
    double min_sigma = 3.0, min_rival_sigma = 1.645;
    // χ² of the held-out data over that without the name, beyond which it is no name.
    double max_held_growth = 1.1;
    // Explanations that are compared on the segments: the most likely, and those that
    // predict the held-out data best.
    size_t max_likeliest = 4, max_predicting = 3;
    // χ² per sample of a law without a name over that of known physics, below which the law is the
    // better description, however known physics stands out.
    double max_fraction_of_law = 0.25;
    // Rounds in which the residual counts as noise, and effects that exceed it are searched for.
    int max_rounds = 4;
  } discrepancy;

  // Where recording and nominal model part, for the report; no verdict depends on it.
  struct Location {
    // Excess of an interval's χ² over that of noise [sigma] and its fewest readings, to be listed.
    double interval_sigma = 5.0;
    int min_readings = 20;
    // Power of a line that counts as noise (four times its mean), and the sum of all excesses that
    // makes a band; the band holds all but this fraction at each end.
    double noise_power = 4.0, min_band_power = 50.0, band_edge = 0.05;
    // Fraction of the misfit that a variable must explain, to be listed.
    double min_dependence = 0.1;
  } location;
};

}  // namespace photorque

// The verdict on explanations that are written out: what is said has to predict, and every name has
// to be missed. Each expectation fails under a mutant, other limits.
#include "inference/decide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace photorque::inference {
namespace {

const std::vector<CandidateTraits> candidates = {{.name = "first"}, {.name = "second"}};

Explanation explanation(std::vector<size_t> which, double log_evidence, double predictive_sigma,
                        double log_score = 0.0) {
  Explanation e;
  e.significance.assign(which.size(), 20.0);
  e.candidates = std::move(which);
  e.log_evidence = log_evidence;
  e.predictive = Predictive{1.0, predictive_sigma, log_score};
  return e;
}

// The decision without residual structure.
Decision decided(const std::vector<Explanation>& trials,
                 const Thresholds::Decision& limits = Thresholds().decision,
                 const std::vector<CandidateTraits>& all = candidates) {
  return decide(trials, all, {[](size_t) { return 0.0; }}, limits);
}

// Nothing missing, "first", and both.
std::vector<Explanation> nested(double first, double both) {
  return {explanation({}, 0.0, 40.0), explanation({0}, first, 1.0), explanation({0, 1}, both, 1.0)};
}

TEST(Decide, NamesPredictiveEffects) {
  const Decision d = decided({explanation({}, 0.0, 40.0), explanation({0}, 100.0, 1.0)});
  EXPECT_EQ(d.verdict, Verdict::missing_physics);
  EXPECT_EQ(d.chosen, 1u);
  EXPECT_TRUE(d.because.empty());
}

TEST(Decide, AnEffectWithoutPredictiveGainIsNotReported) {
  Thresholds::Decision mutant;
  mutant.max_predictive_sigma = 1e9;
  const std::vector<Explanation> named = {explanation({}, 0.0, 40.0), explanation({0}, 100.0, 9.0)};
  EXPECT_EQ(decided(named).verdict, Verdict::unexplained);
  EXPECT_FALSE(decided(named).because.empty());
  EXPECT_EQ(decided(named, mutant).verdict, Verdict::missing_physics);
  // "Nothing is missing" has to predict as well.
  const std::vector<Explanation> nothing = {explanation({}, 0.0, 9.0)};
  EXPECT_EQ(decided(nothing).verdict, Verdict::unexplained);
  EXPECT_EQ(decided(nothing, mutant).verdict, Verdict::consistent);
}

// More evidence than any other, and never compared with the held-out data, where the others were.
TEST(Decide, AnEffectWithoutPredictionIsNotReported) {
  std::vector<Explanation> trials = nested(100.0, 200.0);
  trials[2].predictive.reset();
  EXPECT_EQ(decided(trials).verdict, Verdict::unexplained);
  // Without a recording to predict nothing was asked of anybody.
  for (Explanation& t : trials) t.predictive.reset();
  EXPECT_EQ(decided(trials).verdict, Verdict::missing_physics);
  EXPECT_EQ(decided(trials).chosen, 2u);
}

// 3 of log evidence are odds of 20 to 1 for the second name, and too few to report it.
TEST(Decide, ANameThatHardlyImprovesTheFitIsNotReported) {
  const std::vector<Explanation> trials = nested(100.0, 103.0);
  EXPECT_EQ(decided(trials).chosen, 1u);
  // A further possible effect makes the name no less sure.
  EXPECT_GT(decided(trials).confidence, 0.99);
  Thresholds::Decision mutant;
  mutant.min_log_odds = 1.0;
  EXPECT_EQ(decided(trials, mutant).chosen, 2u);
}

// Enough evidence, all of it from the fitted recordings: it predicts the held-out data worse.
TEST(Decide, ANameThatPredictsWorseIsNotReported) {
  const std::vector<Explanation> trials = {explanation({}, 0.0, 40.0, -90.0),
                                           explanation({0}, 100.0, 1.0, -50.0),
                                           explanation({0, 1}, 120.0, 1.0, -55.0)};
  EXPECT_EQ(decided(trials).chosen, 1u);
  Thresholds::Decision mutant;
  mutant.max_predictive_loss = 1e9;
  EXPECT_EQ(decided(trials, mutant).chosen, 2u);
}

// The name is certain and predicts nothing. That nothing is missing is as wrong as the name.
TEST(Decide, AMisfitWhoseExplanationPredictsNothingIsUnexplained) {
  std::vector<Explanation> trials = {explanation({}, 0.0, 1.0), explanation({0}, 100.0, 1.0)};
  trials[0].holdout_chi2_per_sample = 0.1;
  trials[1].holdout_chi2_per_sample = std::numeric_limits<double>::infinity();
  const Decision d = decided(trials);
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_EQ(d.chosen, 0u);
  EXPECT_GT(d.confidence, 0.99);
  EXPECT_FALSE(d.because.empty());
  Thresholds::Decision mutant;
  mutant.min_probability_of_nothing = 0.0;
  EXPECT_EQ(decided(trials, mutant).verdict, Verdict::consistent);
}

// The numbers of both names are known too poorly to predict: the held-out χ² grows as their errors
// say. Or it grows by more, and a fit to all recordings agrees with the held-out ones only with
// both.
TEST(Decide, ANameWithWrongParametersIsReported) {
  std::vector<Explanation> trials = nested(100.0, 120.0);
  trials[0].holdout_chi2_per_sample = 9000.0;
  trials[1].holdout_chi2_per_sample = 47.0;
  trials[2].holdout_chi2_per_sample = 90.0;
  EXPECT_EQ(decided(trials).chosen, 1u);
  trials[2].predictive->expected_chi2_per_sample = 61.0;
  EXPECT_EQ(decided(trials).chosen, 2u);
  trials[2].predictive->expected_chi2_per_sample = 1.0;
  trials[1].predictive->sigma = 6.0;
  EXPECT_EQ(decided(trials).chosen, 2u);
  Thresholds::Decision mutant;
  mutant.max_predictive_sigma = 6.5;
  EXPECT_EQ(decided(trials, mutant).chosen, 1u);
}

// A law without a name is a hundred times as likely, by less than it takes to say that there is
// one: the name is a candidate and no more.
TEST(Decide, AnUnlikelyNameIsNotReported) {
  const std::vector<CandidateTraits> all = {{.name = "first"},
                                            {.name = "law", .is_empirical = true}};
  const std::vector<Explanation> trials = {explanation({}, 0.0, 40.0), explanation({0}, 100.0, 1.0),
                                           explanation({1}, 104.4, 1.0)};
  Thresholds::Decision limits;
  const Decision d = decided(trials, limits, all);
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_NEAR(d.confidence, 1.0 / (1.0 + std::exp(-4.4)), 1e-3);
  limits.min_probability = 0.0;
  EXPECT_EQ(decided(trials, limits, all).verdict, Verdict::missing_physics);
}

// A law without a name is more likely, but predicts the held-out data far worse than the name.
TEST(Decide, ALawThatDoesNotPredictDoesNotRivalAName) {
  const std::vector<CandidateTraits> all = {{.name = "first"},
                                            {.name = "law", .is_empirical = true}};
  std::vector<Explanation> trials = {explanation({}, 0.0, 40.0), explanation({0}, 100.0, 1.0),
                                     explanation({1}, 110.0, 1.0)};
  EXPECT_EQ(decided(trials, {}, all).verdict, Verdict::unexplained);
  trials[0].holdout_chi2_per_sample = 900.0;
  trials[1].holdout_chi2_per_sample = 1.0;
  trials[2].holdout_chi2_per_sample = 60.0;
  EXPECT_EQ(decided(trials, {}, all).verdict, Verdict::missing_physics);
  EXPECT_GT(decided(trials, {}, all).confidence, 0.99);
  Thresholds::Decision mutant;
  mutant.max_held_out_growth = 100.0;
  EXPECT_EQ(decided(trials, mutant, all).verdict, Verdict::unexplained);
}

// Two that explain as much are one answer: the first with the second in its place.
TEST(Decide, AnIndistinguishableNameIsReportedToo) {
  const Decision d = decided(
      {explanation({}, 0.0, 40.0), explanation({0}, 100.0, 1.0), explanation({1}, 99.9, 1.0)});
  EXPECT_EQ(d.verdict, Verdict::missing_physics);
  EXPECT_NEAR(d.confidence, 1.0 / (1.0 + std::exp(-0.1)), 1e-6);
}

// Each name has to differ from nothing.
TEST(Decide, ANameWithinItsErrorIsNotReported) {
  std::vector<Explanation> trials = {explanation({}, 0.0, 1.0), explanation({0}, 100.0, 1.0)};
  trials[1].significance[0] = 3.9;
  EXPECT_EQ(decided(trials).verdict, Verdict::consistent);
  Thresholds::Decision mutant;
  mutant.min_significance = 3.0;
  EXPECT_EQ(decided(trials, mutant).verdict, Verdict::missing_physics);
}

// Two names stand together; "second" is hardly missed, and alone "first" is within its error.
TEST(Gates, ANameWithinItsErrorWithoutAnotherIsNotReported) {
  std::vector<Explanation> trials = {explanation({}, 0.0, 1.0), explanation({0}, 100.0, 1.0),
                                     explanation({0, 1}, 102.0, 1.0)};
  trials[1].joint_significance = {3.9};
  EXPECT_EQ(decided(trials).chosen, 0u);
  EXPECT_EQ(decided(trials).verdict, Verdict::unexplained);
  Thresholds::Decision mutant;
  mutant.min_significance = 3.0;
  EXPECT_EQ(decided(trials, mutant).verdict, Verdict::missing_physics);
  EXPECT_EQ(decided(trials, mutant).chosen, 1u);
}

// Only a combination of its numbers is known: the limit of another effect has the same one.
TEST(Gates, ANameAllOfWhoseNumbersAreWithinTheirErrorsNeedsALeadOverOthers) {
  std::vector<Explanation> trials = {explanation({}, 0.0, 40.0), explanation({0}, 110.0, 1.0),
                                     explanation({1}, 100.0, 1.0)};
  trials[1].largest_component = {2.1};
  trials[2].largest_component = {9.0};
  EXPECT_EQ(decided(trials).chosen, 2u);
  Thresholds::Decision mutant;
  mutant.min_component_sigma = 0.0;
  EXPECT_EQ(decided(trials, mutant).chosen, 1u);
  trials[1].log_evidence = 130.0;
  EXPECT_EQ(decided(trials).chosen, 1u);
}

TEST(Decide, HopelessEvidenceHasAProbabilityAsWell) {
  const Decision d = decided({explanation({}, -1e300, 40.0), explanation({0}, -1e300, 1.0)});
  EXPECT_TRUE(std::isfinite(d.confidence));
}

// Where all of the probability is on one name, written in several ways, its sum rounds beyond 1.
TEST(Decide, NoConfidenceIsMoreThanOne) {
  for (int k = 0; k < 200; ++k) {
    std::vector<Explanation> trials = {explanation({}, 0.0, 40.0),
                                       explanation({0}, 100.0 + 0.11 * k, 1.0)};
    for (int j = 1; j < 4; ++j) trials.push_back(explanation({0}, 100.0 + 0.37 * j * k, 1.0));
    EXPECT_LE(decided(trials).confidence, 1.0) << k;
    EXPECT_GT(decided(trials).confidence, 0.99) << k;
  }
}

// A law without a name gives "unexplained"; beside it only effects that it needs are named.
TEST(Decide, AKnownEffectIsNamedBesideALawThatNeedsIt) {
  const std::vector<CandidateTraits> all = {
      {.name = "first"}, {.name = "second"}, {.name = "law", .is_empirical = true}};
  const std::vector<Explanation> trials = {
      explanation({}, 0.0, 900.0),         explanation({0}, 500.0, 300.0),
      explanation({2}, 700.0, 200.0),      explanation({0, 2}, 2000.0, 1.0),
      explanation({0, 1, 2}, 2006.0, 1.0),
  };
  const auto judged = [&](double structure_sigma, const Thresholds::Decision& limits) {
    return decide(trials, all, {[&](size_t) { return structure_sigma; }}, limits);
  };
  const Thresholds::Decision limits = Thresholds().decision;
  const Decision d = judged(0.0, limits);
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_EQ(d.chosen, 4u);
  EXPECT_EQ(d.beside_law, std::vector<size_t>{0});
  // All its numbers are within their errors, so only a combination is known.
  std::vector<Explanation> vague = trials;
  vague.back().largest_component = {2.1, 9.0};
  EXPECT_TRUE(decided(vague, limits, all).beside_law.empty());
  // The fit to the first recordings alone may predict the others worse than no law did.
  std::vector<Explanation> worse = trials;
  worse.front().holdout_chi2_per_sample = 20.0;
  worse.back().holdout_chi2_per_sample = 700.0;
  EXPECT_TRUE(decided(worse, limits, all).beside_law.empty());
  // Where the law leaves structure, the names may make up for it.
  EXPECT_TRUE(judged(20.0, limits).beside_law.empty());
  Thresholds::Decision mutant = limits;
  // Two that the law needs may together be its residual.
  mutant.min_log_odds_beside_law = 3.0;
  EXPECT_TRUE(judged(0.0, mutant).beside_law.empty());
}

// Two explanations as likely as one another, each weak without the held-out data. If the nominal
// model is as likely, nothing is reported as missing; if it does not predict, something is.
TEST(Decide, IndistinguishableEffectsAreNotConsistent) {
  const std::vector<CandidateTraits> all = {{.name = "sure"}, {.name = "one"}, {.name = "other"}};
  const auto judged = [&](double nominal_sigma) {
    std::vector<Explanation> trials = {
        explanation({}, 0.0, nominal_sigma), explanation({0}, 700.0, 80.0),
        explanation({1}, 100.0, 200.0),      explanation({0, 1}, 1000.3, 1.0),
        explanation({0, 2}, 1000.0, 1.0),
    };
    for (Explanation& t : trials) {
      t.joint_significance = t.significance;
      if (t.candidates.size() == 2) t.significance[1] = 1.0;
    }
    return decided(trials, Thresholds().decision, all);
  };
  EXPECT_EQ(judged(1.0).verdict, Verdict::consistent);
  EXPECT_TRUE(judged(1.0).undecided);
  const Decision d = judged(900.0);
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_FALSE(d.undecided);
  EXPECT_TRUE(d.beside_law.empty());
  EXPECT_NEAR(d.confidence, 1.0 / (1.0 + std::exp(0.3)), 1e-6);
}

// The gates (a) to (f) of decide.h. Each test has a mutant: the limit of the gate moved until it
// lets everything pass. (a), (b) and the first half of (d) are tested above.

// Evidence of 100, and segments that were left out of the fits are predicted no better with the
// name.
TEST(Gates, ANameThatLeftOutSegmentsDoNotNeedIsNotReported) {
  const std::vector<Explanation> trials = {explanation({}, 0.0, 1.0), explanation({0}, 100.0, 1.0),
                                           explanation({0, 1}, 200.0, 1.0)};
  // Gains of "first" and "second" in standard errors.
  const auto judged = [&](double first, double second, const GateLimits& limits) {
    const auto gain = [&](size_t trial, size_t which) -> std::optional<double> {
      return trials[trial].candidates[which] == 0 ? first : second;
    };
    return decide(trials, candidates, {[](size_t) { return 0.0; }, gain, {}, limits},
                  Thresholds().decision);
  };
  GateLimits limits, mutant;
  mutant.min_gain_sigma = -1e9;
  EXPECT_EQ(judged(8.0, 3.1, limits).chosen, 2u);
  EXPECT_EQ(judged(8.0, 3.1, limits).names[1].gain_sigma, 3.1);
  EXPECT_EQ(judged(8.0, 2.9, limits).chosen, 1u);
  EXPECT_EQ(judged(8.0, 2.9, mutant).chosen, 2u);
  EXPECT_EQ(judged(2.9, 2.9, limits).verdict, Verdict::consistent);
  // Only "second" is needed, and no trial has it alone: no fit can be reported.
  EXPECT_EQ(judged(2.9, 8.0, limits).verdict, Verdict::consistent);
  EXPECT_EQ(judged(2.9, 8.0, mutant).verdict, Verdict::missing_physics);
}

// A fit to all recordings may explain data that the fit to some of them led away from.
TEST(Gates, AHeldOutChi2FarAboveItsPredictionIsUnknown) {
  std::vector<Explanation> trials = {explanation({}, 0.0, 40.0), explanation({0}, 100.0, 1.0)};
  Thresholds::Decision limits, mutant;
  mutant.max_predictive_sigma = 1e9;
  trials[1].held_out_sigma = 4.9;
  EXPECT_EQ(decided(trials, limits).verdict, Verdict::missing_physics);
  trials[1].held_out_sigma = 5.1;
  EXPECT_EQ(decided(trials, limits).verdict, Verdict::unexplained);
  EXPECT_EQ(decided(trials, mutant).verdict, Verdict::missing_physics);
}

TEST(Gates, DataThatTheNominalModelPredictsTestNoName) {
  std::vector<Explanation> trials = {explanation({}, 0.0, 1.0), explanation({0}, 100.0, 1.0)};
  trials[0].holdout_chi2_per_sample = 1.1;
  trials[1].holdout_chi2_per_sample = 1.0;
  const auto is_tested = [&](const GateLimits& limits) {
    return decide(trials, candidates, {[](size_t) { return 0.0; }, {}, {}, limits},
                  Thresholds().decision)
        .held_out_tests_names;
  };
  GateLimits mutant;
  mutant.max_untested_fraction = 1e9;
  EXPECT_EQ(decided(trials).verdict, Verdict::missing_physics);
  EXPECT_FALSE(is_tested({}));
  EXPECT_TRUE(is_tested(mutant));
  trials[0].holdout_chi2_per_sample = 2.0;
  EXPECT_TRUE(is_tested({}));
}

// Cells 0 and 1 explain as much, cell 2 less by odds of e⁵.
TEST(Gates, PlacesThatExplainAsMuchAreListed) {
  const std::vector<CandidateTraits> cells = {
      {.name = "cell 0"}, {.name = "cell 1"}, {.name = "cell 2"}};
  const std::vector<Explanation> trials = {explanation({}, 0.0, 40.0), explanation({0}, 100.0, 1.0),
                                           explanation({1}, 99.0, 1.0),
                                           explanation({2}, 95.0, 1.0)};
  const auto places = [&](size_t trial, size_t) {
    std::vector<Checks::Place> others;
    for (size_t i = 1; i < trials.size(); ++i) {
      if (i == trial) continue;
      others.emplace_back(i - 1, trials[trial].log_evidence - trials[i].log_evidence);
    }
    return others;
  };
  const auto judged = [&](const GateLimits& limits) {
    return decide(trials, cells, {[](size_t) { return 0.0; }, {}, places, limits},
                  Thresholds().decision);
  };
  GateLimits limits, mutant;
  const Decision d = judged(limits);
  EXPECT_EQ(d.verdict, Verdict::missing_physics);
  EXPECT_EQ(d.names.front().equal_places, std::vector<size_t>{1});
  // That it is one of these cells is sure, though none of them is.
  EXPECT_GT(d.names.front().probability, 0.99);
  EXPECT_LT(d.confidence, 0.8);
  mutant.min_log_odds_of_place = -1e9;
  EXPECT_TRUE(judged(mutant).names.front().equal_places.empty());
}

}  // namespace
}  // namespace photorque::inference

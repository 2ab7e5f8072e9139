// The search for missing effects, end to end, in a domain that has nothing to do with motion: terms
// added to a line. Tests also run a mutant, thresholds with which they must fail.
#include "inference/search.h"

#include <gtest/gtest.h>

#include "inference/decide.h"
#include "inference/weigh.h"
#include "tests/inference/line_domain.h"

namespace photorque::inference::line {
namespace {

std::vector<Term> known_terms() {
  std::vector<Term> terms;
  for (Eigen::Index degree = 2; degree <= 7; ++degree) terms.push_back(polynomial(degree));
  terms.push_back(tone());
  terms.push_back(smooth(14));
  return terms;
}

Eigen::VectorXd nothing() {
  return Eigen::VectorXd::Zero(samples);
}

// A polynomial term whose amplitude is so many standard errors.
Eigen::VectorXd of_degree(Eigen::Index degree, double sigmas) {
  return sigmas * orthonormal_polynomials(grid(samples), degree - 1).rightCols(1);
}

struct Answered {
  Decision decision;
  std::multiset<std::string> names;  // of the chosen trial
  std::vector<LineDomain::Trial> trials;
};

Answered answer(const std::vector<Term>& terms, const std::vector<Series>& train,
                const std::vector<Series>& held, const Thresholds& limits = {}) {
  const LineDomain domain(terms, limits);
  Answered a;
  a.trials = search(domain, domain.nominal(train), train, 1);
  if (!held.empty()) weigh_with_held_out(domain, train, held, 1, a.trials);
  a.decision =
      decide({a.trials.begin(), a.trials.end()}, domain.list,
             {[&](size_t t) { return domain.excess_sigma(a.trials[t], train); }}, limits.decision);
  for (const size_t c : a.trials[a.decision.chosen].candidates) {
    a.names.insert(terms[c].traits.name);
  }
  return a;
}

// Recordings of a signal, one to fit and one to predict.
struct Recorded {
  std::vector<Series> train, held;

  explicit Recorded(const Eigen::VectorXd& signal, uint64_t seed = 1)
      : train{recorded(2 * seed, signal)}, held{recorded(2 * seed + 1, signal)} {}
};

Answered answer(const std::vector<Term>& terms, const Recorded& seen,
                const Thresholds& limits = {}) {
  return answer(terms, seen.train, seen.held, limits);
}

using Names = std::multiset<std::string>;

double two_sided(double sigmas) {
  return std::erfc(sigmas / std::sqrt(2.0));
}

// Amplitudes of orthonormal terms are independent standard normals under noise, so that the
// fraction of recordings in which one of six is called significant is known.
double false_alarms(double min_significance, int seeds) {
  std::vector<Term> terms = known_terms();
  terms.resize(6);
  Thresholds limits;
  limits.decision.min_significance = min_significance;
  limits.decision.min_log_odds = -100.0;
  limits.decision.min_probability = 0.0;
  limits.search.max_effects = 1;
  int alarms = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const Answered a =
        answer(terms, {recorded(static_cast<uint64_t>(seed), nothing())}, {}, limits);
    alarms += a.decision.verdict == Verdict::missing_physics ? 1 : 0;
  }
  return alarms / static_cast<double>(seeds);
}

TEST(Search, FalseAlarmsAgreeWithTheSignificance) {
  constexpr int seeds = 2000;
  const double expected = 1.0 - std::pow(1.0 - two_sided(2.5), 6);
  const double standard_error = std::sqrt(expected * (1.0 - expected) / seeds);
  EXPECT_NEAR(false_alarms(2.5, seeds), expected, 3.0 * standard_error);
  // Mutant: another significance.
  EXPECT_GT(std::abs(false_alarms(3.0, seeds) - expected), 3.0 * standard_error);
}

TEST(Search, FindsNothingInNoise) {
  int alarms = 0, alarms_of_mutant = 0;
  Thresholds mutant;
  mutant.decision.min_log_odds = -10.0;
  mutant.decision.min_significance = 2.0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const Recorded seen(nothing(), seed);
    const Answered a = answer(known_terms(), seen);
    alarms += a.decision.verdict == Verdict::consistent ? 0 : 1;
    EXPECT_TRUE(a.names.empty());
    const Answered b = answer(known_terms(), seen, mutant);
    alarms_of_mutant += b.decision.verdict == Verdict::consistent ? 0 : 1;
  }
  // A name needs 4.75 σ: six terms and fifty frequencies reach it once in 5000 recordings or so.
  EXPECT_EQ(alarms, 0);
  EXPECT_GT(alarms_of_mutant, 3);
}

TEST(Search, NamesTheTermsThatWereAdded) {
  Thresholds mutant;
  mutant.search.max_effects = 1;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const Eigen::VectorXd signal = of_degree(3, 12.0) + of_degree(6, -15.0);
    const Recorded seen(signal, seed);
    const Answered a = answer(known_terms(), seen);
    EXPECT_EQ(a.decision.verdict, Verdict::missing_physics);
    EXPECT_EQ(a.names, (Names{"degree 3", "degree 6"})) << seed;
    EXPECT_GT(a.decision.confidence, 0.9);
    EXPECT_NEAR(*a.trials[a.decision.chosen].holdout_chi2_per_sample, 1.0, 0.5);
    EXPECT_NE(answer(known_terms(), seen, mutant).names, a.names);
  }
}

TEST(Search, ScansForAFrequency) {
  Thresholds mutant;
  mutant.scoring.min_scan_gain = 1e9;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Eigen::VectorXd signal =
        tone().shape({grid(samples), {}, 1.0}, 23.0) * Eigen::Vector2d(6.0, -9.0);
    const Recorded seen(signal, seed);
    const Answered a = answer(known_terms(), seen);
    EXPECT_EQ(a.names, Names{"tone"});
    EXPECT_EQ(a.trials[a.decision.chosen].searched, std::vector<double>{23.0});
    EXPECT_NE(answer(known_terms(), seen, mutant).names, a.names);
  }
}

// The prediction without the term is so far away that the runs are cut into pieces.
TEST(Search, FindsAStrongTermByWayOfPieces) {
  const Eigen::VectorXd signal = of_degree(2, 120.0);
  const std::vector<Series> train = {recorded(1, signal)}, held = {recorded(2, signal)};
  const LineDomain domain(known_terms(), {});
  ASSERT_TRUE(has_diverged(domain.nominal(train), domain.limits));
  const Answered a = answer(known_terms(), train, held);
  EXPECT_EQ(a.names, Names{"degree 2"});
  // The reported values were fitted to the whole: one intercept, a slope, an amplitude.
  const LineFit& fit = a.trials[a.decision.chosen].fit;
  ASSERT_EQ(fit.value.size(), 3);
  EXPECT_NEAR(fit.value[2], 120.0, 4.0 + 120.0 / (amplitude_sigma * amplitude_sigma));
}

// Two terms that nearly cancel each other: neither gains much alone.
TEST(Search, FindsPairsThatHideEachOther) {
  std::vector<Term> terms = {polynomial(2), polynomial(3), polynomial(4)};
  const auto mixed = [](double side, const char* name) {
    Term t;
    t.traits = {name, false, true, false, true, 1};
    t.shape = [side](const Series& run, double) -> Eigen::MatrixXd {
      const Eigen::MatrixXd P = orthonormal_polynomials(grid(samples), 5);
      return taken_at(side * P.col(3) + 0.05 * P.col(4), run);
    };
    return t;
  };
  terms.push_back(mixed(1.0, "one side"));
  terms.push_back(mixed(-1.0, "other side"));
  // 200 of each make 20 of the polynomial that they share; alone, each makes 1.
  // Without noise, whose chance could show one of them. What is weak in it (2.6 σ) keeps the search
  // going and is not named.
  const Eigen::VectorXd signal = of_degree(6, 20.0) + of_degree(3, 9.0) + of_degree(4, 2.6);
  const std::vector<Series> train = {{grid(samples), signal, 1.0}};
  EXPECT_EQ(answer(terms, train, train).names, (Names{"degree 3", "one side", "other side"}));
  Thresholds mutant;
  mutant.search.max_effects = 2;
  mutant.decision.max_predictive_sigma = mutant.scoring.min_joint_gain = 1e9;
  EXPECT_NE(answer(terms, train, train, mutant).names,
            (Names{"degree 3", "one side", "other side"}));
}

// A bump that no known term has: only the empirical one takes it up.
TEST(Search, IsUnexplainedIfOnlyTheEmpiricalTermFits) {
  const Eigen::VectorXd signal = smooth(14).shape({grid(samples), {}, 1.0}, 0.0).col(4) * 25.0;
  Thresholds mutant;
  mutant.decision.min_log_odds = 1e9;
  mutant.decision.min_probability_of_nothing = 0.0;
  mutant.decision.max_excess_sigma = mutant.decision.max_predictive_sigma = 1e9;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Recorded seen(signal, seed);
    const Answered a = answer(known_terms(), seen);
    EXPECT_EQ(a.decision.verdict, Verdict::unexplained);
    EXPECT_EQ(a.names.count("smooth"), 1u);
    EXPECT_GT(a.decision.confidence, 0.9);
    EXPECT_NE(answer(known_terms(), seen, mutant).decision.verdict, Verdict::unexplained);
  }
}

// A bump without an empirical term to absorb it: structure is left.
TEST(Search, IsUnexplainedIfStructureRemains) {
  std::vector<Term> terms = known_terms();
  terms.pop_back();
  const Eigen::VectorXd signal = smooth(14).shape({grid(samples), {}, 1.0}, 0.0).col(4) * 40.0;
  const std::vector<Series> train = {recorded(1, signal)}, held = {recorded(2, signal)};
  EXPECT_EQ(answer(terms, train, held).decision.verdict, Verdict::unexplained);
  Thresholds mutant;
  mutant.decision.max_excess_sigma = mutant.decision.max_predictive_sigma = 1e9;
  EXPECT_NE(answer(terms, train, held, mutant).decision.verdict, Verdict::unexplained);
}

Eigen::VectorXd of_swing(double periods, double sigmas) {
  return sigmas * swing().shape({grid(samples), {}, 1.0}, periods).col(0);
}

std::vector<Term> terms_with_swing(size_t most) {
  std::vector<Term> terms = known_terms();
  terms.push_back(swing());
  terms.back().traits.most = most;
  return terms;
}

// The polynomial takes the slow part of the swing, and the ringing that remains cancels in means of
// 20 neighbours. With one effect, nothing can be added to the polynomial. Strong ringing leaves all
// models without it far from the readings, also in pieces.
TEST(Search, NamesAnAppendageThatASlowTermImitates) {
  Thresholds limits;
  limits.search.max_effects = 1;
  for (const double sigmas : {40.0, 400.0}) {
    const Eigen::VectorXd signal = of_swing(40.0, sigmas);
    const std::vector<Series> train = {recorded(1, signal)}, held = {recorded(2, signal)};
    EXPECT_EQ(answer(terms_with_swing(2), train, held, limits).names, Names{"swing"}) << sigmas;
  }
  Thresholds mutant = limits;
  mutant.search.explained_sigma = 1e9;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Eigen::VectorXd signal = of_swing(40.0, 40.0);
    const Recorded seen(signal, seed);
    EXPECT_EQ(answer(terms_with_swing(2), seen, limits).names, Names{"swing"}) << seed;
    EXPECT_NE(answer(terms_with_swing(2), seen, mutant).names, Names{"swing"}) << seed;
  }
}

// The fitted run does not excite the swing, so that all frequencies of the same slow part are alike
// there. The held-out run does, too little to contradict the polynomial.
TEST(Search, NamesAnAppendageThatOnlyTheHeldOutRunExcites) {
  Term swinging = swing();
  swinging.traits.swings = true;
  swinging.shape = [](const Series& run, double periods) -> Eigen::MatrixXd {
    const Eigen::Index degree = 2 + std::lround(periods) % 6;
    const Eigen::MatrixXd slow = polynomial(degree).shape(run, 0.0);
    return run.sign > 0.0 ? slow : swing().shape(run, periods);
  };
  std::vector<Term> terms;
  for (Eigen::Index degree = 2; degree <= 7; ++degree) {
    terms.push_back(polynomial(degree));
    terms.back().traits.is_limit_of_swinging = true;
  }
  terms.push_back(swinging);
  std::vector<Term> mutant = terms;
  mutant.back().traits.swings = false;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const auto recorded_with = [&](uint64_t noise, double sign) {
      const Series run{grid(samples), {}, sign};
      return recorded(noise, 20.0 * swinging.shape(run, 40.0).col(0), sign);
    };
    const std::vector<Series> train = {recorded_with(2 * seed, 1.0)},
                              held = {recorded_with(2 * seed + 1, -1.0)};
    EXPECT_EQ(answer(terms, train, held).names, Names{"swing"}) << seed;
    EXPECT_EQ(answer(mutant, train, held).names, Names{"degree 6"}) << seed;
  }
}

TEST(Search, NamesTwoThatSwing) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Eigen::VectorXd signal = of_swing(20.0, 40.0) + of_swing(33.0, 50.0);
    const Recorded seen(signal, seed);
    const Names both{"swing", "swing"};
    EXPECT_EQ(answer(terms_with_swing(2), seen).names, both) << seed;
    EXPECT_NE(answer(terms_with_swing(1), seen).names, both) << seed;
  }
}

// Only the errors of instruments remain of a trial.
TEST(Search, KeepsInstrumentErrorsInTheBase) {
  std::vector<Term> terms = known_terms();
  terms[1].traits.is_of_instrument = true;
  const LineDomain domain(terms, {});
  const std::vector<Series> runs = {recorded(1, of_degree(3, 30.0))};
  const LineDomain::Trial base = domain.nominal(runs);
  const auto of = [&](const std::vector<size_t>& candidates) {
    LineDomain::Trial trial = base;
    for (const size_t c : candidates) trial = domain.extend(trial, c, domain.start_of(c), runs, {});
    return with_instruments(domain, trial, base, runs).candidates;
  };
  EXPECT_EQ(of({0, 1, 4}), std::vector<size_t>{1});
  EXPECT_TRUE(of({0, 4}).empty());
}

TEST(Search, DoesNotNameForbiddenEffects) {
  std::vector<Term> terms = {polynomial(2)};
  terms.front().not_negative = true;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::VectorXd signal = of_degree(2, 12.0 * sign);
    const Answered a = answer(terms, {recorded(1, signal)}, {recorded(2, signal)});
    EXPECT_EQ(a.names, sign > 0.0 ? Names{"degree 2"} : Names{});
  }
}

// A slope that follows the sign of a run: one run alone leaves it to the uncertain slope of the
// nominal model, two of opposite sign show it together.
TEST(Weigh, FindsAnEffectThatOnlyAllRunsShow) {
  Term turned;
  turned.traits = {"turned slope", false, true, false, true, 1};
  turned.shape = [](const Series& run, double) -> Eigen::MatrixXd { return run.sign * run.x; };
  const std::vector<Term> terms = {turned, polynomial(2)};
  const Eigen::VectorXd slope = 1.5 * grid(samples);
  const std::vector<Series> train = {recorded(1, slope, 1.0)}, held = {recorded(2, -slope, -1.0)};
  EXPECT_TRUE(answer(terms, train, {}).names.empty());
  EXPECT_EQ(answer(terms, train, held).names, Names{"turned slope"});
  Thresholds mutant;
  mutant.scoring.min_joint_gain = mutant.decision.max_predictive_sigma = 1e9;
  mutant.search.forecast_within = 0.0;
  EXPECT_TRUE(answer(terms, train, held, mutant).names.empty());
}

// Two tones of different frequency, of which one may be named: a search that ended at the weaker
// finds the stronger in all runs together.
TEST(Weigh, FindsTheFrequencyOfAnOscillationAgain) {
  constexpr size_t of_tone = 1;
  constexpr double weak = 20.0, strong = 31.0;
  const auto found = [&](bool swings) {
    std::vector<Term> terms = {polynomial(2), tone()};
    terms[of_tone].traits.swings = swings;
    const LineDomain domain(terms, {});
    Eigen::VectorXd signal = of_degree(2, 20.0);
    for (const auto& [periods, sigmas] : {std::pair{weak, 9.0}, std::pair{strong, 15.0}}) {
      signal += sigmas * tone().shape({grid(samples), {}}, periods).col(0);
    }
    const Recorded seen(signal);
    std::vector<LineDomain::Trial> trials = {domain.nominal(seen.train)};
    for (const auto& [c, start] :
         {std::pair{size_t{0}, LineDomain::Start{}}, std::pair{of_tone, LineDomain::Start{weak}}}) {
      trials.push_back(domain.extend(trials.back(), c, start, seen.train, {}));
    }
    weigh_with_held_out(domain, seen.train, seen.held, 1, trials);
    return trials[by_evidence(trials).front()].searched.back();
  };
  EXPECT_EQ(found(false), strong);
  EXPECT_EQ(found(true), weak);  // the mutant is not searched again
}

Explanation scored(double log_evidence, const char* objection = "") {
  Explanation e;
  e.log_evidence = log_evidence;
  e.objection = objection;
  return e;
}

TEST(Leaders, ForbiddenTrialsDoNotAffectTheMargin) {
  Thresholds::HeldOut limits;
  limits.within = 15.0;
  limits.max_leaders = 4;
  // The nominal model, one that drives where it should brake, two that may be, one far behind.
  const std::vector<Explanation> trials = {scored(0.0), scored(120.0, "negative"), scored(100.0),
                                           scored(90.0), scored(80.0)};
  EXPECT_EQ(leaders_among(trials, limits), (std::vector<size_t>{2, 3, 0}));
}

TEST(Leaders, AreTheNominalModelWhereAllElseIsForbidden) {
  const std::vector<Explanation> trials = {scored(0.0), scored(120.0, "negative")};
  EXPECT_EQ(leaders_among(trials, Thresholds::HeldOut{}), (std::vector<size_t>{0}));
}

}  // namespace
}  // namespace photorque::inference::line

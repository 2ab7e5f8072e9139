// The estimator against closed forms of linear models.
#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.h"
#include "inference/estimator/evidence.h"
#include "inference/estimator/score.h"
#include "tests/inference/linear_bench.h"

namespace photorque::inference {
namespace {

// Two runs of unlike length with two nuisances each, three shared parameters, priors on some.
struct TwoRuns {
  Parameters parameters;
  std::vector<LinearRun> runs;
  Eigen::MatrixXd design;  // of all data by all parameters
  Eigen::VectorXd data;

  explicit TwoRuns(uint64_t seed) {
    std::mt19937_64 random(seed);
    runs = {{random_matrix(random, 30, 5), random_matrix(random, 30, 1)},
            {random_matrix(random, 12, 5), random_matrix(random, 12, 1)}};
    runs[1].design.col(4) *= 1e-4;  // units differ
    runs[0].design.col(4) *= 1e-4;
    for (int run = 0; run < 2; ++run) {
      parameters.of_run.push_back({{"bias", "rad/s", 0.3, 0.1, 0.5}, {"start", "rad", -1.0}});
    }
    parameters.shared = {{"offset", "m", 0.0}, {"drag", "", 2.0, 1.0, 0.2}, {"scale", "", 0.0}};
    design = Eigen::MatrixXd::Zero(42, 7);
    design.block(0, 0, 30, 2) = runs[0].design.leftCols(2);
    design.block(0, 4, 30, 3) = runs[0].design.rightCols(3);
    design.block(30, 2, 12, 2) = runs[1].design.leftCols(2);
    design.block(30, 4, 12, 3) = runs[1].design.rightCols(3);
    data.resize(42);
    data << runs[0].data, runs[1].data;
  }

  Eigen::MatrixXd information() const {
    Eigen::MatrixXd H = design.transpose() * design;
    for (Eigen::Index i = 0; i < 7; ++i) {
      if (parameters[i].has_prior()) H(i, i) += std::pow(parameters[i].sigma, -2);
    }
    return H;
  }
  Eigen::VectorXd estimate() const {
    Eigen::VectorXd right = design.transpose() * data;
    for (Eigen::Index i = 0; i < 7; ++i) {
      if (parameters[i].has_prior())
        right[i] += parameters[i].mean * std::pow(parameters[i].sigma, -2);
    }
    return information().fullPivLu().solve(right);
  }
};

TEST(Linear, PosteriorOfTwoRunsWithPriorsAndNuisances) {
  const TwoRuns two(1);
  const ResidualModel model = linear_model(two.parameters, two.runs);
  const Fit found = fit(model, model.start(), Options::to_rounding());
  const Eigen::VectorXd expected = two.estimate();
  const Eigen::MatrixXd covariance = two.information().fullPivLu().inverse();
  const Covariance known = found.covariance();
  EXPECT_TRUE(known.undetermined.empty());
  for (Eigen::Index i = 0; i < 7; ++i) {
    const double sigma = std::sqrt(covariance(i, i));
    EXPECT_NEAR((found.at[i] - expected[i]) / sigma, 0.0, 1e-6) << i;
    EXPECT_NEAR(known.standard_error(i) / sigma, 1.0, 1e-9) << i;
  }
  EXPECT_EQ(found.first_shared, 4);
  EXPECT_NEAR(found.shared().matrix(0, 1) / covariance(4, 5), 1.0, 1e-8);
  EXPECT_EQ(found.samples, 42);
  EXPECT_NEAR(found.run_chi2[0] + found.run_chi2[1], found.data_chi2, 1e-12);
  EXPECT_GT(found.chi2, found.data_chi2);
}

TEST(Linear, AHopelessStartIsNoFit) {
  const TwoRuns two(2);
  const ResidualModel model = linear_model(two.parameters, two.runs);
  Options options;
  options.max_start_chi2 = 1e-3;  // far below that of the start
  const Fit found = fit(model, model.start(), options);
  EXPECT_TRUE(std::isinf(found.chi2));
  EXPECT_EQ(found.termination, Termination::not_evaluable);
}

TEST(Linear, AWindowSeesTheFirstPartOfEveryRunAlone) {
  const TwoRuns two(2);
  const ResidualModel model = linear_model(two.parameters, two.runs);
  const Evaluation half = evaluate(model, model.start(), {true, 0.5});
  EXPECT_EQ(half.sums.samples, 15 + 6);
}

// Solved on the bound, min over θ₂ of |d − A₁ b − A₂ θ₂|²; where parameters are correlated that is
// not the free solution cut off.
TEST(Bounds, TheOtherParametersAreFittedWithTheOneOnItsBound) {
  std::mt19937_64 random(3);
  LinearRun run{random_matrix(random, 40, 2), {}};
  run.design.col(1) = run.design.col(0) + 0.3 * run.design.col(1);
  run.data = run.design * Eigen::Vector2d(-1.0, 2.0) + 0.1 * random_matrix(random, 40, 1);
  Parameters parameters{{{}}, {{"a", "", 0.5}, {"b", "", 0.0}}};
  parameters.shared[0].lowest = 0.0;
  const ResidualModel model = linear_model(parameters, {run});
  const Fit found = fit(model, model.start(), Options::to_rounding());
  EXPECT_EQ(found.at[0], 0.0);
  const double alone = run.design.col(1).dot(run.data) / run.design.col(1).squaredNorm();
  EXPECT_NEAR(found.at[1], alone, 1e-9);
  const Eigen::Vector2d free = run.design.colPivHouseholderQr().solve(run.data);
  EXPECT_GT(std::abs(alone - free[1]), 0.1);  // a solution cut off would not pass
}

// The one policy. An error of zero, or a finite one, fails here.
TEST(Undetermined, IsFlaggedAndNeverGetsAnErrorOfZero) {
  std::mt19937_64 random(4);
  const LinearRun run{random_matrix(random, 50, 4), random_matrix(random, 50, 1)};
  LinearRun duplicate = run;
  duplicate.design.col(2) = 3e6 * duplicate.design.col(1);  // only b + 3e6 c is known
  duplicate.design.col(3).setZero();                        // d does nothing
  const Parameters parameters{{{}}, {{"a", "", 0}, {"b", "", 0}, {"c", "", 0}, {"d", "", 7}}};
  const ResidualModel model = linear_model(parameters, {duplicate});
  const Fit found = fit(model, model.start(), Options::to_rounding());
  const Covariance known = found.covariance();
  EXPECT_EQ(known.undetermined, (std::vector<Eigen::Index>{1, 2, 3}));
  for (const Eigen::Index i : known.undetermined) EXPECT_TRUE(std::isinf(known.standard_error(i)));
  EXPECT_TRUE(std::isinf(found.scatter_errors()[3]));
  EXPECT_EQ(found.at[3], 7.0);  // where the fit began
  // The result is as if c and d were no parameters.
  const Eigen::MatrixXd two = duplicate.design.leftCols(2);
  const Eigen::MatrixXd covariance = (two.transpose() * two).inverse();
  EXPECT_NEAR(known.matrix(0, 0) / covariance(0, 0), 1.0, 1e-9);
  // A prior determines a parameter that the data do not.
  Parameters with_prior = parameters;
  with_prior.shared[2].sigma = 1e-6;
  with_prior.shared[3].sigma = 0.5;
  const ResidualModel constrained = linear_model(with_prior, {duplicate});
  const Fit again = fit(constrained, constrained.start(), Options::to_rounding());
  EXPECT_TRUE(again.covariance().undetermined.empty());
  EXPECT_NEAR(again.covariance().standard_error(3), 0.5, 1e-12);
}

// Data without noise are fitted exactly, and that is the end of the fit, not a failure of it.
TEST(Fit, OfExactDataConverges) {
  std::mt19937_64 random(5);
  LinearRun run{random_matrix(random, 30, 3), {}};
  run.data = run.design * Eigen::Vector3d(1.0, -2.0, 0.5);
  const ResidualModel model =
      linear_model({{{}}, {{"a", "", 0.0}, {"b", "", 0.0}, {"c", "", 0.0}}}, {run});
  const Fit found = fit(model, model.start(), Options::to_rounding());
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.at[1], -2.0, 1e-12);
}

// Two parameters of which the data know the sum, k (x + y)², held apart by priors of width s alone:
// along x − y the variance is s². The policy says undetermined; the posterior stays finite.
TEST(Undetermined, APosteriorThatPriorsHoldIsFinite) {
  const double s = 1e3, k = 1e14 / (s * s);
  Eigen::MatrixXd information(2, 2);
  information << k, k, k, k;
  information.diagonal().array() += 1.0 / (s * s);
  EXPECT_EQ(covariance_of(information).undetermined.size(), 2u);
  EXPECT_TRUE(std::isinf(covariance_of(information).standard_error(0)));
  // Rounding of a matrix of this condition leaves one digit.
  const Eigen::MatrixXd posterior = posterior_of(information);
  EXPECT_NEAR(std::sqrt(posterior(0, 0) / (0.5 * s * s)), 1.0, 0.2);
}

TEST(Score, IsTheExactGainOfALinearModel) {
  const TwoRuns two(5);
  // Fitted without the last two shared parameters, which the full model frees.
  TwoRuns fewer = two;
  fewer.parameters.shared.resize(1);
  for (LinearRun& run : fewer.runs) run.design.conservativeResize(Eigen::NoChange, 3);
  Parameters all = two.parameters;
  for (size_t k : {1u, 2u}) all.shared[k] = {"candidate", "", 0.0};
  const ResidualModel small = linear_model(fewer.parameters, fewer.runs);
  const ResidualModel large = linear_model(all, two.runs);
  const Fit before = fit(small, small.start(), Options::to_rounding());
  const Fit after = fit(large, large.start(), Options::to_rounding());
  Eigen::VectorXd at = Eigen::VectorXd::Zero(7);
  at.head(5) = before.at;
  const Projected projected = project_out(evaluate(large, at, {}).sums, 5);
  const Score score = projected.score(0, 2);
  EXPECT_NEAR(score.gain, before.chi2 - after.chi2, 1e-8 * before.chi2);
  const Eigen::VectorXd sigma = after.shared().matrix.diagonal().cwiseSqrt();
  for (Eigen::Index k = 0; k < 2; ++k) {
    EXPECT_NEAR(score.estimate[k], after.at[5 + k], 1e-6 * sigma[k + 1]);
  }
}

// With priors on all parameters, data are normal with covariance 1 + A Σ Aᵀ about A μ.
TEST(Evidence, IsTheClosedFormOfALinearModel) {
  std::mt19937_64 random(6);
  const LinearRun run{random_matrix(random, 25, 3), random_matrix(random, 25, 1)};
  const Eigen::Vector3d mean(0.5, -1.0, 2.0), sigma(0.3, 2.0, 1e-3);
  Parameters parameters{{{}}, {{"a", "", 0.0}, {"b", "", 0.0}, {"c", "", 0.0}}};
  for (Eigen::Index k = 0; k < 3; ++k) {
    parameters.shared[static_cast<size_t>(k)].mean = mean[k];
    parameters.shared[static_cast<size_t>(k)].sigma = sigma[k];
  }
  const ResidualModel model = linear_model(parameters, {run});
  const double found = log_evidence(fit(model, model.start(), Options::to_rounding()));
  const Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Identity(25, 25) +
      run.design * sigma.cwiseAbs2().asDiagonal() * run.design.transpose();
  const Eigen::VectorXd off = run.data - run.design * mean;
  const double expected = -0.5 * off.dot(covariance.llt().solve(off)) -
                          0.5 * std::log(covariance.fullPivLu().determinant());
  EXPECT_NEAR(found, expected, 1e-9);
}

// One strength, known to C, under a prior whose width is uniform over a grid: the sum is written
// out.
TEST(Evidence, OfAStrengthIsTheMeanOverTheWidthsOfItsPrior) {
  const double value = 3e-4, scale = 1e-3, variance = 1e-9;
  const Strengths one{{0}, {0}, {value}, {scale}};
  const double found = log_strength_evidence(one, Eigen::MatrixXd::Constant(1, 1, variance), 1);
  double mean = 0.0;
  for (int k = 0; k < 19; ++k) {
    const double width = scale * std::pow(10.0, -6.0 + 0.5 * k);
    const double v = variance + width * width;
    mean += std::exp(-0.5 * value * value / v) / std::sqrt(v) / 19.0;
  }
  EXPECT_NEAR(found, std::log(mean), 1e-9);
}

// Over many draws of truth (from the prior) and noise, squared pulls of all parameters, shared and
// own, have mean 1. The mutant: errors ten per cent too small, whose mean is 1.23.
TEST(Coverage, StandardErrorsAreTheScatterOfTheEstimates) {
  constexpr int draws = 400;
  double sum = 0.0, mutant = 0.0, squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    TwoRuns two(static_cast<uint64_t>(1000 + i));
    std::mt19937_64 random(static_cast<uint64_t>(5000 + i));
    Eigen::VectorXd truth = random_matrix(random, 7, 1);
    for (Eigen::Index k = 0; k < 7; ++k) {
      const Parameter& p = two.parameters[k];
      if (p.has_prior()) truth[k] = p.mean + p.sigma * truth[k];
    }
    Eigen::VectorXd of_run(5);
    for (Eigen::Index run = 0; run < 2; ++run) {
      of_run << truth.segment(2 * run, 2), truth.tail(3);
      LinearRun& data = two.runs[static_cast<size_t>(run)];
      data.data = data.design * of_run + random_matrix(random, data.design.rows(), 1);
    }
    const ResidualModel model = linear_model(two.parameters, two.runs);
    const Fit found = fit(model, model.start(), Options::to_rounding());
    const Covariance known = found.covariance();
    const Eigen::VectorXd off = found.at - truth;
    const double pull = off.dot(known.matrix.fullPivLu().solve(off)) / 7.0;
    sum += pull / draws;
    squares += pull * pull / draws;
    mutant += pull / 0.81 / draws;
  }
  // The mean of 400 χ² of seven degrees of freedom over seven.
  const double standard_error = std::sqrt(2.0 / 7.0 / draws);
  EXPECT_NEAR(sum, 1.0, 4.0 * standard_error);
  EXPECT_GT(std::abs(mutant - 1.0), 4.0 * standard_error);
  EXPECT_NEAR(squares - sum * sum, 2.0 / 7.0, 0.12);
}

TEST(Options, ValuesOutsideTheirRangesAreRefused) {
  for (const auto& spoil : std::vector<void (*)(Options&)>{
           [](Options& o) { o.windows = {}; }, [](Options& o) { o.windows = {1.5}; },
           [](Options& o) { o.max_iterations = 0; }, [](Options& o) { o.min_gain = -1.0; },
           [](Options& o) { o.min_gain_fraction = NAN; },
           [](Options& o) { o.min_relative_decrease = -1e-3; },
           [](Options& o) { o.initial_damping = -1e-3; }, [](Options& o) { o.min_damping = -1e-3; },
           [](Options& o) { o.max_damping = 0.0; }}) {
    Options options;
    spoil(options);
    EXPECT_THROW(options.check(), InputError);
  }
  EXPECT_NO_THROW(Options().check());
  EXPECT_NO_THROW(Options::to_rounding().check());
}

TEST(Fit, AModelThatCannotBeEvaluatedIsInfinitelyBad) {
  const ResidualModel model({{"a", "", 1.0}},
                            [](const Eigen::VectorXd&, Eigen::Index, Eigen::VectorXd& residuals,
                               Eigen::MatrixXd*) { residuals.setConstant(3, NAN); });
  const Fit found = fit(model, model.start());
  EXPECT_TRUE(std::isinf(found.chi2));
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.termination, Termination::not_evaluable);
}

}  // namespace
}  // namespace photorque::inference

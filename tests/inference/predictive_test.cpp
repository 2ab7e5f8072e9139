// The expected residual of a fit on runs that it never saw, against draws of straight lines.
#include "inference/estimator/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/inference/linear_bench.h"

namespace photorque::inference {
namespace {

// y = slope · t, t from `from` in steps of 1; each run begins with its own offset.
LinearRun line(std::mt19937_64& random, double from, Eigen::Index rows, double slope) {
  std::normal_distribution<double> normal;
  LinearRun run{Eigen::MatrixXd::Ones(rows, 2), Eigen::VectorXd(rows)};
  for (Eigen::Index i = 0; i < rows; ++i) {
    run.design(i, 1) = from + static_cast<double>(i);
    run.data[i] = slope * run.design(i, 1) + 3.0 + normal(random);
  }
  return run;
}

Fit fitted(const std::vector<LinearRun>& runs) {
  Parameters parameters;
  parameters.of_run.assign(runs.size(), {{"offset", "", 0.0}});
  parameters.shared = {{"slope", "", 0.0}};
  return fit(linear_model(parameters, runs), Eigen::VectorXd::Zero(parameters.size()),
             Options::to_rounding());
}

// The least χ² of a held-out run by its offset alone, the slope as it was fitted.
double chi2_of_held(const LinearRun& held, double slope) {
  const Eigen::VectorXd left = held.data - slope * held.design.col(1);
  return (left.array() - left.mean()).square().sum();
}

// Ten readings fitted, thirty held out: Σ (t − t̄)² = n (n² − 1)/12, so that the slope's error of
// 1/√82.5 leaves 2247.5/82.5 of χ² beside the noise.
TEST(Expected, EqualsTheMeanResidualOfLines) {
  constexpr int draws = 4000;
  constexpr double held_rows = 30.0;
  const double carried = (30.0 * 899.0 / 12.0) / (10.0 * 99.0 / 12.0) / held_rows;
  std::mt19937_64 random(5);
  double sum = 0.0, squares = 0.0;
  HeldOutPrediction predicted;
  for (int draw = 0; draw < draws; ++draw) {
    const std::vector<LinearRun> both = {line(random, 0.0, 10, 0.7), line(random, 50.0, 30, 0.7)};
    const Fit train = fitted({both[0]}), joint = fitted(both);
    predicted = predict_held_out(train, joint);
    ASSERT_NEAR(predicted.chi2_per_sample, 1.0 + carried, 1e-9);
    const double left = chi2_of_held(both[1], train.at[1]) / held_rows;
    sum += left;
    squares += left * left;
  }
  const double mean = sum / draws;
  const double error = std::sqrt((squares / draws - mean * mean) / draws);
  // The run's own offset takes one degree of freedom.
  EXPECT_NEAR(mean, 1.0 + carried - 1.0 / held_rows, 4.0 * error);
  EXPECT_GT(carried, 20.0 * error);  // it would be missed
  // χ² is that of one degree of freedom times 1 + 30 · carried, and of the others: variances 2 x².
  const double one = 1.0 + carried * held_rows,
               deviation = std::sqrt(2.0 * (one * one + held_rows - 1.0)) / held_rows;
  EXPECT_NEAR(predicted.standard_error, deviation, 1e-3 * deviation);
  // The kurtosis of χ² of one degree is 15, so that a deviation is known to √(14/n)/2 of itself.
  EXPECT_NEAR(std::sqrt(squares / draws - mean * mean), deviation,
              4.0 * std::sqrt(14.0 / draws) / 2.0 * deviation);
}

TEST(Expected, IsUnknownWhereTheFitsDoNotShareTheirParameters) {
  std::mt19937_64 random(6);
  const std::vector<LinearRun> runs = {line(random, 0.0, 10, 0.7)};
  Fit other = fitted(runs);
  other.hessian = ArrowMatrix(1, 1, 2);
  EXPECT_TRUE(std::isnan(predict_held_out(fitted(runs), other).chi2_per_sample));
}

}  // namespace
}  // namespace photorque::inference

// Elimination run by run against the same matrix as a whole.
#include "inference/estimator/arrow_matrix.h"
#include "tests/noise.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace photorque::inference {
namespace {

struct Arrow {
  static constexpr Eigen::Index runs = 4, per_run = 3, shared = 2, size = runs * per_run + shared;
  ArrowMatrix arrow{runs, per_run, shared};
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);

  // Jᵀ J of random slopes, run by run, and a prior of 1 on everything.
  explicit Arrow(uint64_t seed) {
    Noise normal(seed);
    for (Eigen::Index run = 0; run < runs; ++run) {
      Eigen::MatrixXd J(20, per_run + shared);
      for (double& x : J.reshaped()) x = normal();
      arrow.add(run, J.transpose() * J);
      Eigen::MatrixXd of_all = Eigen::MatrixXd::Zero(20, size);
      of_all.middleCols(run * per_run, per_run) = J.leftCols(per_run);
      of_all.rightCols(shared) = J.rightCols(shared);
      dense += of_all.transpose() * of_all;
    }
    for (Eigen::Index i = 0; i < size; ++i) arrow.add_to_diagonal(i, 1.0);
    dense.diagonal().array() += 1.0;
  }
};

TEST(ArrowMatrix, IsTheMatrixThatItStandsFor) {
  const Arrow a(1);
  EXPECT_LT((a.arrow.dense() - a.dense).norm(), 1e-12);
  EXPECT_LT((a.arrow.diagonal() - a.dense.diagonal()).norm(), 1e-12);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(Arrow::size, -1.0, 2.0);
  EXPECT_LT((a.arrow * x - a.dense * x).norm(), 1e-11);
  const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(Arrow::size, 0.5, 3.0);
  const Eigen::MatrixXd scaled = s.asDiagonal() * a.dense * s.asDiagonal();
  EXPECT_LT((a.arrow.scaled(s).dense() - scaled).norm(), 1e-11);
}

TEST(ArrowMatrix, SolvesAsTheWholeDoes) {
  const Arrow a(2);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(Arrow::size, -1.0, 2.0);
  const Eigen::VectorXd y = a.dense.partialPivLu().solve(x);
  EXPECT_LT((a.arrow.solve(x) - y).norm(), 1e-12);
  EXPECT_NEAR(a.arrow.log_determinant(), std::log(a.dense.determinant()), 1e-10);
  const Eigen::MatrixXd block = a.dense.inverse().bottomRightCorner(Arrow::shared, Arrow::shared);
  EXPECT_LT((a.arrow.shared_information().inverse() - block).norm(), 1e-12);
  const SumsOfRuns sums{a.arrow, x, 0.0, 0};
  const NormalSums of_shared = sums.of_shared();
  const Eigen::VectorXd tail = of_shared.matrix.partialPivLu().solve(of_shared.gradient);
  EXPECT_LT((tail - y.tail(Arrow::shared)).norm(), 1e-12);
}

// One parameter of a run and one that all share stay where they are.
TEST(ArrowMatrix, HoldsParameters) {
  const Arrow a(3);
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(Arrow::size, -1.0, 2.0);
  ArrowMatrix arrow = a.arrow;
  Eigen::MatrixXd dense = a.dense;
  for (const Eigen::Index i : {Eigen::Index{4}, Arrow::size - 1}) {
    arrow.hold(i);
    x[i] = 0.0;
    dense.row(i).setZero();
    dense.col(i).setZero();
    dense(i, i) = 1.0;
  }
  const Eigen::VectorXd y = arrow.solve(x);
  EXPECT_EQ(y[4], 0.0);
  EXPECT_EQ(y[Arrow::size - 1], 0.0);
  EXPECT_LT((y - dense.partialPivLu().solve(x)).norm(), 1e-12);
}

}  // namespace
}  // namespace photorque::inference

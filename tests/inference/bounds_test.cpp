// The cheapest way back to bounds against every way there is: of a quadratic form under bounds the
// least stands where some parameters are on a bound and the slope by all others is zero.
#include "inference/estimator/parameter.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "tests/inference/linear_bench.h"

namespace photorque::inference {
namespace {

using Eigen::Index;

Eigen::VectorXd best_of_all_active_sets(const Eigen::MatrixXd& H, const Parameters& at) {
  const Index n = at.size();
  int ways = 1;
  for (Index i = 0; i < n; ++i) ways *= 3;
  double least = infinity;
  Eigen::VectorXd best;
  for (int way = 0; way < ways; ++way) {
    Eigen::MatrixXd A = H;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    bool is_possible = true;
    int digits = way;
    for (Index i = 0; i < n; ++i, digits /= 3) {
      if (digits % 3 == 0) continue;
      const double to = (digits % 3 == 1 ? at[i].lowest : at[i].highest) - at[i].value;
      is_possible = is_possible && std::isfinite(to);
      A.row(i).setZero();
      A(i, i) = 1.0;
      right[i] = to;
    }
    if (!is_possible) continue;
    const Eigen::VectorXd step = A.fullPivLu().solve(right);
    bool is_within = true;
    for (Index i = 0; i < n; ++i) {
      const double reached = at[i].value + step[i];
      is_within = is_within && reached >= at[i].lowest - 1e-9 && reached <= at[i].highest + 1e-9;
    }
    const double cost = step.dot(H * step);
    if (!is_within || cost >= least) continue;
    least = cost;
    best = step;
  }
  return best;
}

TEST(StepToBounds, IsTheMinimumOverAllActiveSets) {
  int moved = 0, let_go = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    // Two runs of one parameter each, and four that they share.
    ArrowMatrix arrow(2, 1, 4);
    for (Index run = 0; run < 2; ++run) {
      const Eigen::MatrixXd J = random_matrix(random, 3, 5);
      arrow.add(run, J.transpose() * J);
    }
    for (Index i = 0; i < 6; ++i) arrow.add_to_diagonal(i, 0.05);
    Parameters at;
    at.of_run = {{{"bias", "", normal(random), 0.0, 1.0}},
                 {{"bias", "", normal(random), 0.0, 1.0}}};
    for (int k = 0; k < 4; ++k) {
      Parameter p{"shared", "", normal(random)};
      if (k != 3) p.lowest = 0.0;
      if (k == 1) p.highest = 0.3;
      at.shared.push_back(p);
    }
    const Eigen::VectorXd step = step_to_bounds(arrow, at);
    const Eigen::MatrixXd H = arrow.dense();
    const Eigen::VectorXd best = best_of_all_active_sets(H, at);
    EXPECT_LT((step - best).norm(), 1e-8 * (1.0 + best.norm())) << "seed " << seed;
    moved += best.norm() > 0.0 ? 1 : 0;
    // Cases where the first that is held does not stay on its bound.
    for (Index i = 0; i < 6; ++i) {
      const double reached = at[i].value + best[i];
      if (at[i].value < at[i].lowest && reached > at[i].lowest + 1e-9) ++let_go;
    }
  }
  EXPECT_GT(moved, 100);
  EXPECT_GT(let_go, 20);
}

// Three numbers whose differences are known a million times better than their sum: clamping each
// alone costs 1e11 times more than moving all of them.
TEST(StepToBounds, AdjustsCorrelatedParameters) {
  ArrowMatrix arrow(1, 0, 3);
  Eigen::MatrixXd J(4, 3);
  J << 1e6, -1e6, 0, 0, 1e6, -1e6, -1e6, 0, 1e6, 1, 1, 1;
  arrow.add(0, J.transpose() * J);
  Parameters at;
  at.of_run = {{}};
  for (const double value : {-0.5, -0.2, -0.3}) {
    Parameter p{"compliance", "", value};
    p.lowest = 0.0;
    at.shared.push_back(p);
  }
  const Eigen::VectorXd step = step_to_bounds(arrow, at);
  EXPECT_NEAR(step[0], 0.5, 1e-9);
  EXPECT_NEAR(step[1], 0.5, 1e-9);
  EXPECT_NEAR(step[2], 0.5, 1e-9);
  const Eigen::Vector3d clamped(0.5, 0.2, 0.3);
  EXPECT_LT(step.dot(arrow * step), 1e-10 * clamped.dot(arrow * clamped));
}

}  // namespace
}  // namespace photorque::inference

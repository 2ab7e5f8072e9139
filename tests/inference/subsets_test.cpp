// Gains of sets of terms, predicted about a fit, against least squares of every single set.
#include "inference/subsets.h"
#include "tests/noise.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

namespace photorque::inference {
namespace {

constexpr Eigen::Index rows = 200, groups = 5, columns = 7;
// The second and the fourth term have two strengths.
constexpr Eigen::Index first_of[groups + 1] = {0, 1, 3, 4, 6, 7};

struct Bench {
  Eigen::MatrixXd J = Eigen::MatrixXd(rows, columns);
  Eigen::VectorXd y = Eigen::VectorXd(rows);

  explicit Bench(uint64_t seed) {
    Noise normal(seed);
    for (double& x : J.reshaped()) x = normal();
    J.col(2) += 0.9 * J.col(5);  // terms that look alike
    for (double& x : y) x = normal();
    y += 3.0 * J.col(0) - 2.0 * J.col(5);
  }

  std::vector<Eigen::Index> columns_of(const std::vector<size_t>& set) const {
    std::vector<Eigen::Index> at;
    for (const size_t g : set) {
      for (Eigen::Index k = first_of[g]; k < first_of[g + 1]; ++k) at.push_back(k);
    }
    return at;
  }

  double chi2(const std::vector<size_t>& set) const {
    if (set.empty()) return y.squaredNorm();
    const Eigen::MatrixXd some = J(Eigen::all, columns_of(set));
    return (y - some * some.colPivHouseholderQr().solve(y)).squaredNorm();
  }

  // About the fit of one set.
  LinearProblem about(const std::vector<size_t>& own) const {
    Eigen::VectorXd value = Eigen::VectorXd::Zero(columns);
    if (!own.empty()) {
      const std::vector<Eigen::Index> at = columns_of(own);
      const Eigen::MatrixXd some = J(Eigen::all, at);
      value(at) = some.colPivHouseholderQr().solve(y);
    }
    LinearProblem problem{J.transpose() * J, J.transpose() * (y - J * value), {}, {}};
    for (size_t g = 0; g < groups; ++g) {
      StrengthGroup group{g, "term " + std::to_string(g), false, first_of[g], {}, {}, {}, {}};
      for (Eigen::Index k = first_of[g]; k < first_of[g + 1]; ++k) {
        group.value.push_back(value[k]);
        group.scale.push_back(1.0);
        group.lowest.push_back(-1e300);
        group.highest.push_back(1e300);
      }
      problem.groups.push_back(std::move(group));
    }
    return problem;
  }
};

TEST(Subsets, PredictTheGainOfEverySet) {
  const Bench bench(7);
  for (const std::vector<size_t>& own : {std::vector<size_t>{}, {1}, {0, 2}, {1, 3, 4}}) {
    const double now = bench.chi2(own);
    size_t sets = 0;
    for (const Subset& s : best_subsets(bench.about(own), groups, {})) {
      EXPECT_NEAR(s.gain, now - bench.chi2(s.groups), 1e-6 * bench.chi2({}));
      ++sets;
    }
    EXPECT_EQ(sets, 32u);  // the beam holds them all
  }
}

TEST(Subsets, PutTheTruthFirst) {
  EXPECT_EQ(best_subsets(Bench(7).about({1}), 4, {}).front().groups, (std::vector<size_t>{0, 3}));
}

// A term that looks like everything found, but of whose slopes the nuisances have left a millionth:
// their squares are rounding, and to explain anything with them is none.
TEST(Subsets, AllowForRounding) {
  Bench bench(7);
  LinearProblem problem = bench.about({0, 3});
  const double lost = 1e-7;
  const Eigen::VectorXd duplicate = lost * (3.0 * bench.J.col(0) - 2.0 * bench.J.col(5));
  Eigen::MatrixXd J(rows, columns + 1);
  J << bench.J, duplicate;
  problem.information = J.transpose() * J;
  problem.gradient.conservativeResize(columns + 1);
  problem.gradient[columns] = 0.0;
  problem.groups.push_back({groups, "duplicate", false, columns, {0.0}, {1.0}, {-1e300}, {1e300}});
  const auto gain_of_duplicate = [&] {
    for (const Subset& s : best_subsets(problem, 4, {})) {
      if (s.groups == std::vector<size_t>{groups}) return s.gain;
    }
    return -1e300;
  };
  const double all = bench.chi2({0, 3}) - bench.chi2({});
  EXPECT_NEAR(gain_of_duplicate(), 0.0, -0.1 * all);  // as if nothing had been lost
  problem.before = problem.information.diagonal();
  problem.before[columns] /= lost * lost;
  EXPECT_NEAR(gain_of_duplicate(), all, -0.1 * all);
}

TEST(Subsets, OmitUnphysicalSets) {
  LinearProblem problem = Bench(7).about({});
  ASSERT_EQ(best_subsets(problem, 4, {}).front().groups, (std::vector<size_t>{0, 3}));
  problem.groups[0].highest = {0.0};  // it is 3
  for (const Subset& s : best_subsets(problem, 4, {})) {
    EXPECT_TRUE(s.groups.empty() || s.groups.front() != 0u);
  }
}

}  // namespace
}  // namespace photorque::inference

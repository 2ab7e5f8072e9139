// Against certified values.
#include <gtest/gtest.h>

#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"
#include "tests/inference/nist_strd.h"

namespace photorque::inference {
namespace {

ResidualModel model_of(const NistProblem& problem, const Eigen::VectorXd& start) {
  std::vector<Parameter> parameters;
  for (Eigen::Index k = 0; k < start.size(); ++k) {
    parameters.push_back({"b" + std::to_string(k + 1), "", start[k]});
  }
  return {parameters, [problem](const Eigen::VectorXd& b, Eigen::Index, Eigen::VectorXd& residuals,
                                Eigen::MatrixXd* slopes) {
            const auto points = static_cast<Eigen::Index>(problem.x.size());
            Eigen::VectorXd row(b.size());
            residuals.resize(points);
            if (slopes != nullptr) slopes->resize(points, b.size());
            for (Eigen::Index i = 0; i < points; ++i) {
              const auto at = static_cast<size_t>(i);
              residuals[i] = problem.y[at] - problem.model(problem.x[at], b, row);
              if (slopes != nullptr) slopes->row(i) = row.transpose();
            }
          }};
}

void expect_certified(const NistProblem& problem, const Fit& found) {
  EXPECT_NEAR(found.chi2 / problem.residual_squares, 1.0, 1e-10) << problem.name;
  EXPECT_TRUE(found.covariance().undetermined.empty()) << problem.name;
  const Eigen::VectorXd errors = found.scatter_errors();
  for (Eigen::Index k = 0; k < found.at.size(); ++k) {
    EXPECT_NEAR(found.at[k] / problem.certified[k], 1.0, 1e-6) << problem.name << " b" << k + 1;
    EXPECT_NEAR(errors[k] / problem.certified_error[k], 1.0, 1e-5) << problem.name << " b" << k + 1;
  }
}

// Parameters to six of the eleven certified digits, which NIST counts as a success of any program,
// and their errors to five.
TEST(Nist, CertifiedParametersAndErrors) {
  for (const NistProblem& problem : {misra1a(), mgh17(), thurber()}) {
    for (const Eigen::VectorXd& start : problem.starts) {
      if (problem.name == "MGH17" && &start == &problem.starts.front()) continue;
      expect_certified(problem, fit(model_of(problem, start), start, Options::to_rounding()));
    }
  }
}

// From the far start of MGH17 the two exponentials become one, which sums of squares in double
// precision cannot separate again. The answer is wrong, and is reported as such.
TEST(Nist, ReportsFailures) {
  const NistProblem problem = mgh17();
  const Eigen::VectorXd& start = problem.starts.front();
  const Fit found = fit(model_of(problem, start), start, Options::to_rounding());
  EXPECT_GT(found.chi2, 1.01 * problem.residual_squares);
  EXPECT_FALSE(found.covariance().undetermined.empty());
}

}  // namespace
}  // namespace photorque::inference

// Linear models, for which every result of the estimator has a closed form.
#pragma once

#include <Eigen/Dense>
#include <random>
#include <utility>
#include <vector>

#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"

namespace photorque::inference {

// Data d = A θ + noise of unit variance; of several runs A holds the columns of the run's own
// parameters, then the shared ones.
struct LinearRun {
  Eigen::MatrixXd design;
  Eigen::VectorXd data;
};

inline ResidualModel linear_model(Parameters parameters, std::vector<LinearRun> runs) {
  return {std::move(parameters),
          [runs = std::move(runs)](const Eigen::VectorXd& values, Eigen::Index run,
                                   Eigen::VectorXd& residuals, Eigen::MatrixXd* slopes) {
            const LinearRun& of = runs[static_cast<size_t>(run)];
            residuals = of.data - of.design * values;
            if (slopes != nullptr) *slopes = of.design;
          }};
}

inline Eigen::MatrixXd random_matrix(std::mt19937_64& random, Eigen::Index rows,
                                     Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&]() { return normal(random); });
}

}  // namespace photorque::inference

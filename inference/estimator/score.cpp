#include "inference/estimator/score.h"

#include <Eigen/Cholesky>

#include "core/numerics/linear.h"

namespace photorque::inference {

Score solve_score(const Eigen::MatrixXd& S, const Eigen::VectorXd& s,
                  const Eigen::VectorXd& before) {
  Score score;
  if (s.size() == 0) return score;
  constexpr double rounding = 1e-8;
  const Eigen::VectorXd scale = inverse_roots(before, 0.0);
  const SymmetricEigen eigen = symmetric_eigen(scale.asDiagonal() * S * scale.asDiagonal());
  const Eigen::VectorXd rotated = eigen.vectors.transpose() * scale.cwiseProduct(s);
  Eigen::VectorXd solved = Eigen::VectorXd::Zero(s.size());
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    const double lambda = eigen.values[i];
    if (!(lambda > rounding)) continue;
    solved[i] = rotated[i] / lambda;
    score.gain += rotated[i] * solved[i];
  }
  score.estimate = scale.cwiseProduct(eigen.vectors * solved);
  score.information = S;
  return score;
}

Score Projected::score(Eigen::Index first, Eigen::Index count) const {
  return solve_score(information.block(first, first, count, count), gradient.segment(first, count),
                     before.segment(first, count));
}

Projected project_out(const NormalSums& sums, Eigen::Index fitted) {
  const Eigen::Index count = sums.matrix.rows() - fitted;
  const Eigen::LDLT<Eigen::MatrixXd> nuisance(sums.matrix.topLeftCorner(fitted, fitted));
  const Eigen::MatrixXd cross = sums.matrix.bottomLeftCorner(count, fitted);
  const Eigen::MatrixXd own = sums.matrix.bottomRightCorner(count, count);
  Projected result;
  result.information = own - cross * nuisance.solve(cross.transpose());
  result.gradient = sums.gradient.tail(count) -
                    cross * nuisance.solve(Eigen::VectorXd(sums.gradient.head(fitted)));
  result.before = own.diagonal();
  return result;
}

Projected project_onto(const NormalSums& sums, const std::vector<Eigen::Index>& kept) {
  std::vector<bool> is_kept(static_cast<size_t>(sums.gradient.size()), false);
  for (const Eigen::Index i : kept) is_kept[static_cast<size_t>(i)] = true;
  std::vector<Eigen::Index> order;
  for (Eigen::Index i = 0; i < sums.gradient.size(); ++i) {
    if (!is_kept[static_cast<size_t>(i)]) order.push_back(i);
  }
  const auto fitted = static_cast<Eigen::Index>(order.size());
  order.insert(order.end(), kept.begin(), kept.end());
  const NormalSums sorted{sums.matrix(order, order), sums.gradient(order), sums.chi2, sums.samples};
  return project_out(sorted, fitted);
}

Projected project_out(const SumsOfRuns& sums, Eigen::Index fitted) {
  Projected result = project_out(sums.of_shared(), fitted - sums.matrix.first_shared());
  result.before = sums.matrix.shared().diagonal().tail(result.before.size());
  return result;
}

}  // namespace photorque::inference

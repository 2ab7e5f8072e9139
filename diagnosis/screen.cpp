#include "diagnosis/screen.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "diagnosis/belief.h"

namespace photorque {
namespace {

constexpr size_t variables_at_once = 72;

std::vector<int> parameters_of(const ScoreGroup& group, const Disturbance& d) {
  if (!group.parameters.empty()) return group.parameters;
  std::vector<int> all;
  for (size_t p = 0; p < d.parameters.size(); ++p) all.push_back(static_cast<int>(p));
  return all;
}

// gᵀ S⁻¹ g in the space that the data determine at all.
Score solve(const Eigen::MatrixXd& S, const Eigen::VectorXd& g, const Eigen::VectorXd& before) {
  Score score;
  if (g.size() == 0) return score;
  // Scaled by what the information would be with nothing projected out: what is left below 1e-8 of
  // it is rounding.
  const Eigen::VectorXd scale =
      before.cwiseSqrt().unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(scale.asDiagonal() * S * scale.asDiagonal()));
  const Eigen::VectorXd rotated = eigen.eigenvectors().transpose() * scale.cwiseProduct(g);
  Eigen::VectorXd solved = Eigen::VectorXd::Zero(g.size());
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const double lambda = eigen.eigenvalues()[i];
    if (!(lambda > 1e-8)) continue;
    solved[i] = rotated[i] / lambda;
    score.gain += rotated[i] * solved[i];
  }
  score.estimate = scale.cwiseProduct(eigen.eigenvectors() * solved);
  score.information = S;
  return score;
}

void score_batch(const Fit& at, const std::vector<Observation>& runs,
                 const std::vector<ScoreGroup>& groups, size_t first, size_t last,
                 std::vector<Score>& scores) {
  Hypothesis h = at.best;
  std::vector<Free> extra;
  std::vector<Eigen::Index> begin;
  for (size_t g = first; g < last; ++g) {
    begin.push_back(static_cast<Eigen::Index>(extra.size()));
    for (const Disturbance& d : groups[g].disturbances) {
      // It would act at once.
      if (d.parameters.empty()) continue;
      const size_t index = add_disturbance(h, d);
      for (const int p : parameters_of(groups[g], d)) extra.push_back({index, p});
    }
  }
  begin.push_back(static_cast<Eigen::Index>(extra.size()));
  const NormalSums sums = sums_at(h, runs, extra);
  if (!std::isfinite(sums.chi2)) return;
  // Everything fitted, and the starts of the added disturbances' own states.
  const Eigen::Index known = sums.matrix.rows() - static_cast<Eigen::Index>(extra.size());
  const Eigen::LDLT<Eigen::MatrixXd> nuisance(sums.matrix.topLeftCorner(known, known));
  const Eigen::VectorXd settled = nuisance.solve(sums.gradient.head(known));
  for (size_t g = first; g < last; ++g) {
    const Eigen::Index a = known + begin[g - first], n = begin[g - first + 1] - begin[g - first];
    const Eigen::MatrixXd cross = sums.matrix.block(a, 0, n, known);
    const Eigen::MatrixXd own = sums.matrix.block(a, a, n, n);
    const Eigen::MatrixXd S = own - cross * nuisance.solve(cross.transpose());
    scores[g] = solve(S, sums.gradient.segment(a, n) - cross * settled, own.diagonal());
  }
}

}  // namespace

std::vector<Score> score(const Fit& at, const std::vector<Observation>& runs,
                         const std::vector<ScoreGroup>& groups) {
  std::vector<Score> scores(groups.size());
  const auto size = [&](size_t g) {
    size_t count = 0;
    for (const Disturbance& d : groups[g].disturbances) {
      count += parameters_of(groups[g], d).size();
    }
    return count;
  };
  for (size_t first = 0; first < groups.size();) {
    size_t last = first + 1, count = size(first);
    while (last < groups.size() && count + size(last) <= variables_at_once) count += size(last++);
    score_batch(at, runs, groups, first, last, scores);
    first = last;
  }
  return scores;
}

}  // namespace photorque

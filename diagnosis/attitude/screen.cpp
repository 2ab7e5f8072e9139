#include "diagnosis/attitude/screen.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "diagnosis/attitude/nominal_model.h"

namespace photorque {
namespace {

constexpr size_t variables_at_once = 72;

std::vector<int> parameters_of(const ScoreGroup& group, const Disturbance& d) {
  if (!group.parameters.empty()) return group.parameters;
  std::vector<int> all;
  for (size_t p = 0; p < d.parameters.size(); ++p) all.push_back(static_cast<int>(p));
  return all;
}

// What the data say about the parameters of some groups, everything fitted (and the starts of the
// groups' own states) projected out.
struct Projected {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient, before;  // before: the information with nothing projected out
  std::vector<Eigen::Index> begin;   // of each group's parameters, and the end
  bool known = false;                // false: it could not be propagated
};

Projected project(const Fit& at, const std::vector<Observation>& runs,
                  const std::vector<ScoreGroup>& groups, size_t first, size_t last) {
  Projected result;
  Hypothesis h = at.best;
  std::vector<Free> extra;
  for (size_t g = first; g < last; ++g) {
    result.begin.push_back(static_cast<Eigen::Index>(extra.size()));
    for (const Disturbance& d : groups[g].disturbances) {
      // It would act at once.
      if (d.parameters.empty()) continue;
      const size_t index = add_disturbance(h, d);
      for (const int p : parameters_of(groups[g], d)) extra.push_back({index, p});
    }
  }
  const auto count = static_cast<Eigen::Index>(extra.size());
  result.begin.push_back(count);
  const NormalSums sums = sums_at(h, runs, extra);
  if (!std::isfinite(sums.chi2)) return result;
  const Eigen::Index fitted = sums.matrix.rows() - count;
  const Eigen::LDLT<Eigen::MatrixXd> nuisance(sums.matrix.topLeftCorner(fitted, fitted));
  const Eigen::MatrixXd cross = sums.matrix.bottomLeftCorner(count, fitted);
  const Eigen::MatrixXd own = sums.matrix.bottomRightCorner(count, count);
  result.information = own - cross * nuisance.solve(cross.transpose());
  result.gradient = sums.gradient.tail(count) -
                    cross * nuisance.solve(Eigen::VectorXd(sums.gradient.head(fitted)));
  result.before = own.diagonal();
  result.known = true;
  return result;
}

}  // namespace

Score solve_score(const Eigen::MatrixXd& S, const Eigen::VectorXd& g,
                  const Eigen::VectorXd& before) {
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
    const Projected all = project(at, runs, groups, first, last);
    for (size_t g = first; all.known && g < last; ++g) {
      const Eigen::Index a = all.begin[g - first], n = all.begin[g - first + 1] - a;
      scores[g] = solve_score(all.information.block(a, a, n, n), all.gradient.segment(a, n),
                              all.before.segment(a, n));
    }
    first = last;
  }
  return scores;
}

Eigen::MatrixXd score_pairs(const Fit& at, const std::vector<Observation>& runs,
                            const std::vector<ScoreGroup>& groups) {
  const auto count = static_cast<Eigen::Index>(groups.size());
  Eigen::MatrixXd gains = Eigen::MatrixXd::Zero(count, count);
  const Projected all = project(at, runs, groups, 0, groups.size());
  if (!all.known) return gains;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = i; j < count; ++j) {
      std::vector<Eigen::Index> both;
      for (const Eigen::Index g : {i, j}) {
        const auto at_group = static_cast<size_t>(g);
        for (Eigen::Index p = all.begin[at_group]; p < all.begin[at_group + 1]; ++p) {
          both.push_back(p);
        }
        if (i == j) break;
      }
      gains(i, j) = gains(j, i) =
          solve_score(all.information(both, both), all.gradient(both), all.before(both)).gain;
    }
  }
  return gains;
}

}  // namespace photorque

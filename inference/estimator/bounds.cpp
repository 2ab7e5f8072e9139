#include "inference/estimator/bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace photorque::inference {
namespace {

// The step of all others that costs least where some are held at steps of their own.
Eigen::VectorXd step_beside(const ArrowMatrix& information, const Eigen::VectorXd& scale,
                            const std::vector<Eigen::Index>& held, const Eigen::VectorXd& to) {
  ArrowMatrix scaled = information.scaled(scale);
  Eigen::VectorXd fixed = Eigen::VectorXd::Zero(scale.size());
  for (const Eigen::Index i : held) fixed[i] = to[i] / scale[i];
  Eigen::VectorXd right = -(scaled * fixed);
  for (const Eigen::Index i : held) {
    scaled.hold(i);
    right[i] = fixed[i];
  }
  return scale.cwiseProduct(scaled.solve(right));
}

}  // namespace

Eigen::VectorXd step_to_bounds(const ArrowMatrix& information, const Parameters& at) {
  const Eigen::Index n = at.size();
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().unaryExpr(
      [](double s) { return s > 0.0 ? 1.0 / s : 1.0; });
  Eigen::VectorXd step = Eigen::VectorXd::Zero(n), to = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> held;
  // Each turn holds the one that is furthest beyond, or lets go the one that pulls most to within;
  // the limit is for a set that would turn in circles by rounding.
  for (Eigen::Index turn = 0; turn < 3 * n; ++turn) {
    Eigen::Index changed = -1;
    double most = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (std::ranges::find(held, i) != held.end()) continue;
      const double reached = at[i].value + step[i];
      const double back = std::clamp(reached, at[i].lowest, at[i].highest) - reached;
      if (std::abs(back) / scale[i] <= most) continue;
      most = std::abs(back) / scale[i];
      changed = i;
      to[i] = step[i] + back;
    }
    if (changed >= 0) {
      held.push_back(changed);
    } else {
      const Eigen::VectorXd slope = information * step;
      for (const Eigen::Index i : held) {
        // Half of how χ² falls, in standard errors, on the way from the bound to within.
        const bool is_low = at[i].value + to[i] <= at[i].lowest;
        const double falls = (is_low ? -slope[i] : slope[i]) * scale[i];
        constexpr double rounding = 1e-6;
        if (falls <= std::max(most, rounding)) continue;
        most = falls;
        changed = i;
      }
      if (changed < 0) return step;
      std::erase(held, changed);
    }
    step = step_beside(information, scale, held, to);
    if (!step.allFinite()) return Eigen::VectorXd::Zero(n);
  }
  return step;
}

}  // namespace photorque::inference

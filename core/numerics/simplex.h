// The minimum of a function of a few variables, without derivatives.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace photorque {

struct Minimum {
  Eigen::VectorXd at;
  double value = 0.0;
};

// The downhill simplex of Nelder and Mead (The Computer Journal 7, 308, 1965). It starts from
// `start` and the points one `step` away along each axis, and ends when the values at the corners
// are within `tolerance`. The minimum is local; f may be infinite away from the start.
template <typename Function>
Minimum simplex_minimum(const Function& f, const Eigen::VectorXd& start,
                        const Eigen::VectorXd& step, double tolerance, int max_evaluations = 400) {
  std::vector<Minimum> corners = {{start, f(start)}};
  for (Eigen::Index k = 0; k < start.size(); ++k) {
    Eigen::VectorXd at = start;
    at[k] += step[k];
    corners.push_back({at, f(at)});
  }
  int evaluations = static_cast<int>(corners.size());
  const auto better = [](const Minimum& a, const Minimum& b) { return a.value < b.value; };
  for (;;) {
    std::stable_sort(corners.begin(), corners.end(), better);
    Minimum& worst = corners.back();
    if (evaluations >= max_evaluations || worst.value - corners.front().value < tolerance) break;
    Eigen::VectorXd middle = Eigen::VectorXd::Zero(start.size());
    for (size_t c = 0; c + 1 < corners.size(); ++c) middle += corners[c].at;
    middle /= static_cast<double>(corners.size() - 1);
    const auto along = [&](double x) {
      Minimum point{middle + x * (worst.at - middle), 0.0};
      point.value = f(point.at);
      ++evaluations;
      return point;
    };
    const Minimum reflected = along(-1.0);
    if (better(reflected, corners.front())) {
      const Minimum farther = along(-2.0);
      worst = better(farther, reflected) ? farther : reflected;
      continue;
    }
    if (better(reflected, corners[corners.size() - 2])) {
      worst = reflected;
      continue;
    }
    const Minimum nearer = along(better(reflected, worst) ? -0.5 : 0.5);
    if (better(nearer, better(reflected, worst) ? reflected : worst)) {
      worst = nearer;
      continue;
    }
    for (size_t c = 1; c < corners.size(); ++c) {
      corners[c].at = 0.5 * (corners[c].at + corners.front().at);
      corners[c].value = f(corners[c].at);
      ++evaluations;
    }
  }
  return corners.front();
}

// Standard errors if f is −2 times the logarithm of a likelihood, from the curvature of f at the
// minimum by differences with `step`. Infinite if f is not finite near the minimum or the variance
// is not positive; about 32 for a parameter without curvature.
template <typename Function>
Eigen::VectorXd likelihood_errors(const Function& f, const Minimum& minimum, double step = 0.05) {
  const Eigen::Index n = minimum.at.size();
  Eigen::MatrixXd curvature(n, n);
  const auto at = [&](Eigen::Index i, double by, Eigen::Index j, double and_by) {
    Eigen::VectorXd x = minimum.at;
    x[i] += by * step;
    x[j] += and_by * step;
    return f(x);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double second =
          i == j ? at(i, 1, i, 0) - 2.0 * minimum.value + at(i, -1, i, 0)
                 : 0.25 * (at(i, 1, j, 1) - at(i, 1, j, -1) - at(i, -1, j, 1) + at(i, -1, j, -1));
      curvature(i, j) = curvature(j, i) = 0.5 * second / (step * step);
    }
  }
  if (!curvature.allFinite()) return Eigen::VectorXd::Constant(n, INFINITY);
  // A direction in which f is constant must not affect the errors of the others.
  curvature.diagonal().array() += 1e-3;
  const Eigen::VectorXd variance = curvature.inverse().diagonal();
  return variance.unaryExpr([](double v) { return v > 0.0 ? std::sqrt(v) : INFINITY; });
}

}  // namespace photorque

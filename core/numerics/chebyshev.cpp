#include "core/numerics/chebyshev.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/constants.h"

namespace photorque {
namespace {

// ∫ T_k up to x and up to a constant, for k = 0 … n − 1.
// Source: NIST DLMF 18.17.1 in the form ½ (T_{k+1}/(k+1) − T_{k−1}/(k−1)).
std::vector<double> antiderivatives(size_t n, double x) {
  std::vector<double> t = {1.0, x}, result;
  while (t.size() < n + 1) t.push_back(2.0 * x * t[t.size() - 1] - t[t.size() - 2]);
  for (size_t k = 0; k < n; ++k) {
    const auto order = static_cast<double>(k);
    if (k == 0) result.push_back(x);
    if (k == 1) result.push_back(0.5 * x * x);
    if (k > 1) result.push_back(0.5 * (t[k + 1] / (order + 1.0) - t[k - 1] / (order - 1.0)));
  }
  return result;
}

}  // namespace

double chebyshev_point(size_t n, size_t i) {
  return std::cos(pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
}

double chebyshev_fraction(size_t n, size_t i) {
  return 0.5 - 0.5 * chebyshev_point(n, i);
}

double chebyshev_weight(size_t n, size_t k, double angle_rad) {
  return (k == 0 ? 1.0 : 2.0) / static_cast<double>(n) *
         std::cos(static_cast<double>(k) * angle_rad);
}

Eigen::MatrixXd chebyshev_coefficients(size_t n) {
  const auto points = static_cast<Eigen::Index>(n);
  Eigen::MatrixXd coefficients(points, points);
  for (Eigen::Index i = 0; i < points; ++i) {
    const double angle = pi * (1.0 - (static_cast<double>(i) + 0.5) / static_cast<double>(n));
    for (Eigen::Index k = 0; k < points; ++k) {
      coefficients(k, i) = chebyshev_weight(n, static_cast<size_t>(k), angle);
    }
  }
  return coefficients;
}

Eigen::MatrixXd chebyshev_cell_means(size_t n, size_t cells) {
  const auto points = static_cast<Eigen::Index>(n), parts = static_cast<Eigen::Index>(cells);
  Eigen::MatrixXd means(parts, points);
  const double width = 2.0 / static_cast<double>(cells);
  std::vector<double> before = antiderivatives(n, -1.0);
  for (Eigen::Index c = 0; c < parts; ++c) {
    std::vector<double> after = antiderivatives(n, width * static_cast<double>(c + 1) - 1.0);
    for (Eigen::Index k = 0; k < points; ++k) {
      const auto order = static_cast<size_t>(k);
      means(c, k) = (after[order] - before[order]) / width;
    }
    before = std::move(after);
  }
  return means * chebyshev_coefficients(n);
}

}  // namespace photorque

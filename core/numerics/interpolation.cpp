#include "core/numerics/interpolation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/constants.h"

namespace photorque {
namespace {

// Antiderivatives of T_k at x, up to a constant, for k = 0 … n − 1.
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

Eigen::MatrixXd chebyshev_term_means(size_t n, size_t cells) {
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
  return means;
}

namespace {

// The derivative at knot `k` of the polynomial through the knots first … last: the derivative of
// each Lagrange polynomial there.
double polynomial_slope(std::span<const double> x, std::span<const double> y, size_t k,
                        size_t first, size_t last) {
  double slope = 0.0;
  for (size_t i = first; i <= last; ++i) {
    if (i == k) continue;
    double weight = 1.0 / (x[i] - x[k]);
    for (size_t m = first; m <= last; ++m) {
      if (m != i && m != k) weight *= (x[k] - x[m]) / (x[i] - x[m]);
    }
    slope += weight * (y[i] - y[k]);
  }
  return slope;
}

double cut(double slope, double chord) {
  return chord > 0.0 ? std::clamp(slope, 0.0, 3.0 * chord) : std::clamp(slope, 3.0 * chord, 0.0);
}

// Whether all values are positive and none is more than a hundred times its neighbour.
bool changes_steadily(std::span<const double> y) {
  constexpr double most = 100.0;
  for (size_t k = 0; k < y.size(); ++k) {
    if (!(y[k] > 0.0)) return false;
    if (k > 0 && (y[k] > most * y[k - 1] || y[k - 1] > most * y[k])) return false;
  }
  return true;
}

}  // namespace

std::vector<double> monotone_slopes(std::span<const double> x, std::span<const double> y) {
  const size_t last = x.size() - 1;
  const auto chord = [&](size_t i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
  std::vector<double> slopes(x.size());
  for (size_t k = 0; k <= last; ++k) {
    const size_t first = k < 2 ? 0 : k - 2;
    double slope = polynomial_slope(x, y, k, first, std::min(last, k + 2));
    if (k > 0) slope = cut(slope, chord(k - 1));
    if (k < last) slope = cut(slope, chord(k));
    slopes[k] = slope;
  }
  return slopes;
}

double monotone_middle(std::span<const double> x, std::span<const double> y, size_t i) {
  const size_t first = i < 2 ? 0 : i - 2, last = std::min(x.size() - 1, i + 3);
  const bool steep = y[i] > 2.0 * y[i + 1] || y[i + 1] > 2.0 * y[i];
  const bool by_logarithm = steep && changes_steadily(y.subspan(first, last + 1 - first));
  const double middle = 0.5 * (x[i] + x[i + 1]);
  double value = 0.0;
  for (size_t k = first; k <= last; ++k) {
    double weight = 1.0;
    for (size_t m = first; m <= last; ++m) {
      if (m != k) weight *= (middle - x[m]) / (x[k] - x[m]);
    }
    value += weight * (by_logarithm ? std::log(y[k]) : y[k]);
  }
  if (by_logarithm) value = std::exp(value);
  const double low = std::lerp(y[i], y[i + 1], 0.125), high = std::lerp(y[i], y[i + 1], 0.875);
  return low < high ? std::clamp(value, low, high) : std::clamp(value, high, low);
}

}  // namespace photorque

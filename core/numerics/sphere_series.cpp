#include "core/numerics/sphere_series.h"

#include <cmath>

#include "core/constants.h"
#include "core/numerics/linear.h"

namespace photorque {
namespace {

// The number of coefficients of order m, and the index of the first one among those of one kind.
Eigen::Index count_of(int degree, int m) {
  return degree - m + 1;
}
Eigen::Index first_of(int degree, int m) {
  Eigen::Index first = 0;
  for (int k = 0; k < m; ++k) first += count_of(degree, k);
  return first;
}

// P̄_lm at one elevation for all l from m to `degree`. Source: S. A. Holmes, W. E. Featherstone,
// Journal of Geodesy 76 (2002), eqs. 11 to 13 (the standard forward columns; cos^m underflows only
// where it is negligible).
Eigen::VectorXd legendre(int degree, int m, double elevation_rad) {
  const double sine = std::sin(elevation_rad), cosine = std::cos(elevation_rad);
  double sectorial = 1.0;
  for (int k = 1; k <= m; ++k) {
    sectorial *= cosine * (k == 1 ? std::sqrt(3.0) : std::sqrt((2.0 * k + 1.0) / (2.0 * k)));
  }
  Eigen::VectorXd p(count_of(degree, m));
  p[0] = sectorial;
  if (degree > m) p[1] = std::sqrt(2.0 * m + 3.0) * sine * sectorial;
  for (int l = m + 2; l <= degree; ++l) {
    const double a = std::sqrt((2.0 * l - 1.0) * (2.0 * l + 1.0) / ((l - m) * 1.0 * (l + m)));
    const double b = std::sqrt((2.0 * l + 1.0) * (l + m - 1.0) * (l - m - 1.0) /
                               ((l - m) * 1.0 * (l + m) * (2.0 * l - 3.0)));
    p[l - m] = a * sine * p[l - m - 1] - b * p[l - m - 2];
  }
  return p;
}

// Square root of the area that a node of each ring represents.
Eigen::VectorXd ring_weights(std::span<const double> elevation_rad) {
  constexpr double pole = 0.5 * pi;
  const size_t count = elevation_rad.size();
  Eigen::VectorXd weights(static_cast<Eigen::Index>(count));
  for (size_t e = 0; e < count; ++e) {
    const double low = e == 0 ? -pole : 0.5 * (elevation_rad[e - 1] + elevation_rad[e]);
    const double high = e + 1 == count ? pole : 0.5 * (elevation_rad[e] + elevation_rad[e + 1]);
    weights[static_cast<Eigen::Index>(e)] = std::sqrt(std::sin(high) - std::sin(low));
  }
  return weights;
}

}  // namespace

SphereSeries SphereSeries::fit(int degree, std::span<const double> azimuth_rad,
                               std::span<const double> elevation_rad,
                               const Eigen::MatrixXd& values) {
  const auto rings = static_cast<Eigen::Index>(elevation_rad.size());
  const auto around = static_cast<Eigen::Index>(azimuth_rad.size());
  const Eigen::VectorXd weights = ring_weights(elevation_rad);
  const Eigen::Index kind = first_of(degree, degree + 1);
  SphereSeries series;
  series.degree_ = degree;
  series.coefficients_ = Eigen::MatrixXd::Zero(2 * kind, values.cols());
  for (int m = 0; m <= degree; ++m) {
    // Evenly spaced azimuths make the orders independent.
    Eigen::MatrixXd cosines = Eigen::MatrixXd::Zero(rings, values.cols()), sines = cosines;
    const double scale = (m == 0 ? 1.0 : 2.0) / static_cast<double>(around);
    for (Eigen::Index a = 0; a < around; ++a) {
      const double angle = m * azimuth_rad[static_cast<size_t>(a)];
      const auto ring_values = values.middleRows(a * rings, rings);
      cosines += scale * std::cos(angle) * ring_values;
      sines += scale * std::sin(angle) * ring_values;
    }
    Eigen::MatrixXd basis(rings, count_of(degree, m));
    for (Eigen::Index e = 0; e < rings; ++e) {
      basis.row(e) =
          weights[e] * legendre(degree, m, elevation_rad[static_cast<size_t>(e)]).transpose();
    }
    const Eigen::Index first = first_of(degree, m), count = count_of(degree, m);
    Eigen::MatrixXd both(rings, cosines.cols() + sines.cols());
    both << cosines, sines;
    const Eigen::MatrixXd solved = least_squares(basis, weights.asDiagonal() * both).solution;
    series.coefficients_.middleRows(first, count) = solved.leftCols(cosines.cols());
    if (m == 0) continue;
    series.coefficients_.middleRows(kind + first, count) = solved.rightCols(sines.cols());
  }
  return series;
}

Eigen::MatrixXd SphereSeries::on_grid(std::span<const double> azimuth_rad,
                                      std::span<const double> elevation_rad) const {
  const auto rings = static_cast<Eigen::Index>(elevation_rad.size());
  const auto around = static_cast<Eigen::Index>(azimuth_rad.size());
  const Eigen::Index kind = first_of(degree_, degree_ + 1);
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(around * rings, coefficients_.cols());
  for (int m = 0; m <= degree_; ++m) {
    const Eigen::Index first = first_of(degree_, m), count = count_of(degree_, m);
    Eigen::MatrixXd basis(rings, count);
    for (Eigen::Index e = 0; e < rings; ++e) {
      basis.row(e) = legendre(degree_, m, elevation_rad[static_cast<size_t>(e)]).transpose();
    }
    const Eigen::MatrixXd cosines = basis * coefficients_.middleRows(first, count);
    const Eigen::MatrixXd sines = basis * coefficients_.middleRows(kind + first, count);
    for (Eigen::Index a = 0; a < around; ++a) {
      const double angle = m * azimuth_rad[static_cast<size_t>(a)];
      values.middleRows(a * rings, rings) += std::cos(angle) * cosines + std::sin(angle) * sines;
    }
  }
  return values;
}

double SphereSeries::mean_product(int of_degree, Eigen::Index first, Eigen::Index second) const {
  const Eigen::Index kind = first_of(degree_, degree_ + 1);
  double sum = 0.0;
  for (int m = 0; m <= of_degree; ++m) {
    const Eigen::Index row = first_of(degree_, m) + of_degree - m;
    for (const Eigen::Index i : {row, kind + row}) {
      sum += coefficients_(i, first) * coefficients_(i, second);
    }
  }
  return sum;
}

SphereSeries SphereSeries::combined(const Eigen::MatrixXd& mix) const {
  SphereSeries series;
  series.degree_ = degree_;
  series.coefficients_ = coefficients_ * mix;
  return series;
}

void SphereSeries::scale(int of_degree, Eigen::Index function, double factor) {
  const Eigen::Index kind = first_of(degree_, degree_ + 1);
  for (int m = 0; m <= of_degree; ++m) {
    const Eigen::Index row = first_of(degree_, m) + of_degree - m;
    coefficients_(row, function) *= factor;
    coefficients_(kind + row, function) *= factor;
  }
}

Eigen::VectorXd SphereSeries::at(double azimuth_rad, double elevation_rad) const {
  return on_grid(std::span(&azimuth_rad, 1), std::span(&elevation_rad, 1)).row(0).transpose();
}

}  // namespace photorque

#include "receivers/wrench/smoothing.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr Eigen::Index per_wrench = std::tuple_size_v<WrenchComponents>;

// Azimuths without the last one if it repeats the first.
std::span<const double> once_around(const std::vector<double>& around_rad) {
  const bool closed = std::abs(around_rad.back() - around_rad.front() - 2.0 * pi) < 1e-9;
  return std::span(around_rad).first(around_rad.size() - (closed ? 1 : 0));
}

// Matrix with one row per node; six columns for each of the two estimates.
Eigen::MatrixXd values_of(std::span<const WrenchPair> wrenches, size_t nodes) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(nodes), 2 * per_wrench);
  for (size_t n = 0; n < nodes; ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    for (Eigen::Index k = 0; k < per_wrench; ++k) {
      values(row, k) = wrenches[n].first[static_cast<size_t>(k)];
      values(row, per_wrench + k) = wrenches[n].second[static_cast<size_t>(k)];
    }
  }
  return values;
}

// Mean over the sphere of the product of both estimates' remainders beyond the series.
double unresolved(const Eigen::MatrixXd& rest, std::span<const double> elevation_rad,
                  Eigen::Index k) {
  double sum = 0.0, weights = 0.0;
  const auto rings = static_cast<Eigen::Index>(elevation_rad.size());
  for (Eigen::Index n = 0; n < rest.rows(); ++n) {
    const double weight = std::cos(elevation_rad[static_cast<size_t>(n % rings)]);
    sum += weight * rest(n, k) * rest(n, per_wrench + k);
    weights += weight;
  }
  return std::max(0.0, sum / weights);
}

// Common power and noise power of both estimates in one degree, for their mean.
struct Powers {
  double common = 0.0, noise = 0.0;
};

Powers powers_of(const SphereSeries& halves, int degree, Eigen::Index from) {
  // Force and torque have three components each, which share one factor.
  Powers powers;
  for (Eigen::Index k = from; k < from + 3; ++k) {
    const double both = halves.mean_product(degree, k, per_wrench + k);
    const double first = halves.mean_product(degree, k, k);
    const double second = halves.mean_product(degree, per_wrench + k, per_wrench + k);
    powers.common += both;
    powers.noise += 0.25 * (first + second - 2.0 * both);
  }
  powers.common = std::max(powers.common, 0.0);
  return powers;
}

}  // namespace

SmoothWrench smooth_over_sphere(const WrenchTable& table, std::span<const WrenchPair> wrenches) {
  const auto azimuths = once_around(table.around_rad);
  const std::span<const double> elevations = table.polar_rad;
  constexpr size_t highest = 60;
  const size_t degree = std::min(
      {highest, (azimuths.size() - 1) / 2, elevations.size() > 2 ? elevations.size() - 2 : 0});
  const Eigen::MatrixXd values = values_of(wrenches, azimuths.size() * elevations.size());
  const SphereSeries halves =
      SphereSeries::fit(static_cast<int>(degree), azimuths, elevations, values);
  const Eigen::MatrixXd rest = values - halves.on_grid(azimuths, elevations);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(2 * per_wrench, per_wrench);
  for (Eigen::Index k = 0; k < per_wrench; ++k) mean(k, k) = mean(per_wrench + k, k) = 0.5;

  SmoothWrench smooth{halves.combined(mean), {}, {}};
  for (const Eigen::Index from : {Eigen::Index{0}, Eigen::Index{3}}) {
    double squares = 0.0;
    for (int l = 0; l <= halves.degree(); ++l) {
      const Powers powers = powers_of(halves, l, from);
      const double all = powers.common + powers.noise;
      const double kept = all > 0.0 ? powers.common / all : 0.0;
      squares += std::pow(1.0 - kept, 2) * powers.common + kept * kept * powers.noise;
      for (Eigen::Index k = from; k < from + 3; ++k) smooth.series.scale(l, k, kept);
    }
    for (Eigen::Index k = from; k < from + 3; ++k) {
      smooth.error[static_cast<size_t>(k)] =
          std::sqrt(squares / 3.0 + unresolved(rest, elevations, k));
    }
  }
  const Eigen::MatrixXd nodes = smooth.series.on_grid(table.around_rad, elevations);
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    for (Eigen::Index k = 0; k < per_wrench; ++k) smooth.at_node.push_back(nodes(n, k));
  }
  return smooth;
}

}  // namespace photorque

// A function of a direction as a sum of spherical harmonics: smooth, and single-valued at the
// poles.
//
// f = Σ over l ≤ degree, m ≤ l of P̄_lm(sin elevation) (a_lm cos m azimuth + b_lm sin m azimuth),
// with Legendre functions normalised to a mean square of one over the sphere.
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/transform.h"

namespace photorque {

class SphereSeries {
 public:
  // Least-squares fit, weighted by the area that each node represents. `azimuth_rad`: evenly spaced
  // over a full turn, each once, at least 2 · degree + 1. `elevation_rad`: ascending, within ±π/2,
  // more than `degree`. `values` has a row for each node, elevation by elevation within azimuth by
  // azimuth, and a column for each function.
  static SphereSeries fit(int degree, std::span<const double> azimuth_rad,
                          std::span<const double> elevation_rad, const Eigen::MatrixXd& values);

  int degree() const { return degree_; }
  Eigen::Index functions() const { return coefficients_.cols(); }
  // The mean over the sphere of the product of two functions' parts of one degree.
  double mean_product(int of_degree, Eigen::Index first, Eigen::Index second) const;
  // Linear combinations of these functions, with the coefficients in the columns of `mix`.
  SphereSeries combined(const Eigen::MatrixXd& mix) const;
  // Multiplies a function's part of one degree.
  void scale(int of_degree, Eigen::Index function, double factor);
  // All functions at every node of a grid, in the order of fit().
  Eigen::MatrixXd on_grid(std::span<const double> azimuth_rad,
                          std::span<const double> elevation_rad) const;
  // All functions in one direction.
  Eigen::VectorXd at(double azimuth_rad, double elevation_rad) const;

 private:
  int degree_ = 0;
  Eigen::MatrixXd coefficients_;  // a_lm, then b_lm, order by order; a column for each function
};

}  // namespace photorque

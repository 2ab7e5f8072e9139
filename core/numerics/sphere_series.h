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
  // By least squares with weights for the area that each node stands for. `azimuth_rad`: evenly all
  // round, each once, at least 2 · degree + 1; `elevation_rad`: rising, within ±π/2, more than
  // `degree`. A row of `values` for each node, elevation by elevation within azimuth by azimuth; a
  // column for each function.
  static SphereSeries fit(int degree, std::span<const double> azimuth_rad,
                          std::span<const double> elevation_rad, const Eigen::MatrixXd& values);

  int degree() const { return degree_; }
  Eigen::Index functions() const { return coefficients_.cols(); }
  // The mean over the sphere of the product of two functions' parts of one degree.
  double mean_product(int of_degree, Eigen::Index first, Eigen::Index second) const;
  // The functions that the columns of `mix` make of these.
  SphereSeries combined(const Eigen::MatrixXd& mix) const;
  // Multiplies a function's part of one degree.
  void scale(int of_degree, Eigen::Index function, double factor);
  // All functions at every node of such a grid.
  Eigen::MatrixXd on_grid(std::span<const double> azimuth_rad,
                          std::span<const double> elevation_rad) const;
  // All functions in one direction.
  Eigen::VectorXd at(double azimuth_rad, double elevation_rad) const;

 private:
  int degree_ = 0;
  Eigen::MatrixXd coefficients_;  // a_lm, then b_lm, order by order; a column for each function
};

}  // namespace photorque

#include "sources/profiles/sampling.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/interpolation.h"
#include "core/numerics/quadrature.h"
#include "core/numerics/vector_math.h"

namespace photorque {

void fill_disc(double radius_m, const FractionBlock& radial, const FractionBlock& turn,
               VectorBlock& point_m) {
  const auto radius = static_cast<float>(radius_m);
  for (int i = 0; i < ray_block; ++i) {
    const float r_m = radius * std::sqrt(single_fraction(radial[i]));
    const SingleCirclePoint azimuth = single_circle_point(turn[i]);
    point_m[0][i] = r_m * azimuth.cos;
    point_m[1][i] = r_m * azimuth.sin;
    point_m[2][i] = 0.0f;
  }
}

void fill_directions(const ValueBlock& rise, const FractionBlock& turn, VectorBlock& direction) {
  for (int i = 0; i < ray_block; ++i) {
    const float sine = std::sqrt(rise[i] * (2.0f - rise[i]));
    const SingleCirclePoint azimuth = single_circle_point(turn[i]);
    direction[0][i] = sine * azimuth.cos;
    direction[1][i] = sine * azimuth.sin;
    direction[2][i] = 1.0f - rise[i];
  }
}

// Cubic between two knots of a plane.
struct PlaneSampler::Curve {
  double from_rad, width_rad;
  double low, slope_low, high, slope_high;

  double operator()(double polar_rad) const {
    return std::max(0.0, hermite(width_rad, low, slope_low, high, slope_high,
                                 (polar_rad - from_rad) / width_rad));
  }
};

namespace {

constexpr int deepest_cell = 16;

template <typename Intensity>
double flux_between(const Intensity& intensity, double low_rad, double high_rad) {
  return integrate(
      gauss_8, [&](double t) { return intensity(t) * std::sin(t); }, low_rad, high_rad);
}

}  // namespace

PlaneSampler::PlaneSampler(const std::vector<double>& polar_rad, const double* intensity,
                           const double* slope) {
  std::vector<Curve> curves;
  for (size_t i = 0; i + 1 < polar_rad.size(); ++i) {
    curves.push_back({polar_rad[i], polar_rad[i + 1] - polar_rad[i], intensity[i], slope[i],
                      intensity[i + 1], slope[i + 1]});
    flux_ += flux_between(curves.back(), polar_rad[i], polar_rad[i + 1]);
  }
  if (!(flux_ > 0.0)) return;
  for (size_t i = 0; i < curves.size(); ++i) {
    add(curves[i], polar_rad[i], polar_rad[i + 1], flux_, deepest_cell);
  }
  find_fractions();
}

PlaneSampler::PlaneSampler(const std::vector<RadialPiece>& pieces) {
  double rough = 0.0;
  for (const RadialPiece& piece : pieces) {
    rough += flux_between(piece.intensity, piece.from_rad, piece.to_rad);
  }
  for (const RadialPiece& piece : pieces) {
    add(piece.intensity, piece.from_rad, piece.to_rad, rough, deepest_cell);
  }
  for (const Cell& cell : cells_) flux_ += cell.before;
  if (flux_ > 0.0) find_fractions();
}

// Converts the `before` of each cell from its flux (see add()) to the fraction of the flux below
// it, and builds the lookup table.
void PlaneSampler::find_fractions() {
  double before = 0.0;
  for (Cell& cell : cells_) {
    const double fraction = cell.before / flux_;
    cell.before = before;
    const double scale = fraction / (0.5 * (cell.low + cell.high) * cell.width);
    cell.low *= scale;
    cell.high *= scale;
    before += fraction;
  }
  index_.build(cells_, 2 * cells_.size());
}

// Appends cells for an interval. Cell::before temporarily stores the cell's flux.
template <typename Intensity>
void PlaneSampler::add(const Intensity& curve, double low_rad, double high_rad, double plane_flux,
                       int depth) {
  const double flux = flux_between(curve, low_rad, high_rad);
  if (!(flux > 0.0)) return;
  const double rise = rise_at(low_rad), width = rise_at(high_rad) - rise;
  const double low = curve(low_rad), high = curve(high_rad);
  const double trapezium = 0.5 * (low + high) * width;
  // Error of the cell's flux below a point with the linear density. It is tested at two points,
  // because a cubic may agree with a straight line in the middle.
  const auto error = [&](double part) {
    const double at_rad = low_rad + part * (high_rad - low_rad);
    const double t = (rise_at(at_rad) - rise) / width;
    const double linear = t * (low + 0.5 * t * (high - low)) * width * (flux / trapezium);
    return std::abs(linear - flux_between(curve, low_rad, at_rad));
  };
  if (depth > 0 && !(std::max(error(1.0 / 3.0), error(2.0 / 3.0)) <= cell_error * plane_flux)) {
    const double middle_rad = 0.5 * (low_rad + high_rad);
    add(curve, low_rad, middle_rad, plane_flux, depth - 1);
    add(curve, middle_rad, high_rad, plane_flux, depth - 1);
    return;
  }
  if (trapezium > 0.0) cells_.push_back({flux, rise, width, low, high});
}

double PlaneSampler::rise(double fraction) const {
  const Cell& cell = index_.find(cells_, fraction);
  // Solves fraction − before = width (low t + (high − low) t²/2) in the form without cancellation.
  const double a = std::max(0.0, (fraction - cell.before) / cell.width);
  const double root =
      std::sqrt(std::max(0.0, cell.low * cell.low + 2.0 * (cell.high - cell.low) * a));
  const double sum = cell.low + root;
  const double t = sum > 0.0 ? std::min(1.0, 2.0 * a / sum) : 0.0;
  return cell.rise + t * cell.width;
}

}  // namespace photorque

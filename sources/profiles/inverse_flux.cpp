#include "sources/profiles/inverse_flux.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/interpolation.h"
#include "core/numerics/quadrature.h"
#include "sources/profiles/sampling.h"

namespace photorque {
namespace {

constexpr double allowed_error = 1e-6;

// Flux outside a cone, ∫_h^end I dh, by Gauss–Legendre quadrature on equal panels of the rise.
// Summed from the edge inwards, so that small fractions far from the axis keep their relative
// precision.
class FluxOutside {
 public:
  explicit FluxOutside(const AngularProfile& profile) : profile_(profile) {
    width_ = rise_at(profile.end_rad) / panels;
    outside_.assign(panels + 1, 0.0);
    for (size_t j = panels; j-- > 0;) {
      outside_[j] = outside_[j + 1] + integral(edge(j), edge(j + 1));
    }
  }

  double total() const { return outside_[0]; }

  double intensity(double rise) const {
    return profile_.intensity(2.0 * std::asin(std::sqrt(0.5 * rise)));
  }

  double operator()(double rise) const {
    const auto j = static_cast<size_t>(std::clamp(rise / width_, 0.0, panels - 1.0));
    return outside_[j + 1] + integral(rise, edge(j + 1));
  }

  // Rise outside which `flux` ∈ (0, total) lies, exact to rounding: Newton's method, kept inside
  // the panel by bisection. newton_root() is less exact by a few bits: when rounding stops its
  // steps from shrinking, it bisects.
  double inverse(double flux) const {
    const auto below = std::lower_bound(outside_.rbegin(), outside_.rend(), flux);
    const auto j = std::min<size_t>(static_cast<size_t>(outside_.rend() - below) - 1, panels - 1);
    double low = edge(j), high = edge(j + 1);
    double rise = 0.5 * (low + high);
    for (int step = 0; step < 60; ++step) {
      const double excess = outside_[j + 1] + integral(rise, edge(j + 1)) - flux;
      if (std::abs(excess) <= 1e-14 * flux) break;
      (excess > 0.0 ? low : high) = rise;
      const double newton = rise + excess / intensity(rise);
      if (std::abs(newton - rise) <= 4e-16 * rise) break;
      rise = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return rise;
  }

 private:
  static constexpr size_t panels = 512;
  double edge(size_t j) const { return static_cast<double>(j) * width_; }
  double integral(double low, double high) const {
    return integrate(
        gauss_8, [this](double rise) { return intensity(rise); }, low, high);
  }

  const AngularProfile& profile_;
  double width_ = 0.0;
  std::vector<double> outside_;  // at the edges of the panels
};

}  // namespace

InverseFlux::InverseFlux(const AngularProfile& profile) {
  const FluxOutside outside(profile);
  const double total = outside.total();
  flux_ = 2.0 * pi * total;

  coefficients_.reserve(4 * intervals);
  double low = outside.inverse(knot(0) * total);
  for (uint64_t k = 0; k < intervals; ++k) {
    const double width = knot(k + 1) - knot(k);
    const double high = k + 1 < intervals ? outside.inverse(knot(k + 1) * total) : 0.0;
    const double change = high - low;
    const double slope_low = -width * total / outside.intensity(low);
    const double slope_high = -width * total / outside.intensity(high);
    // This condition is sufficient for a monotone cubic: F. N. Fritsch, R. E. Carlson, SIAM J.
    // Numer. Anal. 17 (1980).
    const bool monotone = slope_low >= 3.0 * change && slope_high >= 3.0 * change;
    const auto cubic = hermite_coefficients(low, change, slope_low, slope_high);
    coefficients_.insert(coefficients_.end(), cubic.begin(), cubic.end());
    const double middle = 0.5 * (knot(k) + knot(k + 1));
    const double error = std::abs(outside(rise(middle)) / total - middle);
    if (!monotone || !(error <= allowed_error)) {
      throw NumericalError("the angular profile of a source is too steep to be tabulated: error " +
                           std::to_string(error) + " of the flux" +
                           (monotone ? "" : ", not monotone"));
    }
    low = high;
  }
}

}  // namespace photorque

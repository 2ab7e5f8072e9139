// The inverse of the encircled flux of a profile: the cone that contains a fraction of the flux.
//
// Method. With the rise h = 1 − cos θ the element of solid angle is 2π dh. The flux outside a cone
// is G(h) = ∫_h^end I dh, and its fraction is v = G/G(0). The inverse h(v) is smooth except
// for v → 0, where profiles without an edge increase like ln 1/v. It is tabulated on knots that
// divide every octave of v evenly, with cubic Hermite polynomials through the exact values and
// slopes dh/dv = −G(0)/I. The rise has full relative precision down to the narrowest beams.
// sin θ = √(h(2 − h)) and cos θ = 1 − h need no trigonometry.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "sources/profiles/angular_profile.h"

namespace photorque {

class InverseFlux {
 public:
  // Throws NumericalError if the error of the table exceeds 1e-6 of the flux, or if it is not
  // monotone.
  explicit InverseFlux(const AngularProfile& profile);

  // ∫ I dΩ [sr times the unit of I].
  double flux() const { return flux_; }

  // Table: four polynomial coefficients per interval, lowest power first.
  const std::vector<double>& coefficients() const { return coefficients_; }

  // Position of a fraction of the flux in the table. For fractions in [smallest_fraction, 1), in
  // single or double precision.
  template <std::floating_point Real>
  static auto place(Real fraction_outside) {
    using Bits = std::conditional_t<std::is_same_v<Real, float>, uint32_t, uint64_t>;
    struct Place {
      Bits interval;
      Real t;  // ∈ [0, 1) along the interval
    };
    constexpr int mantissa_bits = std::numeric_limits<Real>::digits - 1;
    constexpr int shift = mantissa_bits - interval_bits;
    constexpr Bits mantissa = (Bits{1} << mantissa_bits) - 1, one = std::bit_cast<Bits>(Real{1});
    constexpr Bits first = std::bit_cast<Bits>(static_cast<Real>(smallest_fraction)) >> shift;
    const auto bits = std::bit_cast<Bits>(fraction_outside);
    const Bits rest = (bits << interval_bits) & mantissa;
    return Place{(bits >> shift) - first, std::bit_cast<Real>(rest | one) - Real{1}};
  }
  static constexpr double smallest_fraction = 0x1p-33;  // half a step of a 32-bit fraction
  static constexpr int octaves = 33;
  static constexpr int interval_bits = 5;  // 32 intervals in each octave
  static constexpr uint64_t intervals = static_cast<uint64_t>(octaves) << interval_bits;

  // Rise of the cone outside which this fraction of the flux, in [smallest_fraction, 1), lies.
  double rise(double fraction_outside) const {
    const auto p = place(fraction_outside);
    const double* c = &coefficients_[4 * p.interval];
    return c[0] + p.t * (c[1] + p.t * (c[2] + p.t * c[3]));
  }

 private:
  static double knot(uint64_t k) {
    constexpr int shift = 52 - interval_bits;
    return std::bit_cast<double>(std::bit_cast<uint64_t>(smallest_fraction) + (k << shift));
  }

  std::vector<double> coefficients_;
  double flux_ = 0.0;
};

}  // namespace photorque

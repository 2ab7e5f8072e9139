#include "attitude/supply/eddy_sphere.h"

#include <cmath>

#include "attitude/disturbances/fields/current_loop.h"
#include "core/constants.h"

namespace photorque {
namespace {

constexpr std::complex<double> imaginary(0.0, 1.0);

// cot z for Im z ≥ 0, without overflow.
std::complex<double> cotangent(std::complex<double> z) {
  const std::complex<double> turned = std::exp(2.0 * imaginary * z);
  return imaginary * (turned + 1.0) / (turned - 1.0);
}

}  // namespace

// α = −3/2 [1 − 3/x² + (3/x) cot x], x = (1 + i) a/δ. For small x the bracket is −x²/15 − 2 x⁴/315.
std::complex<double> sphere_polarisability(double radius_m, double conductivity_S_m,
                                           double angular_frequency_rad_s) {
  const double skin_m =
      std::sqrt(2.0 / (vacuum_permeability_N_A2 * conductivity_S_m * angular_frequency_rad_s));
  const std::complex<double> x = (1.0 + imaginary) * (radius_m / skin_m);
  const std::complex<double> x2 = x * x;
  constexpr double small = 1e-2;
  if (std::abs(x) < small) return 1.5 * x2 / 15.0 * (1.0 + 2.0 / 21.0 * x2);
  return -1.5 * (1.0 - 3.0 / x2 + 3.0 / x * cotangent(x));
}

double sphere_eddy_loss_W(double radius_m, double conductivity_S_m, double angular_frequency_rad_s,
                          double field_T) {
  const double volume_m3 = 4.0 / 3.0 * pi * radius_m * radius_m * radius_m;
  const double alpha =
      sphere_polarisability(radius_m, conductivity_S_m, angular_frequency_rad_s).imag();
  return 0.5 * angular_frequency_rad_s * volume_m3 * alpha * field_T * field_T /
         vacuum_permeability_N_A2;
}

}  // namespace photorque

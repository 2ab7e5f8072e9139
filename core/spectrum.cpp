#include "core/spectrum.h"

#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "core/solar_spectra.h"

namespace photorque {
namespace {

double gaussian_below(const Spectrum& spectrum, double wavelength_m) {
  if (spectrum.fwhm_m <= 0.0) return wavelength_m > spectrum.centre_m ? 1.0 : 0.0;
  const double sigma = spectrum.fwhm_m / std::sqrt(8.0 * std::numbers::ln2);
  return 0.5 * std::erfc((spectrum.centre_m - wavelength_m) / (sigma * std::numbers::sqrt2));
}

// Fraction of blackbody exitance below a wavelength, by the series in e^{-nx}, x = hc/λkT
// (J. H. Lienhard, A Heat Transfer Textbook, section 10.1; W. K. Widger and M. P. Woodall, 1976).
double blackbody_below(const Spectrum& spectrum, double wavelength_m) {
  if (wavelength_m <= 0.0) return 0.0;
  const double x =
      planck_J_s * speed_of_light_m_s / (wavelength_m * boltzmann_J_K * spectrum.temperature_K);
  if (x < 0.05) return 1.0 - 5.0 * x * x * x / std::pow(pi, 4);  // Rayleigh–Jeans tail
  double sum = 0.0;
  for (int n = 1; n <= 1000; ++n) {
    const double nx = n * x;
    const double term = std::exp(-nx) * (x * x * x / n + 3 * x * x / (n * n) +
                                         6 * x / std::pow(n, 3) + 6 / std::pow(n, 4));
    sum += term;
    if (term < 1e-17 * sum) break;
  }
  return 15.0 / std::pow(pi, 4) * sum;
}

double fraction_below(const Spectrum& spectrum, double wavelength_m) {
  switch (spectrum.shape) {
    case Spectrum::Shape::gaussian:
      return gaussian_below(spectrum, wavelength_m);
    case Spectrum::Shape::blackbody:
      return blackbody_below(spectrum, wavelength_m);
    case Spectrum::Shape::am0:
      return solar_fraction_below(SolarStandard::am0, wavelength_m);
    case Spectrum::Shape::am15g:
      break;
  }
  return solar_fraction_below(SolarStandard::am15g, wavelength_m);
}

}  // namespace

BandValues band_fractions(const Spectrum& spectrum, const Bands& bands) {
  const auto below = [&](double wavelength_m) { return fraction_below(spectrum, wavelength_m); };
  BandValues fractions{};
  if (bands.count() == 1 && bands.edges_m[0] <= 0.0 && bands.edges_m[1] >= 1.0) {
    fractions[0] = 1.0;
    return fractions;
  }
  for (int b = 0; b < bands.count(); ++b) {
    fractions[static_cast<size_t>(b)] = below(bands.edges_m[static_cast<size_t>(b) + 1]) -
                                        below(bands.edges_m[static_cast<size_t>(b)]);
  }
  return fractions;
}

}  // namespace photorque

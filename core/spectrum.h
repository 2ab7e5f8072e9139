// Wavelength: bands that results are split into, and the spectra of sources.
#pragma once

#include <array>
#include <vector>

namespace photorque {

// More bands than this are refused; it bounds what a ray carries.
inline constexpr int max_bands = 8;

// Contiguous wavelength bands, ascending edges in metres; n bands have n + 1 edges. The default is
// one band over all wavelengths.
struct Bands {
  std::vector<double> edges_m = {0.0, 1.0};
  int count() const { return static_cast<int>(edges_m.size()) - 1; }
};

// One value per band; entries beyond the band count are zero.
using BandValues = std::array<double, max_bands>;

// The relative spectral power of a source.
struct Spectrum {
  enum class Shape { gaussian, blackbody, am0, am15g };  // am…: see solar_spectra.h
  Shape shape = Shape::gaussian;
  double centre_m = 550e-9;       // gaussian: wavelength of the maximum
  double fwhm_m = 20e-9;          // gaussian: full width at half maximum; 0 is a line
  double temperature_K = 5772.0;  // blackbody
};

// The fraction of the spectrum's power in each band. Bands may leave wavelengths out: the fractions
// then sum to less than one and the rest is power that no band carries; scenes refuse that.
BandValues band_fractions(const Spectrum& spectrum, const Bands& bands);

}  // namespace photorque

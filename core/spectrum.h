// Wavelength: bands into which results are split, spectra of sources, standard sunlight.
#pragma once

#include <array>
#include <vector>

namespace photorque {

// More bands than this are rejected; it bounds the size of a ray.
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
  enum class Shape { gaussian, blackbody, am0, am15g };  // am…: see SolarStandard
  Shape shape = Shape::gaussian;
  double centre_m = 550e-9;       // gaussian: wavelength of the maximum
  double fwhm_m = 20e-9;          // gaussian: full width at half maximum; 0 is a line
  double temperature_K = 5772.0;  // blackbody
};

// The fraction of the spectrum's power in each band. Bands may omit wavelengths: the fractions then
// sum to less than one, which scenes reject.
BandValues band_fractions(const Spectrum& spectrum, const Bands& bands);

// Standard spectra of sunlight.
enum class SolarStandard {
  am0,    // above the atmosphere
  am15g,  // on the ground: air mass 1.5, direct and diffuse light on a surface tilted by 37 deg
};

// The fraction of the irradiance from 280 to 4000 nm that lies below a wavelength; 0 and 1 outside.
// It is tabulated in bands of 10 nm from 400 to 1100 nm, of 20 nm to 1800 nm, and wider ones
// beyond. The spectrum is uniform within a band.
//
// Source: ASTM G173-03, columns "extraterrestrial" and "global tilt". The sums agree with the
// standard's own totals, 1347.9 and 1000.37 W/m², to 6e-4 and 2e-4; bands of 100 nm from 400 to
// 1100 nm are exact to rounding. Beyond 1100 nm a single band is good to 1 %.
double solar_fraction_below(SolarStandard standard, double wavelength_m);

}  // namespace photorque

// Standard spectra of sunlight, in bands.
#pragma once

namespace photorque {

enum class SolarStandard {
  am0,    // above the atmosphere
  am15g,  // on the ground: air mass 1.5, direct and diffuse light on a surface tilted by 37 deg
};

// The fraction of the irradiance from 280 to 4000 nm that lies below a wavelength; 0 and 1 outside.
// Bands of 10 nm from 400 to 1100 nm, 20 nm to 1800 nm, wider beyond; even within a band.
//
// Source: ASTM G173-03, columns "extraterrestrial" and "global tilt". The sums agree with the
// standard's own totals, 1347.9 and 1000.37 W/m², to 6e-4 and 2e-4; bands of 100 nm from 400 to
// 1100 nm are exact to rounding. Beyond 1100 nm a single band is good to 1 %.
double solar_fraction_below(SolarStandard standard, double wavelength_m);

}  // namespace photorque

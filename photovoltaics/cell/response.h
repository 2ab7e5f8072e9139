// Conversion of light into photocurrent.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/spectrum.h"

namespace photorque {

// Electrons collected per photon that falls on the cell (external: reflection is included), as a
// function of wavelength; linear between the points, zero outside them.
struct QuantumEfficiency {
  std::vector<double> wavelength_m;  // ascending, at least two
  std::vector<double> efficiency;    // in [0, 1]

  double at(double wavelength_m) const;
};

// Quantum efficiency of the cell of that name among known_cells(). `peak`: its largest value.
//
// Silicon: the spectral response of a measured monocrystalline cell, 13 points, from A. Driesse, J.
// Stein, Global Normal Spectral Irradiance in Albuquerque (2020), doi:10.2172/1814068, divided by
// wavelength. The measurement is relative; at the best wavelength (800 nm) the efficiency is by
// default 0.95, that of a textured cell with an antireflective coat (assumed).
//
// "gallium_arsenide" and "cadmium_telluride": a plateau between the blue loss and the absorption
// edge. Its height, unless `peak` states it, gives the published current density in AM1.5G sunlight
// of 1000 W/m²: 29.78 and 30.25 mA/cm² (M. A. Green et al., Solar cell efficiency tables (version
// 54), Progress in Photovoltaics 27, 565 (2019)). The edges are those of alloys as published for
// such cells: half height at 874 nm, and at 883 nm by selenium in the absorber.
QuantumEfficiency quantum_efficiency_of(std::string_view cell, std::optional<double> peak = {});

// Ampere per watt at one wavelength: EQE λ q/(h c).
double responsivity_A_W(const QuantumEfficiency& efficiency, double wavelength_m);

// A spectrum with its radiant power, in any unit.
struct WeighedSpectrum {
  Spectrum spectrum;
  double power = 1.0;
};

// "light at 850 nm", "light of a black body of 5772 K", "sunlight AM1.5G".
std::string in_words(const Spectrum& spectrum);

// Ampere per watt of the light in each band, averaged over the spectra in proportion to their power
// in it; zero for a band without light. The integral is a sum over steps of 0.5 nm (1e-5 relative
// for smooth spectra); a line is taken at its wavelength.
BandValues band_responsivity_A_W(const QuantumEfficiency& efficiency, const Bands& bands,
                                 std::span<const WeighedSpectrum> spectra);

// One line for each spectrum that may give too little current because the table does not cover it:
// nearly all of its light is outside, or the table ends well above zero and cuts off some of it.
std::vector<std::string> light_outside(const QuantumEfficiency& efficiency,
                                       std::span<const WeighedSpectrum> spectra);

}  // namespace photorque

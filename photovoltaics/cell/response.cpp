#include "photovoltaics/cell/response.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text/format.h"

namespace photorque {
namespace {

constexpr double step_m = 0.5e-9;

// Power fraction and photocurrent of one spectrum in one band.
struct BandFraction {
  double power = 0.0;
  double current_A_W = 0.0;
};

// A spectral line that is narrow compared with the steps is treated as one wavelength.
BandFraction fraction_of(const QuantumEfficiency& efficiency, const Spectrum& spectrum,
                         double low_m, double high_m) {
  BandFraction fraction;
  fraction.power = band_fractions(spectrum, Bands{{low_m, high_m}})[0];
  if (spectrum.shape == Spectrum::Shape::gaussian && spectrum.fwhm_m < 2 * step_m) {
    fraction.current_A_W = fraction.power * responsivity_A_W(efficiency, spectrum.centre_m);
    return fraction;
  }
  // Outside the table nothing is converted.
  const double from_m = std::max(low_m, efficiency.wavelength_m.front());
  const double to_m = std::min(high_m, efficiency.wavelength_m.back());
  if (!(to_m > from_m)) return fraction;
  const int steps = static_cast<int>(std::ceil((to_m - from_m) / step_m));
  const double width_m = (to_m - from_m) / steps;
  for (int i = 0; i < steps; i += max_bands) {
    const int count = std::min(max_bands, steps - i);
    Bands fine{{}};
    for (int k = 0; k <= count; ++k) fine.edges_m.push_back(from_m + (i + k) * width_m);
    const BandValues parts = band_fractions(spectrum, fine);
    for (int k = 0; k < count; ++k) {
      fraction.current_A_W += parts[static_cast<size_t>(k)] *
                              responsivity_A_W(efficiency, from_m + (i + k + 0.5) * width_m);
    }
  }
  return fraction;
}

}  // namespace

double QuantumEfficiency::at(double wavelength) const {
  if (wavelength < wavelength_m.front() || wavelength > wavelength_m.back()) return 0.0;
  const auto above = std::ranges::upper_bound(wavelength_m, wavelength);
  if (above == wavelength_m.end()) return efficiency.back();
  const auto i = static_cast<size_t>(above - wavelength_m.begin());
  const double t = (wavelength - wavelength_m[i - 1]) / (wavelength_m[i] - wavelength_m[i - 1]);
  return std::lerp(efficiency[i - 1], efficiency[i], t);
}

QuantumEfficiency quantum_efficiency_of(std::string_view cell, std::optional<double> peak) {
  struct Point {
    double wavelength_nm, height;
  };
  static constexpr Point silicon_response[] = {
      {290, 0.00}, {350, 0.27},  {400, 0.37},  {500, 0.52},  {650, 0.71},  {800, 0.88}, {900, 0.97},
      {950, 1.00}, {1000, 0.93}, {1050, 0.58}, {1100, 0.21}, {1150, 0.05}, {1190, 0.00}};
  static constexpr Point gallium_arsenide[] = {{300, 0.2}, {350, 0.5},  {400, 0.8},  {450, 0.95},
                                               {500, 1.0}, {850, 1.0},  {860, 0.98}, {868, 0.85},
                                               {876, 0.4}, {884, 0.08}, {900, 0.0}};
  static constexpr Point cadmium_telluride[] = {{300, 0.2}, {350, 0.5},  {400, 0.82}, {450, 0.92},
                                                {500, 1.0}, {850, 1.0},  {860, 0.97}, {870, 0.88},
                                                {880, 0.6}, {890, 0.27}, {900, 0.08}, {920, 0.0}};
  QuantumEfficiency table;
  const auto add = [&](const Point& point, double efficiency) {
    table.wavelength_m.push_back(1e-9 * point.wavelength_nm);
    table.efficiency.push_back(efficiency);
  };
  if (cell == "gallium_arsenide") {
    for (const Point& p : gallium_arsenide) add(p, peak.value_or(0.950) * p.height);
  } else if (cell == "cadmium_telluride") {
    for (const Point& p : cadmium_telluride) add(p, peak.value_or(0.949) * p.height);
  } else {
    double largest = 0.0;
    for (const Point& p : silicon_response) largest = std::max(largest, p.height / p.wavelength_nm);
    for (const Point& p : silicon_response) {
      add(p, peak.value_or(0.95) * p.height / p.wavelength_nm / largest);
    }
  }
  return table;
}

double responsivity_A_W(const QuantumEfficiency& efficiency, double wavelength_m) {
  return efficiency.at(wavelength_m) * wavelength_m * elementary_charge_C /
         (planck_J_s * speed_of_light_m_s);
}

std::string in_words(const Spectrum& spectrum) {
  switch (spectrum.shape) {
    case Spectrum::Shape::gaussian:
      return "light at " + readable_number(1e9 * spectrum.centre_m, 4) + " nm";
    case Spectrum::Shape::blackbody:
      return "light of a black body of " + readable_number(spectrum.temperature_K, 4) + " K";
    case Spectrum::Shape::am0:
      return "sunlight AM0";
    default:
      return "sunlight AM1.5G";
  }
}

BandValues band_responsivity_A_W(const QuantumEfficiency& efficiency, const Bands& bands,
                                 std::span<const WeighedSpectrum> spectra) {
  BandValues responsivity{};
  for (size_t b = 0; b < static_cast<size_t>(bands.count()); ++b) {
    double power = 0.0, current = 0.0;
    for (const WeighedSpectrum& weighed : spectra) {
      const BandFraction fraction =
          fraction_of(efficiency, weighed.spectrum, bands.edges_m[b], bands.edges_m[b + 1]);
      power += weighed.power * fraction.power;
      current += weighed.power * fraction.current_A_W;
    }
    responsivity[b] = power > 0 ? current / power : 0.0;
  }
  return responsivity;
}

std::vector<std::string> light_outside(const QuantumEfficiency& efficiency,
                                       std::span<const WeighedSpectrum> spectra) {
  constexpr double noticeable = 0.01, nearly_all = 0.99, longest_m = 1.0;
  const double from_m = efficiency.wavelength_m.front(), to_m = efficiency.wavelength_m.back();
  std::vector<std::string> lines;
  for (const WeighedSpectrum& one : spectra) {
    const BandValues parts = band_fractions(one.spectrum, Bands{{0.0, from_m, to_m, longest_m}});
    const double outside = parts[0] + parts[2];
    // Current by the light beyond the table, if the efficiency there equalled that at its ends.
    const double cut_off =
        parts[0] * efficiency.efficiency.front() + parts[2] * efficiency.efficiency.back();
    if (outside < nearly_all && cut_off < noticeable) continue;
    const std::string line = readable_number(100.0 * outside, 3) + " % of the " +
                             in_words(one.spectrum) + " lies outside of " +
                             readable_number(1e9 * from_m, 4) + " to " +
                             readable_number(1e9 * to_m, 4) +
                             " nm, where the cells' quantum efficiency is stated, and gives no "
                             "current";
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

}  // namespace photorque

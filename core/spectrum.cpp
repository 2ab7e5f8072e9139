#include "core/spectrum.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/constants.h"

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

namespace {

struct SolarBand {
  double end_nm;  // begins at the end of the previous band; the first at 280 nm
  double am0_W_m2;
  double am15g_W_m2;

  double irradiance_W_m2(SolarStandard standard) const {
    return standard == SolarStandard::am0 ? am0_W_m2 : am15g_W_m2;
  }
};

constexpr double first_nm = 280.0;
constexpr auto solar_bands = std::to_array<SolarBand>({
    {300, 8.31, 0.00},   {320, 12.65, 1.53},  {340, 18.22, 7.45},  {360, 19.41, 10.06},
    {380, 22.68, 13.23}, {400, 21.73, 13.84}, {410, 17.20, 11.55}, {420, 17.34, 12.01},
    {430, 16.69, 11.88}, {440, 16.43, 12.00}, {450, 19.24, 14.34}, {460, 20.31, 15.44},
    {470, 20.18, 15.59}, {480, 20.29, 15.79}, {490, 19.32, 15.30}, {500, 19.52, 15.69},
    {510, 19.17, 15.42}, {520, 18.27, 14.91}, {530, 18.70, 15.30}, {540, 18.89, 15.48},
    {550, 18.55, 15.27}, {560, 18.47, 15.27}, {570, 18.36, 15.06}, {580, 18.35, 14.85},
    {590, 18.09, 14.91}, {600, 17.84, 14.54}, {610, 17.51, 14.75}, {620, 16.96, 14.55},
    {630, 16.80, 14.19}, {640, 16.44, 14.33}, {650, 16.00, 14.20}, {660, 15.23, 13.61},
    {670, 15.55, 14.07}, {680, 15.09, 14.05}, {690, 14.73, 12.77}, {700, 14.45, 12.73},
    {710, 14.09, 12.97}, {720, 13.65, 11.96}, {730, 13.41, 10.87}, {740, 13.12, 11.87},
    {750, 12.83, 12.37}, {760, 12.67, 11.79}, {770, 12.34, 7.19},  {780, 12.07, 11.74},
    {790, 11.86, 11.49}, {800, 11.45, 10.93}, {810, 11.23, 10.75}, {820, 11.04, 9.26},
    {830, 10.70, 9.11},  {840, 10.50, 9.66},  {850, 10.20, 9.96},  {860, 9.73, 9.56},
    {870, 9.68, 9.58},   {880, 9.59, 9.50},   {890, 9.38, 9.25},   {900, 9.27, 7.90},
    {910, 9.05, 7.07},   {920, 8.93, 6.61},   {930, 8.65, 6.88},   {940, 8.61, 2.73},
    {950, 8.28, 3.35},   {960, 8.10, 3.58},   {970, 7.94, 5.24},   {980, 7.77, 6.26},
    {990, 7.68, 7.14},   {1000, 7.52, 7.45},  {1010, 7.30, 7.23},  {1020, 7.15, 7.11},
    {1030, 6.97, 6.94},  {1040, 6.82, 6.80},  {1050, 6.67, 6.63},  {1060, 6.54, 6.44},
    {1070, 6.35, 6.20},  {1080, 6.23, 6.08},  {1090, 6.08, 5.81},  {1100, 5.89, 5.35},
    {1120, 11.72, 7.26}, {1140, 11.29, 2.93}, {1160, 10.93, 4.46}, {1180, 10.54, 8.27},
    {1200, 10.19, 8.63}, {1220, 9.88, 8.77},  {1240, 9.46, 9.21},  {1260, 9.11, 9.04},
    {1280, 8.84, 7.91},  {1300, 8.46, 8.15},  {1320, 8.08, 6.65},  {1340, 7.76, 4.46},
    {1360, 7.44, 0.99},  {1380, 7.22, 0.00},  {1400, 6.98, 0.00},  {1420, 6.77, 0.10},
    {1440, 6.53, 0.56},  {1460, 6.31, 1.43},  {1480, 6.18, 1.66},  {1500, 6.06, 3.02},
    {1520, 5.74, 4.75},  {1540, 5.51, 5.41},  {1560, 5.41, 5.40},  {1580, 5.20, 5.00},
    {1600, 5.10, 4.98},  {1620, 4.84, 4.65},  {1640, 4.71, 4.71},  {1660, 4.51, 4.40},
    {1680, 4.37, 4.28},  {1700, 4.19, 4.09},  {1720, 4.03, 3.84},  {1740, 3.88, 3.46},
    {1760, 3.72, 3.19},  {1780, 3.58, 2.60},  {1800, 3.44, 1.39},  {1850, 7.97, 0.23},
    {1900, 7.34, 0.00},  {1950, 6.68, 0.14},  {2000, 6.09, 2.65},  {2050, 5.57, 3.08},
    {2100, 5.05, 3.78},  {2150, 4.65, 4.48},  {2200, 4.31, 4.00},  {2250, 3.95, 3.74},
    {2300, 3.63, 3.25},  {2350, 3.35, 2.76},  {2400, 3.10, 2.08},  {2450, 2.86, 1.54},
    {2500, 2.65, 0.73},  {2750, 10.52, 0.02}, {3000, 7.47, 0.36},  {3250, 5.47, 1.20},
    {3500, 4.09, 1.68},  {3750, 3.14, 2.45},  {4000, 2.46, 2.04},
});

}  // namespace

double solar_fraction_below(SolarStandard standard, double wavelength_m) {
  const double wavelength_nm = 1e9 * wavelength_m;
  double below_W_m2 = 0.0, all_W_m2 = 0.0, begin_nm = first_nm;
  for (const SolarBand& band : solar_bands) {
    const double irradiance_W_m2 = band.irradiance_W_m2(standard);
    const double part = (wavelength_nm - begin_nm) / (band.end_nm - begin_nm);
    if (part > 0.0) below_W_m2 += (part < 1.0 ? part : 1.0) * irradiance_W_m2;
    all_W_m2 += irradiance_W_m2;
    begin_nm = band.end_nm;
  }
  return below_W_m2 / all_W_m2;
}

}  // namespace photorque

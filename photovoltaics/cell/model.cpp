#include "photovoltaics/cell/model.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

// One square centimetre at 298.15 K. J₀ follows from the open-circuit voltage at a current density
// of `short_circuit_A`, as one diode. Reverse breakdown as in the partial-shading
// example of pvlib (a = 2e-3, −15 V, exponent 3).
CellModel single_diode(double open_circuit_V, double short_circuit_A, double series_ohm,
                       double shunt_ohm, double ideality = 1.0) {
  CellParameters p;
  p.ideality_1 = ideality;
  const double thermal_V = ideality * boltzmann_J_K * p.temperature_K / elementary_charge_C;
  p.saturation_1_A = short_circuit_A / std::expm1(open_circuit_V / thermal_V);
  p.series_ohm = series_ohm;
  p.shunt_ohm = shunt_ohm;
  p.breakdown_fraction = 2e-3;
  return {p, 1e-4, silicon_gap_eV, silicon_gap_slope_1_K, 0.0};
}

// The model with the band gap of another semiconductor and its slope.
CellModel of_gap(CellModel model, double gap_eV, double gap_slope_1_K) {
  model.gap_eV = gap_eV;
  model.gap_slope_1_K = gap_slope_1_K;
  return model;
}

// The default cell of PVMismatch (github.com/SunPower/PVMismatch, pvcell.py): 153.33 cm², two
// diodes, fitted to an interdigitated cell of 2013.
CellModel two_diode_interdigitated() {
  CellParameters p;
  p.saturation_1_A = 2.286188161253440e-11;
  p.saturation_2_A = 1.117455042372326e-6;
  p.series_ohm = 4.267236774264931e-3;
  p.shunt_ohm = 10.01226369025448;
  p.breakdown_fraction = 1.036748445065697e-4;
  p.breakdown_V = -5.527260068445654;
  p.breakdown_exponent = 3.284628553041425;
  return {p, 153.33e-4, 1.1, 0.0, 0.0};
}

}  // namespace

CellParameters parameters_at(const CellModel& model, double area_m2, double temperature_K) {
  const double size = area_m2 / model.reference_area_m2;
  const double reference_K = model.reference.temperature_K;
  const double ratio = temperature_K / reference_K;
  const double gap_eV = model.gap_eV * (1.0 + model.gap_slope_1_K * (temperature_K - reference_K));
  const double exponent =
      elementary_charge_C / boltzmann_J_K * (model.gap_eV / reference_K - gap_eV / temperature_K);
  CellParameters p = model.reference;
  p.temperature_K = temperature_K;
  p.saturation_1_A *= size * ratio * ratio * ratio * std::exp(exponent);
  p.saturation_2_A *= size * ratio * ratio * ratio * std::exp(0.5 * exponent);
  p.series_ohm /= size;
  p.shunt_ohm /= size;
  p.shunt_dark_ohm /= size;
  p.shunt_light_A *= size * photocurrent_factor(model, temperature_K);
  return p;
}

CellParameters with_leak(CellParameters p, double extra_S) {
  const double shunt_ohm = 1.0 / (1.0 / p.shunt_ohm + extra_S);
  p.breakdown_fraction *= shunt_ohm / p.shunt_ohm;
  p.shunt_ohm = shunt_ohm;
  return p;
}

double photocurrent_factor(const CellModel& model, double temperature_K) {
  return std::max(
      0.0, 1.0 + model.photocurrent_slope_1_K * (temperature_K - model.reference.temperature_K));
}

// Open-circuit voltages and currents in sunlight typical of each technology in M. A. Green et al.,
// Solar cell efficiency tables (Progress in Photovoltaics, twice a year since 1993). Gallium
// arsenide and cadmium telluride are the records of version 54 (2019): 1.1272 V, 29.78 mA/cm², fill
// factor 86.7 %, and 0.8759 V, 30.25 mA/cm², 79.4 %; the series resistances follow from the fill
// factors. Gaps and their slopes at 298 K: I. Vurgaftman, J. R. Meyer, L. R. Ram-Mohan, J. Appl.
// Phys. 89, 5815 (2001) for GaAs; 1.40 eV by the edge of the cell's response for CdTe with
// selenium.
std::vector<NamedCell> known_cells() {
  return {
      {"silicon_back_surface_field", "aluminium back surface field, 0.635 V in sunlight",
       single_diode(0.635, 37.0e-3, 0.7, 3e3)},
      {"silicon_interdigitated", "interdigitated back contact, 0.700 V in sunlight",
       single_diode(0.700, 40.0e-3, 0.5, 1e4)},
      {"silicon_heterojunction", "record heterojunction, 0.750 V in sunlight",
       single_diode(0.750, 41.0e-3, 0.3, 1e5)},
      {"silicon_two_diode",
       "two-diode fit of an interdigitated cell of 2013 (PVMismatch's default)",
       two_diode_interdigitated()},
      {"gallium_arsenide", "gallium arsenide thin film, record of 29.1 %, 1.127 V in sunlight",
       of_gap(single_diode(1.1272, 29.78e-3, 1.024, 1e5), 1.424, -3.2e-4)},
      {"cadmium_telluride", "cadmium telluride, record of 21.0 %, 0.876 V in sunlight",
       of_gap(single_diode(0.8759, 30.25e-3, 0.923, 1e4, 1.5), 1.40, -2.9e-4)},
  };
}

}  // namespace photorque

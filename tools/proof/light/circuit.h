// The array of an injected case: cells of one diode, strings, bypass diodes; bisection and Newton's
// method.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace photorque::injected {

struct InjectedCell {
  double saturation_A = 1e-11, ideality = 1.0, series_ohm = 0.01, shunt_ohm = 100.0;
  double gap_eV = 1.121, gap_slope_per_K = -0.0002677, photocurrent_slope_per_K = 0.0004;
  double reference_K = 298.15;
};

struct InjectedCircuit {
  int columns = 1, rows = 1, strings = 1, bypass_every = 1;
  bool along_columns = true, blocking = false;
  double drop_V = 0.5, efficiency = 0.9, wavelength_m = 730e-9, cell_area_m2 = 0.0025;
  InjectedCell cell;
  // What acts.
  std::vector<double> cell_current, cell_light;  // shares, by cell
  std::vector<bool> string_open, bypass_shorted;
  double soiling = 1.0, series_ohm = 0.0, shunt_S = 0.0;
  double photocurrent_per_K = 0.0, voltage_V_per_K = 0.0;

  size_t cells() const { return static_cast<size_t>(columns * rows); }
  size_t bypasses() const;  // diodes, over all strings
};

struct InjectedPoint {
  double voltage_V = 0.0, current_A = 0.0;
  double power_W() const { return voltage_V * current_A; }
};

// An array under some light, at a temperature.
class LitCircuit {
 public:
  // `light_W_m2` of each cell, row · columns + column.
  LitCircuit(const InjectedCircuit& circuit, const std::vector<double>& light_W_m2,
             double temperature_K);
  double open_voltage_V() const;
  double current_A(double voltage_V) const;
  // Local maxima of the power, the highest first.
  std::vector<InjectedPoint> maxima() const;

 private:
  // Cells in series from one bypass diode to the next; those in a string.
  using Group = std::vector<double>;  // photocurrents
  double cell_voltage_V(double photocurrent_A, double current_A) const;
  double string_voltage_V(size_t string, double current_A) const;
  double string_current_A(size_t string, double voltage_V) const;
  InjectedPoint at(double parameter) const;

  const InjectedCircuit* circuit_;
  double slope_V_ = 0.0, saturation_A_ = 0.0, conductance_S_ = 0.0, extra_V_ = 0.0;
  double largest_A_ = 0.0;
  std::vector<std::vector<Group>> strings_;
  std::vector<size_t> open_;  // strings that carry current
};

}  // namespace photorque::injected

// The 100-cell array of the reference calculations: cells, maps, wirings, in the words of
// tests/data/electrical, whose numbers come from PVMismatch, from ngspice and from a nested
// bracketed solver in Python.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/constants.h"
#include "photovoltaics/array/design.h"
#include "photovoltaics/cell/table.h"
#include "photovoltaics/network/curve.h"
#include "tests/files.h"
#include "tests/outside.h"
#include "tests/settings.h"

namespace photorque {

// Light of a known irradiance on a whole grid, without error: one replicate, one band.
inline ArrayLight array_light(int width, int height, double u_length_m, double v_length_m,
                              const std::vector<double>& irradiance_W_m2) {
  const double area_m2 = u_length_m * v_length_m / (width * height);
  ArrayLight light;
  light.grid.width = width;
  light.grid.height = height;
  light.grid.u_high = u_length_m;
  light.grid.v_high = v_length_m;
  light.grid.area_m2.assign(irradiance_W_m2.size(), area_m2);
  light.power_W = {irradiance_W_m2.size(), 1, {}, {}};
  for (const double e : irradiance_W_m2) light.power_W.sums.push_back(e * area_m2);
  return light;
}

}  // namespace photorque

namespace photorque::reference {

inline std::filesystem::path file(const std::string& name) {
  return outside::reference_data("electrical") / (name + ".csv");
}

// All numbers of a CSV file without header; lines that begin with # are comments.
inline std::vector<double> numbers(const std::filesystem::path& file) {
  std::vector<double> all;
  for (const auto& row : csv_rows(file)) {
    for (const std::string& cell : row) all.push_back(std::stod(cell));
  }
  return all;
}

// The 10 × 10 irradiances of a map over one sun.
inline std::vector<double> suns(const std::string& map) {
  return numbers(file(map));
}

// ngspice was run with constants of CODATA 2014; only kT/q enters, so this temperature gives the
// same circuit.
inline double ngspice_temperature_K() {
  return 298.15 * (1.38064852e-23 / 1.6021766208e-19) / (boltzmann_J_K / elementary_charge_C);
}

inline CellParameters cell(double temperature_K = 298.15) {
  CellParameters p;
  p.saturation_1_A = 2.286188161253440e-11;
  p.saturation_2_A = 1.117455042372326e-6;
  p.series_ohm = 4.267236774264931e-3;
  p.shunt_ohm = 10.01226369025448;
  p.breakdown_fraction = 1.036748445065697e-4;
  p.breakdown_V = -5.527260068445654;
  p.breakdown_exponent = 3.284628553041425;
  p.temperature_K = temperature_K;
  return p;
}

// The reference's photocurrent leaves the breakdown term out at short circuit.
inline double photocurrent_A(double suns, const CellParameters& p) {
  const double isc = 6.3056 * suns, vd = isc * p.series_ohm;
  const double vt = boltzmann_J_K * p.temperature_K / elementary_charge_C;
  return isc + p.saturation_1_A * std::expm1(vd / vt) +
         p.saturation_2_A * std::expm1(vd / (2 * vt)) + vd / p.shunt_ohm;
}

inline Diode clamp() {
  Diode d;
  d.kind = Diode::Kind::clamp;
  d.drop_V = 0.5;
  return d;
}

inline Diode schottky() {
  Diode d;
  d.kind = Diode::Kind::junction;
  d.temperature_K = ngspice_temperature_K();
  return d;
}

// All cells in series, down one column and up the next, a bypass diode over each `bypass_every`.
inline ArrayWiring series(int columns, int rows, int bypass_every, const Diode& bypass = clamp()) {
  RegularWiring options;
  options.bypass_every = bypass_every;
  options.bypass = bypass;
  return regular_wiring(columns, rows, options);
}

// 100 cells in series.
inline ArrayWiring series_5(const Diode& bypass) {
  return series(10, 10, 20, bypass);
}

// Ten columns in parallel, each with one bypass and one blocking diode.
inline ArrayWiring parallel_10(const Diode& bypass, const Diode& blocking) {
  RegularWiring options;
  options.strings = 10;
  options.bypass_every = 10;
  options.bypass = bypass;
  options.blocking = blocking;
  return regular_wiring(10, 10, options);
}

// An array of equal known cells in series, a bypass diode over each `bypass_every`.
inline ArrayDesign array_in_series(int columns, int rows, int bypass_every, size_t known_cell = 1) {
  ArrayDesign design;
  design.columns = columns;
  design.rows = rows;
  design.wiring = series(columns, rows, bypass_every);
  design.cell = known_cells().at(known_cell).model;
  return design;
}

// The design that the table [array] states.
inline ArrayDesign design(SettingsNode::Table table) {
  return read_array_design(test::settings_of(std::move(table), "array"));
}

inline std::shared_ptr<const DiodeVoltageTable> table(const CellParameters& p) {
  return std::make_shared<const DiodeVoltageTable>(CellCurve(p), 20.0);
}

inline ArrayCurve curve(const ArrayWiring& wiring, const std::vector<double>& suns,
                        const CellParameters& p) {
  std::vector<double> currents;
  currents.reserve(suns.size());
  for (const double s : suns) currents.push_back(photocurrent_A(s, p));
  return {wiring, CellTables(suns.size(), table(p)), currents};
}

}  // namespace photorque::reference

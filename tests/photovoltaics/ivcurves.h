// The published curves and parameters of cwhanse/ivcurves.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/constants.h"
#include "reference.h"
#include "tests/files.h"

namespace photorque::ivcurves {

struct Truth {
  double photocurrent_A = 0, saturation_A = 0, series_ohm = 0, shunt_ohm = 0, ideality = 0;
  double cells_in_series = 0;

  double scale_V() const {
    return ideality * cells_in_series * boltzmann_J_K * 298.15 / elementary_charge_C;
  }
  CellParameters parameters() const {
    CellParameters p;
    p.saturation_1_A = saturation_A;
    p.series_ohm = series_ohm;
    p.shunt_ohm = shunt_ohm;
    p.ideality_1 = ideality * cells_in_series;
    return p;
  }
};

struct Curve {
  Truth truth;
  std::vector<double> voltage_V, current_A;
  double short_circuit_A = 0, open_circuit_V = 0;
  double maximum_W = 0, maximum_V = 0, maximum_A = 0;
  double half_A = 0;  // at half the open-circuit voltage
};

// Numbers that a file writes as texts.
inline double number_in(const nlohmann::json& text) {
  return std::stod(text.get<std::string>());
}
inline std::vector<double> numbers_in(const nlohmann::json& texts) {
  std::vector<double> all;
  for (const auto& text : texts) all.push_back(number_in(text));
  return all;
}

// The curves of a case; each with the parameters of its line, or of the only line.
inline std::vector<Curve> read(const std::string& name) {
  const auto folder = outside::third_party("reference/ivcurves");
  const auto json = nlohmann::json::parse(file_text(folder / (name + ".json")));
  std::vector<Truth> truths;
  const auto rows = csv_rows(folder / (name + ".csv"));
  for (size_t r = 1; r < rows.size(); ++r) {
    const auto c = [&](size_t column) { return std::stod(rows[r][column]); };
    if (rows[r].size() == 7) truths.push_back({c(1), c(2), c(3), c(4), c(5), c(6)});
  }
  std::vector<Curve> curves;
  for (const auto& one : json.at("IV Curves")) {
    Curve curve;
    curve.truth = truths[truths.size() == 1 ? 0 : curves.size()];
    curve.voltage_V = numbers_in(one.at("Voltages"));
    curve.current_A = numbers_in(one.at("Currents"));
    if (truths.size() > 1) {
      curve.short_circuit_A = number_in(one.at("i_sc"));
      curve.open_circuit_V = number_in(one.at("v_oc"));
      curve.maximum_W = number_in(one.at("p_mp"));
      curve.maximum_V = number_in(one.at("v_mp"));
      curve.maximum_A = number_in(one.at("i_mp"));
      curve.half_A = number_in(one.at("i_x"));
    }
    curves.push_back(curve);
  }
  return curves;
}

}  // namespace photorque::ivcurves

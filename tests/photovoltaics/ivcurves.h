// The published curves and parameters of cwhanse/ivcurves.
#pragma once

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

// The quoted numbers of the array called `key` in the curve that starts at `from`.
inline std::vector<double> quoted_array(const std::string& json, const std::string& key,
                                        size_t from) {
  const size_t start = json.find('[', json.find('"' + key + '"', from));
  const size_t end = json.find(']', start);
  std::vector<double> values;
  for (size_t quote = json.find('"', start); quote < end;) {
    const size_t close = json.find('"', quote + 1);
    values.push_back(std::stod(json.substr(quote + 1, close - quote - 1)));
    quote = json.find('"', close + 1);
  }
  return values;
}

inline double quoted_number(const std::string& json, const std::string& key, size_t from) {
  const size_t quote = json.find('"', json.find(':', json.find('"' + key + '"', from)));
  return std::stod(json.substr(quote + 1, json.find('"', quote + 1) - quote - 1));
}

// The curves of a case; each with the parameters of its line, or of the only line.
inline std::vector<Curve> read(const std::string& name) {
  const auto folder = outside::third_party("reference/ivcurves");
  const std::string json = file_text(folder / (name + ".json"));
  if (json.empty()) return {};
  std::vector<Truth> truths;
  const auto rows = csv_rows(folder / (name + ".csv"));
  for (size_t r = 1; r < rows.size(); ++r) {
    const auto c = [&](size_t column) { return std::stod(rows[r][column]); };
    if (rows[r].size() == 7) truths.push_back({c(1), c(2), c(3), c(4), c(5), c(6)});
  }
  std::vector<Curve> curves;
  size_t at = json.find("\"IV Curves\"");
  for (at = json.find("\"Index\"", at + 1); at != std::string::npos;
       at = json.find("\"Index\"", at + 1)) {
    Curve curve;
    curve.truth = truths[truths.size() == 1 ? 0 : curves.size()];
    curve.voltage_V = quoted_array(json, "Voltages", at);
    curve.current_A = quoted_array(json, "Currents", at);
    if (truths.size() > 1) {
      curve.short_circuit_A = quoted_number(json, "i_sc", at);
      curve.open_circuit_V = quoted_number(json, "v_oc", at);
      curve.maximum_W = quoted_number(json, "p_mp", at);
      curve.maximum_V = quoted_number(json, "v_mp", at);
      curve.maximum_A = quoted_number(json, "i_mp", at);
      curve.half_A = quoted_number(json, "i_x", at);
    }
    curves.push_back(curve);
  }
  return curves;
}

}  // namespace photorque::ivcurves

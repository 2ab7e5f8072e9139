#include "diagnosis/light/model/lit_cells.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

// Breakdown keeps its own current beside a larger shunt.
CellParameters with_shunt(CellParameters p, double extra_S) {
  const double shunt_ohm = 1.0 / (1.0 / p.shunt_ohm + extra_S);
  p.breakdown_fraction *= shunt_ohm / p.shunt_ohm;
  p.shunt_ohm = shunt_ohm;
  return p;
}

bool is_one_diode(const CellParameters& p) {
  return p.saturation_1_A > 0.0 && p.saturation_2_A == 0.0 && p.breakdown_fraction == 0.0;
}

}  // namespace

LitDiode::LitDiode(const CellParameters& parameters, double extra_shunt_S)
    : curve_(with_shunt(parameters, extra_shunt_S)), series_ohm_(parameters.series_ohm) {
  if (is_one_diode(parameters)) plain_.emplace(curve_.parameters(), curve_.thermal_V());
}

LitDiode::LitDiode(const CellParameters& parameters, std::shared_ptr<const DiodeVoltageTable> table)
    : LitDiode(parameters, 0.0) {
  table_ = std::move(table);
}

LitCells lit_cells(const std::vector<const CellModel*>& models, const std::vector<double>& area_m2,
                   double temperature_K, double extra_shunt_S, bool tabulated) {
  LitCells cells;
  std::vector<size_t> first;  // cell of each kind
  for (size_t i = 0; i < area_m2.size(); ++i) {
    const auto alike = [&](size_t other) {
      return models[other] == models[i] &&
             std::abs(area_m2[other] - area_m2[i]) <= 1e-9 * area_m2[i];
    };
    const auto known = std::ranges::find_if(first, alike);
    cells.kind_of_cell.push_back(static_cast<int>(known - first.begin()));
    if (known != first.end()) continue;
    first.push_back(i);
    const CellParameters p =
        with_shunt(parameters_at(*models[i], area_m2[i], temperature_K), extra_shunt_S);
    constexpr double largest_A_m2 = 2000.0;  // five suns on silicon; beyond it the exact solution
    if (tabulated && !is_one_diode(p)) {
      cells.kinds.emplace_back(
          p, std::make_shared<const DiodeVoltageTable>(CellCurve(p), largest_A_m2 * area_m2[i]));
    } else {
      cells.kinds.emplace_back(p, 0.0);
    }
  }
  return cells;
}

LitDiode::Point LitDiode::at(double dark_A) const {
  if (plain_) {
    const OneDiode::Point at = plain_->at(dark_A);
    return {at.value_V, at.slope_ohm, at.curvature_V_A2};
  }
  if (table_) {
    const DiodeVoltage at = table_->at(dark_A);
    return {at.value_V, at.slope_ohm, at.curvature_V_A2};
  }
  const double v = curve_.diode_voltage_V(dark_A);
  const DarkCurrent d = curve_.dark(v);
  const double r = 1.0 / d.slope_S;
  return {v, r, -d.curvature_A_V2 * r * r * r};
}

}  // namespace photorque

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

}  // namespace

LitDiode::LitDiode(const CellParameters& parameters, double extra_shunt_S)
    : curve_(with_shunt(parameters, extra_shunt_S)),
      saturation_A_(parameters.saturation_1_A),
      scale_V_(parameters.ideality_1 * curve_.thermal_V()),
      shunt_S_(1.0 / curve_.parameters().shunt_ohm),
      series_ohm_(parameters.series_ohm),
      is_plain_(parameters.saturation_2_A == 0.0 && parameters.breakdown_fraction == 0.0) {}

LitDiode::LitDiode(const CellParameters& parameters, std::shared_ptr<const DiodeVoltageTable> table)
    : LitDiode(parameters, 0.0) {
  table_ = std::move(table);
}

LitCells lit_cells(const CellModel& cell, const std::vector<double>& area_m2, double temperature_K,
                   double extra_shunt_S, bool tabulated) {
  LitCells cells;
  std::vector<double> known;
  for (const double area : area_m2) {
    size_t k = 0;
    while (k < known.size() && std::abs(known[k] - area) > 1e-9 * area) ++k;
    cells.kind_of_cell.push_back(static_cast<int>(k));
    if (k < known.size()) continue;
    known.push_back(area);
    const CellParameters p = with_shunt(parameters_at(cell, area, temperature_K), extra_shunt_S);
    constexpr double largest_A_m2 = 2000.0;  // five suns on silicon; beyond it the exact solution
    if (tabulated) {
      cells.kinds.emplace_back(
          p, std::make_shared<const DiodeVoltageTable>(CellCurve(p), largest_A_m2 * area));
    } else {
      cells.kinds.emplace_back(p, 0.0);
    }
  }
  return cells;
}

LitDiode::Point LitDiode::at(double dark_A) const {
  if (table_) {
    const DiodeVoltage at = table_->at(dark_A);
    return {at.value_V, at.slope_ohm, at.curvature_V_A2};
  }
  double v = 0.0, slope_S = 0.0, curvature = 0.0;
  if (!is_plain_) {
    v = curve_.diode_voltage_V(dark_A);
    const DarkCurrent d = curve_.dark(v);
    slope_S = d.slope_S;
    curvature = d.curvature_A_V2;
  } else {
    // Both terms alone bound the voltage from above, and Newton's steps on a convex function come
    // down from there.
    v = dark_A > 0.0 ? std::min(dark_A / shunt_S_, scale_V_ * std::log1p(dark_A / saturation_A_))
                     : dark_A / (shunt_S_ + saturation_A_ / scale_V_);
    // Steps fall quadratically: after one of 1e-5 the next would be of 1e-10, and the slopes follow
    // to first order.
    for (int i = 0; i < 60; ++i) {
      const double grown = saturation_A_ * std::exp(v / scale_V_);
      slope_S = grown / scale_V_ + shunt_S_;
      const double step = (grown - saturation_A_ + v * shunt_S_ - dark_A) / slope_S;
      v -= step;
      if (std::abs(step) < 1e-5 * scale_V_) {
        const double now = grown * (1.0 - step / scale_V_);
        slope_S = now / scale_V_ + shunt_S_;
        curvature = now / (scale_V_ * scale_V_);
        break;
      }
    }
  }
  const double r = 1.0 / slope_S;
  return {v, r, -curvature * r * r * r};
}

}  // namespace photorque

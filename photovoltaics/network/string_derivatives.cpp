// Bounds of a StringCurve between two points, its derivatives, and the states of its cells.
#include "photovoltaics/network/string.h"

namespace photorque {

SlopeRange StringCurve::substring_range(uint32_t index, const StringState& low_i,
                                        const StringState& high_i) const {
  const Substring& substring = substrings_[index];
  SlopeRange sum;
  for (const Run& run : runs_of(substring)) {
    for (uint32_t c = run.first_cell; c < run.first_cell + run.cells; ++c) {
      sum += cell_range(cells_[c], low_i.cells[c], high_i.cells[c]) * cells_[c].copies;
    }
  }
  for (const Row& row : rows_of(substring)) {
    sum += tied_cells_range(lit(row), std::span(low_i.cells).subspan(row.first_cell, row.cells),
                            std::span(high_i.cells).subspan(row.first_cell, row.cells));
  }
  if (substring.bypass.kind != Diode::Kind::junction) return sum;
  SlopeRange both = inverted(sum);
  both +=
      substring.bypass.range(low_i.bypasses[index].junction_S, high_i.bypasses[index].junction_S);
  return inverted(both);
}

SlopeRange StringCurve::resistance_range(const StringState& low_i, const StringState& high_i,
                                         const StringRegime& regime) const {
  SlopeRange sum;
  for (uint32_t s = 0; s < substrings_.size(); ++s) {
    if (!regime.clamped[s]) sum += substring_range(s, low_i, high_i);
  }
  if (blocking_.kind == Diode::Kind::junction) {
    const double low = high_i.blocking_ohm, high = low_i.blocking_ohm;
    sum += SlopeRange{low + blocking_.series_ohm, high + blocking_.series_ohm,
                      low * low * blocking_.per_scale_1_V, high * high * blocking_.per_scale_1_V};
  }
  return sum;
}

SlopeRange StringCurve::conductance_range(const StringState& low_i, const StringState& high_i,
                                          const StringRegime& regime) const {
  return regime.blocked ? SlopeRange{} : inverted(resistance_range(low_i, high_i, regime));
}

// Of the rows of a substring V_r(I_r) each photocurrent moves the voltage by r = dV_d/dj, and the
// slope by −q, q = dr/dj. In a row of tied cells at one voltage a cell's current moves by a =
// r/(r + R_s) of its photocurrent's change, and the row's voltage by a/S, S = Σ 1/(r + R_s); the
// slope follows by the chain rule through the currents of all its cells. A junction beside the
// rows, of the conductance g = di/dw, shares what they get: with ρ = −dV_r/dI_r and D = 1 + ρ g,
//   ∂V/∂I_k = r/D,   ∂²V/∂I∂I_k = −q/D² − r (ρ² dg/dw − g d²V_r/dI_r²)/D³.
std::vector<VoltageMotion> StringCurve::voltage_motions(const StringState& state,
                                                        const StringRegime& regime) const {
  std::vector<VoltageMotion> all, moved;  // the wiring's cells, and those of a substring
  for (uint32_t s = 0; s < substrings_.size(); ++s) {
    if (regime.clamped[s]) continue;
    const Substring& substring = substrings_[s];
    moved.clear();
    double rows_ohm = 0.0, rows_V_A2 = 0.0;
    for (const Run& run : runs_of(substring)) {
      for (uint32_t c = run.first_cell; c < run.first_cell + run.cells; ++c) {
        const JunctionState& cell = state.cells[c];
        moved.push_back({c, cell.slope_ohm, -cell.curvature_V_A2});
        rows_ohm += copies_[c] * (cell.slope_ohm + cells_[c].series_ohm);
        rows_V_A2 += copies_[c] * cell.curvature_V_A2;
      }
    }
    for (const Row& row : rows_of(substring)) {
      double all_S = 0.0, bend = 0.0;
      for (uint32_t c = row.first_cell; c < row.first_cell + row.cells; ++c) {
        const double cell_S = 1.0 / (state.cells[c].slope_ohm + cells_[c].series_ohm);
        all_S += cell_S;
        bend += state.cells[c].curvature_V_A2 * cell_S * cell_S * cell_S;
      }
      for (uint32_t c = row.first_cell; c < row.first_cell + row.cells; ++c) {
        const JunctionState& cell = state.cells[c];
        const double ohm = cell.slope_ohm + cells_[c].series_ohm, part = cell.slope_ohm / ohm;
        moved.push_back({c, part / all_S,
                         -(cell.curvature_V_A2 * cells_[c].series_ohm / (ohm * ohm * ohm) +
                           part * bend / all_S) /
                             (all_S * all_S)});
      }
      rows_ohm += 1.0 / all_S;
      rows_V_A2 += bend / (all_S * all_S * all_S);
    }
    double beside = 1.0, more = 0.0;  // D, and what multiplies −r/D³
    if (substring.bypass.kind == Diode::Kind::junction) {
      const Slopes diode = substring.bypass.slopes(state.bypasses[s].junction_S);
      beside = 1.0 + rows_ohm * diode.slope;
      more = rows_ohm * rows_ohm * diode.curvature - diode.slope * rows_V_A2;
    }
    for (const VoltageMotion& m : moved) {
      for (const int wired : wired_to(static_cast<uint32_t>(m.cell))) {
        all.push_back({static_cast<size_t>(wired), m.voltage_ohm / beside,
                       (m.slope_V_A2 - m.voltage_ohm * more / beside) / (beside * beside)});
      }
    }
  }
  return all;
}

void StringCurve::cells_at(double current_A, std::vector<double>& voltages_V,
                           std::vector<double>& currents_A) const {
  StringState state = make_state();
  const StringRegime regime = regime_at(current_A);
  for (uint32_t s = 0; s < substrings_.size(); ++s) {
    const Substring& substring = substrings_[s];
    double rows_A = regime.clamped[s] ? substring.clamp_A : current_A;
    if (substring.bypass.kind == Diode::Kind::junction) {
      bypassed_at(s, current_A, 1e-9, state);
      rows_A -= substring.bypass.saturation_A *
                std::expm1(state.bypasses[s].junction_V / substring.bypass.scale_V);
    }
    for (const Run& run : runs_of(substring)) {
      for (uint32_t c = run.first_cell; c < run.first_cell + run.cells; ++c) {
        const double voltage_V = cell_at(cells_[c], rows_A, state.cells[c]).voltage_V;
        for (const int wired : wired_to(c)) {
          voltages_V[static_cast<size_t>(wired)] = voltage_V;
          currents_A[static_cast<size_t>(wired)] = rows_A;
        }
      }
    }
    for (const Row& row : rows_of(substring)) {
      const auto states = std::span(state.cells).subspan(row.first_cell, row.cells);
      const double voltage_V = tied_cells_at(lit(row), rows_A, states).voltage_V;
      for (uint32_t c = row.first_cell; c < row.first_cell + row.cells; ++c) {
        const auto wired = static_cast<size_t>(wired_to(c).front());
        voltages_V[wired] = voltage_V;
        currents_A[wired] = cells_[c].law->curve().current_A(cells_[c].photocurrent_A,
                                                             voltage_V - cells_[c].offset_V);
      }
    }
  }
}

}  // namespace photorque

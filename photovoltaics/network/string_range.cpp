// Bounds of a StringCurve between two points, and what its cells do.
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
        currents_A[wired] = cells_[c].table->curve().current_A(cells_[c].photocurrent_A, voltage_V);
      }
    }
  }
}

}  // namespace photorque

#include "receivers/photovoltaic_string.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "receivers/photovoltaic_root.h"

namespace photorque {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Below this a junction carries nothing that double precision can see; keeps cubes of its
// reciprocal finite.
constexpr double least_S = 1e-90;

double scale_V(const Diode& diode) {
  return diode.ideality * boltzmann_J_K * diode.temperature_K / elementary_charge_C;
}

// I(V) of a junction with its series resistance, from the junction's own conductance: the slope
// rises with it, the curvature has one maximum at g R_s = 1/2.
double bypass_slope_S(double g, const Diode& d) {
  return g / (1.0 + g * d.series_ohm);
}
double bypass_curvature_A_V2(double g, const Diode& d) {
  const double divisor = 1.0 + g * d.series_ohm;
  return g / (scale_V(d) * divisor * divisor * divisor);
}

SlopeRange bypass_range(double low_S, double high_S, const Diode& d) {
  const double a = bypass_curvature_A_V2(low_S, d), b = bypass_curvature_A_V2(high_S, d);
  const double peak_S = 0.5 / std::max(d.series_ohm, 1e-30);
  const double top =
      low_S < peak_S && peak_S < high_S ? bypass_curvature_A_V2(peak_S, d) : std::max(a, b);
  return {bypass_slope_S(low_S, d), bypass_slope_S(high_S, d), std::min(a, b), top};
}

}  // namespace

StringCurve::StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
                         const std::vector<double>& photocurrents_A)
    : blocking_(wiring.blocking) {
  for (const auto& substring : wiring.substrings) add_substring(substring, tables, photocurrents_A);
  for (const LitCell& cell : cells_) {
    largest_photocurrent_A_ = std::max(largest_photocurrent_A_, cell.photocurrent_A);
  }
  StringState state = make_state();
  for (Substring& substring : substrings_) substring.clamp_A = clamp_current_A(substring, state);
  at_current(0.0, regime_at(0.0), state);
  open_circuit_V_ = state.voltage_V;
}

void StringCurve::add_substring(const ArrayWiring::Substring& wiring, const CellTables& tables,
                                const std::vector<double>& photocurrents_A) {
  const auto lit = [&](int cell) {
    const auto i = static_cast<size_t>(cell);
    return LitCell{tables[i].get(), photocurrents_A[i], tables[i]->curve().parameters().series_ohm};
  };
  Substring substring{static_cast<uint32_t>(rows_.size()), 0, wiring.bypass, infinity};
  std::vector<int> singles;
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) {
      singles.push_back(row[0]);
      continue;
    }
    rows_.push_back({static_cast<uint32_t>(cells_.size()), static_cast<uint32_t>(row.size()), 1.0});
    for (const int cell : row) {
      cells_.push_back(lit(cell));
      wired_.push_back({cell});
    }
  }
  std::ranges::stable_sort(singles, [&](int a, int b) {
    const LitCell x = lit(a), y = lit(b);
    if (x.photocurrent_A != y.photocurrent_A) return x.photocurrent_A < y.photocurrent_A;
    return std::less<>()(x.table, y.table);
  });
  for (const int cell : singles) {
    const LitCell next = lit(cell);
    const bool same = !rows_.empty() && rows_.size() > substring.first_row &&
                      rows_.back().cells == 1 && cells_.back().table == next.table &&
                      cells_.back().photocurrent_A == next.photocurrent_A;
    if (same) {
      rows_.back().copies += 1.0;
      wired_.back().push_back(cell);
    } else {
      rows_.push_back({static_cast<uint32_t>(cells_.size()), 1, 1.0});
      cells_.push_back(next);
      wired_.push_back({cell});
    }
  }
  substring.rows = static_cast<uint32_t>(rows_.size()) - substring.first_row;
  substrings_.push_back(substring);
}

StringState StringCurve::make_state() const {
  StringState state;
  state.cells.resize(cells_.size());
  state.bypass_V.resize(substrings_.size());
  state.bypass_S.resize(substrings_.size());
  return state;
}

StringRegime StringCurve::regime_at(double current_A) const {
  StringRegime regime;
  regime.clamped.reserve(substrings_.size());
  for (const Substring& s : substrings_) regime.clamped.push_back(current_A >= s.clamp_A);
  return regime;
}

std::vector<double> StringCurve::clamp_currents_A() const {
  std::vector<double> currents;
  currents.reserve(substrings_.size());
  for (const Substring& s : substrings_) currents.push_back(s.clamp_A);
  return currents;
}

double StringCurve::largest_A(const Substring& substring) const {
  double largest = 0.0;
  for (uint32_t r = substring.first_row; r < substring.first_row + substring.rows; ++r) {
    double sum = 0.0;
    for (uint32_t c = 0; c < rows_[r].cells; ++c) {
      sum += cells_[rows_[r].first_cell + c].photocurrent_A;
    }
    largest = std::max(largest, sum);
  }
  return largest;
}

double StringCurve::clamp_current_A(const Substring& substring, StringState& state) const {
  if (substring.bypass.kind != Diode::Kind::clamp) return infinity;
  const double drop_V = substring.bypass.drop_V;
  const auto excess_V = [&](double current_A) {
    const ElementPoint p = rows_at(substring, current_A, state);
    return ValueAndSlope{p.voltage_V + drop_V, -p.slope_ohm};
  };
  double low = 0.0, high = largest_A(substring), step = 1e-3 * high + 1e-9;
  while (excess_V(high).value > 0.0) {
    low = high;
    high += step;
    step *= 4.0;
  }
  return falling_root(low, high, std::midpoint(low, high), 1e-13, excess_V);
}

ElementPoint StringCurve::rows_at(const Substring& substring, double current_A,
                                  StringState& state) const {
  ElementPoint sum;
  for (uint32_t r = substring.first_row; r < substring.first_row + substring.rows; ++r) {
    const Row& row = rows_[r];
    const ElementPoint p =
        row.cells == 1
            ? cell_at(cells_[row.first_cell], current_A, state.cells[row.first_cell])
            : tied_cells_at(std::span(cells_).subspan(row.first_cell, row.cells), current_A,
                            std::span(state.cells).subspan(row.first_cell, row.cells));
    sum.voltage_V += row.copies * p.voltage_V;
    sum.slope_ohm += row.copies * p.slope_ohm;
    sum.curvature_V_A2 += row.copies * p.curvature_V_A2;
  }
  return sum;
}

// With u the junction voltage of the bypass diode, its current is i(u) = I_s (e^{u/nV_t} − 1) and
// the substring's voltage is −(u + i R_s): one equation, V_rows(I − i(u)) + u + i(u) R_s = 0,
// rising in u. At u = −V_rows(I) the left side has the sign of u, at u = 0 the other one; and a
// diode that carries all of I leaves the rows at V ≥ 0.
ElementPoint StringCurve::bypassed_at(uint32_t index, double current_A, StringState& state) const {
  const Substring& substring = substrings_[index];
  const Diode& d = substring.bypass;
  const double scale = scale_V(d);
  ElementPoint rows;
  double g = 0.0;
  const auto shortfall_V = [&](double u) {
    const double through_A = d.saturation_A * std::expm1(u / scale);
    g = (through_A + d.saturation_A) / scale;
    rows = rows_at(substring, current_A - through_A, state);
    return ValueAndSlope{-(rows.voltage_V + u + through_A * d.series_ohm),
                         -(rows.slope_ohm * g + 1.0 + g * d.series_ohm)};
  };
  const double alone_V = -rows_at(substring, current_A, state).voltage_V;
  const double all_V = scale * std::log1p(std::max(current_A, 0.0) / d.saturation_A);
  const double u = falling_root(std::min(alone_V, 0.0), std::clamp(alone_V, 0.0, all_V),
                                state.bypass_V[index], 1e-9, shortfall_V);
  state.bypass_V[index] = u;
  state.bypass_S[index] = g;
  const double rows_S = 1.0 / rows.slope_ohm;
  const double slope = 1.0 / (rows_S + bypass_slope_S(g, d));
  const double curvature =
      rows.curvature_V_A2 * rows_S * rows_S * rows_S + bypass_curvature_A_V2(g, d);
  const double through_A = d.saturation_A * std::expm1(u / scale);
  return {-(u + through_A * d.series_ohm), slope, curvature * slope * slope * slope};
}

ElementPoint StringCurve::substrings_at(double current_A, const StringRegime& regime,
                                        StringState& state) const {
  ElementPoint sum;
  for (uint32_t s = 0; s < substrings_.size(); ++s) {
    const Substring& substring = substrings_[s];
    if (regime.clamped[s]) {
      sum.voltage_V -= substring.bypass.drop_V;
      continue;
    }
    const ElementPoint p = substring.bypass.kind == Diode::Kind::junction
                               ? bypassed_at(s, current_A, state)
                               : rows_at(substring, current_A, state);
    sum.voltage_V += p.voltage_V;
    sum.slope_ohm += p.slope_ohm;
    sum.curvature_V_A2 += p.curvature_V_A2;
  }
  return sum;
}

void StringCurve::at_current(double current_A, const StringRegime& regime,
                             StringState& state) const {
  ElementPoint sum = substrings_at(current_A, regime, state);
  if (blocking_.kind == Diode::Kind::clamp) sum.voltage_V -= blocking_.drop_V;
  if (blocking_.kind == Diode::Kind::junction) {
    const double scale = scale_V(blocking_);
    const double g = std::max((current_A + blocking_.saturation_A) / scale, least_S);
    state.blocking_S = g;
    sum.voltage_V -=
        scale * std::log1p(current_A / blocking_.saturation_A) + current_A * blocking_.series_ohm;
    sum.slope_ohm += 1.0 / g + blocking_.series_ohm;
    sum.curvature_V_A2 += 1.0 / (scale * g * g);
  }
  state.current_A = current_A;
  state.voltage_V = sum.voltage_V;
  state.slope_ohm = sum.slope_ohm;
  state.curvature_V_A2 = sum.curvature_V_A2;
}

// Backwards through a blocking junction the current is below I_s; its voltage z is what is left
// over.
void StringCurve::reverse_at_voltage(double voltage_V, const StringRegime& regime,
                                     StringState& state) const {
  const double scale = scale_V(blocking_);
  ElementPoint sum;
  double g = 0.0, current_A = 0.0;
  const auto surplus_V = [&](double z) {
    current_A = blocking_.saturation_A * std::expm1(z / scale);
    g = std::max((current_A + blocking_.saturation_A) / scale, least_S);
    sum = substrings_at(current_A, regime, state);
    return ValueAndSlope{sum.voltage_V - current_A * blocking_.series_ohm - z - voltage_V,
                         -(sum.slope_ohm + blocking_.series_ohm) * g - 1.0};
  };
  const double z =
      falling_root(open_circuit_V_ - voltage_V, 0.0, open_circuit_V_ - voltage_V, 1e-9, surplus_V);
  current_A = blocking_.saturation_A * std::expm1(z / scale);
  state.blocking_S = g;
  state.current_A = current_A;
  state.voltage_V = voltage_V;
  state.slope_ohm = sum.slope_ohm + blocking_.series_ohm + 1.0 / g;
  state.curvature_V_A2 = sum.curvature_V_A2 + 1.0 / (scale * g * g);
}

void StringCurve::at_voltage(double voltage_V, const StringRegime& regime, double low_A,
                             double high_A, StringState& state) const {
  if (regime.blocked) {
    state.current_A = 0.0;
    state.voltage_V = voltage_V;
    state.slope_ohm = infinity;
    state.curvature_V_A2 = 0.0;
    return;
  }
  if (blocking_.kind == Diode::Kind::junction && voltage_V >= open_circuit_V_) {
    reverse_at_voltage(voltage_V, regime, state);
    return;
  }
  const auto excess_V = [&](double current_A) {
    at_current(current_A, regime, state);
    return ValueAndSlope{state.voltage_V - voltage_V, -state.slope_ohm};
  };
  if (voltage_V > open_circuit_V_ && low_A >= 0.0) {
    // Fed backwards by the other strings.
    double step = 1e-3 * largest_photocurrent_A_ + 1e-9;
    high_A = 0.0;
    for (low_A = -step; excess_V(low_A).value < 0.0; step *= 4.0) {
      high_A = low_A;
      low_A -= step;
    }
  }
  state.current_A = falling_root(low_A, high_A, state.current_A, 1e-9, excess_V);
  state.voltage_V = voltage_V;
}

SlopeRange StringCurve::substring_range(uint32_t index, const StringState& low_i,
                                        const StringState& high_i) const {
  const Substring& substring = substrings_[index];
  SlopeRange sum;
  for (uint32_t r = substring.first_row; r < substring.first_row + substring.rows; ++r) {
    const Row& row = rows_[r];
    const uint32_t c = row.first_cell;
    sum += row.cells == 1 ? cell_range(cells_[c], low_i.cells[c], high_i.cells[c]) * row.copies
                          : tied_cells_range(std::span(cells_).subspan(c, row.cells),
                                             std::span(low_i.cells).subspan(c, row.cells),
                                             std::span(high_i.cells).subspan(c, row.cells));
  }
  if (substring.bypass.kind != Diode::Kind::junction) return sum;
  SlopeRange both = inverted(sum);
  both += bypass_range(low_i.bypass_S[index], high_i.bypass_S[index], substring.bypass);
  return inverted(both);
}

SlopeRange StringCurve::resistance_range(const StringState& low_i, const StringState& high_i,
                                         const StringRegime& regime) const {
  SlopeRange sum;
  for (uint32_t s = 0; s < substrings_.size(); ++s) {
    if (!regime.clamped[s]) sum += substring_range(s, low_i, high_i);
  }
  if (blocking_.kind == Diode::Kind::junction) {
    const double low = low_i.blocking_S, high = high_i.blocking_S, scale = scale_V(blocking_);
    sum += {1.0 / high + blocking_.series_ohm, 1.0 / low + blocking_.series_ohm,
            1.0 / (scale * high * high), 1.0 / (scale * low * low)};
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
      bypassed_at(s, current_A, state);
      rows_A -=
          substring.bypass.saturation_A * std::expm1(state.bypass_V[s] / scale_V(substring.bypass));
    }
    for (uint32_t r = substring.first_row; r < substring.first_row + substring.rows; ++r) {
      const uint32_t first = rows_[r].first_cell, count = rows_[r].cells;
      const ElementPoint row = tied_cells_at(std::span(cells_).subspan(first, count), rows_A,
                                             std::span(state.cells).subspan(first, count));
      for (uint32_t c = first; c < first + count; ++c) {
        for (const int wired : wired_[c]) {
          const auto i = static_cast<size_t>(wired);
          voltages_V[i] = row.voltage_V;
          currents_A[i] = count == 1 ? rows_A
                                     : cells_[c].table->curve().current_A(cells_[c].photocurrent_A,
                                                                          row.voltage_V);
        }
      }
    }
  }
}

}  // namespace photorque

#include "receivers/photovoltaic_string.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "receivers/photovoltaic_root.h"

namespace photorque {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Beyond this a junction carries nothing that double precision can see; keeps its cube finite.
constexpr double most_ohm = 1e90;
// At this many n V_t in reverse a diode carries I_s but for 1e-13 of it.
constexpr double saturated = -30.0;

}  // namespace

StringCurve::Junction::Junction(const Diode& diode)
    : kind(diode.kind),
      drop_V(diode.drop_V),
      saturation_A(diode.saturation_A),
      series_ohm(diode.series_ohm),
      scale_V(diode.ideality * boltzmann_J_K * diode.temperature_K / elementary_charge_C),
      per_scale_1_V(1.0 / scale_V) {}

double StringCurve::Junction::slope_S(double g) const {
  return g / (1.0 + g * series_ohm);
}

double StringCurve::Junction::curvature_A_V2(double g) const {
  const double divisor = 1.0 + g * series_ohm;
  return g / (scale_V * divisor * divisor * divisor);
}

// The slope rises with g; the curvature has one maximum, at g R_s = 1/2.
SlopeRange StringCurve::Junction::range(double low_S, double high_S) const {
  const double a = curvature_A_V2(low_S), b = curvature_A_V2(high_S);
  const double peak_S = 0.5 / std::max(series_ohm, 1e-30);
  const bool inside = low_S < peak_S && peak_S < high_S;
  return {slope_S(low_S), slope_S(high_S), std::min(a, b),
          inside ? curvature_A_V2(peak_S) : std::max(a, b)};
}

StringCurve::StringCurve(const ArrayWiring::String& wiring, const CellTables& tables,
                         const std::vector<double>& photocurrents_A)
    : blocking_(wiring.blocking) {
  for (const auto& substring : wiring.substrings) add_substring(substring, tables, photocurrents_A);
  for (const Substring& substring : substrings_) {
    largest_photocurrent_A_ = std::max(largest_photocurrent_A_, largest_A(substring));
  }
  StringState state = make_state();
  for (Substring& substring : substrings_) {
    substring.clamp_A = clamp_current_A(substring, state);
    substring.open_circuit_V = rows_at(substring, 0.0, state).voltage_V;
  }
  at_current(0.0, regime_at(0.0), state);
  open_circuit_V_ = state.voltage_V;
}

void StringCurve::add_substring(const ArrayWiring::Substring& wiring, const CellTables& tables,
                                const std::vector<double>& photocurrents_A) {
  const auto lit_cell = [&](int cell) {
    const auto i = static_cast<size_t>(cell);
    return LitCell{tables[i].get(), photocurrents_A[i], tables[i]->curve().parameters().series_ohm};
  };
  const auto add = [&](int cell) {
    cells_.push_back(lit_cell(cell));
    wired_.push_back({cell});
  };
  std::vector<int> singles;
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) singles.push_back(row[0]);
  }
  // Like cells stand next to each other and become one.
  std::ranges::stable_sort(singles, [&](int a, int b) {
    const LitCell x = lit_cell(a), y = lit_cell(b);
    if (x.photocurrent_A != y.photocurrent_A) return x.photocurrent_A < y.photocurrent_A;
    return std::less<>()(x.table, y.table);
  });
  Substring substring{Junction(wiring.bypass)};
  substring.first_cell = static_cast<uint32_t>(cells_.size());
  for (const int cell : singles) {
    const LitCell next = lit_cell(cell);
    if (cells_.size() > substring.first_cell && cells_.back().table == next.table &&
        cells_.back().photocurrent_A == next.photocurrent_A) {
      cells_.back().copies += 1.0;
      wired_.back().push_back(cell);
    } else {
      add(cell);
    }
  }
  substring.cells = static_cast<uint32_t>(cells_.size()) - substring.first_cell;
  substring.first_row = static_cast<uint32_t>(rows_.size());
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) continue;
    rows_.push_back({static_cast<uint32_t>(cells_.size()), static_cast<uint32_t>(row.size())});
    for (const int cell : row) add(cell);
  }
  substring.rows = static_cast<uint32_t>(rows_.size()) - substring.first_row;
  substrings_.push_back(substring);
}

StringState StringCurve::make_state() const {
  StringState state;
  state.cells.resize(cells_.size());
  state.bypass_V.resize(substrings_.size(), -infinity);
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

// From this current on no row has a voltage above zero.
double StringCurve::largest_A(const Substring& substring) const {
  double largest = 0.0;
  for (uint32_t c = substring.first_cell; c < substring.first_cell + substring.cells; ++c) {
    largest = std::max(largest, cells_[c].photocurrent_A);
  }
  for (const Row& row : rows_of(substring)) {
    double sum = 0.0;
    for (const LitCell& cell : lit(row)) sum += cell.photocurrent_A;
    largest = std::max(largest, sum);
  }
  return largest;
}

double StringCurve::clamp_current_A(const Substring& substring, StringState& state) const {
  if (substring.bypass.kind != Diode::Kind::clamp) return infinity;
  const double drop_V = substring.bypass.drop_V;
  const auto excess_V = [&](double current_A) {
    const ElementPoint p = rows_at(substring, current_A, state);
    return FunctionAt{p.voltage_V + drop_V, -p.slope_ohm};
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
  for (uint32_t c = substring.first_cell; c < substring.first_cell + substring.cells; ++c) {
    const ElementPoint p = cell_at(cells_[c], current_A, state.cells[c]);
    const double copies = cells_[c].copies;
    sum.voltage_V += copies * p.voltage_V;
    sum.slope_ohm += copies * p.slope_ohm;
    sum.curvature_V_A2 += copies * p.curvature_V_A2;
  }
  for (const Row& row : rows_of(substring)) {
    const ElementPoint p = tied_cells_at(lit(row), current_A,
                                         std::span(state.cells).subspan(row.first_cell, row.cells));
    sum.voltage_V += p.voltage_V;
    sum.slope_ohm += p.slope_ohm;
    sum.curvature_V_A2 += p.curvature_V_A2;
  }
  return sum;
}

// With u the junction voltage of the bypass diode, its current is i(u) = I_s (e^{u/nV_t} − 1) and
// the substring's voltage is −(u + i R_s): one equation, V_rows(I − i(u)) + u + i(u) R_s = 0,
// rising in u. A diode that carries all of I leaves the rows at V ≥ 0, and one that carries nothing
// leaves them at most at their open circuit: between the two lies u.
ElementPoint StringCurve::bypassed_at(uint32_t index, double current_A, StringState& state) const {
  const Substring& substring = substrings_[index];
  const Junction& d = substring.bypass;
  const double scale = d.scale_V;
  double& warm_V = state.bypass_V[index];
  if (warm_V <= saturated * scale) {
    // Far in reverse the diode leaks I_s and no more: nothing to solve.
    const ElementPoint rows = rows_at(substring, current_A + d.saturation_A, state);
    const double u = d.saturation_A * d.series_ohm - rows.voltage_V;
    warm_V = u;
    state.bypass_S[index] = 0.0;
    if (u <= saturated * scale) return rows;
  }
  ElementPoint rows;
  double g = 0.0;
  const auto shortfall_V = [&](double u) {
    const double through_A = d.saturation_A * std::expm1(u * d.per_scale_1_V);
    g = (through_A + d.saturation_A) * d.per_scale_1_V;
    rows = rows_at(substring, current_A - through_A, state);
    return FunctionAt{-(rows.voltage_V + u + through_A * d.series_ohm),
                      -(rows.slope_ohm * g + 1.0 + g * d.series_ohm)};
  };
  const double lowest_V = current_A >= 0.0 ? -substring.open_circuit_V
                                           : -rows_at(substring, current_A, state).voltage_V;
  const double highest_V = scale * std::log1p(std::max(current_A, 0.0) / d.saturation_A);
  const double u =
      falling_root(lowest_V, highest_V, std::min(warm_V, highest_V), 1e-9, shortfall_V);
  warm_V = u;
  state.bypass_S[index] = g;
  const double rows_S = 1.0 / rows.slope_ohm;
  const double slope = 1.0 / (rows_S + d.slope_S(g));
  const double curvature = rows.curvature_V_A2 * rows_S * rows_S * rows_S + d.curvature_A_V2(g);
  const double through_A = d.saturation_A * std::expm1(u * d.per_scale_1_V);
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
    const double junction_ohm =
        std::min(blocking_.scale_V / (current_A + blocking_.saturation_A), most_ohm);
    state.blocking_ohm = junction_ohm;
    sum.voltage_V -= blocking_.scale_V * std::log1p(current_A / blocking_.saturation_A) +
                     current_A * blocking_.series_ohm;
    sum.slope_ohm += junction_ohm + blocking_.series_ohm;
    sum.curvature_V_A2 += junction_ohm * junction_ohm * blocking_.per_scale_1_V;
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
  ElementPoint sum;
  double junction_S = 0.0, current_A = 0.0;
  const auto surplus_V = [&](double z) {
    current_A = blocking_.saturation_A * std::expm1(z * blocking_.per_scale_1_V);
    junction_S = (current_A + blocking_.saturation_A) * blocking_.per_scale_1_V;
    sum = substrings_at(current_A, regime, state);
    return FunctionAt{sum.voltage_V - current_A * blocking_.series_ohm - z - voltage_V,
                      -(sum.slope_ohm + blocking_.series_ohm) * junction_S - 1.0};
  };
  const double left_over_V = open_circuit_V_ - voltage_V;
  const double z = falling_root(left_over_V, 0.0, left_over_V, 1e-9, surplus_V);
  const double junction_ohm = std::min(1.0 / junction_S, most_ohm);
  state.blocking_ohm = junction_ohm;
  state.current_A = blocking_.saturation_A * std::expm1(z * blocking_.per_scale_1_V);
  state.voltage_V = voltage_V;
  state.slope_ohm = sum.slope_ohm + blocking_.series_ohm + junction_ohm;
  state.curvature_V_A2 = sum.curvature_V_A2 + junction_ohm * junction_ohm * blocking_.per_scale_1_V;
}

void StringCurve::at_voltage(double voltage_V, const StringRegime& regime, double low_A,
                             double high_A, double tolerance, StringState& state) const {
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
    return FunctionAt{state.voltage_V - voltage_V, -state.slope_ohm, state.curvature_V_A2};
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
  state.current_A = falling_root(low_A, high_A, state.current_A, tolerance, excess_V);
  state.voltage_V = voltage_V;
}

SlopeRange StringCurve::substring_range(uint32_t index, const StringState& low_i,
                                        const StringState& high_i) const {
  const Substring& substring = substrings_[index];
  SlopeRange sum;
  for (uint32_t c = substring.first_cell; c < substring.first_cell + substring.cells; ++c) {
    sum += cell_range(cells_[c], low_i.cells[c], high_i.cells[c]) * cells_[c].copies;
  }
  for (const Row& row : rows_of(substring)) {
    sum += tied_cells_range(lit(row), std::span(low_i.cells).subspan(row.first_cell, row.cells),
                            std::span(high_i.cells).subspan(row.first_cell, row.cells));
  }
  if (substring.bypass.kind != Diode::Kind::junction) return sum;
  SlopeRange both = inverted(sum);
  both += substring.bypass.range(low_i.bypass_S[index], high_i.bypass_S[index]);
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
      bypassed_at(s, current_A, state);
      rows_A -=
          substring.bypass.saturation_A * std::expm1(state.bypass_V[s] / substring.bypass.scale_V);
    }
    for (uint32_t c = substring.first_cell; c < substring.first_cell + substring.cells; ++c) {
      const double voltage_V = cell_at(cells_[c], rows_A, state.cells[c]).voltage_V;
      for (const int wired : wired_[c]) {
        voltages_V[static_cast<size_t>(wired)] = voltage_V;
        currents_A[static_cast<size_t>(wired)] = rows_A;
      }
    }
    for (const Row& row : rows_of(substring)) {
      const auto states = std::span(state.cells).subspan(row.first_cell, row.cells);
      const double voltage_V = tied_cells_at(lit(row), rows_A, states).voltage_V;
      for (uint32_t c = row.first_cell; c < row.first_cell + row.cells; ++c) {
        const auto wired = static_cast<size_t>(wired_[c].front());
        voltages_V[wired] = voltage_V;
        currents_A[wired] = cells_[c].table->curve().current_A(cells_[c].photocurrent_A, voltage_V);
      }
    }
  }
}

}  // namespace photorque

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

// With w the voltage forwards, w(i) = n V_t ln(1 + i/I_s) + i R_s; the substring's V is −w.
Slopes StringCurve::Junction::slopes(double g) const {
  const double divisor = 1.0 + g * series_ohm, per_divisor = 1.0 / divisor;
  const double per_divisor3 = per_divisor * per_divisor * per_divisor;
  const double bend = g * per_scale_1_V * per_divisor3;
  return {g * per_divisor, bend,
          -bend * per_scale_1_V * (1.0 - 2.0 * g * series_ohm) * per_divisor * per_divisor};
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
  reserve(wiring);
  for (const auto& substring : wiring.substrings) add_substring(substring, tables, photocurrents_A);
  for (const Substring& substring : substrings_) {
    largest_photocurrent_A_ = std::max(largest_photocurrent_A_, largest_A(substring));
  }
  StringState state = make_state();
  for (Substring& substring : substrings_) {
    const Junction& bypass = substring.bypass;
    if (bypass.kind == Diode::Kind::clamp) {
      substring.clamp_A = rows_current_A(substring, bypass.drop_V, state);
    } else if (bypass.kind == Diode::Kind::junction) {
      const double typical_A = 0.2 * largest_photocurrent_A_;
      substring.turn_on_A = rows_current_A(
          substring, bypass.scale_V * std::log1p(typical_A / bypass.saturation_A), state);
    }
    substring.open_circuit_V = rows_at(substring, 0.0, state).voltage_V;
  }
  at_current(0.0, regime_at(0.0), 1e-9, state);
  open_circuit_V_ = state.voltage_V;
}

// Room for all, filled up in runs of like tables.
void StringCurve::reserve(const ArrayWiring::String& wiring) {
  size_t cells = 0;
  for (const auto& substring : wiring.substrings) {
    for (const auto& row : substring.rows) cells += row.size();
    cells += DiodeVoltageTable::lanes;
  }
  cells_.reserve(cells);
  photocurrents_A_.reserve(cells);
  copies_.reserve(cells);
  wired_.reserve(cells);
  first_wired_.reserve(cells);
  substrings_.reserve(wiring.substrings.size());
}

void StringCurve::add_cell(int cell, const CellTables& tables,
                           const std::vector<double>& photocurrents_A) {
  const auto i = static_cast<size_t>(cell);
  cells_.push_back(
      {tables[i].get(), photocurrents_A[i], tables[i]->curve().parameters().series_ohm});
  photocurrents_A_.push_back(photocurrents_A[i]);
  close_V_ = std::min(close_V_, 0.1 * tables[i]->curve().least_scale_V());
  copies_.push_back(1.0);
  first_wired_.push_back(static_cast<uint32_t>(wired_.size()));
  wired_.push_back(cell);
}

// Cells of one table stand next to each other; like cells under the same light become one.
void StringCurve::add_series(std::vector<int> cells, const CellTables& tables,
                             const std::vector<double>& photocurrents_A) {
  const auto table = [&](int cell) { return tables[static_cast<size_t>(cell)].get(); };
  const auto light_A = [&](int cell) { return photocurrents_A[static_cast<size_t>(cell)]; };
  std::ranges::stable_sort(cells, [&](int a, int b) {
    if (table(a) != table(b)) return std::less<>()(table(a), table(b));
    return light_A(a) < light_A(b);
  });
  for (size_t first = 0, end = 0; first < cells.size(); first = end) {
    Run run{table(cells[first]), 0.0, static_cast<uint32_t>(cells_.size()), 0, 0};
    for (; end < cells.size() && table(cells[end]) == run.table; ++end) {
      if (end > first && light_A(cells[end]) == light_A(cells[end - 1])) {
        cells_.back().copies += 1.0;
        copies_.back() += 1.0;
        wired_.push_back(cells[end]);
      } else {
        add_cell(cells[end], tables, photocurrents_A);
      }
      run.series_ohm += cells_.back().series_ohm;
    }
    run.cells = static_cast<uint32_t>(cells_.size()) - run.first_cell;
    while ((cells_.size() - run.first_cell) % DiodeVoltageTable::lanes != 0) {
      add_cell(cells[end - 1], tables, photocurrents_A);
      copies_.back() = 0.0;
    }
    run.filled_cells = static_cast<uint32_t>(cells_.size()) - run.first_cell;
    runs_.push_back(run);
  }
}

void StringCurve::add_substring(const ArrayWiring::Substring& wiring, const CellTables& tables,
                                const std::vector<double>& photocurrents_A) {
  std::vector<int> singles;
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) singles.push_back(row[0]);
  }
  Substring substring{Junction(wiring.bypass)};
  substring.first_run = static_cast<uint32_t>(runs_.size());
  add_series(std::move(singles), tables, photocurrents_A);
  substring.runs = static_cast<uint32_t>(runs_.size()) - substring.first_run;
  substring.first_row = static_cast<uint32_t>(rows_.size());
  for (const auto& row : wiring.rows) {
    if (row.size() == 1) continue;
    rows_.push_back({static_cast<uint32_t>(cells_.size()), static_cast<uint32_t>(row.size())});
    for (const int cell : row) add_cell(cell, tables, photocurrents_A);
  }
  substring.rows = static_cast<uint32_t>(rows_.size()) - substring.first_row;
  substrings_.push_back(substring);
}

StringState StringCurve::make_state() const {
  StringState state;
  state.cells.resize(cells_.size());
  state.bypasses.resize(substrings_.size());
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

double StringCurve::first_guess_A() const {
  double guess_A = largest_photocurrent_A_;
  for (const Substring& s : substrings_) guess_A = std::min(guess_A, s.clamp_A);
  return guess_A;
}

// From this current on no row has a voltage above zero.
double StringCurve::largest_A(const Substring& substring) const {
  double largest = 0.0;
  for (const Run& run : runs_of(substring)) {
    largest = std::max(largest, cells_[run.first_cell + run.cells - 1].photocurrent_A);
  }
  for (const Row& row : rows_of(substring)) {
    double sum = 0.0;
    for (const LitCell& cell : lit(row)) sum += cell.photocurrent_A;
    largest = std::max(largest, sum);
  }
  return largest;
}

double StringCurve::rows_current_A(const Substring& substring, double drop_V,
                                   StringState& state) const {
  const auto excess_V = [&](double current_A) {
    const ElementPoint p = rows_at(substring, current_A, state);
    const double excess = p.voltage_V + drop_V;
    return FunctionAt{excess, -p.slope_ohm, p.curvature_V_A2, p.third_V_A3, close(excess)};
  };
  double low = 0.0, high = largest_A(substring), step = 1e-3 * high + 1e-9;
  while (excess_V(high).value > 0.0) {
    low = high;
    high += step;
    step *= 4.0;
  }
  return falling_root(low, high, std::midpoint(low, high), 1e-9, excess_V);
}

ElementPoint StringCurve::rows_at(const Substring& substring, double current_A,
                                  StringState& state) const {
  ElementPoint sum;
  for (const Run& run : runs_of(substring)) {
    const DiodeVoltage v = run.table->series_at(
        std::span(photocurrents_A_).subspan(run.first_cell, run.filled_cells),
        std::span(copies_).subspan(run.first_cell, run.filled_cells), current_A,
        std::span(state.cells).subspan(run.first_cell, run.filled_cells));
    sum += {v.value_V - current_A * run.series_ohm, v.slope_ohm + run.series_ohm, v.curvature_V_A2,
            -v.third_V_A3};
  }
  for (const Row& row : rows_of(substring)) {
    sum += tied_cells_at(lit(row), current_A,
                         std::span(state.cells).subspan(row.first_cell, row.cells));
  }
  return sum;
}

// From the last solution along the substring's derivatives there; where that is too far, as if the
// rows kept the current at which they turn the diode on.
double StringCurve::bypass_guess_V(const Substring& substring, const StringState::Bypass& last,
                                   double current_A) {
  const Junction& d = substring.bypass;
  const double h = current_A - last.current_A;
  const double last_through_A = last.junction_S * d.scale_V;
  if (std::abs(h) > 0.3 * last_through_A && current_A > substring.turn_on_A) {
    return d.scale_V * std::log1p((current_A - substring.turn_on_A) / d.saturation_A);
  }
  const ElementPoint& p = last.substring;
  const double fall_V = h * (p.slope_ohm - h * (p.curvature_V_A2 / 2.0 + h * p.third_V_A3 / 6.0));
  return last.junction_V + fall_V / (1.0 + last.junction_S * d.series_ohm);
}

// With u the junction voltage of the bypass diode, its current is i(u) = I_s (e^{u/nV_t} − 1) and
// the substring's voltage is −(u + i R_s): one equation, V_rows(I − i(u)) + u + i(u) R_s = 0,
// rising in u. A diode that carries all of I leaves the rows at V ≥ 0, and one that carries nothing
// leaves them at most at their open circuit: between the two lies u.
ElementPoint StringCurve::bypassed_at(uint32_t index, double current_A, double tolerance,
                                      StringState& state) const {
  const Substring& substring = substrings_[index];
  const Junction& d = substring.bypass;
  StringState::Bypass& last = state.bypasses[index];
  if (last.junction_V <= saturated * d.scale_V && current_A <= substring.turn_on_A) {
    // Far in reverse the diode leaks I_s and no more: nothing to solve.
    const ElementPoint rows = rows_at(substring, current_A + d.saturation_A, state);
    const double u = d.saturation_A * d.series_ohm - rows.voltage_V;
    last = {u, 0.0, current_A, rows};
    if (u <= saturated * d.scale_V) return rows;
  }
  ElementPoint rows;
  double through_A = 0.0, g = 0.0;
  const auto shortfall_V = [&](double u) {
    through_A = d.saturation_A * std::expm1(u * d.per_scale_1_V);
    g = (through_A + d.saturation_A) * d.per_scale_1_V;
    rows = rows_at(substring, current_A - through_A, state);
    const double bend = (rows.slope_ohm + d.series_ohm) * g * d.per_scale_1_V;
    const double curved = rows.curvature_V_A2 * g * g;
    const double shortfall = -(rows.voltage_V + u + through_A * d.series_ohm);
    return FunctionAt{shortfall, -((rows.slope_ohm + d.series_ohm) * g + 1.0), -(curved + bend),
                      rows.third_V_A3 * g * g * g - (3.0 * curved + bend) * d.per_scale_1_V,
                      close(shortfall)};
  };
  const double lowest_V = current_A >= 0.0 ? -substring.open_circuit_V
                                           : -rows_at(substring, current_A, state).voltage_V;
  const double highest_V = d.scale_V * std::log1p(std::max(current_A, 0.0) / d.saturation_A);
  const double u = falling_root(lowest_V, highest_V, bypass_guess_V(substring, last, current_A),
                                std::min(tolerance, 1e-2), shortfall_V);
  // What was evaluated last lies a small step away.
  const double step_A = through_A - d.saturation_A * std::expm1(u * d.per_scale_1_V);
  through_A -= step_A;
  g = (through_A + d.saturation_A) * d.per_scale_1_V;
  Slopes current = inverted(
      Slopes{rows.slope_ohm - step_A * (rows.curvature_V_A2 + 0.5 * step_A * rows.third_V_A3),
             rows.curvature_V_A2 + step_A * rows.third_V_A3, rows.third_V_A3});
  current += d.slopes(g);
  const Slopes voltage = inverted(current);
  last = {u,
          g,
          current_A,
          {-(u + through_A * d.series_ohm), voltage.slope, voltage.curvature, voltage.third}};
  return last.substring;
}

ElementPoint StringCurve::substrings_at(double current_A, const StringRegime& regime,
                                        double tolerance, StringState& state) const {
  ElementPoint sum;
  for (uint32_t s = 0; s < substrings_.size(); ++s) {
    const Substring& substring = substrings_[s];
    if (regime.clamped[s]) {
      sum.voltage_V -= substring.bypass.drop_V;
      continue;
    }
    const ElementPoint p = substring.bypass.kind == Diode::Kind::junction
                               ? bypassed_at(s, current_A, tolerance, state)
                               : rows_at(substring, current_A, state);
    sum += p;
  }
  return sum;
}

void StringCurve::at_current(double current_A, const StringRegime& regime, double tolerance,
                             StringState& state) const {
  ElementPoint sum = substrings_at(current_A, regime, tolerance, state);
  if (blocking_.kind == Diode::Kind::clamp) sum.voltage_V -= blocking_.drop_V;
  if (blocking_.kind == Diode::Kind::junction) {
    const double junction_ohm =
        std::min(blocking_.scale_V / (current_A + blocking_.saturation_A), most_ohm);
    state.blocking_ohm = junction_ohm;
    sum.voltage_V -= blocking_.scale_V * std::log1p(current_A / blocking_.saturation_A) +
                     current_A * blocking_.series_ohm;
    sum.slope_ohm += junction_ohm + blocking_.series_ohm;
    const double bend = junction_ohm * junction_ohm * blocking_.per_scale_1_V;
    sum.curvature_V_A2 += bend;
    sum.third_V_A3 -= 2.0 * bend * junction_ohm * blocking_.per_scale_1_V;
  }
  state.current_A = current_A;
  state.voltage_V = sum.voltage_V;
  state.slope_ohm = sum.slope_ohm;
  state.curvature_V_A2 = sum.curvature_V_A2;
  state.third_V_A3 = sum.third_V_A3;
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
    sum = substrings_at(current_A, regime, 1e-9, state);
    const double ohm = sum.slope_ohm + blocking_.series_ohm;
    return FunctionAt{
        sum.voltage_V - current_A * blocking_.series_ohm - z - voltage_V, -ohm * junction_S - 1.0,
        (sum.curvature_V_A2 * junction_S - ohm * blocking_.per_scale_1_V) * junction_S};
  };
  const double left_over_V = open_circuit_V_ - voltage_V;
  const double z = falling_root(left_over_V, 0.0, left_over_V, 1e-9, surplus_V);
  const double junction_ohm = std::min(1.0 / junction_S, most_ohm);
  state.blocking_ohm = junction_ohm;
  state.current_A = blocking_.saturation_A * std::expm1(z * blocking_.per_scale_1_V);
  state.voltage_V = voltage_V;
  state.slope_ohm = sum.slope_ohm + blocking_.series_ohm + junction_ohm;
  const double bend = junction_ohm * junction_ohm * blocking_.per_scale_1_V;
  state.curvature_V_A2 = sum.curvature_V_A2 + bend;
  state.third_V_A3 = sum.third_V_A3 - 2.0 * bend * junction_ohm * blocking_.per_scale_1_V;
}

void StringCurve::at_voltage(double voltage_V, const StringRegime& regime, double low_A,
                             double high_A, double tolerance, StringState& state) const {
  if (regime.blocked) {
    state.current_A = 0.0;
    state.voltage_V = voltage_V;
    state.slope_ohm = infinity;
    state.curvature_V_A2 = state.third_V_A3 = 0.0;
    return;
  }
  if (blocking_.kind == Diode::Kind::junction && voltage_V >= open_circuit_V_) {
    reverse_at_voltage(voltage_V, regime, state);
    return;
  }
  const auto excess_V = [&](double current_A) {
    at_current(current_A, regime, tolerance, state);
    const double excess = state.voltage_V - voltage_V;
    return FunctionAt{excess, -state.slope_ohm, state.curvature_V_A2, state.third_V_A3,
                      close(excess)};
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
  const double root_A = falling_root(low_A, high_A, state.current_A, tolerance, excess_V);
  const double step_A = root_A - state.current_A;
  state.slope_ohm -= step_A * (state.curvature_V_A2 + 0.5 * step_A * state.third_V_A3);
  state.curvature_V_A2 += step_A * state.third_V_A3;
  state.current_A = root_A;
  state.voltage_V = voltage_V;
}

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

#include "photovoltaics/network/elements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/constants.h"
#include "core/numerics/root.h"

namespace photorque {
namespace {

// Sums over the cells of a row, each at a current of its own.
struct RowSums {
  Slopes current;  // of I(V)

  void add(const ElementPoint& cell) { current += inverted(cell.slopes()); }
  ElementPoint at(double voltage_V) const {
    const Slopes voltage = inverted(current);
    return {voltage_V, voltage.slope, voltage.curvature, voltage.third};
  }
};

constexpr size_t max_tied_cells = 64;  // in a row that is solved for all currents at once

// Newton's method for all currents at once: each cell's curve is replaced by its tangent and the
// tangents are made to meet at one voltage. Cells of one type without series resistance would all
// have the same dark current; from there two or three rounds are enough. Empty if they are not.
std::optional<ElementPoint> solve_together(std::span<const LitCell> cells, double current_A,
                                           std::span<JunctionState> states) {
  if (cells.size() > max_tied_cells) return std::nullopt;
  double all_A = 0.0;
  for (const LitCell& cell : cells) all_A += cell.photocurrent_A;
  const double dark_A = (all_A - current_A) / static_cast<double>(cells.size());
  double cell_A[max_tied_cells];
  ElementPoint points[max_tied_cells];
  for (size_t i = 0; i < cells.size(); ++i) cell_A[i] = cells[i].photocurrent_A - dark_A;
  for (int round = 0; round < 12; ++round) {
    RowSums sums;
    double tangents_A = -current_A;
    for (size_t i = 0; i < cells.size(); ++i) {
      points[i] = cell_at(cells[i], cell_A[i], states[i]);
      sums.add(points[i]);
      tangents_A += cell_A[i] + points[i].voltage_V / points[i].slope_ohm;
    }
    const double voltage_V = tangents_A / sums.current.slope;
    double spread_V = 0.0;
    for (size_t i = 0; i < cells.size(); ++i) {
      const double apart_V = points[i].voltage_V - voltage_V;
      cell_A[i] += apart_V / points[i].slope_ohm;
      spread_V = std::max(spread_V, std::abs(apart_V));
    }
    // What is left is of second order in the spread over n V_t.
    if (spread_V <= 1e-9) return sums.at(voltage_V);
  }
  return std::nullopt;
}

// The same by one search for the voltage, with a search for each cell's current inside.
ElementPoint solve_nested(std::span<const LitCell> cells, double current_A,
                          std::span<JunctionState> states) {
  // Were the current shared equally, the row's voltage would lie between its cells'.
  const double cell_A = current_A / static_cast<double>(cells.size());
  double low_V = std::numeric_limits<double>::infinity(), high_V = -low_V;
  for (const LitCell& cell : cells) {
    JunctionState unused;
    const double v = cell_at(cell, cell_A, unused).voltage_V;
    low_V = std::min(low_V, v);
    high_V = std::max(high_V, v);
  }
  RowSums sums;
  const auto excess_A = [&](double voltage_V) {
    double sum_A = -current_A;
    sums = {};
    for (size_t i = 0; i < cells.size(); ++i) {
      const double i_A =
          cells[i].law->curve().current_A(cells[i].photocurrent_A, voltage_V - cells[i].offset_V);
      sums.add(cell_at(cells[i], i_A, states[i]));
      sum_A += i_A;
    }
    return FunctionAt{sum_A, -sums.current.slope, sums.current.curvature, sums.current.third};
  };
  const double voltage_V =
      falling_root(low_V, high_V, std::midpoint(low_V, high_V), 1e-9, excess_A);
  return sums.at(voltage_V);
}

}  // namespace

ElementPoint tied_cells_at(std::span<const LitCell> cells, double current_A,
                           std::span<JunctionState> states) {
  const auto together = solve_together(cells, current_A, states);
  return together ? *together : solve_nested(cells, current_A, states);
}

SlopeRange tied_cells_range(std::span<const LitCell> cells, std::span<const JunctionState> high_v,
                            std::span<const JunctionState> low_v) {
  SlopeRange sum;
  for (size_t i = 0; i < cells.size(); ++i) {
    sum += inverted(cell_range(cells[i], high_v[i], low_v[i]));
  }
  return inverted(sum);
}

double extrapolated_A(const ElementPoint& at, double current_A, double voltage_V) {
  const Slopes current = inverted(at.slopes());
  const double h = voltage_V - at.voltage_V;
  const double growth = current.curvature != 0.0 ? h * current.third / current.curvature : 0.0;
  const double bend = std::abs(growth) > 1e-3 && std::abs(growth) < 30.0
                          ? (std::expm1(growth) - growth) / (growth * growth)
                          : 0.5 + growth / 6.0;
  return current_A - h * (current.slope - h * current.curvature * bend);
}

DiodeJunction::DiodeJunction(const Diode& diode)
    : kind(diode.kind),
      drop_V(diode.drop_V),
      saturation_A(diode.saturation_A),
      series_ohm(diode.series_ohm),
      scale_V(diode.ideality * boltzmann_J_K * diode.temperature_K / elementary_charge_C),
      per_scale_1_V(1.0 / scale_V) {}

double DiodeJunction::current_A(double junction_voltage_V) const {
  return saturation_A * std::expm1(junction_voltage_V * per_scale_1_V);
}

// Newton's method for u + i(u) R_s = V, which is convex: from a start at or above the root it falls
// to it, from below it jumps above first.
double DiodeJunction::junction_V(double forward_V) const {
  if (forward_V <= saturated_V()) return forward_V + saturation_A * series_ohm;
  double u = forward_V;
  if (forward_V > 0.0 && series_ohm > 0.0) {
    u = std::min(u, scale_V * std::log1p(forward_V / (saturation_A * series_ohm)));
  }
  constexpr int max_rounds = 60;
  for (int round = 0; round < max_rounds; ++round) {
    const double through_A = current_A(u);
    const double step =
        (u + through_A * series_ohm - forward_V) / (1.0 + conductance_S(through_A) * series_ohm);
    u -= step;
    // What is left is of second order in the step over n V_t.
    if (std::abs(step) <= 1e-9 * scale_V) break;
  }
  return u;
}

double DiodeJunction::slope_S(double g) const {
  return g / (1.0 + g * series_ohm);
}

double DiodeJunction::curvature_A_V2(double g) const {
  const double divisor = 1.0 + g * series_ohm;
  return g / (scale_V * divisor * divisor * divisor);
}

// With w the voltage forwards, w(i) = n V_t ln(1 + i/I_s) + i R_s; the substring's V is −w.
Slopes DiodeJunction::slopes(double g) const {
  const double divisor = 1.0 + g * series_ohm, per_divisor = 1.0 / divisor;
  const double per_divisor3 = per_divisor * per_divisor * per_divisor;
  const double bend = g * per_scale_1_V * per_divisor3;
  return {g * per_divisor, bend,
          -bend * per_scale_1_V * (1.0 - 2.0 * g * series_ohm) * per_divisor * per_divisor};
}

// The slope rises with g; the curvature has one maximum, at g R_s = 1/2.
SlopeRange DiodeJunction::range(double low_S, double high_S) const {
  const double a = curvature_A_V2(low_S), b = curvature_A_V2(high_S);
  const double peak_S = 0.5 / std::max(series_ohm, 1e-30);
  const bool inside = low_S < peak_S && peak_S < high_S;
  return {slope_S(low_S), slope_S(high_S), std::min(a, b),
          inside ? curvature_A_V2(peak_S) : std::max(a, b)};
}

}  // namespace photorque

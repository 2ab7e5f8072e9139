// The parts of a StringCurve at a current: cells and parts in series, in parallel, and with a
// bypass diode.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/numerics/root.h"
#include "photovoltaics/network/string.h"

namespace photorque {
namespace {

constexpr size_t max_together = 64;  // maximum branches that are solved for all currents at once
// Voltages that differ by less than this are equal except for rounding.
constexpr double same_V = 1e-9;

}  // namespace

ElementPoint StringCurve::inside_at(uint32_t index, double current_A, const StringRegime* regime,
                                    double tolerance, StringState& state) const {
  const Part& part = parts_[index];
  if (part.in_parallel) return tied_at(index, current_A, regime, state);
  ElementPoint sum;
  for (const Run& run : runs_of(part)) {
    const DiodeVoltage v =
        run.law->series_at(std::span(photocurrents_A_).subspan(run.first_cell, run.filled_cells),
                           std::span(copies_).subspan(run.first_cell, run.filled_cells), current_A,
                           std::span(state.cells).subspan(run.first_cell, run.filled_cells));
    sum += {v.value_V + run.offset_V - current_A * run.series_ohm, v.slope_ohm + run.series_ohm,
            v.curvature_V_A2, -v.third_V_A3};
  }
  for (const uint32_t p : inner(part)) sum += part_at(p, current_A, regime, tolerance, state);
  return sum;
}

ElementPoint StringCurve::part_at(uint32_t index, double current_A, const StringRegime* regime,
                                  double tolerance, StringState& state) const {
  const Part& part = parts_[index];
  if (part.bypass.kind == Diode::Kind::junction) {
    return bypassed_at(index, current_A, regime, tolerance, state);
  }
  const ElementPoint held{-part.bypass.drop_V, 0.0, 0.0, 0.0};
  const bool is_clamp = part.bypass.kind == Diode::Kind::clamp;
  ElementPoint at = held;
  if (!is_clamp || regime == nullptr || regime->clamped[index] == 0) {
    at = inside_at(index, current_A, regime, tolerance, state);
  }
  if (is_clamp && regime == nullptr && at.voltage_V < held.voltage_V) at = held;
  StringState::Part& last = state.parts[index];
  last.current_A = current_A;
  last.at = at;
  return at;
}

// Start of the search for the diode's voltage: the last solution, extrapolated by the derivatives
// of the part. If the current has changed too much, the cells are assumed to keep the current at
// which they turn the diode on.
double StringCurve::bypass_guess_V(const Part& part, const StringState::Part& last,
                                   double current_A) {
  const DiodeJunction& d = part.bypass;
  const double h = current_A - last.current_A;
  const double last_through_A = last.junction_S * d.scale_V;
  if (std::abs(h) > 0.3 * last_through_A && current_A > part.turn_on_A) {
    return d.scale_V * std::log1p((current_A - part.turn_on_A) / d.saturation_A);
  }
  const ElementPoint& p = last.at;
  const double fall_V = h * (p.slope_ohm - h * (p.curvature_V_A2 / 2.0 + h * p.third_V_A3 / 6.0));
  return last.junction_V + fall_V / (1.0 + last.junction_S * d.series_ohm);
}

// With u the junction voltage of the bypass diode, its current is i(u) = I_s (e^{u/nV_t} − 1) and
// the part's voltage is −(u + i R_s). This gives one equation, V_inside(I − i(u)) + u + i(u) R_s =
// 0, which rises in u. If the diode carries all of I, the cells are at V ≥ 0. If it carries
// nothing, they are at most at their open circuit. u lies between these two cases.
ElementPoint StringCurve::bypassed_at(uint32_t index, double current_A, const StringRegime* regime,
                                      double tolerance, StringState& state) const {
  const Part& part = parts_[index];
  const DiodeJunction& d = part.bypass;
  StringState::Part& last = state.parts[index];
  if (last.junction_V <= d.saturated_V() && current_A <= part.turn_on_A) {
    // Far in reverse the diode's leak is I_s, and there is no equation to solve.
    const ElementPoint rows =
        inside_at(index, current_A + d.saturation_A, regime, tolerance, state);
    const double u = d.saturation_A * d.series_ohm - rows.voltage_V;
    last = {u, 0.0, current_A, rows};
    if (u <= d.saturated_V()) return rows;
  }
  ElementPoint rows;
  double through_A = 0.0, g = 0.0;
  const auto shortfall_V = [&](double u) {
    through_A = d.saturation_A * std::expm1(u * d.per_scale_1_V);
    g = (through_A + d.saturation_A) * d.per_scale_1_V;
    rows = inside_at(index, current_A - through_A, regime, tolerance, state);
    const double bend = (rows.slope_ohm + d.series_ohm) * g * d.per_scale_1_V;
    const double curved = rows.curvature_V_A2 * g * g;
    const double shortfall = -(rows.voltage_V + u + through_A * d.series_ohm);
    return FunctionAt{shortfall, -((rows.slope_ohm + d.series_ohm) * g + 1.0), -(curved + bend),
                      rows.third_V_A3 * g * g * g - (3.0 * curved + bend) * d.per_scale_1_V,
                      close(shortfall)};
  };
  const double lowest_V = current_A >= 0.0
                              ? -part.open_circuit_V
                              : -inside_at(index, current_A, regime, tolerance, state).voltage_V;
  const double highest_V = d.scale_V * std::log1p(std::max(current_A, 0.0) / d.saturation_A);
  const double u = falling_root(lowest_V, highest_V, bypass_guess_V(part, last, current_A),
                                std::min(tolerance, 1e-2), shortfall_V);
  // The last evaluation is one small step away from the root: a Taylor step corrects it.
  const double step_A = through_A - d.saturation_A * std::expm1(u * d.per_scale_1_V);
  through_A -= step_A;
  g = (through_A + d.saturation_A) * d.per_scale_1_V;
  Slopes current = d.slopes(g);
  if (rows.slope_ohm > 0.0) {
    current += inverted(
        Slopes{rows.slope_ohm - step_A * (rows.curvature_V_A2 + 0.5 * step_A * rows.third_V_A3),
               rows.curvature_V_A2 + step_A * rows.third_V_A3, rows.third_V_A3});
  } else {
    current.slope = std::numeric_limits<double>::infinity();  // held by the diodes inside
  }
  last = {u, g, current_A, tied_point(-(u + through_A * d.series_ohm), current)};
  return last.at;
}

bool StringCurve::is_held(uint32_t index, const StringRegime& regime) const {
  const Part& part = parts_[index];
  if (part.bypass.kind == Diode::Kind::clamp && regime.clamped[index] != 0) return true;
  if (part.bypass.kind == Diode::Kind::junction || !part.has_clamps) return false;
  if (part.in_parallel) return clamping_part(index, regime) != nothing;
  return part.runs == 0 &&
         std::ranges::all_of(inner(part), [&](uint32_t p) { return is_held(p, regime); });
}

uint32_t StringCurve::clamping_part(uint32_t index, const StringRegime& regime) const {
  const Part& part = parts_[index];
  if (!part.has_clamps) return nothing;
  for (const uint32_t p : inner(part)) {
    if (is_held(p, regime)) return p;
  }
  return nothing;
}

ElementPoint StringCurve::tied_at(uint32_t index, double current_A, const StringRegime* regime,
                                  StringState& state) const {
  const Part& part = parts_[index];
  if (regime == nullptr && part.has_clamps) {
    return tied_nested_at(index, current_A, nullptr, state);
  }
  if (const uint32_t p = regime != nullptr ? clamping_part(index, *regime) : nothing;
      p != nothing) {
    // This part carries the remaining current.
    const double voltage_V = part_at(p, parts_[p].light_A, regime, 1e-9, state).voltage_V;
    const double others_A = tied_A(index, voltage_V, regime, p, nullptr, state);
    return part_at(p, current_A - others_A, regime, 1e-9, state);
  }
  const auto together = tied_together_at(index, current_A, regime, state);
  return together ? *together : tied_nested_at(index, current_A, regime, state);
}

// Newton's method for all currents at once: each branch's curve is replaced by its tangent, and the
// common voltage of the tangents is computed. Cells of one type without series resistance would all
// have the same dark current. From there, or from a part's last current, two or three rounds are
// sufficient. Returns nothing if they are not.
std::optional<ElementPoint> StringCurve::tied_together_at(uint32_t index, double current_A,
                                                          const StringRegime* regime,
                                                          StringState& state) const {
  const Part& part = parts_[index];
  const std::span<const LitCell> cells = tied_cells(part);
  const std::span<const uint32_t> parts = inner(part);
  const size_t branches = cells.size() + parts.size();
  if (branches > max_together) return std::nullopt;
  const std::span<JunctionState> states =
      std::span(state.cells).subspan(part.first_cell, part.cells);
  const double dark_A = (part.light_A - current_A) / static_cast<double>(branches);
  double branch_A[max_together];
  ElementPoint points[max_together];
  for (size_t i = 0; i < cells.size(); ++i) branch_A[i] = cells[i].photocurrent_A - dark_A;
  for (size_t i = 0; i < parts.size(); ++i) {
    const StringState::Part& last = state.parts[parts[i]];
    branch_A[cells.size() + i] =
        last.at.slope_ohm > 0.0 ? last.current_A : parts_[parts[i]].light_A - dark_A;
  }
  for (int round = 0; round < 12; ++round) {
    Slopes current;
    double tangents_A = -current_A;
    for (size_t i = 0; i < branches; ++i) {
      points[i] = i < cells.size()
                      ? cell_at(cells[i], branch_A[i], states[i])
                      : part_at(parts[i - cells.size()], branch_A[i], regime, 1e-9, state);
      current += inverted(points[i].slopes());
      tangents_A += branch_A[i] + points[i].voltage_V / points[i].slope_ohm;
    }
    const double voltage_V = tangents_A / current.slope;
    if (!std::isfinite(voltage_V)) return std::nullopt;
    double spread_V = 0.0;
    for (size_t i = 0; i < branches; ++i) {
      const double apart_V = points[i].voltage_V - voltage_V;
      branch_A[i] += apart_V / points[i].slope_ohm;
      spread_V = std::max(spread_V, std::abs(apart_V));
    }
    // The remaining error is of second order in the spread over n V_t.
    if (spread_V <= same_V) return tied_point(voltage_V, current);
  }
  return std::nullopt;
}

double StringCurve::tied_A(uint32_t index, double voltage_V, const StringRegime* regime,
                           uint32_t but, Slopes* slopes, StringState& state) const {
  const Part& part = parts_[index];
  double sum_A = 0.0;
  for (uint32_t c = part.first_cell; c < part.first_cell + part.cells; ++c) {
    const LitCell& cell = cells_[c];
    const double i_A = cell.law->curve().current_A(cell.photocurrent_A, voltage_V - cell.offset_V);
    const ElementPoint at = cell_at(cell, i_A, state.cells[c]);
    if (slopes != nullptr) *slopes += inverted(at.slopes());
    sum_A += i_A;
  }
  for (const uint32_t p : inner(part)) {
    if (p == but) continue;
    sum_A += part_A(p, voltage_V, regime, state);
    if (slopes != nullptr && state.parts[p].at.slope_ohm > 0.0) {
      *slopes += inverted(state.parts[p].at.slopes());
    }
  }
  return sum_A;
}

// Solves for the common voltage by a search, with an inner search for the current of each branch.
ElementPoint StringCurve::tied_nested_at(uint32_t index, double current_A,
                                         const StringRegime* regime, StringState& state) const {
  const Part& part = parts_[index];
  // With equal currents the common voltage would lie between the voltages of the branches.
  const double branch_A = current_A / static_cast<double>(part.cells + part.parts);
  double low_V = unlimited, high_V = -unlimited;
  const auto reach = [&](double v) {
    low_V = std::min(low_V, v);
    high_V = std::max(high_V, v);
  };
  for (const LitCell& cell : tied_cells(part)) {
    JunctionState unused;
    reach(cell_at(cell, branch_A, unused).voltage_V);
  }
  for (const uint32_t p : inner(part)) {
    reach(part_at(p, branch_A, regime, 1e-9, state).voltage_V);
  }
  if (regime == nullptr && part.lowest_V > -unlimited && current_A >= part.lowest_A) {
    return {part.lowest_V, 0.0, 0.0, 0.0};
  }
  Slopes current;
  const auto excess_A = [&](double voltage_V) {
    current = {};
    const double sum_A = tied_A(index, voltage_V, regime, nothing, &current, state) - current_A;
    return FunctionAt{sum_A, -current.slope, current.curvature, current.third};
  };
  const double voltage_V =
      falling_root(low_V, high_V, std::midpoint(low_V, high_V), 1e-9, excess_A);
  return tied_point(voltage_V, current);
}

double StringCurve::part_A(uint32_t index, double voltage_V, const StringRegime* regime,
                           StringState& state) const {
  const Part& part = parts_[index];
  if (regime == nullptr && voltage_V <= part.lowest_V + same_V) {
    state.parts[index].current_A = part.lowest_A;
    state.parts[index].at = {part.lowest_V, 0.0, 0.0, 0.0};
    return part.lowest_A;
  }
  const auto excess_V = [&](double current_A) {
    const ElementPoint p = part_at(index, current_A, regime, 1e-9, state);
    const double excess = p.voltage_V - voltage_V;
    return FunctionAt{excess, -p.slope_ohm, p.curvature_V_A2, p.third_V_A3, close(excess)};
  };
  const StringState::Part& last = state.parts[index];
  const double guess_A =
      last.at.slope_ohm > 0.0 ? extrapolated_A(last.at, last.current_A, voltage_V) : part.light_A;
  double low = 0.0, high = part.largest_A;
  const double step_A = 1e-3 * part.largest_A + 1e-9;
  if (voltage_V < 0.0) {
    widen(low, high, step_A, [&](double i_A) { return excess_V(i_A).value > 0.0; });
  }
  if (part.has_clamps || voltage_V > 0.9 * part.open_circuit_V) {
    widen(high, low, -step_A, [&](double i_A) { return excess_V(i_A).value < 0.0; });
  }
  return falling_root(low, high, guess_A, 1e-9, excess_V);
}

double StringCurve::inside_A(uint32_t index, double drop_V, StringState& state) const {
  const auto excess_V = [&](double current_A) {
    const ElementPoint p = inside_at(index, current_A, nullptr, 1e-9, state);
    const double excess = p.voltage_V + drop_V;
    return FunctionAt{excess, -p.slope_ohm, p.curvature_V_A2, p.third_V_A3, close(excess)};
  };
  double low = 0.0, high = parts_[index].largest_A;
  widen(low, high, 1e-3 * high + 1e-9, [&](double i_A) { return excess_V(i_A).value > 0.0; });
  return falling_root(low, high, std::midpoint(low, high), 1e-9, excess_V);
}

}  // namespace photorque

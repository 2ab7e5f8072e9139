#include "photovoltaics/network/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/numerics/interpolation.h"
#include "core/numerics/root.h"

namespace photorque {
namespace {

// The switching point of a diode that never switches.
constexpr double never = std::numeric_limits<double>::infinity();
// The switching point of a diode that always conducts.
constexpr double always = std::numeric_limits<double>::max();
// Relative step of a string's current at which its solution ends: the error is of second order.
constexpr double fine = 1e-9;

void check(const CellGroup& group, std::vector<char>& used) {
  if (!group.is_cell()) {
    if (group.parts.empty()) throw InputError({}, "array", "an empty group of cells", "cells");
    for (const CellGroup& part : group.parts) check(part, used);
    return;
  }
  const auto cell = static_cast<size_t>(group.cell);
  if (group.cell < 0 || cell >= used.size() || used[cell] != 0) {
    throw InputError({}, "array", "cell " + std::to_string(group.cell),
                     "each of the " + std::to_string(used.size()) + " cells at most once");
  }
  used[cell] = 1;
}

void check(const ArrayWiring& wiring, size_t cells) {
  std::vector<char> used(cells, 0);
  for (const auto& string : wiring.strings) {
    if (string.substrings.empty()) throw InputError({}, "array", "an empty string", "substrings");
    for (const auto& substring : string.substrings) {
      if (substring.rows.empty()) throw InputError({}, "array", "an empty substring", "cells");
      for (const CellGroup& row : substring.rows) check(row, used);
    }
  }
  if (wiring.strings.empty()) throw InputError({}, "array", "no strings", "at least one");
}

// Hermite interpolation between two points, from values and slopes.
double hermite_A(const StringState& a, const StringState& b, double voltage_V) {
  const double width = b.voltage_V - a.voltage_V, t = (voltage_V - a.voltage_V) / width;
  const auto c = hermite_coefficients(a.current_A, b.current_A - a.current_A, -width / a.slope_ohm,
                                      -width / b.slope_ohm);
  return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

}  // namespace

ArrayCurve::ArrayCurve(const ArrayWiring& wiring, CellTables tables,
                       const std::vector<double>& photocurrents_A, const ArrayChanges& changes)
    : tables_(std::move(tables)), cells_(photocurrents_A.size()), series_ohm_(changes.series_ohm) {
  if (tables_.size() != cells_) {
    throw InputError({}, "array", std::to_string(tables_.size()) + " cell tables",
                     "one per photocurrent");
  }
  check(wiring, cells_);
  set_photocurrents(photocurrents_A);
  add_strings(wiring, photocurrents_A, changes);
  for (const StringCurve& string : strings_) switches_.push_back(switches_of(string));
  end_x_ = find_end_x();
}

// Replaces the laws of cells whose shunt depends on the light: one law for each photocurrent.
void ArrayCurve::set_photocurrents(const std::vector<double>& photocurrents_A) {
  std::map<std::pair<const DiodeVoltageLaw*, double>, std::shared_ptr<const DiodeVoltageLaw>> known;
  std::vector<std::shared_ptr<const DiodeVoltageLaw>> replaced;  // alive, so that addresses differ
  for (size_t i = 0; i < cells_; ++i) {
    if (tables_[i]->curve().parameters().shunt_light_A == 0.0) continue;
    auto& law = known[{tables_[i].get(), photocurrents_A[i]}];
    if (law == nullptr) law = law_in_light(tables_[i], photocurrents_A[i]);
    replaced.push_back(std::exchange(tables_[i], law));
  }
}

void ArrayCurve::add_strings(const ArrayWiring& wiring, const std::vector<double>& photocurrents_A,
                             const ArrayChanges& changes) {
  const auto holds = [](const std::vector<bool>& all, size_t i) {
    return i < all.size() && all[i];
  };
  strings_.reserve(wiring.strings.size());
  size_t first = 0;  // substring of the string, over all strings
  for (size_t s = 0; s < wiring.strings.size(); ++s) {
    const ArrayWiring::String& string = wiring.strings[s];
    if (!holds(changes.string_open, s)) {
      strings_.emplace_back(string, tables_, photocurrents_A, changes.cell_offset_V,
                            [&](size_t b) { return holds(changes.bypass_shorted, first + b); });
      if (strings_.back().is_shorted()) {
        strings_.pop_back();
        is_shorted_ = is_shorted_ || string.blocking.kind == Diode::Kind::none;
      }
    }
    first += string.substrings.size();
  }
  if (is_shorted_) strings_.clear();
}

ArrayPoint ArrayCurve::point(double x, double y) const {
  return by_current() ? ArrayPoint{y, x} : ArrayPoint{x - series_ohm_ * y, y};
}

ArrayCurve::Node ArrayCurve::make_node() const {
  Node node;
  node.series_ohm = by_current() ? 0.0 : series_ohm_;
  node.strings.reserve(strings_.size());
  for (const StringCurve& string : strings_) node.strings.push_back(string.make_state());
  return node;
}

void ArrayCurve::evaluate(double x, const std::vector<StringRegime>& regimes, Node& node,
                          double tolerance, const Node* low, const Node* high) const {
  node.x = x;
  if (by_current()) {
    StringState& state = node.strings[0];
    strings_[0].at_current(x, regimes[0], tolerance, state);
    node.y = state.voltage_V - series_ohm_ * x;
    node.slope = state.slope_ohm + series_ohm_;
    node.curvature = state.curvature_V_A2;
    node.third = state.third_V_A3;
    return;
  }
  for (size_t s = 0; s < strings_.size(); ++s) {
    const CurrentGuess guess = guess_current(s, x, node, low, high);
    strings_[s].at_voltage(x, regimes[s], guess.low_A, guess.high_A, tolerance, node.strings[s]);
  }
  node.sum_strings();
}

ArrayCurve::CurrentGuess ArrayCurve::guess_current(size_t s, double x, Node& node, const Node* low,
                                                   const Node* high) const {
  StringState& state = node.strings[s];
  if (low != nullptr && high != nullptr) {
    state.current_A = hermite_A(low->strings[s], high->strings[s], x);
    return {high->strings[s].current_A, low->strings[s].current_A};
  }
  state.current_A = state.slope_ohm > 0.0 ? extrapolated_A(state, state.current_A, x)
                                          : strings_[s].first_guess_A();
  return {0.0, strings_[s].largest_photocurrent_A()};
}

void ArrayCurve::Node::sum_strings() {
  y = 0.0;
  Slopes sum;
  for (const StringState& state : strings) {
    y += state.current_A;
    sum += inverted(state.slopes());
  }
  slope = sum.slope;
  curvature = sum.curvature;
  third = sum.third;
}

void ArrayCurve::enter(const Piece& piece, const Piece& last, double tolerance, Node& node) const {
  if (by_current()) {
    evaluate(piece.low_x, piece.regimes, node, tolerance);
    return;
  }
  for (size_t s = 0; s < strings_.size(); ++s) {
    if (piece.regimes[s] == last.regimes[s]) continue;
    strings_[s].at_voltage(piece.low_x, piece.regimes[s], 0.0, strings_[s].largest_photocurrent_A(),
                           tolerance, node.strings[s]);
  }
  node.sum_strings();
}

ArrayCurve::Switches ArrayCurve::switches_of(const StringCurve& string) const {
  Switches switches{string.clamp_currents_A(), never};
  if (by_current()) return switches;
  StringState state = string.make_state();
  for (double& clamp : switches.clamp_x) {
    if (clamp == never) continue;
    string.at_current(clamp, string.regime_at(clamp), fine, state);
    // If the voltage is not finite, no current that the blocking diode admits ends the conduction.
    clamp = std::isfinite(state.voltage_V) ? state.voltage_V : always;
  }
  if (string.has_blocking_clamp()) switches.blocked_x = string.open_circuit_V();
  return switches;
}

std::vector<StringRegime> ArrayCurve::regimes_at(double x) const {
  std::vector<StringRegime> regimes;
  find_regimes(x, regimes);
  return regimes;
}

void ArrayCurve::find_regimes(double x, std::vector<StringRegime>& regimes) const {
  regimes.resize(strings_.size());
  for (size_t s = 0; s < strings_.size(); ++s) {
    regimes[s].clamped.clear();
    for (const double clamp_x : switches_[s].clamp_x) {
      const bool clamped = clamp_x != never && (by_current() ? x >= clamp_x : x < clamp_x);
      regimes[s].clamped.push_back(clamped);
    }
    regimes[s].blocked = x >= switches_[s].blocked_x;
  }
}

ArrayCurve::Node ArrayCurve::node_at(double x) const {
  Node node = make_node();
  evaluate(x, regimes_at(x), node, fine);
  return node;
}

double ArrayCurve::find_end_x() const {
  double low = 0.0, high = 0.0;
  if (by_current()) {
    high = strings_[0].largest_photocurrent_A();
  } else {
    low = std::numeric_limits<double>::infinity();
    for (const StringCurve& string : strings_) {
      low = std::min(low, string.open_circuit_V());
      high = std::max(high, string.open_circuit_V());
    }
  }
  low = std::max(low, 0.0);
  if (!(high > low)) return std::max(high, 0.0);
  Node node = make_node();
  evaluate(high, regimes_at(high), node, fine);
  if (node.y >= 0.0) return high;
  const double guess = by_current() ? std::midpoint(low, high) : high + node.y / node.slope;
  return falling_root(low, high, guess, 1e-9, [&](double x) {
    evaluate(x, regimes_at(x), node, fine);
    return FunctionAt{node.y, -node.slope, node.curvature, node.third};
  });
}

double ArrayCurve::x_at(double y) const {
  if (end_x_ == 0.0) return 0.0;
  Node node = make_node();
  return falling_root(0.0, end_x_, 0.5 * end_x_, 1e-9, [&](double x) {
    evaluate(x, regimes_at(x), node, fine);
    return FunctionAt{node.y - y, -node.slope, node.curvature, node.third};
  });
}

double ArrayCurve::current_A(double voltage_V) const {
  if (by_current()) return x_at(voltage_V);
  return series_ohm_ == 0.0 ? y_at(voltage_V) : at_voltages({voltage_V}).front().current_A;
}

double ArrayCurve::voltage_V(double current_A) const {
  return by_current() ? y_at(current_A) : x_at(current_A) - series_ohm_ * current_A;
}

std::vector<double> ArrayCurve::edges() const {
  std::vector<double> edges = {0.0, end_x_};
  for (const Switches& switches : switches_) {
    edges.insert(edges.end(), switches.clamp_x.begin(), switches.clamp_x.end());
    edges.push_back(switches.blocked_x);
  }
  std::erase_if(edges, [&](double x) { return !(x >= 0.0 && x <= end_x_); });
  std::ranges::sort(edges);
  edges.erase(std::ranges::unique(edges).begin(), edges.end());
  return edges;
}

ArrayCurve::Piece ArrayCurve::piece(double low_x, double high_x) const {
  return {low_x, high_x, regimes_at(std::midpoint(low_x, high_x))};
}

CellStates ArrayCurve::cells_at(double voltage_V) const {
  CellStates states{std::vector<double>(cells_, 0.0), std::vector<double>(cells_, 0.0)};
  const double x = by_current() ? x_at(voltage_V) : voltage_V;
  const Node node = node_at(x);
  for (size_t s = 0; s < strings_.size(); ++s) {
    strings_[s].cells_at(node.strings[s].current_A, states.voltages_V, states.currents_A);
  }
  return states;
}

}  // namespace photorque

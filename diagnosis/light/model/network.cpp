#include "diagnosis/light/model/network.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/errors.h"

namespace photorque {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

// Breakdown keeps its own current beside a larger shunt.
CellParameters with_shunt(CellParameters p, double extra_S) {
  const double shunt_ohm = 1.0 / (1.0 / p.shunt_ohm + extra_S);
  p.breakdown_fraction *= shunt_ohm / p.shunt_ohm;
  p.shunt_ohm = shunt_ohm;
  return p;
}

double clamp_of(const Diode& diode, const char* what) {
  if (diode.kind == Diode::Kind::junction) {
    throw InputError({}, what, "\"junction\"",
                     "\"ideal\" or \"none\": the diagnosis of light knows ideal diodes alone");
  }
  return diode.kind == Diode::Kind::none ? unlimited : diode.drop_V;
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

LitNetwork::LitNetwork(const ArrayWiring& wiring, std::shared_ptr<const LitCells> cells,
                       const NetworkSettings& settings, const std::vector<double>& photocurrents_A)
    : cells_(std::move(cells)), photocurrents_A_(photocurrents_A), settings_(settings) {
  size_t bypass = 0;
  for (size_t s = 0; s < wiring.strings.size(); ++s) {
    String string;
    const Diode& blocking = wiring.strings[s].blocking;
    string.is_blocking = blocking.kind != Diode::Kind::none;
    if (string.is_blocking) string.blocking_V = clamp_of(blocking, "array.blocking");
    for (const ArrayWiring::Substring& wired : wiring.strings[s].substrings) {
      Substring substring;
      substring.clamp_V = clamp_of(wired.bypass, "array.bypass");
      substring.is_shorted =
          bypass < settings.bypass_shorted.size() && settings.bypass_shorted[bypass];
      ++bypass;
      for (const std::vector<int>& row : wired.rows) {
        if (row.size() != 1) {
          throw InputError({}, "array.cross_tied", "cells tied in parallel",
                           "strings of single cells: the diagnosis of light knows no others");
        }
        substring.cells.push_back(row.front());
        string.largest_A =
            std::max(string.largest_A, photocurrents_A_[static_cast<size_t>(row.front())]);
      }
      string.substrings.push_back(std::move(substring));
    }
    const bool is_open = s < settings.string_open.size() && settings.string_open[s];
    if (!is_open) strings_.push_back(std::move(string));
  }
}

void LitNetwork::evaluate(const String& string, double current_A, StringPoint& at) const {
  at.current_A = current_A;
  at.voltage_V = string.is_blocking ? -string.blocking_V : 0.0;
  at.slope_ohm = 0.0;
  at.curvature_V_A2 = 0.0;
  at.clamped.clear();
  at.cells.clear();
  for (const Substring& substring : string.substrings) {
    if (substring.is_shorted) {
      at.clamped.push_back(1);
      at.cells.resize(at.cells.size() + substring.cells.size());
      continue;
    }
    double voltage = 0.0, slope = 0.0, curvature = 0.0;
    for (const int cell : substring.cells) {
      const auto k = static_cast<size_t>(cell);
      const LitDiode& kind = cells_->kinds[static_cast<size_t>(cells_->kind_of_cell[k])];
      const LitDiode::Point d = kind.at(photocurrents_A_[k] - current_A);
      at.cells.push_back(d);
      voltage += d.value_V + settings_.cell_offset_V - current_A * kind.series_ohm();
      slope += d.slope_ohm + kind.series_ohm();
      curvature += d.curvature_V_A2;
    }
    const bool is_clamped = voltage < -substring.clamp_V;
    at.clamped.push_back(is_clamped ? 1 : 0);
    if (is_clamped) {
      at.voltage_V -= substring.clamp_V;
    } else {
      at.voltage_V += voltage;
      at.slope_ohm += slope;
      at.curvature_V_A2 += curvature;
    }
  }
}

// Newton's steps within a bracket that closes.
void LitNetwork::solve(const String& string, double voltage_V, StringPoint& at) const {
  double low = -unlimited, high = unlimited;
  double x = at.clamped.empty() ? 0.9 * string.largest_A : at.current_A;
  const double least = 1e-12 + 1e-12 * string.largest_A;
  for (int i = 0; i < 200; ++i) {
    if (string.is_blocking && x < 0.0) x = 0.0;
    evaluate(string, x, at);
    const double off = at.voltage_V - voltage_V;
    if (off > 0.0) {
      low = x;
    } else {
      high = x;
    }
    if (string.is_blocking && x == 0.0 && off <= 0.0) {
      at.slope_ohm = unlimited;  // blocked: carries nothing at any voltage near
      return;
    }
    if (std::abs(off) < 1e-11) return;
    double next =
        at.slope_ohm > 0.0 ? x + off / at.slope_ohm : (off > 0.0 ? unlimited : -unlimited);
    if (!(next > low && next < high)) {
      if (low > -unlimited && high < unlimited) {
        next = 0.5 * (low + high);
      } else if (!std::isfinite(next)) {
        next = off > 0.0 ? x + string.largest_A + 1e-3 : x - string.largest_A - 1e-3;
      }
    }
    if (std::abs(next - x) < least) return;
    x = next;
    if (std::abs(x) > 1e6) return;  // beyond all clamps: no current has this voltage
  }
}

void LitNetwork::at(double x, State& state) const {
  state.strings.resize(strings_.size());
  if (by_current()) {
    StringPoint& p = state.strings.front();
    evaluate(strings_.front(), x, p);
    state.voltage_V = p.voltage_V;
    state.current_A = x;
    state.slope_S = p.slope_ohm > 0.0 ? 1.0 / p.slope_ohm : 1e12;
    state.curvature = p.curvature_V_A2 * state.slope_S * state.slope_S * state.slope_S;
    return;
  }
  state.voltage_V = x;
  state.current_A = state.slope_S = state.curvature = 0.0;
  for (size_t s = 0; s < strings_.size(); ++s) {
    StringPoint& p = state.strings[s];
    solve(strings_[s], x, p);
    const double conductance = p.slope_ohm > 0.0 ? 1.0 / p.slope_ohm : 1e12;
    state.current_A += p.current_A;
    state.slope_S += conductance;
    if (conductance > 0.0) {
      state.curvature += p.curvature_V_A2 * conductance * conductance * conductance;
    }
  }
}

LitNetwork::Point LitNetwork::nearest(double voltage_V, double current_A, double voltage_error_V,
                                      double current_error_A, bool derivatives,
                                      const Trace& trace) const {
  if (strings_.empty()) return {voltage_V, 0.0, 0.0, std::vector<double>(photocurrents_A_.size())};
  const double R = settings_.series_ohm;
  const double wv = 1.0 / (voltage_error_V * voltage_error_V),
               wi = 1.0 / (current_error_A * current_error_A);
  State state;
  const auto distance2 = [&] {
    const double v = voltage_V - (state.voltage_V - R * state.current_A),
                 i = current_A - state.current_A;
    return v * v * wv + i * i * wi;
  };
  // Gauss–Newton along the curve, each step halved until it comes nearer.
  const auto descend = [&](double x) {
    at(x, state);
    double now = distance2();
    for (int k = 0; k < 60; ++k) {
      const double v = voltage_V - (state.voltage_V - R * state.current_A),
                   i = current_A - state.current_A;
      const double dv = by_current() ? -(1.0 / state.slope_S + R) : 1.0 + R * state.slope_S;
      const double di = by_current() ? 1.0 : -state.slope_S;
      double step = (v * dv * wv + i * di * wi) / (dv * dv * wv + di * di * wi);
      const double from = x;
      bool nearer = false;
      for (int half = 0; half < 30; ++half, step *= 0.5) {
        x = from + step;
        at(x, state);
        const double then = distance2();
        if (then < now) {
          nearer = now - then > 1e-9 * (1.0 + then);
          now = then;
          break;
        }
        if (half == 29 || std::abs(step) < 1e-13 * (1.0 + std::abs(from))) {
          x = from;
          at(x, state);
          break;
        }
      }
      if (!nearer) break;
    }
    return std::pair(now, x);
  };
  double start = by_current() ? current_A : voltage_V, least = unlimited;
  for (const Trace::Place& p : trace.places) {
    const double v = voltage_V - p.voltage_V, i = current_A - p.current_A;
    const double far = v * v * wv + i * i * wi;
    if (far < least) {
      least = far;
      start = p.x;
    }
  }
  auto best = descend(start);
  // A corner of the curve has two sides.
  constexpr double far2 = 9.0;
  if (best.first > far2 && trace.places.empty()) {
    double other = voltage_V;
    if (by_current()) {
      StringPoint p;
      solve(strings_.front(), voltage_V + R * current_A, p);
      other = p.current_A;
    }
    const auto second = descend(other);
    if (second.first < best.first) best = second;
    at(best.second, state);
  }
  Point point;
  point.voltage_V = state.voltage_V - R * state.current_A;
  point.current_A = state.current_A;
  point.slope_S = state.slope_S / (1.0 + R * state.slope_S);
  if (!derivatives) return point;
  point.current_by_photocurrent = current_derivatives(state);
  for (double& d : point.current_by_photocurrent) d /= 1.0 + R * state.slope_S;
  return point;
}

LitNetwork::Trace LitNetwork::trace() const {
  Trace result;
  if (strings_.empty()) return result;
  const double R = settings_.series_ohm, end = end_x();
  if (!(end > 0.0)) return result;
  State state;
  const auto place = [&](double x) -> Trace::Place {
    at(x, state);
    return {x, state.voltage_V - R * state.current_A, state.current_A};
  };
  const Trace::Place first = place(-0.05 * end), last = place(1.05 * end);
  const double largest_V = std::max(std::abs(first.voltage_V), std::abs(last.voltage_V)),
               largest_A = std::max(std::abs(first.current_A), std::abs(last.current_A));
  constexpr double near = 0.015;
  const std::function<void(const Trace::Place&, const Trace::Place&, int)> refine =
      [&](const Trace::Place& a, const Trace::Place& b, int depth) {
        const bool far = std::abs(a.voltage_V - b.voltage_V) > near * largest_V ||
                         std::abs(a.current_A - b.current_A) > near * largest_A;
        if (far && depth < 14) {
          const Trace::Place middle = place(0.5 * (a.x + b.x));
          refine(a, middle, depth + 1);
          refine(middle, b, depth + 1);
          return;
        }
        result.places.push_back(b);
      };
  result.places.push_back(first);
  refine(first, last, 0);
  return result;
}

std::vector<double> LitNetwork::current_derivatives(const State& state) const {
  std::vector<double> result(photocurrents_A_.size(), 0.0);
  for (size_t s = 0; s < strings_.size(); ++s) {
    const StringPoint& p = state.strings[s];
    size_t k = 0;
    for (size_t b = 0; b < strings_[s].substrings.size(); ++b) {
      for (const int cell : strings_[s].substrings[b].cells) {
        const LitDiode::Point& d = p.cells[k++];
        if (p.clamped[b] || !(p.slope_ohm > 0.0)) continue;
        result[static_cast<size_t>(cell)] = d.slope_ohm / p.slope_ohm;
      }
    }
  }
  return result;
}

double LitNetwork::clamp_current_A(const Substring& substring) const {
  if (substring.is_shorted || !(substring.clamp_V < unlimited)) return unlimited;
  String alone;
  alone.substrings = {substring};
  alone.substrings.front().clamp_V = unlimited;
  for (const int cell : substring.cells) {
    alone.largest_A = std::max(alone.largest_A, photocurrents_A_[static_cast<size_t>(cell)]);
  }
  StringPoint p;
  solve(alone, -substring.clamp_V, p);
  return p.current_A;
}

double LitNetwork::end_x() const {
  const double R = settings_.series_ohm;
  if (by_current()) {
    String with_resistance = strings_.front();
    StringPoint p;
    if (R == 0.0) {
      solve(with_resistance, 0.0, p);
      return p.current_A;
    }
    double low = 0.0, high = 2.0 * with_resistance.largest_A + 1e-3;
    for (int i = 0; i < 60; ++i) {
      const double x = 0.5 * (low + high);
      evaluate(with_resistance, x, p);
      (p.voltage_V - R * x > 0.0 ? low : high) = x;
    }
    return low;
  }
  // The open circuit: between zero and the largest voltage of a string without current.
  double low = 0.0, high = 0.0;
  for (const String& string : strings_) {
    StringPoint p;
    evaluate(string, 0.0, p);
    high = std::max(high, p.voltage_V);
  }
  State state;
  for (int i = 0; i < 50; ++i) {
    const double x = 0.5 * (low + high);
    at(x, state);
    (state.current_A > 0.0 ? low : high) = x;
  }
  return low;
}

std::vector<double> LitNetwork::breakpoints(double end) const {
  std::vector<double> all = {0.0};
  for (const String& string : strings_) {
    for (const Substring& substring : string.substrings) {
      double x = clamp_current_A(substring);
      if (!by_current() && x < unlimited) {
        StringPoint p;
        evaluate(string, x, p);
        x = p.voltage_V;
      }
      if (x > 0.0 && x < end) all.push_back(x);
    }
  }
  all.push_back(end);
  std::sort(all.begin(), all.end());
  return all;
}

// dP/dx, falling through zero at a maximum.
double LitNetwork::power_slope(const State& state) const {
  const double R = settings_.series_ohm, I = state.current_A;
  if (by_current()) return state.voltage_V - R * I - I * (1.0 / state.slope_S + R);
  return I - state.slope_S * (state.voltage_V - 2.0 * R * I);
}

LitNetwork::Maximum LitNetwork::maximum_at(const State& state, bool derivatives) const {
  const double R = settings_.series_ohm, I = state.current_A, S = state.slope_S;
  Maximum result;
  result.current_A = I;
  result.voltage_V = state.voltage_V - R * I;
  if (!derivatives) return result;
  // F = I′(V − 2RI) + I is zero all along the way: see network.h for I_θ, and I′_θ likewise.
  const double lever = state.voltage_V - 2.0 * R * I;
  const double F_V = state.curvature * lever - S * (2.0 + 2.0 * R * S);
  const std::vector<double> I_theta = current_derivatives(state);
  result.voltage_by_photocurrent.assign(photocurrents_A_.size(), 0.0);
  result.current_by_photocurrent.assign(photocurrents_A_.size(), 0.0);
  for (size_t s = 0; s < strings_.size(); ++s) {
    const StringPoint& p = state.strings[s];
    if (!(p.slope_ohm > 0.0) || !std::isfinite(p.slope_ohm)) continue;
    size_t at_cell = 0;
    for (size_t b = 0; b < strings_[s].substrings.size(); ++b) {
      for (const int cell : strings_[s].substrings[b].cells) {
        const LitDiode::Point& d = p.cells[at_cell++];
        if (p.clamped[b]) continue;
        const auto k = static_cast<size_t>(cell);
        const double slope_theta =
            (d.curvature_V_A2 - p.curvature_V_A2 * I_theta[k]) / (p.slope_ohm * p.slope_ohm);
        const double F_theta = slope_theta * lever + 2.0 * R * S * I_theta[k] + I_theta[k];
        const double moved_V = -F_theta / F_V;
        const double moved_A = I_theta[k] - S * moved_V;
        result.current_by_photocurrent[k] = moved_A;
        result.voltage_by_photocurrent[k] = moved_V - R * moved_A;
      }
    }
  }
  return result;
}

std::vector<LitNetwork::Maximum> LitNetwork::maxima(Which which, bool derivatives) const {
  std::vector<Maximum> found;
  double largest = 0.0;
  for (const String& string : strings_) largest = std::max(largest, string.largest_A);
  if (strings_.empty() || !(largest > 0.0)) return found;
  const double R = settings_.series_ohm;
  const double end = end_x();
  if (!(end > 0.0)) return found;
  const std::vector<double> edges = breakpoints(end);
  State state;
  // Current and voltage at the edges bound the power in between: y falls with x.
  struct Span {
    double low, high, bound_W;
  };
  std::vector<Span> spans;
  double last_y = 0.0;
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    if (i == 0) {
      at(edges[0], state);
      last_y = by_current() ? state.voltage_V : state.current_A;
    }
    at(edges[i + 1], state);
    if (edges[i + 1] - edges[i] > 1e-12 * end) {
      spans.push_back({edges[i], edges[i + 1], edges[i + 1] * last_y});
    }
    last_y = by_current() ? state.voltage_V : state.current_A;
  }
  if (which == Which::highest) {
    std::stable_sort(spans.begin(), spans.end(),
                     [](const Span& a, const Span& b) { return a.bound_W > b.bound_W; });
  }
  double best_W = 0.0;
  for (const Span& span : spans) {
    if (which == Which::highest && span.bound_W < best_W) break;
    const double width = span.high - span.low;
    double low = span.low + 1e-9 * width, high = span.high - 1e-9 * width;
    at(high, state);
    if (power_slope(state) >= 0.0) continue;
    at(low, state);
    if (power_slope(state) <= 0.0) continue;
    double x = 0.5 * (low + high);
    for (int k = 0; k < 80; ++k) {
      at(x, state);
      const double g = power_slope(state);
      (g > 0.0 ? low : high) = x;
      const double ohm = 1.0 / state.slope_S;
      const double g_x = by_current()
                             ? -2.0 * (ohm + R) + x * state.strings.front().curvature_V_A2
                             : state.curvature * (state.voltage_V - 2.0 * R * state.current_A) -
                                   state.slope_S * (2.0 + 2.0 * R * state.slope_S);
      double next = x - g / g_x;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      const bool done = std::abs(next - x) < 1e-11 * end;
      x = next;
      if (done) break;
    }
    at(x, state);
    found.push_back(maximum_at(state, derivatives));
    best_W = std::max(best_W, found.back().power_W());
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Maximum& a, const Maximum& b) { return a.power_W() > b.power_W(); });
  return found;
}

double LitNetwork::short_circuit_A() const {
  if (strings_.empty()) return 0.0;
  if (by_current()) return end_x();
  State state;
  at(0.0, state);
  return state.current_A;
}

}  // namespace photorque

#include "diagnosis/light/model/network.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/errors.h"

namespace photorque {
namespace {

double clamp_of(const Diode& diode, const char* what) {
  if (diode.kind == Diode::Kind::junction) {
    throw InputError({}, what, "\"junction\"",
                     "\"ideal\" or \"none\": the diagnosis of light knows ideal diodes alone");
  }
  return diode.kind == Diode::Kind::none ? std::numeric_limits<double>::infinity() : diode.drop_V;
}

}  // namespace

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
void LitNetwork::solve(const String& string, double voltage_V, StringPoint& at,
                       double behind_ohm) const {
  double low = -unlimited, high = unlimited;
  double x = at.clamped.empty() ? 0.9 * string.largest_A : at.current_A;
  const double least = 1e-12 + 1e-12 * string.largest_A;
  for (int i = 0; i < 200; ++i) {
    if (string.is_blocking && x < 0.0) x = 0.0;
    evaluate(string, x, at);
    const double off = at.voltage_V - behind_ohm * x - voltage_V;
    const double slope_ohm = at.slope_ohm + behind_ohm;
    (off > 0.0 ? low : high) = x;
    if (string.is_blocking && x == 0.0 && off <= 0.0) {
      at.slope_ohm = unlimited;  // blocked: carries nothing at any voltage near
      return;
    }
    if (std::abs(off) < 1e-11) return;
    double next = slope_ohm > 0.0 ? x + off / slope_ohm : (off > 0.0 ? unlimited : -unlimited);
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
      const double along2 = dv * dv * wv + di * di * wi;
      double step = (v * dv * wv + i * di * wi) / along2;
      // No nearer than a millionth of an error along the curve, which nothing feels.
      if (step * step * along2 < 1e-12) break;
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

}  // namespace photorque

// Where the power of a lit network is highest, and how its maxima move with the light.
#include <algorithm>
#include <cmath>

#include "diagnosis/light/model/network.h"

namespace photorque {

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

// The voltage of cells in series is concave in their current: from the least photocurrent, or the
// right of the root, Newton's steps come down to it.
double LitNetwork::clamp_current_A(const Substring& substring) const {
  if (substring.is_shorted || !(substring.clamp_V < unlimited)) return unlimited;
  double x = unlimited;
  for (const int cell : substring.cells) {
    x = std::min(x, photocurrents_A_[static_cast<size_t>(cell)]);
  }
  double low = -unlimited, high = unlimited;
  for (int i = 0; i < 200; ++i) {
    double off = substring.clamp_V, slope_ohm = 0.0;
    for (const int cell : substring.cells) {
      const auto k = static_cast<size_t>(cell);
      const LitDiode& kind = cells_->kinds[static_cast<size_t>(cells_->kind_of_cell[k])];
      const LitDiode::Point d = kind.at(photocurrents_A_[k] - x);
      off += d.value_V + settings_.cell_offset_V - x * kind.series_ohm();
      slope_ohm += d.slope_ohm + kind.series_ohm();
    }
    (off > 0.0 ? low : high) = x;
    double next = x + off / slope_ohm;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(off) < 1e-11 || !std::isfinite(next) || next == x) break;
    x = next;
  }
  return x;
}

double LitNetwork::end_x() const {
  if (by_current()) {
    StringPoint p;
    solve(strings_.front(), 0.0, p, settings_.series_ohm);
    return p.current_A;
  }
  // The open circuit: between zero and the largest voltage of a string without current.
  double low = 0.0, high = 0.0;
  StringPoint open;
  for (const String& string : strings_) {
    evaluate(string, 0.0, open);
    high = std::max(high, open.voltage_V);
  }
  State state;
  const double least = 1e-13 * high;
  double x = high;
  for (int i = 0; i < 100; ++i) {
    at(x, state);
    (state.current_A > 0.0 ? low : high) = x;
    // Behind blocking diodes nothing flows beyond the open circuit, and nothing says how far it is.
    double next = x + state.current_A / state.slope_S;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - x) < least) break;
    x = next;
  }
  return x;
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
  std::vector<Maximum> corners;
  // `state` is that at x.
  const auto add_corner = [&](double x) {
    if (which != Which::with_corners) return;
    Maximum corner = maximum_at(state, false);
    // By d ln P/d ln x: some thousandths of the light turn it round.
    constexpr double nearly_level = 0.1;
    if (std::abs(power_slope(state)) * x > nearly_level * corner.power_W()) return;
    corner.is_corner = true;
    corner.voltage_by_photocurrent.assign(photocurrents_A_.size(), 0.0);
    corner.current_by_photocurrent.assign(photocurrents_A_.size(), 0.0);
    corners.push_back(std::move(corner));
  };
  for (const Span& span : spans) {
    if (which == Which::highest && span.bound_W < best_W) break;
    const double width = span.high - span.low;
    double low = span.low + 1e-9 * width, high = span.high - 1e-9 * width;
    at(high, state);
    if (power_slope(state) >= 0.0) {
      if (span.high < end) add_corner(high);
      continue;
    }
    at(low, state);
    if (power_slope(state) <= 0.0) {
      if (span.low > 0.0) add_corner(low);
      continue;
    }
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
  found.insert(found.end(), corners.begin(), corners.end());
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

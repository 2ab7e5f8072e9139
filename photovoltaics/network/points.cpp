// Points of ArrayCurve at given voltages and nearest to readings, also beyond short and open
// circuit, and their derivatives with respect to the photocurrents.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/numerics/root.h"
#include "photovoltaics/network/curve.h"

namespace photorque {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();
// Slope of a curve whose voltage does not depend on the current.
constexpr double steepest_S = 1e12;

double inverse_or_steepest(double slope_ohm) {
  return slope_ohm > 0.0 ? 1.0 / slope_ohm : steepest_S;
}

}  // namespace

// A node that is moved along the curve.
class ArrayCurve::Probe {
 public:
  explicit Probe(const ArrayCurve& curve) : curve_(curve), node_(curve.make_node()) {}

  const Node& at(double x) {
    constexpr double fine = 1e-9;
    curve_.find_regimes(x, regimes_);
    curve_.evaluate(x, regimes_, node_, fine);
    return node_;
  }
  const Node& node() const { return node_; }
  const std::vector<StringRegime>& regimes() const { return regimes_; }
  ArrayPoint point() const { return curve_.point(node_.x, node_.y); }
  double slope_S() const {
    return curve_.by_current() ? inverse_or_steepest(node_.slope)
                               : node_.slope / (1.0 + curve_.series_ohm_ * node_.slope);
  }

  // The point with a given terminal voltage, which decreases with the current.
  SlopedPoint at_voltage(double voltage_V, double low_x, double high_x, double guess_x) {
    const bool by_current = curve_.by_current();
    const double R = node_.series_ohm;
    const double close_V = by_current ? curve_.strings_[0].close_V() : unlimited;
    const double x = falling_root(low_x, high_x, guess_x, 1e-6, [&](double trial_x) {
      const Node& n = at(trial_x);
      if (!by_current) {
        return FunctionAt{voltage_V - (n.x - R * n.y), -(1.0 + R * n.slope), R * n.curvature,
                          R * n.third};
      }
      const double excess_V = n.y - voltage_V;
      return FunctionAt{excess_V, -n.slope, n.curvature, n.third, std::abs(excess_V) <= close_V};
    });
    const Node& n = at(x);
    return {voltage_V, by_current ? x : n.y, slope_S()};
  }

 private:
  const ArrayCurve& curve_;
  Node node_;
  std::vector<StringRegime> regimes_;
};

// Lower limit of x: below it, a string whose substrings all clamp has no solution.
double ArrayCurve::lowest_x() const {
  if (by_current()) return strings_[0].has_blocking_clamp() ? 0.0 : -unlimited;
  double lowest_V = -unlimited;
  for (const StringCurve& string : strings_) lowest_V = std::max(lowest_V, string.lowest_V());
  constexpr double inside = 0.98;
  return inside * lowest_V;
}

double ArrayCurve::x_of(const ArrayPoint& point) const {
  return by_current() ? point.current_A : point.voltage_V + series_ohm_ * point.current_A;
}

std::vector<ArrayCurve::SlopedPoint> ArrayCurve::at_voltages(
    const std::vector<double>& rising_V) const {
  std::vector<SlopedPoint> points;
  points.reserve(rising_V.size());
  if (strings_.empty()) {
    for (const double V : rising_V) points.push_back({V, 0.0, 0.0});
    return points;
  }
  Probe probe(*this);
  if (!by_current()) {
    for (const double V : rising_V) {
      if (series_ohm_ == 0.0) {
        points.push_back({V, probe.at(V).y, probe.slope_S()});
        continue;
      }
      // The voltage across the series resistance is between zero and that of the first estimate.
      const double other_x = V + series_ohm_ * probe.at(V).y;
      points.push_back(probe.at_voltage(V, std::min(V, other_x), std::max(V, other_x), V));
    }
    return points;
  }
  const double open_V = probe.at(0.0).y, lowest = lowest_x();
  double high = end_x_;
  for (double step = 0.05 * end_x_ + 1e-9, k = 0;
       k < 40 && !rising_V.empty() && probe.at(high).y > rising_V.front(); step *= 2.0, ++k) {
    high += step;
  }
  double low = 0.0, guess = high;
  for (const double V : rising_V) {
    if (V > open_V && lowest == 0.0) {
      points.push_back({V, 0.0, 0.0});  // blocked
      continue;
    }
    for (double step = 0.05 * end_x_ + 1e-9, k = 0; k < 40 && V > open_V && probe.at(low).y < V;
         step *= 2.0, ++k) {
      low -= step;
    }
    points.push_back(probe.at_voltage(V, low, high, guess));
    high = points.back().current_A;
    const Node& n = probe.node();
    const double next_V = &V == &rising_V.back() ? V : *(&V + 1);
    guess = n.slope > 0.0 ? extrapolated_A({n.y, n.slope, n.curvature, n.third},
                                           points.back().current_A, next_V)
                          : high;
  }
  return points;
}

std::vector<ArrayPoint> ArrayCurve::trace() const {
  std::vector<ArrayPoint> places;
  if (!(end_x_ > 0.0)) return places;
  Probe probe(*this);
  const auto place = [&](double x) {
    probe.at(x);
    return probe.point();
  };
  const double begin_x = std::max(-0.05 * end_x_, lowest_x());
  const ArrayPoint first = place(begin_x), last = place(1.05 * end_x_);
  const double largest_V = std::max(std::abs(first.voltage_V), std::abs(last.voltage_V)),
               largest_A = std::max(std::abs(first.current_A), std::abs(last.current_A));
  constexpr double near = 0.015;
  struct End {
    double x;
    ArrayPoint at;
  };
  const std::function<void(const End&, const End&, int)> refine = [&](const End& a, const End& b,
                                                                      int depth) {
    const bool far = std::abs(a.at.voltage_V - b.at.voltage_V) > near * largest_V ||
                     std::abs(a.at.current_A - b.at.current_A) > near * largest_A;
    if (far && depth < 14) {
      const double x = std::midpoint(a.x, b.x);
      const End middle{x, place(x)};
      refine(a, middle, depth + 1);
      refine(middle, b, depth + 1);
      return;
    }
    places.push_back(b.at);
  };
  places.push_back(first);
  refine({begin_x, first}, {1.05 * end_x_, last}, 0);
  return places;
}

ArrayCurve::SlopedPoint ArrayCurve::nearest(const ArrayPoint& reading, const ArrayPoint& error,
                                            const std::vector<ArrayPoint>& trace) const {
  if (is_shorted_) return {0.0, reading.current_A, steepest_S};
  if (strings_.empty()) return {reading.voltage_V, 0.0, 0.0};
  const double wv = 1.0 / (error.voltage_V * error.voltage_V),
               wi = 1.0 / (error.current_A * error.current_A);
  const auto distance2 = [&](const ArrayPoint& p) {
    const double v = reading.voltage_V - p.voltage_V, i = reading.current_A - p.current_A;
    return v * v * wv + i * i * wi;
  };
  Probe probe(*this);
  const double lowest = lowest_x();
  struct Foot {
    double distance2, x;
    SlopedPoint point;
  };
  const auto foot_at = [&](double x) -> Foot {
    x = std::max(x, lowest);
    probe.at(x);
    const ArrayPoint p = probe.point();
    return {distance2(p), x, {p.voltage_V, p.current_A, probe.slope_S()}};
  };
  // Gauss–Newton steps along the curve; each step is halved until the distance decreases.
  const auto descend = [&](double start_x) {
    Foot best = foot_at(start_x);
    for (int k = 0; k < 60; ++k) {
      const double slope = probe.node().slope;
      const double dv = by_current() ? -slope : 1.0 + series_ohm_ * slope;
      const double di = by_current() ? 1.0 : -slope;
      const double along2 = dv * dv * wv + di * di * wi;
      double step = ((reading.voltage_V - best.point.voltage_V) * dv * wv +
                     (reading.current_A - best.point.current_A) * di * wi) /
                    along2;
      // Steps below a millionth of the error do not change the distance.
      if (step * step * along2 < 1e-12) break;
      bool is_nearer = false;
      for (int half = 0; half < 30 && std::abs(step) > 1e-13 * (1.0 + std::abs(best.x));
           ++half, step *= 0.5) {
        const Foot next = foot_at(best.x + step);
        if (!(next.distance2 < best.distance2)) continue;
        is_nearer = best.distance2 - next.distance2 > 1e-9 * (1.0 + next.distance2);
        best = next;
        break;
      }
      if (!is_nearer) break;
    }
    return best;
  };
  double start_x = by_current() ? reading.current_A : reading.voltage_V;
  const auto closest = std::ranges::min_element(trace, {}, distance2);
  if (closest != trace.end()) start_x = x_of(*closest);
  Foot best = descend(start_x);
  // At a corner of the curve, a second start on the other side may find a nearer point.
  constexpr double far2 = 9.0;
  if (best.distance2 > far2 && trace.empty()) {
    const Foot second = descend(by_current() ? at_voltages({reading.voltage_V}).front().current_A
                                             : reading.voltage_V);
    if (second.distance2 < best.distance2) best = second;
  }
  // A blocked string can have any voltage above its open-circuit voltage.
  if (by_current() && best.x == 0.0 && lowest == 0.0 && reading.voltage_V > best.point.voltage_V) {
    return {reading.voltage_V, 0.0, 0.0};
  }
  return best.point;
}

// With V_s(I_s) of a string and ρ = −dV_s/dI_s, at a fixed voltage
//   ∂I_s/∂I_k = (∂V_s/∂I_k)/ρ,   ∂(dI_s/dV)/∂I_k = −(V_s″ ∂I_s/∂I_k + ∂²V_s/∂I_s∂I_k)/ρ².
ArrayCurve::Moved ArrayCurve::moved_by_photocurrents(
    const Node& node, const std::vector<StringRegime>& regimes) const {
  Moved moved{std::vector<double>(cells_, 0.0), std::vector<double>(cells_, 0.0)};
  for (size_t s = 0; s < strings_.size(); ++s) {
    const StringState& state = node.strings[s];
    const double ohm = state.slope_ohm;
    if (!(ohm > 0.0) || !std::isfinite(ohm)) continue;
    for (const VoltageMotion& m : strings_[s].voltage_motions(state, regimes[s])) {
      const double current = m.voltage_ohm / ohm;
      moved.current[m.cell] = current;
      moved.slope_1_V[m.cell] = -(state.curvature_V_A2 * current + m.slope_V_A2) / (ohm * ohm);
    }
  }
  return moved;
}

std::vector<double> ArrayCurve::current_by_photocurrent(const ArrayPoint& at) const {
  if (strings_.empty()) return std::vector<double>(cells_, 0.0);
  Probe probe(*this);
  const Node& node = probe.at(x_of(at));
  const bool is_blocked = lowest_x() == 0.0 && at.current_A == 0.0 && at.voltage_V > node.y;
  if (by_current() && is_blocked) return std::vector<double>(cells_, 0.0);
  Moved moved = moved_by_photocurrents(node, probe.regimes());
  double conductance_S = 0.0;
  for (const StringState& state : node.strings) {
    conductance_S += inverse_or_steepest(state.slope_ohm);
  }
  for (double& current : moved.current) current /= 1.0 + series_ohm_ * conductance_S;
  return moved.current;
}

// With V the voltage before the resistance R and S = −dI/dV, F = I − S (V − 2 R I) is zero at the
// maximum, whatever the photocurrents: ∂V/∂I_k = −(∂F/∂I_k)/(∂F/∂V).
ArrayCurve::MaximumMotion ArrayCurve::maximum_by_photocurrent(const ArrayPoint& maximum) const {
  Probe probe(*this);
  const Node& node = probe.at(x_of(maximum));
  const Moved moved = moved_by_photocurrents(node, probe.regimes());
  const double R = series_ohm_, lever_V = maximum.voltage_V - R * maximum.current_A;
  Slopes current;
  for (const StringState& state : node.strings) current += inverted(state.slopes());
  const double S = current.slope;
  const double F_V = current.curvature * lever_V - S * (2.0 + 2.0 * R * S);
  MaximumMotion motion;
  for (size_t k = 0; k < cells_; ++k) {
    const double I_k = moved.current[k];
    const double F_k = moved.slope_1_V[k] * lever_V + (1.0 + 2.0 * R * S) * I_k;
    const double moved_V = -F_k / F_V, moved_A = I_k - S * moved_V;
    motion.current.push_back(moved_A);
    motion.voltage_ohm.push_back(moved_V - R * moved_A);
  }
  return motion;
}

}  // namespace photorque

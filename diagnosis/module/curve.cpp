#include "diagnosis/module/curve.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/constants.h"

namespace photorque {
namespace {

constexpr double silicon_gap_eV = 1.121;

// A fit may try numbers that no cell has; there it finds a bad curve and no error.
CellParameters at_state(const ModuleCell& cell, const ModuleState& state) {
  const double T = std::clamp(state.temperature_K, 100.0, 800.0), T0 = cell.temperature_K,
               n = std::clamp(cell.ideality, 0.05, 50.0);
  const double per_kelvin = silicon_gap_eV * elementary_charge_C / boltzmann_J_K / n;
  CellParameters p;
  p.temperature_K = T;
  p.ideality_1 = n;
  p.saturation_1_A = std::clamp(
      cell.saturation_A * std::pow(T / T0, 3.0 / n) * std::exp(per_kelvin * (1.0 / T0 - 1.0 / T)),
      1e-60, 1e3);
  p.series_ohm = std::clamp(cell.series_ohm, 0.0, 1e6);
  const double leak_S =
      std::max(state.light, 1e-6) / std::max(cell.shunt_ohm, 1e-9) + state.shunt_S;
  p.shunt_ohm = 1.0 / std::clamp(leak_S, 1e-12, 1e6);
  return p;
}

// V(I) and −dV/dI.
struct Branch {
  double voltage_V = 0.0, slope_ohm = 0.0;
};

Branch of_cell(const CellCurve& curve, double photocurrent_A, double current_A) {
  const double v = curve.diode_voltage_V(photocurrent_A - current_A);
  const double R = curve.parameters().series_ohm;
  return {v - current_A * R, 1.0 / curve.dark(v).slope_S + R};
}

// A falling function by its values and slopes at some places: cubics between neighbours.
class Falling {
 public:
  struct Node {
    double x, y, slope;
  };
  explicit Falling(std::vector<Node> nodes) : nodes_(std::move(nodes)) {
    std::ranges::sort(nodes_, [](const Node& a, const Node& b) { return a.x < b.x; });
  }
  // y and its slope; straight on beyond the ends.
  Node at(double x) const {
    const auto above = std::ranges::upper_bound(nodes_, x, {}, &Node::x);
    if (above == nodes_.begin() || above == nodes_.end()) {
      const Node& end = above == nodes_.end() ? nodes_.back() : nodes_.front();
      return {x, end.y + (x - end.x) * end.slope, end.slope};
    }
    const Node &b = *above, &a = *(above - 1);
    const double h = b.x - a.x, t = (x - a.x) / h, rise = (b.y - a.y) / h;
    // Slopes beyond three times the chord's would make it turn back.
    const double p = std::max(a.slope, 3.0 * rise), q = std::max(b.slope, 3.0 * rise);
    const double u = 1.0 - t;
    const double y =
        u * u * (1.0 + 2.0 * t) * a.y + t * t * (3.0 - 2.0 * t) * b.y + h * t * u * (u * p - t * q);
    const double slope = 6.0 * t * u * rise + u * (1.0 - 3.0 * t) * p + t * (3.0 * t - 2.0) * q;
    return {x, y, slope};
  }

 private:
  std::vector<Node> nodes_;
};

// Two parts of one cell in parallel, one of them behind a resistance: at one voltage their currents
// add up.
class CrackedCell {
 public:
  CrackedCell(const CellParameters& whole, double photocurrent_A, double lowest_V,
              const ModuleState::Cracked& crack)
      : voltage_(nodes(whole, photocurrent_A, lowest_V, crack)) {}

  Branch at(double current_A) const {
    const Falling::Node n = voltage_.at(current_A);
    return {n.y, -n.slope};
  }

 private:
  static std::vector<Falling::Node> nodes(const CellParameters& whole, double photocurrent_A,
                                          double lowest_V, const ModuleState::Cracked& crack) {
    const CellCurve good = part(whole, 1.0 - crack.fraction, 0.0),
                    cut = part(whole, crack.fraction, crack.resistance_ohm);
    const double light = photocurrent_A * (1.0 - crack.fraction),
                 light_cut = photocurrent_A * crack.fraction;
    const double open_V = good.open_circuit_V(light);
    std::vector<Falling::Node> nodes;
    const auto add = [&](double V) {
      const double i = good.current_A(light, V), j = cut.current_A(light_cut, V);
      const auto slope = [&](const CellCurve& c, double current_A) {
        const double R = c.parameters().series_ohm;
        return 1.0 / (1.0 / c.dark(V + current_A * R).slope_S + R);
      };
      nodes.push_back({i + j, V, -1.0 / (slope(good, i) + slope(cut, j))});
    };
    constexpr int backwards = 40, forwards = 160;
    // The part cut off saturates a little backwards, where the resistance takes all its voltage.
    for (int k = backwards; k > 0; --k) {
      const double part = static_cast<double>(k) / backwards;
      add(lowest_V * part * part);
    }
    for (int k = 0; k <= forwards; ++k) add(1.15 * open_V * k / forwards);
    return nodes;
  }
  static CellCurve part(CellParameters p, double fraction, double resistance_ohm) {
    p.saturation_1_A *= fraction;
    p.series_ohm = p.series_ohm / fraction + resistance_ohm;
    p.shunt_ohm /= fraction;
    return CellCurve(p);
  }
  Falling voltage_;
};

// Cells under one bypass diode that are alike among each other but not like the rest.
struct Group {
  int count = 0;
  std::function<Branch(double current_A)> at;
};

class Module {
 public:
  Module(const ModuleWiring& wiring, const ModuleCell& cell, const ModuleState& state)
      : wiring_(wiring),
        state_(state),
        usual_(at_state(cell, state)),
        light_A_(cell.photocurrent_A * state.light),
        largest_A_(light_A_) {
    plain_ = wiring.cells - state.bypassed;
    const double lowest_V = -1.1 * wiring.cells * usual_.open_circuit_V(light_A_);
    for (const auto& s : state.shaded) {
      CellParameters p = usual_.parameters();
      p.breakdown_fraction = s.breakdown_fraction;
      p.breakdown_V = s.breakdown_V;
      p.breakdown_exponent = s.breakdown_exponent;
      add(s.count, [curve = CellCurve(p), light = light_A_ * s.factor](double current_A) {
        return of_cell(curve, light, current_A);
      });
    }
    for (const auto& s : state.shunted) {
      CellParameters p = usual_.parameters();
      p.shunt_ohm = 1.0 / (1.0 / p.shunt_ohm + s.shunt_S);
      add(s.count, [curve = CellCurve(p), light = light_A_](double current_A) {
        return of_cell(curve, light, current_A);
      });
    }
    for (const auto& c : state.cracked) {
      add(c.count, [cracked = CrackedCell(usual_.parameters(), light_A_, lowest_V, c)](
                       double current_A) { return cracked.at(current_A); });
    }
  }

  double largest_A() const { return largest_A_; }

  Branch at(double current_A) const {
    const Branch one = of_cell(usual_, light_A_, current_A);
    Branch sum{-current_A * state_.series_ohm, state_.series_ohm};
    int left = plain_;
    for (const Group& g : groups_) {
      const int beside = wiring_.bypass_every > 0
                             ? std::clamp(wiring_.bypass_every - g.count, 0, std::max(0, left))
                             : 0;
      left -= beside;
      const Branch changed = g.at(current_A);
      Branch substring{g.count * changed.voltage_V + beside * one.voltage_V,
                       g.count * changed.slope_ohm + beside * one.slope_ohm};
      if (wiring_.bypass_every > 0 && substring.voltage_V < -wiring_.bypass_drop_V) {
        substring = {-wiring_.bypass_drop_V, 0.0};
      }
      sum.voltage_V += substring.voltage_V;
      sum.slope_ohm += substring.slope_ohm;
    }
    sum.voltage_V += left * one.voltage_V;
    sum.slope_ohm += left * one.slope_ohm;
    return sum;
  }

 private:
  void add(int count, std::function<Branch(double)> at) {
    count = std::min(count, plain_);
    if (count <= 0) return;
    plain_ -= count;
    groups_.push_back({count, std::move(at)});
  }

  ModuleWiring wiring_;
  const ModuleState& state_;
  CellCurve usual_;
  double light_A_, largest_A_;
  int plain_ = 0;
  std::vector<Group> groups_;
};

}  // namespace

std::vector<ModulePoint> module_curve(const ModuleWiring& wiring, const ModuleCell& cell,
                                      const ModuleState& state,
                                      const std::vector<double>& voltage_V) {
  const Module module(wiring, cell, state);
  if (voltage_V.empty()) return {};
  const double low_V = std::ranges::min(voltage_V), high_V = std::ranges::max(voltage_V);
  const double span_V = std::max(high_V - low_V, 1e-3);
  struct Place {
    double current_A;
    Branch at;
  };
  const auto place = [&](double current_A) { return Place{current_A, module.at(current_A)}; };
  // Currents about all of the voltages asked for.
  double reach_A = 0.05 * module.largest_A();
  Place most = place(module.largest_A()), least = place(-reach_A);
  for (int i = 0; i < 40 && most.at.voltage_V > low_V; ++i, reach_A *= 2.0) {
    most = place(most.current_A + reach_A);
  }
  reach_A = 0.05 * module.largest_A();
  for (int i = 0; i < 40 && least.at.voltage_V < high_V; ++i, reach_A *= 2.0) {
    least = place(least.current_A - reach_A);
  }
  // Intervals are halved until their voltages are near each other.
  const double near_V = span_V / 160.0;
  std::vector<Falling::Node> nodes;
  const std::function<void(const Place&, const Place&, int)> refine =
      [&](const Place& a, const Place& b, int depth) {  // a: less current, more voltage
        const bool asked = a.at.voltage_V > low_V - near_V && b.at.voltage_V < high_V + near_V;
        if (asked && depth < 40 && a.at.voltage_V - b.at.voltage_V > near_V) {
          const Place middle = place(0.5 * (a.current_A + b.current_A));
          refine(a, middle, depth + 1);
          refine(middle, b, depth + 1);
          return;
        }
        nodes.push_back({b.at.voltage_V, b.current_A, -1.0 / std::max(b.at.slope_ohm, 1e-12)});
      };
  nodes.push_back(
      {least.at.voltage_V, least.current_A, -1.0 / std::max(least.at.slope_ohm, 1e-12)});
  refine(least, most, 0);
  const Falling current(std::move(nodes));
  std::vector<ModulePoint> curve;
  for (const double V : voltage_V) {
    const Falling::Node n = current.at(V);
    curve.push_back({n.y, std::max(0.0, -n.slope)});
  }
  return curve;
}

}  // namespace photorque

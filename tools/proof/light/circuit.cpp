#include "tools/proof/light/circuit.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque::injected {
namespace {

constexpr double far_A = 1000.0;  // backwards, beyond all that an array is driven to

// Where a falling function crosses zero: bisection, and the false position (with Illinois's
// halving) in between.
template <class Function>
double crossing(double low, double high, const Function& f) {
  const double span = high - low;
  double above = f(low), below = f(high);
  if (!(above > 0.0)) return low;
  if (!(below < 0.0)) return high;
  for (int i = 0; i < 200 && high - low > 1e-13 * span; ++i) {
    const bool halve = i % 3 == 0;
    const double at = halve ? 0.5 * (low + high) : low + (high - low) * above / (above - below);
    const double here = f(at);
    if (here > 0.0) {
      low = at, above = here;
      if (!halve) below *= 0.5;
    } else if (here < 0.0) {
      high = at, below = here;
      if (!halve) above *= 0.5;
    } else {
      return at;
    }
    if (std::abs(here) < 1e-12) return at;
  }
  return 0.5 * (low + high);
}

}  // namespace

size_t InjectedCircuit::bypasses() const {
  const size_t length = cells() / static_cast<size_t>(strings);
  const auto every = static_cast<size_t>(bypass_every);
  return static_cast<size_t>(strings) * ((length + every - 1) / every);
}

LitCircuit::LitCircuit(const InjectedCircuit& circuit, const std::vector<double>& light_W_m2,
                       double temperature_K)
    : circuit_(&circuit) {
  const InjectedCell& c = circuit.cell;
  const double warm = temperature_K - c.reference_K, ratio = temperature_K / c.reference_K;
  const double per_V = elementary_charge_C / boltzmann_J_K;
  slope_V_ = c.ideality * temperature_K / per_V;
  const double gap_eV = c.gap_eV * (1.0 + c.gap_slope_per_K * warm);
  saturation_A_ = c.saturation_A * ratio * ratio * ratio *
                  std::exp(per_V * (c.gap_eV / c.reference_K - gap_eV / temperature_K));
  conductance_S_ = 1.0 / c.shunt_ohm + circuit.shunt_S;
  extra_V_ = circuit.voltage_V_per_K * warm;
  const double per_W = circuit.efficiency * circuit.wavelength_m * elementary_charge_C /
                       (planck_J_s * speed_of_light_m_s);
  const double warmth = 1.0 + (c.photocurrent_slope_per_K + circuit.photocurrent_per_K) * warm;
  const int lines = circuit.along_columns ? circuit.columns : circuit.rows;
  const int length = circuit.along_columns ? circuit.rows : circuit.columns;
  std::vector<double> chain;  // along the serpentine
  for (int line = 0; line < lines; ++line) {
    for (int i = 0; i < length; ++i) {
      const int place = line % 2 == 0 ? i : length - 1 - i;
      const auto cell = static_cast<size_t>(circuit.along_columns ? place * circuit.columns + line
                                                                  : line * circuit.columns + place);
      chain.push_back(light_W_m2[cell] * circuit.cell_light[cell] * circuit.cell_current[cell] *
                      circuit.soiling * circuit.cell_area_m2 * per_W * warmth);
    }
  }
  const size_t of_string = chain.size() / static_cast<size_t>(circuit.strings);
  size_t diode = 0;
  for (size_t s = 0; s < static_cast<size_t>(circuit.strings); ++s) {
    std::vector<Group> groups;
    for (size_t i = 0; i < of_string; i += static_cast<size_t>(circuit.bypass_every)) {
      Group group;
      for (size_t k = i; k < std::min(of_string, i + static_cast<size_t>(circuit.bypass_every));
           ++k) {
        group.push_back(chain[s * of_string + k]);
        largest_A_ = std::max(largest_A_, group.back());
      }
      if (circuit.bypass_shorted[diode++]) group.clear();
      groups.push_back(group);
    }
    strings_.push_back(groups);
    if (!circuit.string_open[s]) open_.push_back(s);
  }
}

// The junction's voltage x solves L − I₀(exp(x/a) − 1) − G x = I. From a bound above it, Newton's
// method comes down evenly, because the left side is concave.
double LitCircuit::cell_voltage_V(double photocurrent_A, double current_A) const {
  const double left = photocurrent_A - current_A;
  double x = left > 0.0
                 ? std::min(slope_V_ * std::log1p(left / saturation_A_), left / conductance_S_)
                 : 0.0;
  for (int i = 0; i < 100; ++i) {
    const double e = saturation_A_ * std::exp(x / slope_V_);
    const double step =
        (left - (e - saturation_A_) - conductance_S_ * x) / (e / slope_V_ + conductance_S_);
    x += step;
    if (std::abs(step) < 1e-13) break;
  }
  return x - current_A * circuit_->cell.series_ohm + extra_V_;
}

double LitCircuit::string_voltage_V(size_t string, double current_A) const {
  double sum = 0.0;
  for (const Group& group : strings_[string]) {
    if (group.empty()) continue;
    double voltage = 0.0;
    for (const double light : group) voltage += cell_voltage_V(light, current_A);
    sum += std::max(voltage, -circuit_->drop_V);
  }
  return sum;
}

double LitCircuit::string_current_A(size_t string, double voltage_V) const {
  double low = -far_A;
  const double high = 1.5 * largest_A_ + 1.0;
  if (circuit_->blocking) {
    if (string_voltage_V(string, 0.0) <= voltage_V) return 0.0;
    low = 0.0;
  }
  return crossing(low, high, [&](double i) { return string_voltage_V(string, i) - voltage_V; });
}

// On the curve: by the current of an only string, by the voltage of several.
InjectedPoint LitCircuit::at(double parameter) const {
  InjectedPoint p;
  if (open_.size() == 1) {
    p = {string_voltage_V(open_[0], parameter), parameter};
  } else {
    p.voltage_V = parameter;
    for (const size_t s : open_) p.current_A += string_current_A(s, parameter);
  }
  p.voltage_V -= p.current_A * circuit_->series_ohm;
  return p;
}

double LitCircuit::open_voltage_V() const {
  double most = 0.0;
  for (const size_t s : open_) most = std::max(most, string_voltage_V(s, 0.0));
  if (open_.size() < 2) return most;
  return crossing(0.0, most, [&](double v) { return at(v).current_A; });
}

double LitCircuit::current_A(double voltage_V) const {
  if (open_.empty()) return 0.0;
  if (open_.size() == 1) {
    return crossing(circuit_->blocking ? 0.0 : -far_A, 1.5 * largest_A_ + 1.0,
                    [&](double i) { return at(i).voltage_V - voltage_V; });
  }
  const double v = crossing(-60.0, 120.0, [&](double u) { return voltage_V - at(u).voltage_V; });
  return at(v).current_A;
}

std::vector<InjectedPoint> LitCircuit::maxima() const {
  std::vector<InjectedPoint> found;
  if (open_.empty()) return found;
  constexpr int steps = 800;
  const double low = 0.0;
  const double high = open_.size() == 1 ? 1.001 * largest_A_ : open_voltage_V();
  std::vector<double> power(steps + 1);
  const auto where = [&](double i) { return low + (high - low) * i / steps; };
  for (int i = 0; i <= steps; ++i) power[static_cast<size_t>(i)] = at(where(i)).power_W();
  for (int i = 1; i < steps; ++i) {
    const auto k = static_cast<size_t>(i);
    if (power[k] <= 0.0 || power[k] < power[k - 1] || power[k] < power[k + 1]) continue;
    constexpr double golden = 0.6180339887498949;
    double a = where(i - 1), b = where(i + 1);
    while (b - a > 1e-10 * (high - low)) {
      const double c = b - golden * (b - a), d = a + golden * (b - a);
      (at(c).power_W() > at(d).power_W() ? b : a) = at(c).power_W() > at(d).power_W() ? d : c;
    }
    found.push_back(at(0.5 * (a + b)));
  }
  std::ranges::sort(found, [](const auto& a, const auto& b) { return a.power_W() > b.power_W(); });
  return found;
}

}  // namespace photorque::injected

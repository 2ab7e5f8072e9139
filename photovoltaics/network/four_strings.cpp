#include "photovoltaics/network/four_strings.h"

#include <algorithm>
#include <limits>

#include "core/numerics/root.h"
#include "photovoltaics/cell/table.h"

namespace photorque {
std::vector<FourStrings> FourStrings::groups(std::span<const StringCurve> strings) {
  std::vector<FourStrings> all;
  for (size_t s = 0; s < strings.size(); ++s) {
    const auto plain = strings[s].plain();
    // Other laws are not evaluated in lanes.
    if (!plain || dynamic_cast<const DiodeVoltageTable*>(plain->law) == nullptr) continue;
    auto group = std::ranges::find_if(
        all, [&](const FourStrings& g) { return g.count_ < 4 && g.fits(*plain); });
    if (group == all.end()) group = all.emplace(all.end());
    group->add(s, strings[s], *plain);
  }
  for (FourStrings& group : all) group.fill();
  return all;
}

bool FourStrings::fits(const PlainString& string) const {
  return string.law == table_ &&
         (string.bypass->kind == Diode::Kind::junction) == bypass_junctions_ &&
         (string.blocking->kind == Diode::Kind::junction) == blocking_junctions_;
}

void FourStrings::add(size_t index, const StringCurve& curve, const PlainString& string) {
  const DiodeJunction &bypass = *string.bypass, &blocking = *string.blocking;
  if (count_ == 0) {
    table_ = static_cast<const DiodeVoltageTable*>(string.law);
    bypass_junctions_ = bypass.kind == Diode::Kind::junction;
    blocking_junctions_ = blocking.kind == Diode::Kind::junction;
    close_V_ = std::numeric_limits<double>::infinity();
  }
  // Fills all further lanes with this string, so that unused lanes repeat the last one.
  for (size_t lane = count_; lane < 4; ++lane) {
    member_[lane] = index;
    cells_[lane] = string.photocurrents_A.size();
    const size_t cells = std::max(light_A_.size(), string.photocurrents_A.size());
    light_A_.resize(cells, std::array<double, 4>{});
    copies_.resize(cells, std::array<double, 4>{});
    for (size_t c = 0; c < cells; ++c) {
      const bool there = c < string.photocurrents_A.size();
      light_A_[c][lane] = there ? string.photocurrents_A[c] : string.photocurrents_A.back();
      copies_[c][lane] = there ? string.copies[c] : 0.0;
    }
    series_ohm_[lane] = string.series_ohm;
    max_A_[lane] = curve.largest_photocurrent_A();
    open_circuit_V_[lane] = curve.open_circuit_V();
    bypass_saturation_A_[lane] = bypass.saturation_A;
    bypass_scale_V_[lane] = bypass.scale_V;
    bypass_ohm_[lane] = bypass.series_ohm;
    blocking_saturation_A_[lane] = blocking.saturation_A;
    blocking_scale_V_[lane] = blocking.scale_V;
    blocking_ohm_[lane] = blocking.series_ohm;
    blocking_drop_V_[lane] = blocking.kind == Diode::Kind::clamp ? blocking.drop_V : 0.0;
  }
  ++count_;
  close_V_ = std::min(close_V_, curve.close_V());
}

// Cells that pad a string shorter than the others have no copies. Cells that pad all four strings
// are removed.
void FourStrings::fill() {
  const auto unused = [](const std::array<double, 4>& copies) {
    return std::ranges::all_of(copies, [](double c) { return c == 0.0; });
  };
  while (!copies_.empty() && unused(copies_.back())) {
    copies_.pop_back();
    light_A_.pop_back();
  }
}

FourStrings::State FourStrings::read(std::span<const StringState> states) const {
  State state;
  state.voltage_V = states[member_[0]].voltage_V;
  for (size_t lane = 0; lane < 4; ++lane) {
    const StringState& from = states[member_[lane]];
    state.current_A[lane] = from.current_A;
    state.resistance.slope[lane] = from.slope_ohm;
    state.resistance.curvature[lane] = from.curvature_V_A2;
    state.resistance.third[lane] = from.third_V_A3;
  }
  return state;
}

void FourStrings::write(const State& state, std::span<StringState> states) const {
  for (size_t i = 0; i < count_; ++i) {
    if (!solves(i, state.voltage_V)) continue;
    StringState& to = states[member_[i]];
    to.voltage_V = state.voltage_V;
    to.current_A = state.current_A[i];
    to.slope_ohm = state.resistance.slope[i];
    to.curvature_V_A2 = state.resistance.curvature[i];
    to.third_V_A3 = state.resistance.third[i];
  }
}

double FourStrings::sum_A(const State& state) const {
  double sum_A = 0.0;
  for (size_t i = 0; i < count_; ++i) {
    if (solves(i, state.voltage_V)) sum_A += state.current_A[i];
  }
  return sum_A;
}

FourStrings::Point FourStrings::rows_at(const Quad& rows_A, const CellTargets& targets,
                                        bool& outside) const {
  Quad value{}, slope{}, curvature{}, third{};
  QuadBits any_outside{};
  for (size_t c = 0; c < light_A_.size(); ++c) {
    const QuadVoltage v = table_->quad_at_dark(quad_at(light_A_[c].data()) - rows_A);
    const Quad weight = quad_at(copies_[c].data());
    if (targets[0] != nullptr) {
      for (size_t lane = 0; lane < 4; ++lane) {
        if (c < cells_[lane]) targets[lane][c] = {v.slope_ohm[lane], v.curvature_V_A2[lane]};
      }
    }
    any_outside |= v.outside;
    value = multiply_add(weight, v.value_V, value);
    slope = multiply_add(weight, v.slope_ohm, slope);
    curvature = multiply_add(weight, v.curvature_V_A2, curvature);
    third = multiply_add(weight, v.third_V_A3, third);
  }
  outside = any_of(any_outside);
  return {value - rows_A * series_ohm_, {slope + series_ohm_, curvature, -third}};
}

// Adds the reverse current of the bypass diodes of lit rows, in place of the assumed leak:
// Newton's method as in DiodeJunction::junction_V(), with as many rounds as small diodes need.
bool FourStrings::add_bypass(Point& at, Quad& current_A, Quad& leak_A) const {
  constexpr int rounds = 2;
  const Quad& scale_V = bypass_scale_V_;
  if (all_of(at.voltage_V > 30.0 * scale_V)) {
    current_A += -bypass_saturation_A_ - leak_A;
    leak_A = -bypass_saturation_A_;
    return true;
  }
  Quad u = -at.voltage_V, through_A{}, g{}, apart_V{};
  for (int round = 0; round <= rounds; ++round) {
    through_A = bypass_saturation_A_ * (exp(u / scale_V) - 1.0);
    g = (through_A + bypass_saturation_A_) / scale_V;
    apart_V = u + through_A * bypass_ohm_ + at.voltage_V;
    if (round < rounds) u -= apart_V / (1.0 + g * bypass_ohm_);
  }
  if (!all_of(abs(apart_V) <= 1e-14 * scale_V + 4e-16 * abs(u))) return false;
  current_A += through_A - leak_A;
  leak_A = through_A;
  at.bypass_S = g;
  const Quad per_divisor = 1.0 / (1.0 + g * bypass_ohm_);
  const Quad bend = g / scale_V * (per_divisor * per_divisor * per_divisor);
  SlopesOf<Quad> conductance = inverted(at.resistance);
  conductance += {g * per_divisor, bend,
                  -(bend / scale_V * (1.0 - 2.0 * g * bypass_ohm_) * (per_divisor * per_divisor))};
  at.resistance = inverted(conductance);
  return true;
}

void FourStrings::add_blocking(Point& at, const Quad& current_A) const {
  at.voltage_V -= blocking_drop_V_;
  if (!blocking_junctions_) return;
  const Quad forward_A = max(current_A, Quad{});
  const Quad ohm = blocking_scale_V_ / (forward_A + blocking_saturation_A_);
  const Quad bend = ohm * ohm / blocking_scale_V_;
  const Quad junction_V = blocking_scale_V_ * log(1.0 + forward_A / blocking_saturation_A_);
  at.voltage_V -= multiply_add(forward_A, blocking_ohm_, junction_V);
  at.resistance += {ohm + blocking_ohm_, bend, -(2.0 * bend * ohm / blocking_scale_V_)};
}

// The strings' voltages and derivatives. Corrects the currents by the error of the assumed leak of
// the bypass diodes.
bool FourStrings::at_currents(const CellTargets& targets, Quad& current_A, Quad& leak_A,
                              Point& at) const {
  bool outside = false;
  at = rows_at(current_A - leak_A, targets, outside);
  if (outside || !all_of(is_finite(at.voltage_V))) return false;
  if (bypass_junctions_ && !add_bypass(at, current_A, leak_A)) return false;
  add_blocking(at, current_A);
  return true;
}

void FourStrings::write_diodes(const Point& at, double voltage_V, const Quad& current_A,
                               std::span<StringState> states) const {
  for (size_t i = 0; i < count_; ++i) {
    if (!solves(i, voltage_V)) continue;
    StringState& to = states[member_[i]];
    to.parts[0].junction_S = at.bypass_S[i];
    to.blocking_ohm = blocking_scale_V_[i] / (current_A[i] + blocking_saturation_A_[i]);
  }
}

bool FourStrings::solve(double voltage_V, const Quad& low_A, const Quad& high_A, double tolerance,
                        State& state, std::span<StringState> states) const {
  constexpr int max_rounds = 30;
  const QuadBits idle = open_circuit_V_ <= voltage_V;
  const Quad none{};
  // Values of idle lanes may be NaN.
  Quad low = select(idle, none, low_A), high = select(idle, none, high_A);
  Quad current = select(idle, none, min(max(state.current_A, low), high));
  Quad leak = bypass_junctions_ ? -bypass_saturation_A_ : none;
  CellTargets targets{};
  if (!states.empty()) {
    for (size_t lane = 0; lane < 4; ++lane) targets[lane] = states[member_[lane]].cells.data();
  }
  Point at;
  for (int round = 0; round < max_rounds; ++round) {
    if (!at_currents(targets, current, leak, at)) return false;
    const SlopesOf<Quad>& r = at.resistance;
    const Quad excess = at.voltage_V - voltage_V;
    // The method of falling_root(), in all lanes at once.
    const RootStep<Quad> step = third_order_step(excess, Quad(-r.slope), r.curvature, r.third);
    const Quad root = current + step.length, size = abs(current), length = abs(step.length);
    const QuadBits exact = (step.left <= 1e-12 * size) | (length <= 1e-13 * size);
    const QuadBits near = length <= tolerance * size;
    if (all_of(idle | (exact & near & (abs(excess) <= close_V_)))) {
      if (!states.empty()) write_diodes(at, voltage_V, current, states);
      state = {voltage_V,
               root,
               {r.slope - step.length * (r.curvature + 0.5 * step.length * r.third),
                r.curvature + step.length * r.third, r.third}};
      return true;
    }
    low = select(excess > 0.0, max(current, low), low);
    high = select(excess > 0.0, high, min(current, high));
    current = select((root >= low) & (root <= high), root, 0.5 * (low + high));
  }
  return false;
}

// The search starts from the last solution, extrapolated by the sum of a straight line and an
// exponential, like a shunt and a diode. This is correct to third order for any curve.
bool FourStrings::advance(double voltage_V, State& state) const {
  const SlopesOf<Quad> conductance = inverted(state.resistance);
  const double h = voltage_V - state.voltage_V;
  const Quad growth =
      min(max(h * conductance.third / conductance.curvature, Quad{} - 2.0), Quad{} + 2.0);
  const Quad bend =
      0.5 + growth * (1.0 / 6 + growth * (1.0 / 24 + growth * (1.0 / 120 + growth / 720.0)));
  State trial = state;
  trial.current_A -= h * (conductance.slope - h * conductance.curvature * bend);
  constexpr double any = std::numeric_limits<double>::infinity();
  if (!solve(voltage_V, Quad{}, max_A_, any, trial, {})) return false;
  state = trial;
  return true;
}

}  // namespace photorque

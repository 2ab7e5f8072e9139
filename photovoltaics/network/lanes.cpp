#include "photovoltaics/network/lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "photovoltaics/cell/table_quad.h"

namespace photorque {
namespace {

using FourLanes = Eigen::Array4d;

Quad quad_of(const FourLanes& x) {
  return quad_at(x.data());
}

FourLanes lanes_of(Quad x) {
  FourLanes lanes;
  std::memcpy(lanes.data(), &x, sizeof x);
  return lanes;
}

// From V(I) to I(V) or back, as inverted() of Slopes.
void invert(FourLanes& slope, FourLanes& curvature, FourLanes& third) {
  const FourLanes inverse = slope.inverse(), cube = inverse * inverse * inverse;
  third = -(3.0 * curvature * curvature * inverse + third) * inverse * cube;
  curvature *= cube;
  slope = inverse;
}

}  // namespace

std::vector<FourStrings> FourStrings::groups(std::span<const StringCurve> strings) {
  std::vector<FourStrings> all;
  for (size_t s = 0; s < strings.size(); ++s) {
    const auto plain = strings[s].plain();
    if (!plain) continue;
    auto group = std::ranges::find_if(
        all, [&](const FourStrings& g) { return g.count_ < 4 && g.fits(*plain); });
    if (group == all.end()) group = all.emplace(all.end());
    group->add(s, strings[s], *plain);
  }
  for (FourStrings& group : all) group.fill();
  return all;
}

bool FourStrings::fits(const PlainString& string) const {
  return string.table == table_ &&
         (string.bypass->kind == Diode::Kind::junction) == bypass_junctions_ &&
         (string.blocking->kind == Diode::Kind::junction) == blocking_junctions_;
}

void FourStrings::add(size_t index, const StringCurve& curve, const PlainString& string) {
  const DiodeJunction &bypass = *string.bypass, &blocking = *string.blocking;
  if (count_ == 0) {
    table_ = string.table;
    bypass_junctions_ = bypass.kind == Diode::Kind::junction;
    blocking_junctions_ = blocking.kind == Diode::Kind::junction;
    close_V_ = std::numeric_limits<double>::infinity();
  }
  // From this string on, all further lanes: those that stay without one repeat it.
  for (size_t lane = count_; lane < 4; ++lane) {
    const auto l = static_cast<Eigen::Index>(lane);
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
    series_ohm_[l] = string.series_ohm;
    max_A_[l] = curve.largest_photocurrent_A();
    open_circuit_V_[l] = curve.open_circuit_V();
    bypass_saturation_A_[l] = bypass.saturation_A;
    bypass_scale_V_[l] = bypass.scale_V;
    bypass_ohm_[l] = bypass.series_ohm;
    blocking_saturation_A_[l] = blocking.saturation_A;
    blocking_scale_V_[l] = blocking.scale_V;
    blocking_ohm_[l] = blocking.series_ohm;
    blocking_drop_V_[l] = blocking.kind == Diode::Kind::clamp ? blocking.drop_V : 0.0;
  }
  ++count_;
  close_V_ = std::min(close_V_, curve.close_V());
}

// Cells that fill up a string shorter than its neighbours have no copies; those that fill up all
// four are not asked.
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
  for (Eigen::Index lane = 0; lane < 4; ++lane) {
    const StringState& from = states[member_[static_cast<size_t>(lane)]];
    state.current_A[lane] = from.current_A;
    state.slope_ohm[lane] = from.slope_ohm;
    state.curvature_V_A2[lane] = from.curvature_V_A2;
    state.third_V_A3[lane] = from.third_V_A3;
  }
  return state;
}

void FourStrings::write(const State& state, std::span<StringState> states) const {
  for (size_t i = 0; i < count_; ++i) {
    if (!solves(i, state.voltage_V)) continue;
    StringState& to = states[member_[i]];
    const auto lane = static_cast<Eigen::Index>(i);
    to.voltage_V = state.voltage_V;
    to.current_A = state.current_A[lane];
    to.slope_ohm = state.slope_ohm[lane];
    to.curvature_V_A2 = state.curvature_V_A2[lane];
    to.third_V_A3 = state.third_V_A3[lane];
  }
}

double FourStrings::sum_A(const State& state) const {
  double sum_A = 0.0;
  for (size_t i = 0; i < count_; ++i) {
    if (solves(i, state.voltage_V)) sum_A += state.current_A[static_cast<Eigen::Index>(i)];
  }
  return sum_A;
}

FourStrings::Point FourStrings::rows_at(const Lanes& rows_A, const CellTargets& targets,
                                        bool& outside) const {
  Quad value{}, slope{}, curvature{}, third{};
  QuadBits any_outside{};
  const Quad current = quad_of(rows_A);
  for (size_t c = 0; c < light_A_.size(); ++c) {
    const QuadVoltage v = table_->quad_at_dark(quad_at(light_A_[c].data()) - current);
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
  outside = (any_outside[0] | any_outside[1] | any_outside[2] | any_outside[3]) != 0;
  return {lanes_of(value) - rows_A * series_ohm_, lanes_of(slope) + series_ohm_,
          lanes_of(curvature), -lanes_of(third), FourLanes::Zero()};
}

// What flows backwards through the bypass diodes beside lit rows joins the current, in place of the
// leak that was assumed: Newton's method as in DiodeJunction::junction_V(), as many rounds as small
// diodes need.
bool FourStrings::add_bypass(Point& at, FourLanes& current_A, FourLanes& leak_A) const {
  constexpr int rounds = 2;
  const FourLanes& scale_V = bypass_scale_V_;
  if ((at.voltage_V > 30.0 * scale_V).all()) {
    current_A += -bypass_saturation_A_ - leak_A;
    leak_A = -bypass_saturation_A_;
    return true;
  }
  FourLanes u = -at.voltage_V, through_A, g, apart_V;
  for (int round = 0; round <= rounds; ++round) {
    through_A = bypass_saturation_A_ * ((u / scale_V).exp() - 1.0);
    g = (through_A + bypass_saturation_A_) / scale_V;
    apart_V = u + through_A * bypass_ohm_ + at.voltage_V;
    if (round < rounds) u -= apart_V / (1.0 + g * bypass_ohm_);
  }
  if (!(apart_V.abs() <= 1e-14 * scale_V + 4e-16 * u.abs()).all()) return false;
  current_A += through_A - leak_A;
  leak_A = through_A;
  at.bypass_S = g;
  const FourLanes per_divisor = (1.0 + g * bypass_ohm_).inverse();
  const FourLanes bend = g / scale_V * per_divisor.cube();
  invert(at.slope_ohm, at.curvature_V_A2, at.third_V_A3);
  at.slope_ohm += g * per_divisor;
  at.curvature_V_A2 += bend;
  at.third_V_A3 -= bend / scale_V * (1.0 - 2.0 * g * bypass_ohm_) * per_divisor.square();
  invert(at.slope_ohm, at.curvature_V_A2, at.third_V_A3);
  return true;
}

void FourStrings::add_blocking(Point& at, const FourLanes& current_A) const {
  at.voltage_V -= blocking_drop_V_;
  if (!blocking_junctions_) return;
  const FourLanes forward_A = current_A.max(0.0);
  const FourLanes ohm = blocking_scale_V_ / (forward_A + blocking_saturation_A_);
  const FourLanes bend = ohm * ohm / blocking_scale_V_;
  at.voltage_V -= blocking_scale_V_ * (1.0 + forward_A / blocking_saturation_A_).log() +
                  forward_A * blocking_ohm_;
  at.slope_ohm += ohm + blocking_ohm_;
  at.curvature_V_A2 += bend;
  at.third_V_A3 -= 2.0 * bend * ohm / blocking_scale_V_;
}

// The strings' voltages and derivatives; their currents move by what the bypass diodes' leak was
// off.
bool FourStrings::at_currents(const CellTargets& targets, Lanes& current_A, Lanes& leak_A,
                              Point& at) const {
  bool outside = false;
  at = rows_at(current_A - leak_A, targets, outside);
  if (outside || !at.voltage_V.isFinite().all()) return false;
  if (bypass_junctions_ && !add_bypass(at, current_A, leak_A)) return false;
  add_blocking(at, current_A);
  return true;
}

void FourStrings::write_diodes(const Point& at, double voltage_V, const Lanes& current_A,
                               std::span<StringState> states) const {
  for (size_t i = 0; i < count_; ++i) {
    if (!solves(i, voltage_V)) continue;
    const auto lane = static_cast<Eigen::Index>(i);
    StringState& to = states[member_[i]];
    to.bypasses[0].junction_S = at.bypass_S[lane];
    to.blocking_ohm = blocking_scale_V_[lane] / (current_A[lane] + blocking_saturation_A_[lane]);
  }
}

bool FourStrings::solve(double voltage_V, const Lanes& low_A, const Lanes& high_A, double tolerance,
                        State& state, std::span<StringState> states) const {
  constexpr int max_rounds = 30;
  const Eigen::Array<bool, 4, 1> idle = open_circuit_V_ <= voltage_V;
  // What idle lanes had may be no number.
  Lanes low = idle.select(0.0, low_A), high = idle.select(0.0, high_A);
  Lanes current = idle.select(0.0, state.current_A.max(low).min(high));
  Lanes leak = bypass_junctions_ ? Lanes(-bypass_saturation_A_) : Lanes(Lanes::Zero());
  CellTargets targets{};
  if (!states.empty()) {
    for (size_t lane = 0; lane < 4; ++lane) targets[lane] = states[member_[lane]].cells.data();
  }
  Point at;
  for (int round = 0; round < max_rounds; ++round) {
    if (!at_currents(targets, current, leak, at)) return false;
    const Lanes excess = at.voltage_V - voltage_V;
    // As root_step() and falling_root().
    const Lanes inverse = -at.slope_ohm.inverse(), newton = excess * inverse;
    const Lanes bent = 0.5 * newton * at.curvature_V_A2 * inverse;
    const Lanes twist = newton * newton * at.third_V_A3 * inverse / 6.0;
    const Lanes q2 = (bent * bent).max(twist.abs());
    const Lanes left = newton.abs() * q2 * (q2.sqrt() + 2e-3);
    const Lanes chebyshev = -newton * (bent.abs() < 0.5).select(1.0 + bent, 1.0);
    const Lanes step =
        (q2 < 0.09).select(-newton * (1.0 + bent + 2.0 * bent * bent - twist), chebyshev);
    const Lanes root = current + step;
    const auto exact = left <= 1e-12 * current.abs() || step.abs() <= 1e-13 * current.abs();
    const auto near = step.abs() <= tolerance * current.abs();
    if ((idle || (exact && near && excess.abs() <= close_V_)).all()) {
      if (!states.empty()) write_diodes(at, voltage_V, current, states);
      state = {voltage_V, root,
               at.slope_ohm - step * (at.curvature_V_A2 + 0.5 * step * at.third_V_A3),
               at.curvature_V_A2 + step * at.third_V_A3, at.third_V_A3};
      return true;
    }
    low = (excess > 0.0).select(current.max(low), low);
    high = (excess > 0.0).select(high, current.min(high));
    current = (root >= low && root <= high).select(root, 0.5 * (low + high));
  }
  return false;
}

// From the last voltage on: a straight line and an exponential, as a shunt and a diode have it; to
// third order any curve.
bool FourStrings::advance(double voltage_V, State& state) const {
  Lanes slope = state.slope_ohm, curvature = state.curvature_V_A2, third = state.third_V_A3;
  invert(slope, curvature, third);
  const double h = voltage_V - state.voltage_V;
  const Lanes growth = (h * third / curvature).max(-2.0).min(2.0);
  const Lanes bend =
      0.5 + growth * (1.0 / 6 + growth * (1.0 / 24 + growth * (1.0 / 120 + growth / 720)));
  State trial = state;
  trial.current_A -= h * (slope - h * curvature * bend);
  constexpr double any = std::numeric_limits<double>::infinity();
  if (!solve(voltage_V, Lanes::Zero(), max_A_, any, trial, {})) return false;
  state = trial;
  return true;
}

}  // namespace photorque

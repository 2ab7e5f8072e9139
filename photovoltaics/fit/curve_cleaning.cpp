// Readings that do not belong to a curve: spikes, and runs in changing light.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/numerics/median.h"
#include "core/numerics/order.h"
#include "photovoltaics/fit/curve_text.h"

namespace photorque {
namespace curve_cleaning {
namespace {

// Order of the readings: by rising voltage, and at equal voltage by falling current.
std::vector<size_t> order_of(const IvSweep& sweep) {
  return sorted_indices(sweep.voltage_V.size(), [&](size_t a, size_t b) {
    if (sweep.voltage_V[a] != sweep.voltage_V[b]) return sweep.voltage_V[a] < sweep.voltage_V[b];
    return sweep.current_A[a] > sweep.current_A[b];
  });
}

// Removes the marked readings from the sweep and from the indices of those kept.
void take(const std::vector<char>& out, IvSweep& sweep, CurveCleaning& cleaning) {
  sweep = sweep.without(out);
  size_t i = 0;
  std::erase_if(cleaning.kept, [&](size_t) { return out[i++] != 0; });
}

// Removes single readings that differ from both neighbours, which agree with each other and with
// the readings beyond them.
void take_spikes(IvSweep& sweep, CurveCleaning& cleaning) {
  const std::vector<size_t> order = order_of(sweep);
  const double scale_A = std::ranges::max(sweep.current_A);
  constexpr double far = 0.1, alike = 0.25;
  std::vector<char> out(order.size(), 0);
  size_t count = 0;
  for (size_t k = 2; k + 2 < order.size(); ++k) {
    const double at = sweep.current_A[order[k]];
    const std::array<double, 4> near = {
        sweep.current_A[order[k - 2]], sweep.current_A[order[k - 1]], sweep.current_A[order[k + 1]],
        sweep.current_A[order[k + 2]]};
    const auto [low, high] = std::ranges::minmax(near);
    const double off = at > high ? at - high : low - at;
    if (off > far * scale_A && high - low < alike * off) {
      out[order[k]] = 1;
      ++count;
    }
  }
  // If there are many, they are not outliers.
  if (count == 0 || count * 20 > order.size()) return;
  cleaning.spikes = count;
  take(out, sweep, cleaning);
}

// Removes readings without current at voltages below those of the highest voltages with a current.
void take_dead(IvSweep& sweep, CurveCleaning& cleaning) {
  const double flows_A = 0.1 * std::ranges::max(sweep.current_A);
  std::vector<double> flowing_V;
  for (size_t i = 0; i < sweep.voltage_V.size(); ++i) {
    if (sweep.current_A[i] > flows_A) flowing_V.push_back(sweep.voltage_V[i]);
  }
  constexpr size_t fewest = 3;
  if (flowing_V.size() < fewest) return;
  std::ranges::nth_element(flowing_V, flowing_V.begin() + (fewest - 1), std::greater());
  std::vector<char> out(sweep.voltage_V.size(), 0);
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = sweep.current_A[i] == 0.0 && sweep.voltage_V[i] < flowing_V[fewest - 1];
    cleaning.dead += static_cast<size_t>(out[i]);
  }
  if (cleaning.dead > 0) take(out, sweep, cleaning);
}

// The step in which the largest currents are written; 0 if they are not multiples of a step. It is
// the smallest difference of two currents, or a half or a third of that if no two are nearer.
double step_of_readings_A(const IvSweep& sweep) {
  std::vector<double> falling_A = sweep.current_A;
  std::ranges::sort(falling_A, std::greater());
  double smallest_A = falling_A[0];
  for (size_t k = 1; k < falling_A.size(); ++k) {
    const double fall_A = falling_A[k - 1] - falling_A[k];
    if (fall_A > 0.0) smallest_A = std::min(smallest_A, fall_A);
  }
  constexpr double near = 20.0, close = 0.2;
  for (const double part : {1.0, 2.0, 3.0}) {
    const double step_A = smallest_A / part;
    const auto is_multiple = [&](double current_A) {
      const double steps = (falling_A[0] - current_A) / step_A;
      return steps > near || std::abs(steps - std::round(steps)) < close;
    };
    if (std::ranges::all_of(falling_A, is_multiple)) return step_A;
  }
  return 0.0;
}

// A falling line through two readings, and the number of readings that agree with it.
struct Line {
  double at_zero_A = 0.0, slope_S = 0.0;
  size_t agree = 0;
};

// The line at most as steep as `steepest_S` with which most of the readings `of`, by rising
// voltage, agree to `close_A`.
Line line_of_most(const IvSweep& sweep, const std::vector<size_t>& of, double steepest_S,
                  double close_A) {
  const auto volts = [&](size_t k) { return sweep.voltage_V[of[k]]; };
  const auto amperes = [&](size_t k) { return sweep.current_A[of[k]]; };
  constexpr size_t most_starts = 60;
  const size_t stride = std::max<size_t>(1, of.size() / most_starts);
  Line best;
  for (size_t a = 0; a < of.size(); a += stride) {
    for (size_t b = a + of.size() / 4; b < of.size(); b += stride) {
      if (!(volts(b) > volts(a))) continue;
      const double slope_S = (amperes(b) - amperes(a)) / (volts(b) - volts(a));
      if (slope_S > 0.0 || slope_S < -steepest_S) continue;
      size_t agree = 0;
      for (size_t k = 0; k < of.size(); ++k) {
        agree += std::abs(amperes(k) - amperes(a) - slope_S * (volts(k) - volts(a))) < close_A;
      }
      if (agree > best.agree) best = {amperes(a) - slope_S * volts(a), slope_S, agree};
    }
  }
  return best;
}

}  // namespace
}  // namespace curve_cleaning

bool reverse_negative(IvSweep& sweep) {
  const std::vector<double>& voltage_V = sweep.voltage_V;
  if (voltage_V.empty()) return false;
  const auto current_at = [&](auto reading) {
    return sweep.current_A[static_cast<size_t>(reading - voltage_V.begin())];
  };
  const auto highest = std::ranges::max_element(voltage_V);
  const double short_circuit_A =
      current_at(std::ranges::min_element(voltage_V, {}, [](double v) { return std::abs(v); }));
  // A smaller current, as of a dark curve, may be an offset of the meter.
  constexpr double offset = 1e-3;
  const auto [least_A, most_A] = std::ranges::minmax(sweep.current_A);
  if (!(short_circuit_A < -offset * (most_A - least_A) && *highest > 0.0 &&
        current_at(highest) > 0.5 * short_circuit_A)) {
    return false;
  }
  for (double& current : sweep.current_A) current = -current;
  return true;
}

IvSweep IvSweep::without(const std::vector<char>& out) const {
  IvSweep kept;
  kept.is_timed = is_timed;
  const auto keep = [&out](const std::vector<double>& all, std::vector<double>& some) {
    for (size_t i = 0; i < all.size(); ++i) {
      if (out[i] == 0) some.push_back(all[i]);
    }
  };
  keep(voltage_V, kept.voltage_V);
  keep(current_A, kept.current_A);
  keep(light, kept.light);
  keep(rate_V_s, kept.rate_V_s);
  return kept;
}

UnsteadyLight take_unsteady_light(IvSweep& sweep, double noise) {
  using namespace curve_cleaning;
  const std::vector<size_t> order = order_of(sweep);
  if (order.size() < 20) return {};
  const double open_V = sweep.voltage_V[order.back()];
  std::vector<size_t> flat;  // readings of the flat part, by rising voltage
  for (const size_t i : order) {
    if (sweep.voltage_V[i] < 0.6 * open_V) flat.push_back(i);
  }
  if (flat.size() < 12) return {};
  const auto volts = [&](size_t k) { return sweep.voltage_V[flat[k]]; };
  const auto amperes = [&](size_t k) { return sweep.current_A[flat[k]]; };
  const double scale_A = std::ranges::max(sweep.current_A), close_A = 3.0 * noise * scale_A;
  const Line line = line_of_most(sweep, flat, 0.1 * scale_A / (0.6 * open_V), close_A);
  if (5 * line.agree < 3 * flat.size()) return {};  // no line
  UnsteadyLight found;
  std::vector<char> out(order.size(), 0);
  constexpr size_t shortest = 3, beside = 3;
  constexpr double least = 0.01, half = 0.5;
  const auto off_A = [&](size_t k) {
    return amperes(k) - line.at_zero_A - line.slope_S * volts(k);
  };
  for (size_t k = 0, end = 0; k < flat.size(); k = end + 1) {
    for (end = k; end < flat.size() && std::abs(off_A(end)) > close_A;) ++end;
    if (end - k < shortest) continue;
    // Includes the edges of the run, which merge into the line.
    const double sign = off_A(k + (end - k) / 2) < 0.0 ? -1.0 : 1.0;
    size_t first = k, last = end;
    while (first > 0 && sign * off_A(first - 1) > close_A / 3.0) --first;
    while (last < flat.size() && sign * off_A(last) > close_A / 3.0) ++last;
    double largest_A = 0.0, lowest_A = amperes(first), rise_A = 0.0;
    for (size_t j = first; j < last; ++j) largest_A = std::max(largest_A, std::abs(off_A(j)));
    for (size_t j = first - std::min(first, beside); j < std::min(last + beside, flat.size());
         ++j) {
      lowest_A = std::min(lowest_A, amperes(j));
      rise_A = std::max(rise_A, amperes(j) - lowest_A);
    }
    // In steady light the current never rises with the voltage.
    if (largest_A < least * scale_A || rise_A < half * largest_A) continue;
    for (size_t j = first; j < last; ++j) out[flat[j]] = 1;
    found.largest = std::max(found.largest, largest_A / scale_A);
    if (found.readings == 0) found.from_V = volts(first);
    found.to_V = volts(last - 1);
    found.readings += last - first;
    end = std::max(end, last);
  }
  if (found.readings > 0) sweep = sweep.without(out);
  return found;
}

RangeLimit take_range_limit(IvSweep& sweep) {
  using namespace curve_cleaning;
  const std::vector<size_t> order = order_of(sweep);
  if (order.size() < 20) return {};
  const double largest_A = std::ranges::max(sweep.current_A);
  size_t longest = 0, run = 0, last = 0;
  for (size_t k = 0; k < order.size(); ++k) {
    run = sweep.current_A[order[k]] == largest_A ? run + 1 : 0;
    longest = std::max(longest, run);
    if (run > 0) last = k;
  }
  constexpr size_t fewest = 3, beside = 3;
  constexpr double abrupt = 10.0;
  if (longest < fewest || last + beside >= order.size()) return {};
  std::vector<double> next_A;
  for (size_t k = 1; k <= beside; ++k) next_A.push_back(sweep.current_A[order[last + k]]);
  if (largest_A - upper_median(next_A) < abrupt * step_of_readings_A(sweep)) return {};
  RangeLimit limit{0, largest_A};
  std::vector<char> out(order.size(), 0);
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = sweep.current_A[i] == largest_A;
    limit.readings += static_cast<size_t>(out[i]);
  }
  sweep = sweep.without(out);
  return limit;
}

CurveCleaning clean_curve(IvSweep& sweep, bool dark_parts) {
  using namespace curve_cleaning;
  CurveCleaning cleaning;
  cleaning.kept.resize(sweep.voltage_V.size());
  std::iota(cleaning.kept.begin(), cleaning.kept.end(), size_t{0});
  if (sweep.voltage_V.size() < 8 || sweep.current_A.size() != sweep.voltage_V.size()) {
    return cleaning;
  }
  const double scale_A = std::ranges::max(sweep.current_A);
  if (!(scale_A > 0.0)) return cleaning;
  take_spikes(sweep, cleaning);
  take_dead(sweep, cleaning);
  const std::vector<size_t> order = order_of(sweep);
  const auto volts = [&](size_t k) { return sweep.voltage_V[order[k]]; };
  const auto amperes = [&](size_t k) { return sweep.current_A[order[k]]; };
  constexpr double near_zero = 0.03, least_fall = 0.01, held = 0.25;
  // The longest tail below the band about zero, then the longest part of it with a constant
  // current.
  size_t band = order.size();
  while (band > 0 && amperes(band - 1) <= near_zero * scale_A) --band;
  for (size_t first = band; first + 1 < order.size(); ++first) {
    double low = amperes(first), high = low;
    for (size_t k = first; k < order.size(); ++k) {
      low = std::min(low, amperes(k));
      high = std::max(high, amperes(k));
    }
    // The largest slope before these readings, over at least a tenth of the short-circuit current.
    double steepest_S = 0.0;
    for (size_t k = first; k-- > 0;) {
      const double fall_A = amperes(k) - high;
      const double run_V = volts(first) - volts(k);
      if (fall_A < 0.1 * scale_A) continue;
      if (run_V > 0.0) steepest_S = std::max(steepest_S, fall_A / run_V);
      if (fall_A > 0.5 * scale_A) break;
    }
    const double expected_A = steepest_S * (volts(order.size() - 1) - volts(first));
    if (!(expected_A > least_fall * scale_A && high - low < held * expected_A)) continue;
    // A point of the falling curve that the band reached does not belong to the tail.
    std::vector<double> tail;
    for (size_t k = first; k < order.size(); ++k) tail.push_back(amperes(k));
    const double usual_A = upper_median(tail);
    constexpr double end = 0.85;
    if (dark_parts && usual_A >= 0.0 && volts(first) < end * volts(order.size() - 1)) break;
    for (double& one : tail) one = std::abs(one - usual_A);
    const double around_A = std::max(5.0 * upper_median(tail), 2e-3 * scale_A);
    while (std::abs(amperes(first) - usual_A) > around_A) ++first;
    // One or two small currents may be true unless they are equal.
    constexpr size_t fewest = 3;
    if (order.size() - first < fewest && amperes(first) != amperes(order.size() - 1)) break;
    std::vector<char> out(order.size(), 0);
    for (size_t k = first; k < order.size(); ++k) out[order[k]] = 1;
    cleaning.clipped = order.size() - first;
    cleaning.clipped_from_V = volts(first);
    cleaning.clipped_A = usual_A;
    take(out, sweep, cleaning);
    break;
  }
  return cleaning;
}

}  // namespace photorque

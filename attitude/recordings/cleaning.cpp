#include "attitude/recordings/cleaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace photorque {
namespace {

// Ratio of standard deviation and median absolute deviation of a Gaussian.
constexpr double sigma_per_mad = 1.4826;

// The median (the upper one of an even number); reorders the values. 0 if there are none.
template <class Iterator>
double middle_of(Iterator first, Iterator last) {
  if (first == last) return 0.0;
  const Iterator middle = first + (last - first) / 2;
  std::nth_element(first, middle, last);
  return *middle;
}

// Deviation of a value from the parabola through the three values before it (direction −1) or after
// it (+1): a third difference. A spike deviates equally from both, a step from only one. NaN near
// gaps and ends.
double off_parabola(const std::vector<double>& x, size_t i, int direction) {
  const auto at = [&](int steps) {
    const auto j = static_cast<std::ptrdiff_t>(i) + direction * steps;
    return j < 0 || j >= static_cast<std::ptrdiff_t>(x.size()) ? empty_cell
                                                               : x[static_cast<size_t>(j)];
  };
  return at(0) - 3 * at(1) + 3 * at(2) - at(3);
}

// Standard deviation of white noise from third differences. Their variance is 20 times that of the
// noise, and smooth motion hardly contributes.
double noise_level(const std::vector<double>& x) {
  std::vector<double> size;
  for (size_t i = 3; i < x.size(); ++i) {
    const double d = off_parabola(x, i, -1);
    if (std::isfinite(d)) size.push_back(std::abs(d));
  }
  return sigma_per_mad * middle_of(size.begin(), size.end()) / std::sqrt(20.0);
}

// Whether a value is a spike in smooth motion of any rate.
bool stands_out_of_motion(const std::vector<double>& x, size_t i, double noise) {
  constexpr size_t reach = 10;
  constexpr double threshold = 6.0;
  const double before = off_parabola(x, i, -1), after = off_parabola(x, i, +1);
  const double off = before * after > 0.0 ? std::min(std::abs(before), std::abs(after)) : 0.0;
  if (!(off > threshold * std::sqrt(20.0) * noise)) return false;
  // The deviations of a rough motion from its parabolas are no evidence of outliers.
  std::array<double, 2 * reach + 1> rough{};
  size_t count = 0;
  for (size_t j = i - std::min(i, reach); j < std::min(x.size(), i + reach + 1); ++j) {
    const double size = std::abs(off_parabola(x, j, -1));
    if (std::isfinite(size)) rough[count++] = size;
  }
  const auto end = rough.begin() + static_cast<std::ptrdiff_t>(count);
  return off > threshold * sigma_per_mad * middle_of(rough.begin(), end);
}

// Whether a value is far from its six neighbours while they hardly move. Finds pairs, too.
bool stands_out_of_rest(const std::vector<double>& x, size_t i, double noise) {
  constexpr size_t reach = 3;
  constexpr double threshold = 12.0;
  std::array<double, 2 * reach> neighbours{};
  size_t count = 0;
  for (size_t j = i - std::min(i, reach); j < std::min(x.size(), i + reach + 1); ++j) {
    if (j != i && std::isfinite(x[j])) neighbours[count++] = x[j];
  }
  if (count < reach + 1) return false;
  const auto end = neighbours.begin() + static_cast<std::ptrdiff_t>(count);
  const double middle = middle_of(neighbours.begin(), end);
  const double off = std::abs(x[i] - middle);
  if (off <= threshold * noise) return false;
  std::transform(neighbours.begin(), end, neighbours.begin(),
                 [middle](double value) { return std::abs(value - middle); });
  return off > threshold * sigma_per_mad * middle_of(neighbours.begin(), end);
}

// Rows with outliers; `x` may contain NaN.
std::vector<size_t> outlying_rows(const std::vector<double>& x) {
  const double noise = noise_level(x);
  std::vector<size_t> rows;
  for (size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) continue;
    if (stands_out_of_motion(x, i, noise) || stands_out_of_rest(x, i, noise)) rows.push_back(i);
  }
  return rows;
}

// Constant readings of a sensor at the end of its range, or of one that repeats its last reading.
struct Stuck {
  static constexpr size_t least = 5;         // minimum number of equal successive readings
  std::vector<bool> is_stuck;                // by row
  size_t readings = 0, stuck = 0, ties = 0;  // ties: equal neighbours outside
  size_t turns = 0, differences = 0;         // sign changes and number of third differences outside
  double noise = 0.0;                        // standard deviation outside
  double least_step = std::numeric_limits<double>::infinity();  // between neighbours outside

  explicit Stuck(const std::vector<double>& x) : is_stuck(x.size(), false) {
    for (size_t i = 0; i < x.size();) {
      size_t end = i + 1;
      while (end < x.size() && x[end] == x[i]) ++end;
      const size_t equal = end - i;
      if (std::isfinite(x[i])) readings += equal;
      if (equal >= least) {
        stuck += equal;
        std::fill_n(is_stuck.begin() + static_cast<std::ptrdiff_t>(i), equal, true);
      } else {
        ties += equal - 1;
      }
      i = end;
    }
    double before = 0.0;
    std::vector<double> free = x;
    for (size_t i = 0; i < x.size(); ++i) {
      if (is_stuck[i]) free[i] = empty_cell;
      const double step = i > 0 ? std::abs(free[i] - free[i - 1]) : 0.0;
      if (step > 0.0) least_step = std::min(least_step, step);
    }
    noise = noise_level(free);
    for (size_t i = 3; i < x.size(); ++i) {
      const double d = off_parabola(free, i, -1);
      if (d * before < 0.0) ++turns;
      if (std::isfinite(d * before)) ++differences;
      before = d;
    }
  }

  // Whether the channel has white noise that is so fine that equal readings are rare. The third
  // differences of white noise change their sign in three of four cases, those of a smooth motion
  // almost never. Rounding of the numbers makes noise too, but not more than its steps.
  bool has_fine_noise() const {
    constexpr size_t enough = 50;
    return noise > 2.0 * least_step && differences >= enough && 2 * turns > differences &&
           50 * ties < readings - stuck;
  }
  bool never_moves() const { return readings > 0 && stuck == readings; }
};

// Rows whose readings are stuck, and their neighbours. Readings between saturated ones occur only
// if the noise moves them into the range of the sensor, so they are biased.
std::vector<size_t> stuck_rows(const std::vector<double>& x, const Stuck& found) {
  std::vector<size_t> rows;
  for (size_t i = 0; i < x.size(); ++i) {
    bool is_near = false;
    for (const size_t j : {i - 1, i, i + 1}) is_near |= j < x.size() && found.is_stuck[j];
    if (is_near && std::isfinite(x[i])) rows.push_back(i);
  }
  return rows;
}

// The components w, x, y, z of the attitude; empty unless there are all four.
std::vector<Channel*> quaternion_channels(Recording& recording) {
  std::vector<Channel*> q;
  for (const char* name : quaternion_names) {
    q.push_back(recording.find(name));
    if (q.back() == nullptr) return {};
  }
  return q;
}

}  // namespace

void repair_quaternions(Recording& recording) {
  const std::vector<Channel*> q = quaternion_channels(recording);
  if (q.empty()) return;
  std::array<double, 4> before{};
  for (size_t i = 0; i < recording.rows(); ++i) {
    std::array<double, 4> now{};
    double square = 0.0, along = 0.0;
    for (size_t k = 0; k < 4; ++k) {
      now[k] = q[k]->values[i];
      square += now[k] * now[k];
      along += now[k] * before[k];
    }
    if (std::isnan(square)) {
      // Three components do not determine the attitude reliably.
      for (Channel* channel : q) channel->values[i] = empty_cell;
      continue;
    }
    const double norm = std::sqrt(square);
    if (!(std::abs(norm - 1.0) < 0.01)) {
      ++recording.report.bad_quaternions;
      for (Channel* channel : q) channel->values[i] = empty_cell;
      continue;
    }
    const double sign = along < 0.0 ? -1.0 : 1.0;
    recording.report.flipped_quaternions += along < 0.0 ? 1 : 0;
    for (size_t k = 0; k < 4; ++k) {
      before[k] = sign * now[k] / norm;
      q[k]->values[i] = before[k];
    }
  }
}

void remove_outliers(Recording& recording) {
  const auto empty = [&](Channel& channel, size_t row) {
    if (std::isnan(channel.values[row])) return;
    channel.values[row] = empty_cell;
    ++recording.report.outlier_cells;
    ++recording.report.outliers[channel.name];
  };
  std::vector<Channel*> gyro;
  for (const char* name : gyro_names) {
    if (Channel* channel = recording.find(name)) gyro.push_back(channel);
  }
  std::vector<Stuck> stuck;
  for (const Channel* channel : gyro) stuck.emplace_back(channel->values);
  const bool has_noise = std::ranges::any_of(stuck, &Stuck::has_fine_noise);
  for (size_t k = 0; k < gyro.size(); ++k) {
    const std::vector<double>& x = gyro[k]->values;
    // An axis that the instrument does not have is zero in all rows.
    const bool is_pinned = has_noise && stuck[k].never_moves() && x.front() != 0.0;
    if (!is_pinned && !stuck[k].has_fine_noise()) continue;
    for (const size_t row : stuck_rows(x, stuck[k])) empty(*gyro[k], row);
  }
  for (Channel* channel : gyro) {
    for (const size_t row : outlying_rows(channel->values)) empty(*channel, row);
  }
  // The components of a quaternion are emptied together.
  const std::vector<Channel*> q = quaternion_channels(recording);
  if (q.empty()) return;
  std::vector<size_t> rows;
  const auto append = [&rows](const std::vector<size_t>& found) {
    rows.insert(rows.end(), found.begin(), found.end());
  };
  for (const Channel* channel : q) {
    const Stuck held(channel->values);
    if (held.has_fine_noise()) append(stuck_rows(channel->values, held));
    append(outlying_rows(channel->values));
  }
  for (const size_t row : rows) {
    for (Channel* channel : q) empty(*channel, row);
  }
}

void measure_times(Recording& recording) {
  const std::vector<double>& t = recording.time_s;
  RecordingReport& report = recording.report;
  report.gaps.clear();
  std::vector<double> intervals;
  for (size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  report.median_interval_s = middle_of(intervals.begin(), intervals.end());
  double sum = 0.0, squares = 0.0;
  int64_t count = 0;
  for (size_t i = 1; i < t.size(); ++i) {
    const double interval_s = t[i] - t[i - 1];
    if (interval_s > 5.0 * report.median_interval_s) {
      report.gaps.push_back({t[i - 1], t[i]});
      continue;
    }
    const double off = interval_s - report.median_interval_s;
    sum += off;
    squares += off * off;
    ++count;
  }
  if (count > 1) {
    const double n = static_cast<double>(count);
    report.jitter_s = std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1.0)));
  }
}

std::optional<ClockJump> jump_of_clock(const Recording& recording) {
  constexpr double longest_gap = 10.0;
  if (recording.rows() < 2) return std::nullopt;
  double gaps_s = 0.0, longest_s = 0.0;
  ClockJump jump;
  for (const RecordingReport::Gap& gap : recording.report.gaps) {
    const double gap_s = gap.to_s - gap.from_s;
    gaps_s += gap_s;
    if (gap_s > longest_s) jump.gap = gap;
    longest_s = std::max(longest_s, gap_s);
  }
  jump.recorded_s = recording.time_s.back() - recording.time_s.front() - gaps_s;
  if (!(longest_s > longest_gap * jump.recorded_s)) return std::nullopt;
  return jump;
}

void omit_isolated_rows(Recording& recording) {
  constexpr size_t most = 2, fewest_left = 20;
  std::vector<double>& t = recording.time_s;
  const auto erase = [&](size_t first, size_t count) {
    const auto from = [first](auto& values) {
      return values.begin() + static_cast<std::ptrdiff_t>(first);
    };
    const auto rows = static_cast<std::ptrdiff_t>(count);
    t.erase(from(t), from(t) + rows);
    for (Channel& channel : recording.channels) {
      channel.values.erase(from(channel.values), from(channel.values) + rows);
    }
    recording.report.isolated_rows += rows;
    recording.report.rows_kept -= rows;
  };
  while (t.size() >= fewest_left + 1) {
    measure_times(recording);
    const std::optional<ClockJump> jump = jump_of_clock(recording);
    if (!jump) return;
    const auto before =
        static_cast<size_t>(std::ranges::upper_bound(t, jump->gap.from_s) - t.begin());
    const size_t after = t.size() - before, fewer = std::min(before, after);
    if (fewer > most || t.size() - fewer < fewest_left) return;
    erase(before < after ? 0 : before, fewer);
  }
}

}  // namespace photorque

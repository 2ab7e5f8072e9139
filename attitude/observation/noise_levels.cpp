#include "attitude/observation/noise_levels.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "attitude/observation/prediction.h"
#include "core/constants.h"
#include "core/numerics/median.h"

namespace photorque {

namespace {

struct ReadingAt {
  double time_s, value;
};

// Readings of the channel in order of time. Attitudes are rotation angles from the first, without
// jumps.
std::vector<ReadingAt> readings_of(const Observation& seen, int channel) {
  std::vector<ReadingAt> all;
  double angle_rad = 0.0;
  size_t before = seen.blocks();
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    if (!(rows > 0.0)) continue;
    if (channel >= 3) {
      all.push_back({seen.time_s[i], seen.value_of(i, channel)});
      continue;
    }
    if (before < seen.blocks()) {
      const Quat turn = seen.attitude[i] * seen.attitude[before].conjugate();
      angle_rad += turn_vector(turn)[channel];
    }
    before = i;
    all.push_back({seen.time_s[i], angle_rad});
  }
  return all;
}

double mean_rows(const Observation& seen, int channel) {
  double sum = 0.0, count = 0.0;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    const double rows = seen.rows_of(i, channel);
    sum += rows;
    count += rows > 0.0 ? 1.0 : 0.0;
  }
  return count > 0.0 ? sum / count : 1.0;
}

// Divided difference of `order` + 1 readings from the one at `first`. Polynomials below that order
// do not contribute, even for unequal steps. It is scaled so that the noise of one reading gives
// the standard deviation of this noise.
double difference(const std::vector<ReadingAt>& x, size_t first, size_t order) {
  double sum = 0.0, squares = 0.0;
  const double unit_s = (x[first + order].time_s - x[first].time_s) / static_cast<double>(order);
  for (size_t k = first; k <= first + order; ++k) {
    double product = 1.0;
    for (size_t j = first; j <= first + order; ++j) {
      if (j != k) product *= (x[k].time_s - x[j].time_s) / unit_s;
    }
    sum += x[k].value / product;
    squares += 1.0 / (product * product);
  }
  return sum / std::sqrt(squares);
}

// Whether the `order` + 1 readings from `first` on are equal to the last digit. A counter that
// stands still contains no information on its noise. If it mostly stands still, its step determines
// the noise.
bool stands_still(const std::vector<ReadingAt>& x, size_t first, size_t order) {
  constexpr double rounding = 1e-12;
  for (size_t k = first + 1; k <= first + order; ++k) {
    const double moved = std::abs(x[k].value - x[first].value);
    if (moved > rounding * std::max(1.0, std::abs(x[first].value))) return false;
  }
  return true;
}

// Collects the sizes of the differences of readings and of the second differences. They are
// multiples of the last digit; second differences are small for a steady motion. Sizes below the
// rounding of a file are left out. Equal steps in equal times, as of a simulated steady motion,
// show no digit.
void collect_steps(const std::vector<ReadingAt>& x, std::vector<double>& steps) {
  double largest = 0.0;
  for (const ReadingAt& reading : x) largest = std::max(largest, std::abs(reading.value));
  std::vector<double> firsts;
  for (size_t i = 1; i < x.size(); ++i) {
    if (x[i].value != x[i - 1].value) firsts.push_back(std::abs(x[i].value - x[i - 1].value));
  }
  constexpr double of_largest = 1e-5, of_usual = 1e-2;
  const double rounding =
      firsts.empty() ? 0.0 : std::min(of_largest * largest, of_usual * upper_median(firsts));
  constexpr double alike = 1e-3;
  const size_t before = steps.size();
  bool is_steady = true;
  for (size_t i = 1; i < x.size(); ++i) {
    const double step = x[i].value - x[i - 1].value;
    if (std::abs(step) > rounding) steps.push_back(std::abs(step));
    if (i < 2) continue;
    const double change = step - (x[i - 1].value - x[i - 2].value),
                 time_s = x[i].time_s - x[i - 1].time_s,
                 longer_s = time_s - (x[i - 1].time_s - x[i - 2].time_s);
    if (std::abs(change) > rounding) steps.push_back(std::abs(change));
    is_steady = is_steady && std::abs(change) <= rounding && std::abs(longer_s) < alike * time_s;
  }
  if (is_steady) steps.resize(before);
}

}  // namespace

std::optional<double> reading_level(const std::vector<Observation>& runs, int channel) {
  constexpr size_t lowest_order = 3, highest_order = 6, fewest = 10;
  std::vector<std::vector<double>> sizes(highest_order + 1);
  std::vector<double> steps;
  size_t windows = 0;
  double squares = 0.0, readings = 0.0;  // of the deviations from the mean of a run; their number
  for (const Observation& seen : runs) {
    const std::vector<ReadingAt> x = readings_of(seen, channel);
    windows += x.size() - std::min(x.size(), lowest_order);
    const double rows = mean_rows(seen, channel), one = std::sqrt(rows);
    double mean = 0.0;
    for (const ReadingAt& reading : x) mean += reading.value / static_cast<double>(x.size());
    for (const ReadingAt& reading : x) squares += rows * std::pow(reading.value - mean, 2);
    readings += static_cast<double>(x.size());
    for (size_t order = lowest_order; order <= highest_order; ++order) {
      for (size_t i = 0; i + order < x.size(); ++i) {
        if (stands_still(x, i, order)) continue;
        sizes[order].push_back(one * std::abs(difference(x, i, order)));
      }
    }
    collect_steps(x, steps);
  }
  if (windows < fewest) return std::nullopt;
  const bool moves = 2 * sizes[lowest_order].size() > windows;
  double level = moves ? upper_median(sizes[lowest_order]) / normal_median : 0.0;
  // White noise gives the same level at every order. If the next order gives a much lower one, the
  // present level contains motion that the readings resolve too coarsely. With six readings per
  // period the ratio is 0.53.
  constexpr double quieter = 0.7;
  for (size_t order = lowest_order + 1; order <= highest_order; ++order) {
    if (sizes[order].size() < fewest) break;
    const double next = upper_median(sizes[order]) / normal_median;
    if (!(next < quieter * level)) break;
    level = next;
  }
  // The level of white noise is the standard deviation of the readings. A higher level is that of a
  // motion with fewer than three readings per period, which hides the noise.
  constexpr double of_spread = 1.3;
  if (level * level * readings > of_spread * of_spread * squares) return std::nullopt;
  const double step = steps.empty() ? 0.0 : *std::min_element(steps.begin(), steps.end()),
               rounding = step / std::sqrt(12.0);
  // Third differences of rounding errors are at most four steps, also where the errors alternate.
  constexpr double most_steps = 4.5, beyond = 0.002;
  const double most = most_steps * step / std::sqrt(20.0);
  const auto larger =
      std::ranges::count_if(sizes[lowest_order], [=](double d) { return d > most; });
  if (static_cast<double>(larger) <= beyond * static_cast<double>(sizes[lowest_order].size())) {
    level = 0.0;
  }
  const double least = std::max(level, rounding);
  if (!(least > 0.0)) return std::nullopt;
  return least;
}

namespace {

struct Differences {
  std::vector<double> values;  // zero where there is no difference
  size_t count = 0;
  int order = 2;
};

// Differences of the residuals from a smooth motion. If this motion is from the camera and has its
// noise, differences of the readings are used instead, with twice the order.
Differences differences_of(const Observation& seen, const KinematicRun& run, int k) {
  const double interval_s = reading_interval_s(seen, 3 + k);
  std::vector<size_t> read;
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (seen.gyro_rows[i][k] > 0.0) read.push_back(i);
  }
  Differences result;
  result.order = run.about_readings ? 4 : 2;
  result.values.resize(read.size());
  std::vector<char> good(read.size(), 1);
  for (size_t n = 0; n < read.size(); ++n) {
    const size_t i = read[n];
    const double rate = run.about_readings ? seen.gyro_rad_s[i][k] : run.rate_body_rad_s[i][k];
    result.values[n] = std::sqrt(seen.gyro_rows[i][k]) * rate;
    if (n == 0) continue;
    const size_t before = read[n - 1];
    const double rows = std::max(seen.gyro_rows[i][k], seen.gyro_rows[before][k]);
    const bool gap = seen.time_s[i] - seen.time_s[before] > 1.5 * interval_s * rows + 1e-9;
    // Averages over different numbers of readings have different levels.
    const bool differs = seen.gyro_rows[i][k] != seen.gyro_rows[before][k];
    const auto jump = run.axis[0].jumps.begin();
    if (gap || differs ||
        std::any_of(jump + static_cast<std::ptrdiff_t>(before) + 1,
                    jump + static_cast<std::ptrdiff_t>(i) + 1, [](char j) { return j != 0; })) {
      good[n] = 0;
    }
  }
  // good[n]: the step to reading n from the one before it is regular.
  for (int order = 0; order < result.order; ++order) {
    for (size_t n = result.values.size(); n-- > 1;) result.values[n] -= result.values[n - 1];
  }
  const auto reach = static_cast<size_t>(result.order);
  for (size_t n = result.values.size(); n-- > 0;) {
    bool all = n >= reach;
    for (size_t m = 0; all && m < reach; ++m) all = good[n - m] != 0;
    if (!all) result.values[n] = 0.0;
    result.count += all ? 1 : 0;
  }
  return result;
}

// Power relative to that of white noise of unit variance, tapered so that slow motion does not
// leak.
void add_powers(const Differences& d, std::vector<double>& powers) {
  const size_t n = d.values.size();
  std::vector<double> tapered(n);
  double weight = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const double x = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    const double taper = 1.0 - std::cos(2.0 * pi * x);
    tapered[i] = d.values[i] * taper;
    if (d.values[i] != 0.0) weight += taper * taper;
  }
  constexpr size_t most = 800;
  const size_t frequencies = std::min(most, n / 4);
  for (size_t f = 0; f < frequencies; ++f) {
    // Frequencies below the Nyquist frequency, at which a sinusoid has no phase.
    const double angle =
        pi * (0.5 + 0.48 * (static_cast<double>(f) + 0.5) / static_cast<double>(frequencies));
    const std::complex<double> turn = std::polar(1.0, angle);
    std::complex<double> phase = 1.0, sum = 0.0;
    for (size_t i = 0; i < n; ++i) {
      sum += tapered[i] * phase;
      phase *= turn;
    }
    const double passed = std::pow(2.0 - 2.0 * std::cos(angle), d.order);
    powers.push_back(std::norm(sum) / (weight * passed));
  }
}

// Least noise of a reading over the rms of the readings, about the rounding to 20 bits. A lower
// one, of a simulation without noise, is the error of an integrator; differences of log evidence
// would be lost in double precision.
constexpr double finest = 1e-6;

}  // namespace

std::optional<NoiseLevel> gyro_level(const std::vector<Observation>& seen,
                                     const std::vector<KinematicRun>& runs, int k,
                                     const Thresholds::Noise& limits) {
  std::vector<double> powers;
  double squares = 0.0, readings = 0.0;
  for (size_t run = 0; run < runs.size(); ++run) {
    for (size_t i = 0; i < seen[run].blocks(); ++i) {
      if (!(seen[run].gyro_rows[i][k] > 0.0)) continue;
      squares += std::pow(seen[run].gyro_rad_s[i][k], 2);
      readings += 1.0;
    }
    const Differences d = differences_of(seen[run], runs[run], k);
    if (2 * d.count < d.values.size() || d.count < limits.min_differences) continue;
    add_powers(d, powers);
  }
  if (powers.size() < limits.min_frequencies) return std::nullopt;
  std::sort(powers.begin(), powers.end());
  powers.resize(powers.size() * 4 / 5);
  double sum = 0.0;
  for (const double power : powers) sum += power;
  // Powers are exponentially distributed. Below the quantile 4/5, which is ln 5, their mean is 1 −
  // ln(5)/4 = 0.598 of the whole mean. Its relative scatter is 1.15/√n (from random draws). Tapered
  // neighbours are correlated, which reduces their number by a factor of 1.9.
  const double power = sum / static_cast<double>(powers.size()) / (1.0 - std::log(5.0) / 4.0);
  const double sigma = 0.5 * 1.15 * std::sqrt(1.9 * 0.8 / static_cast<double>(powers.size()));
  return NoiseLevel{std::max(std::sqrt(power), finest * std::sqrt(squares / readings)), sigma};
}

namespace {

// Residuals of one channel of one run, in order of time, and the readings of each block.
struct ResidualSeries {
  std::vector<double> time_s, value, rows;
};

void append_left(const std::vector<Prediction>& residuals, const std::vector<Observation>& runs,
                 int channel, std::vector<ResidualSeries>& all) {
  for (size_t run = 0; run < runs.size(); ++run) {
    ResidualSeries& series = all.emplace_back();
    for (size_t i = 0; i < residuals[run].off.size(); ++i) {
      const double x = residuals[run].off[i][channel];
      if (!std::isfinite(x)) continue;
      series.time_s.push_back(runs[run].time_s[i]);
      series.value.push_back(x);
      series.rows.push_back(runs[run].rows_of(i, channel));
    }
  }
}

// Groups of channels with a common residual noise: forces on a table have no preferred axis.
std::vector<std::vector<int>> alike_channels() {
  std::vector<std::vector<int>> groups;
  for (int channel = 0; channel < channel_count; ++channel) {
    const bool is_along_y = channel == vector_channels + static_cast<int>(Scalar::position_y) ||
                            channel == vector_channels + static_cast<int>(Scalar::velocity_y);
    if (is_along_y) {
      groups.back().push_back(channel);
    } else {
      groups.push_back({channel});
    }
  }
  return groups;
}

// Mean square of the residuals of blocks, and of single readings if those of a block are
// independent.
struct MeanSquares {
  double of_blocks = 0.0, of_readings = 0.0;
};

MeanSquares mean_squares(const std::vector<ResidualSeries>& all) {
  MeanSquares sum;
  double count = 0.0;
  for (const ResidualSeries& s : all) {
    for (size_t i = 0; i < s.value.size(); ++i) {
      const double square = s.value[i] * s.value[i];
      sum.of_blocks += square;
      sum.of_readings += s.rows[i] * square;
    }
    count += static_cast<double>(s.value.size());
  }
  if (!(count > 0.0)) return {};
  return {sum.of_blocks / count, sum.of_readings / count};
}

// The correlated fraction of the mean square, and its correlation time.
struct Shared {
  double fraction = 0.0, time_s = 0.0;
};

// Mean product of values `lag` readings apart, relative to the mean square.
double autocorrelation(const std::vector<ResidualSeries>& all, double square, size_t lag) {
  double sum = 0.0, count = 0.0;
  for (const ResidualSeries& s : all) {
    for (size_t i = lag; i < s.value.size(); ++i) sum += s.value[i] * s.value[i - lag];
    count += s.value.size() > lag ? static_cast<double>(s.value.size() - lag) : 0.0;
  }
  return count > 0.0 ? sum / count / square : 0.0;
}

// Correlation of neighbours, and the time after which it has fallen to 1/e.
Shared shared_by_neighbours(const std::vector<ResidualSeries>& all, double square) {
  size_t longest = 0;
  double read_s = 0.0, intervals = 0.0;
  for (const ResidualSeries& s : all) {
    longest = std::max(longest, s.value.size());
    if (s.value.size() < 2) continue;
    read_s += s.time_s.back() - s.time_s.front();
    intervals += static_cast<double>(s.value.size() - 1);
  }
  if (!(intervals > 0.0)) return {};
  const double interval_s = read_s / intervals;
  const double neighbours = std::clamp(autocorrelation(all, square, 1), 0.0, 1.0);
  double before = neighbours;
  for (size_t lag = 2; lag < longest; ++lag) {
    const double now = autocorrelation(all, square, lag), wanted = std::exp(-1.0) * neighbours;
    if (now < wanted) {
      const double part = (before - wanted) / (before - now);
      return {neighbours, (static_cast<double>(lag) - 1.0 + part) * interval_s};
    }
    before = now;
  }
  return {neighbours, static_cast<double>(longest) * interval_s};
}

}  // namespace

NoiseLevels with_discrepancy(const std::vector<Prediction>& residuals,
                             const std::vector<Observation>& runs, const NoiseLevels& own,
                             Remainder remainder) {
  NoiseLevels noise = own;
  for (const std::vector<int>& channels : alike_channels()) {
    std::vector<ResidualSeries> left;
    for (const int channel : channels) append_left(residuals, runs, channel, left);
    const MeanSquares square = mean_squares(left);
    ChannelNoise found{std::sqrt(square.of_readings)};
    if (square.of_blocks > 0.0 && remainder == Remainder::correlated) {
      const Shared shared = shared_by_neighbours(left, square.of_blocks);
      const double coloured = shared.fraction * square.of_blocks,
                   all = coloured + (1.0 - shared.fraction) * square.of_readings;
      found = {std::sqrt(all), coloured / all, shared.time_s};
    }
    for (const int channel : channels) {
      if (found.level > own.of(channel).level) noise.set(channel, found);
    }
  }
  return noise;
}

void set_profiles(const std::vector<Prediction>& residuals, size_t parts,
                  std::vector<Observation>& runs) {
  // Weight of the residuals of a part relative to that of the prior factor of one.
  constexpr double independent = 4.0;
  size_t blocks = 0;
  for (const Observation& seen : runs) blocks += seen.blocks();
  for (size_t run = 0; run < runs.size(); ++run) {
    Observation& seen = runs[run];
    const size_t own = std::max<size_t>(1, (parts * seen.blocks() + blocks / 2) / blocks);
    seen.profile = {seen.time_s.front(), seen.duration_s() / static_cast<double>(own),
                    std::vector<double>(own, 1.0)};
    std::vector<double> sum(own, 0.0), count(own, 0.0);
    for (size_t i = 0; i < seen.blocks(); ++i) {
      const double since = (seen.time_s[i] - seen.profile.begin_s) / seen.profile.part_s;
      const size_t part = std::min(own - 1, static_cast<size_t>(std::max(0.0, since)));
      for (int channel = 0; channel < channel_count; ++channel) {
        const double off = residuals[run].off[i][channel], rows = seen.rows_of(i, channel);
        if (!std::isfinite(off) || !(rows > 0.0)) continue;
        const ChannelNoise noise = seen.noise.of(channel);
        const double variance = noise.coloured + (1.0 - noise.coloured) / rows;
        sum[part] += off * off / (noise.level * noise.level * variance);
        count[part] += 1.0;
      }
    }
    for (size_t part = 0; part < own; ++part) {
      if (!(count[part] > 0.0)) continue;
      const double square = (1.0 + independent * sum[part] / count[part]) / (1.0 + independent);
      seen.profile.factor[part] = std::sqrt(square);
    }
  }
}

NoiseLevels noise_from_spread(const std::vector<Observation>& runs, const NoiseLevels& own) {
  constexpr double part = 0.1;
  NoiseLevels noise = own;
  for (int channel = 3; channel < channel_count; ++channel) {
    if (channel_traits(channel).measures != Measures::rate) continue;
    double sum = 0.0, square = 0.0, count = 0.0;
    for (const Observation& seen : runs) {
      for (size_t i = 0; i < seen.blocks(); ++i) {
        if (!(seen.rows_of(i, channel) > 0.0)) continue;
        const double x = seen.value_of(i, channel);
        sum += x;
        square += x * x;
        count += 1.0;
      }
    }
    if (!(count > 0.0)) continue;
    const double mean = sum / count,
                 spread = std::sqrt(std::max(0.0, square / count - mean * mean));
    noise.set(channel, {std::max(own.of(channel).level, part * spread)});
  }
  return noise;
}

bool is_quieter(const NoiseLevels& now, const NoiseLevels& before) {
  constexpr double worth = 0.9;
  for (int channel = 0; channel < channel_count; ++channel) {
    if (now.of(channel).level < worth * before.of(channel).level) return true;
  }
  return false;
}

}  // namespace photorque

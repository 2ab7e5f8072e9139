#include "attitude/estimation/axis_readings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/numerics/linear.h"
#include "core/numerics/median.h"

namespace photorque {

AxisReadings angles_about(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  AxisReadings read;
  const std::vector<double> angles_rad = rows.angles_rad(axis, first, last);
  for (size_t i = first; i < last; ++i) {
    if (std::isnan(angles_rad[i - first])) continue;
    read.row.push_back(i);
    read.time_s.push_back(rows.time_s[i]);
    read.value.push_back(angles_rad[i - first]);
  }
  return read;
}

std::optional<double> rate_along(const Observation& rows, size_t row, const Vec3& axis) {
  double along_rad_s = 0.0, read = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (axis[k] == 0.0) continue;
    along_rad_s += axis[k] * rows.gyro_rad_s[row][k];
    read += rows.gyro_rows[row][k];
  }
  if (!(read > 0.0) || !std::isfinite(along_rad_s)) return std::nullopt;
  return along_rad_s;
}

AxisReadings rates_about(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  Eigen::Index along = 0;
  axis.cwiseAbs().maxCoeff(&along);
  AxisReadings read;
  for (size_t i = first; i < last; ++i) {
    if (!(rows.gyro_rows[i][along] > 0.0)) continue;
    read.row.push_back(i);
    read.time_s.push_back(rows.time_s[i]);
    read.value.push_back(rows.gyro_rad_s[i][along]);
  }
  return read;
}

bool turns_less(const std::vector<Observation>& runs, const Vec3& axis, double turns) {
  const double most_rad = turns * 2.0 * pi;
  return std::ranges::all_of(runs, [&](const Observation& seen) {
    const std::vector<double> angle_rad = angles_about(seen, axis, 0, seen.blocks()).value;
    if (!angle_rad.empty()) {
      const auto [least, most] = std::ranges::minmax_element(angle_rad);
      return *most - *least < most_rad;
    }
    double sum_rad_s = 0.0, count = 0.0;
    for (size_t i = 0; i < seen.blocks(); ++i) {
      const std::optional<double> along_rad_s = rate_along(seen, i, axis);
      if (!along_rad_s) continue;
      sum_rad_s += std::abs(*along_rad_s);
      count += 1.0;
    }
    return count > 0.0 && sum_rad_s / count * seen.duration_s() < most_rad;
  });
}

Eigen::Vector4d fitted_cubic(const AxisReadings& read, size_t first, size_t last, double at_s,
                             double unit_s, double origin) {
  const auto count = static_cast<Eigen::Index>(last - first);
  Eigen::MatrixXd powers(count, 4);
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const size_t k = first + static_cast<size_t>(i);
    const double since = (read.time_s[k] - at_s) / unit_s;
    powers.row(i) << 1.0, since, since * since, since * since * since;
    values[i] = read.value[k] - origin;
  }
  return least_squares(powers, values).solution;
}

namespace {

// A straight line through readings that are added one by one.
class RegressionLine {
 public:
  void add(double t, double x) {
    if (count_ == 0.0) {
      first_t_ = t;
      first_x_ = before_x_ = x;
    }
    steps_ += (x - before_x_) * (x - before_x_);
    before_x_ = x;
    t -= first_t_;
    x -= first_x_;
    count_ += 1.0;
    t_ += t;
    x_ += x;
    tt_ += t * t;
    tx_ += t * x;
    xx_ += x * x;
  }
  double mean() const { return first_x_ + x_ / count_; }
  double slope() const { return (tx_ - t_ * x_ / count_) / spread(); }
  double slope_error() const {
    const double left = square() - slope() * (tx_ - t_ * x_ / count_);
    return std::sqrt(std::max(0.0, left) / (std::max(1.0, count_ - 2.0) * spread()));
  }
  double scatter() const { return std::sqrt(square() / std::max(1.0, count_ - 1.0)); }
  // Mean square of the differences of successive readings, relative to that of independent readings
  // with this scatter (J. von Neumann 1941): near 1 for noise, near 0 for a slow motion.
  double roughness() const { return 0.5 * steps_ / std::max(1e-300, square()); }

 private:
  double spread() const { return tt_ - t_ * t_ / count_; }
  double square() const { return std::max(0.0, xx_ - x_ * x_ / count_); }

  double count_ = 0.0, first_t_ = 0.0, first_x_ = 0.0;
  double before_x_ = 0.0, steps_ = 0.0, t_ = 0.0, x_ = 0.0, tt_ = 0.0, tx_ = 0.0, xx_ = 0.0;
};

// Index of the first reading of a motion that starts at most 12 readings after a rest of `rest`
// readings; 0 if there is no sudden motion.
size_t motion_start(const AxisReadings& read, size_t rest, double mean, double scatter) {
  constexpr size_t most_between = 12, least_after = 5;
  constexpr double away = 5.0, sudden = 10.0;
  const size_t after = std::clamp(rest, least_after, most_between);
  for (size_t first = rest; first <= rest + most_between; ++first) {
    if (first + after > read.value.size()) return 0;
    const double side = read.value[first] > mean ? 1.0 : -1.0;
    RegressionLine moving;
    bool stays_away = true;
    for (size_t i = first; i < first + after; ++i) {
      stays_away = stays_away && side * (read.value[i] - mean) > away * scatter;
      moving.add(read.time_s[i], read.value[i]);
    }
    if (!stays_away) continue;
    const double duration_s = read.time_s[rest - 1] - read.time_s[0];
    return std::abs(moving.slope()) * duration_s > sudden * scatter ? first : 0;
  }
  return 0;
}

// Index of the first reading of the motion after a rest; 0 without one.
size_t first_after_rest(const AxisReadings& read, bool is_rate) {
  constexpr size_t fewest = 5, many = 24;
  constexpr double no_slope = 3.0, clear_slope = 8.0, near_zero = 0.02, least_rough = 0.4,
                   rounding = 1e-9;
  if (read.value.size() < 4 * fewest) return 0;
  const auto [least, most] = std::ranges::minmax_element(read.value);
  const double range = *most - *least, largest = std::max(std::abs(*least), std::abs(*most));
  RegressionLine line;
  for (size_t rest = 1; rest + fewest < read.value.size(); ++rest) {
    line.add(read.time_s[rest - 1], read.value[rest - 1]);
    if (rest < fewest) continue;
    const double scatter = std::max(line.scatter(), rounding * range);
    if (is_rate && std::abs(line.mean()) > near_zero * largest + scatter) return 0;
    const bool is_constant = line.scatter() <= rounding * range;
    const double slope_sigma = is_constant || !(line.slope_error() > 0.0)
                                   ? 0.0
                                   : std::abs(line.slope()) / line.slope_error();
    if (rest >= many && slope_sigma > clear_slope) return 0;
    if (slope_sigma > no_slope || (!is_constant && line.roughness() < least_rough)) continue;
    if (const size_t first = motion_start(read, rest, line.mean(), scatter); first > 0)
      return first;
  }
  return 0;
}

}  // namespace

size_t start_of_motion(const Observation& rows, const Vec3& axis, size_t first, size_t last) {
  size_t sets_off = last;
  const auto limit_to = [&](const AxisReadings& read, bool is_rate) {
    if (read.row.empty()) return;
    const size_t moves = first_after_rest(read, is_rate);
    sets_off = std::min(sets_off, moves == 0 ? first : read.row[moves]);
  };
  if (rows.has_some_attitude()) limit_to(angles_about(rows, axis, first, last), false);
  if (rows.has_gyro) limit_to(rates_about(rows, axis, first, last), true);
  return sets_off == last ? first : sets_off;
}

std::optional<ReadingAtRest> reading_at_rest(const Observation& rows, const Vec3& axis) {
  constexpr size_t part = 10, fewest = 10;
  constexpr double moves = 10.0, without_slope = 4.0, most = 0.1;
  const std::vector<double> rate = rates_about(rows, axis, 0, rows.blocks()).value;
  const size_t count = std::max(fewest, rate.size() / part);
  if (rate.size() < 2 * count) return std::nullopt;
  const auto mean = [&](size_t first, size_t last) {
    return std::accumulate(rate.begin() + static_cast<ptrdiff_t>(first),
                           rate.begin() + static_cast<ptrdiff_t>(last), 0.0) /
           static_cast<double>(last - first);
  };
  const size_t from = rate.size() - count, middle = rate.size() - count / 2;
  const double at_rest = mean(from, rate.size());
  double squares = 0.0, farthest = 0.0;
  for (size_t i = 0; i < rate.size(); ++i) {
    const double off = rate[i] - at_rest;
    if (i < from) farthest = std::max(farthest, std::abs(off));
    if (i >= from) squares += off * off;
  }
  const double scatter = std::sqrt(squares / static_cast<double>(count - 1)),
               sigma = scatter / std::sqrt(static_cast<double>(count));
  const bool is_at_rest =
      farthest > moves * scatter && std::abs(at_rest) < most * farthest &&
      std::abs(mean(from, middle) - mean(middle, rate.size())) <= without_slope * 2.0 * sigma;
  return is_at_rest ? std::optional(ReadingAtRest{at_rest, sigma}) : std::nullopt;
}

bool is_rate_of_angle(const Observation& rows, const Vec3& axis) {
  constexpr size_t fewest = 20;
  constexpr double exactly = 0.05;
  if (!rows.has_some_attitude() || !rows.has_gyro) return false;
  const AxisReadings angle = angles_about(rows, axis, 0, rows.blocks()),
                     read = rates_about(rows, axis, 0, rows.blocks());
  // The first or the last row often has no quotient.
  if (read.row.size() < fewest || read.row.size() + 4 < angle.row.size()) return false;
  std::vector<double> rate(rows.blocks(), NAN);
  for (size_t i = 0; i < read.row.size(); ++i) rate[read.row[i]] = read.value[i];
  std::vector<double> quotient;
  for (size_t i = 0; i + 1 < angle.row.size(); ++i) {
    quotient.push_back((angle.value[i + 1] - angle.value[i]) /
                       (angle.time_s[i + 1] - angle.time_s[i]));
  }
  // Sums of the scatter of neighbouring quotients and of the differences of the rates from the
  // quotients.
  double scatter = 0.0;
  std::array<double, 3> off = {};
  for (size_t i = 1; i + 1 < quotient.size(); ++i) {
    const double w = rate[angle.row[i]], before = quotient[i - 1], after = quotient[i],
                 before_s = angle.time_s[i] - angle.time_s[i - 1],
                 after_s = angle.time_s[i + 1] - angle.time_s[i], both_s = before_s + after_s;
    const double between = (before * before_s + after * after_s) / both_s,
                 parabola = (before * after_s + after * before_s) / both_s;
    if (!std::isfinite(w)) continue;
    scatter += std::abs(quotient[i + 1] - 2.0 * after + before);
    off[0] += std::abs(w - before);
    off[1] += std::abs(w - after);
    off[2] += std::min(std::abs(w - between), std::abs(w - parabola));
  }
  return scatter > 0.0 && std::ranges::min(off) <= exactly * scatter;
}

void drop_rates(Observation& rows) {
  rows.has_gyro = false;
  std::ranges::fill(rows.gyro_rows, Vec3::Zero().eval());
}

std::optional<Recording> with_rates_of_far_turns(const Recording& recording,
                                                 const Platform& platform) {
  constexpr double readings_per_turn = 9.0, fewest_turns = 10.0;
  if (!platform.turns_about_one_axis() || platform.slides()) return std::nullopt;
  const auto is_angle = [](const Channel& channel) {
    return std::ranges::any_of(std::array{"angle_rad", "roll_rad", "pitch_rad", "yaw_rad"},
                               [&](const char* name) { return channel.name == name; });
  };
  const auto angle = std::ranges::find_if(recording.channels, is_angle);
  if (angle == recording.channels.end()) return std::nullopt;
  const std::vector<std::string> unused = MotionColumns(recording, platform, "").unused();
  for (const Channel& channel : recording.channels) {
    const bool is_used = std::ranges::find(unused, channel.name) == unused.end();
    if (is_used && &channel != &*angle) return std::nullopt;
  }
  Recording result = recording;
  Channel rate{"rate_rad_s", {}};
  result.time_s.clear();
  std::vector<double> turned_rad;
  size_t before = recording.rows();
  for (size_t i = 0; i < recording.rows(); ++i) {
    if (!std::isfinite(angle->values[i])) continue;
    if (before < recording.rows()) {
      const double by_rad = angle->values[i] - angle->values[before],
                   interval_s = recording.time_s[i] - recording.time_s[before];
      if (!turned_rad.empty() && by_rad * turned_rad.front() < 0.0) return std::nullopt;
      turned_rad.push_back(by_rad);
      result.time_s.push_back(recording.time_s[before] + 0.5 * interval_s);
      rate.values.push_back(by_rad / interval_s);
    }
    before = i;
  }
  double turns = 0.0;
  for (double& by_rad : turned_rad) turns += (by_rad = std::abs(by_rad)) / (2.0 * pi);
  if (turns < fewest_turns || upper_median(turned_rad) * readings_per_turn < 2.0 * pi) {
    return std::nullopt;
  }
  result.channels = {std::move(rate)};
  return result;
}

}  // namespace photorque

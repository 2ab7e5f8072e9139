#include "attitude/observation/observation.h"

#include <algorithm>
#include <cmath>

#include "attitude/observation/blocks.h"
#include "attitude/recordings/columns.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/median.h"

namespace photorque {
namespace {

constexpr size_t fewest_readings = 20;

// Removes jumps by whole turns, so that means of the angles are meaningful.
void unwind(std::vector<double>& angle_rad) {
  double last_rad = NAN;
  for (double& angle : angle_rad) {
    if (!std::isfinite(angle)) continue;
    if (std::isfinite(last_rad)) angle = last_rad + std::remainder(angle - last_rad, 2.0 * pi);
    last_rad = angle;
  }
}

}  // namespace

double NoiseProfile::at(double time_s) const {
  if (factor.empty()) return 1.0;
  const double part = (time_s - begin_s) / part_s;
  return factor[static_cast<size_t>(
      std::clamp(part, 0.0, static_cast<double>(factor.size()) - 1.0))];
}

namespace {

// The stated standard deviation of a channel; zero if none is stated.
double stated_level(const Sensors& sensors, int channel) {
  switch (channel_traits(channel).measures) {
    case Measures::angle:
      return sensors.camera ? sensors.camera->noise_rad.minCoeff() : 0.0;
    case Measures::rate:
      return sensors.gyro ? sensors.gyro->noise_rad_s : 0.0;
    case Measures::force:
      return sensors.accelerometer ? sensors.accelerometer->noise_m_s2 : 0.0;
    case Measures::length:
      return sensors.position ? sensors.position->noise_m : 0.0;
    case Measures::speed:
      return sensors.position ? sensors.position->noise_m_s : 0.0;
    case Measures::field:
      return sensors.magnetometer ? sensors.magnetometer->noise_T : 0.0;
  }
  return 0.0;
}

// The usual standard deviation of a scalar, beside the levels of camera and gyro.
double usual_level(Measures measures, const NoiseLevels& noise) {
  switch (measures) {
    case Measures::angle:  // as accurate as the camera about the vertical
      return noise.of(2).level;
    case Measures::rate:  // a magnitude is as accurate as one of its axes
      return noise.of(5).level;
    case Measures::force:
      return 0.01;  // m/s²
    case Measures::length:
      return 1e-3;  // m
    case Measures::speed:
      return 1e-2;  // m/s
    case Measures::field:
      return 1e-7;  // T
  }
  return 0.0;
}

}  // namespace

bool states_noise(const Sensors& sensors, int channel) {
  return stated_level(sensors, channel) > 0.0;
}

NoiseLevels noise_levels(const Sensors& sensors) {
  NoiseLevels noise;
  if (states_noise(sensors, 0)) noise.set_levels(0, sensors.camera->noise_rad);
  if (states_noise(sensors, 3)) noise.set_levels(3, Vec3::Constant(sensors.gyro->noise_rad_s));
  for (int channel = vector_channels; channel < channel_count; ++channel) {
    const Measures measures = channel_traits(channel).measures;
    const bool is_of_vector = measures == Measures::angle || measures == Measures::rate;
    noise.set(channel,
              {states_noise(sensors, channel) && !is_of_vector ? stated_level(sensors, channel)
                                                               : usual_level(measures, noise)});
  }
  return noise;
}

FieldInstruments field_instruments(const Sensors& sensors) {
  FieldInstruments fields;
  if (sensors.accelerometer) {
    fields.accelerometer_place_m = sensors.accelerometer->position_m;
    fields.accelerometer_bias_m_s2 = sensors.accelerometer->bias_m_s2;
  }
  if (sensors.magnetometer) fields.magnetometer_bias_T = sensors.magnetometer->bias_T;
  return fields;
}

bool Observation::has_scalars() const {
  return std::any_of(scalar.begin(), scalar.end(),
                     [](const ScalarReadings& s) { return !s.rows.empty(); });
}

bool Observation::measures_attitude(const Platform& platform) const {
  if (has_some_attitude()) return true;
  for (int s = 0; s < scalar_count; ++s) {
    if (scalar[static_cast<size_t>(s)].rows.empty()) continue;
    const Measures measures = channel_traits(vector_channels + s).measures;
    if (measures == Measures::length || measures == Measures::speed) continue;
    // A freely falling body is weightless.
    if (measures == Measures::force ? platform.has_bearing() : measures != Measures::rate) {
      return true;
    }
  }
  return false;
}

size_t Observation::readings(size_t first, size_t last) const {
  const bool has_place = has(Scalar::position_x) || has(Scalar::position_y);
  size_t count = 0;
  for (size_t i = first; i < last; ++i) {
    bool read = false;
    if (has_some_attitude() && !has_place) {
      read = attitude_rows[i] > 0.0;
    } else {
      for (int channel = 3; channel < channel_count; ++channel) {
        read = read || rows_of(i, channel) > 0.0;
      }
    }
    count += read ? 1 : 0;
  }
  return count;
}

std::vector<double> Observation::angles_rad(const Vec3& axis, size_t first, size_t last) const {
  std::vector<double> angles_rad(last - first, NAN);
  double angle_rad = 0.0;
  const Quat* before = nullptr;
  for (size_t i = first; i < last; ++i) {
    if (!(attitude_rows[i] > 0.0)) continue;
    if (before != nullptr) {
      angle_rad += axis.dot(turn_vector(attitude[i] * before->conjugate()));
    } else {
      angle_rad = axis.dot(turn_vector(attitude[i]));
      const double turned_rad = first == 0 ? first_angle_rad.value_or(angle_rad) : angle_rad;
      angle_rad += 2.0 * pi * std::round((turned_rad - angle_rad) / (2.0 * pi));
    }
    before = &attitude[i];
    angles_rad[i - first] = angle_rad;
  }
  return angles_rad;
}

Observation observe(const Recording& recording, const std::string& name, const Platform& platform,
                    size_t max_blocks) {
  const MotionColumns columns(recording, platform, name);
  Observation seen;
  seen.name = name;
  seen.schedule = recording.schedule();
  seen.has_gyro = columns.has_gyro();
  seen.sees_axis = columns.sees_axis();
  seen.rows = static_cast<int64_t>(recording.rows());
  seen.row_interval_s = recording.report.median_interval_s;
  seen.time_s = recording.time_s;
  int64_t events = 0;
  for (size_t row = 0; row < recording.rows(); ++row) {
    const bool usable = !columns.has_event(row);
    events += usable ? 0 : 1;
    const Quat q = columns.attitude(row);
    const bool complete = usable && columns.has_attitude() && q.coeffs().allFinite();
    seen.attitude.push_back(q);
    seen.attitude_rows.push_back(complete ? 1.0 : 0.0);
    const Vec3 rate(columns.rate_rad_s(0, row), columns.rate_rad_s(1, row),
                    columns.rate_rad_s(2, row));
    seen.gyro_rad_s.push_back(rate);
    seen.gyro_rows.push_back(
        rate.unaryExpr([&](double x) { return usable && std::isfinite(x) ? 1.0 : 0.0; }));
  }
  for (int s = 0; s < scalar_count; ++s) {
    if (!columns.has_scalar(static_cast<Scalar>(s))) continue;
    ScalarReadings& read = seen.scalar[static_cast<size_t>(s)];
    for (size_t row = 0; row < recording.rows(); ++row) {
      const double value = columns.scalar(static_cast<Scalar>(s), row);
      read.value.push_back(value);
      read.rows.push_back(!columns.has_event(row) && std::isfinite(value) ? 1.0 : 0.0);
    }
    if (channel_traits(vector_channels + s).turns) unwind(read.value);
  }
  if (const size_t readings = seen.readings(0, seen.blocks()); readings < fewest_readings) {
    throw InputError({name, 0}, columns.first_name(),
                     std::to_string(readings) +
                         (columns.has_attitude() ? " complete attitudes"
                          : columns.has_gyro()   ? " rates"
                                                 : " readings") +
                         (events > 0 ? ", " + std::to_string(events) + " of " +
                                           std::to_string(seen.rows) + " rows are marked as events"
                                     : ""),
                     "at least " + std::to_string(fewest_readings) +
                         (columns.has_attitude() ? ", quaternions of unit norm" : ""));
  }
  if (platform.turns_about_one_axis()) {
    seen.only_axis = platform.axis;
    std::vector<double> angles_rad = seen.angles_rad(platform.axis, 0, seen.blocks());
    std::erase_if(angles_rad, [](double angle) { return std::isnan(angle); });
    if (!angles_rad.empty()) {
      const double turns = std::round(upper_median(angles_rad) / (2.0 * pi));
      seen.first_angle_rad = angles_rad.front() - 2.0 * pi * turns;
    }
  }
  return seen.averaged(max_blocks);
}

Observation Observation::averaged(size_t max_blocks) const {
  if (blocks() <= max_blocks) return *this;
  Observation result = without_blocks(*this);
  const double block_s = duration_s() / static_cast<double>(max_blocks);
  // If there are fewer attitudes than blocks and the body rotates far within a block, rows with an
  // attitude become separate blocks, with their gyro readings.
  constexpr double far_rad = 0.1;
  const auto attitudes = static_cast<size_t>(
      std::ranges::count_if(attitude_rows, [](double rows) { return rows > 0.0; }));
  const bool apart = attitudes <= max_blocks && fastest_rad_s(*this) * block_s > far_rad;
  for (size_t first = 0, last = 0; first < blocks(); first = last) {
    // Half a row of tolerance, so that rounding of the times does not make uneven blocks.
    const double end_s = time_s[first] + block_s - 0.5 * row_interval_s;
    last = first + 1;
    const auto is_within = [&](size_t row) {
      return time_s[row] <= end_s && !(apart && attitude_rows[row] > 0.0);
    };
    // A motion starts at a reading: a mean over times before the start cannot be predicted.
    const bool stands_alone = first == 0 || (apart && attitude_rows[first] > 0.0);
    while (!stands_alone && last < blocks() && is_within(last)) ++last;
    // A short last block is merged with the previous one unless there is a gap between them.
    const double left_s = last < blocks() ? time_s.back() - time_s[last] + row_interval_s : block_s;
    const bool goes_on = last < blocks() && time_s[last] - time_s[last - 1] < block_s;
    if (!stands_alone && !apart && goes_on && left_s < 0.5 * block_s) last = blocks();
    append_mean(*this, first, last, result);
  }
  return result;
}

Observation Observation::part(size_t first, size_t last) const {
  const auto cut = [&](auto& to, const auto& from) {
    to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
              from.begin() + static_cast<std::ptrdiff_t>(last));
  };
  Observation result = *this;
  cut(result.time_s, time_s);
  if (!spread.empty()) cut(result.spread, spread);
  cut(result.attitude, attitude);
  cut(result.attitude_rows, attitude_rows);
  cut(result.gyro_rad_s, gyro_rad_s);
  cut(result.gyro_rows, gyro_rows);
  for (size_t s = 0; s < scalar.size(); ++s) {
    if (scalar[s].rows.empty()) continue;
    cut(result.scalar[s].value, scalar[s].value);
    cut(result.scalar[s].rows, scalar[s].rows);
  }
  if (first_angle_rad) {
    const std::vector<double> angles = angles_rad(only_axis, 0, last);
    const auto from = std::find_if(angles.begin() + static_cast<std::ptrdiff_t>(first),
                                   angles.end(), [](double angle) { return !std::isnan(angle); });
    if (from != angles.end()) result.first_angle_rad = *from;
  }
  if (result.spread_of(0).readings_s > 0.0) correct_first_block(*this, first, result);
  const double start_s = result.time_s.front();
  double from_s = time_s.front();
  for (size_t i = 0; i < schedule.time_s.size() && from_s < start_s; ++i) {
    const double until_s =
        i + 1 < schedule.time_s.size() ? std::min(start_s, schedule.time_s[i + 1]) : start_s;
    if (until_s <= from_s) continue;
    result.initial_charge_C += schedule.held[i].battery_current_A * (until_s - from_s);
    from_s = until_s;
  }
  return result;
}

}  // namespace photorque

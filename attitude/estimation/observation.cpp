#include "attitude/estimation/observation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "attitude/readings/columns.h"
#include "core/constants.h"
#include "core/errors.h"

namespace photorque {
namespace {

constexpr size_t fewest_readings = 20;

Quat turned_by(const Vec3& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (angle == 0.0) return Quat::Identity();
  return Quat(Eigen::AngleAxisd(angle, rotation_rad / angle));
}

// Rows [first, last) of an observation, which become one block.
struct BlockRows {
  const Observation& from;
  size_t first, last;

  // The mean time of the attitudes, because they move; of all rows where there is none.
  double time_s() const {
    double rows = 0.0, sum_s = 0.0;
    for (size_t i = first; i < last; ++i) {
      rows += from.attitude_rows[i];
      sum_s += from.attitude_rows[i] * from.time_s[i];
    }
    if (rows > 0.0) return sum_s / rows;
    for (size_t i = first; i < last; ++i) sum_s += from.time_s[i];
    return sum_s / static_cast<double>(last - first);
  }

  // A rate in body axes at a time, and how it changes.
  struct Rate {
    double rad_s = NAN, slope_rad_s2 = 0.0;
  };

  Rate gyro_rate(int axis, double at_s) const {
    return mean_of(
        at_s, [&](size_t i) { return from.gyro_rows[i][axis]; },
        [&](size_t i) { return from.gyro_rad_s[i][axis]; });
  }

  // The mean of one number's readings, moved to `at_s` with the slope over three blocks: a camera
  // that sees every second row has another mean time.
  template <typename Weight, typename Value>
  Rate mean_of(double at_s, const Weight& weight_of, const Value& value_of) const {
    const size_t length = last - first;
    const double reach_s = 1.5 * (from.time_s[last - 1] - from.time_s[first]) + 1e-9;
    double rows = 0.0, rate_sum = 0.0, time_sum_s = 0.0;
    double all = 0.0, all_rate = 0.0, all_s = 0.0, all_s2 = 0.0, all_product = 0.0;
    const size_t end = std::min(from.blocks(), last + length);
    for (size_t i = first - std::min(first, length); i < end; ++i) {
      const double weight = weight_of(i), since_s = from.time_s[i] - at_s;
      if (!(weight > 0.0) || std::abs(since_s) > reach_s) continue;
      const double rate_rad_s = value_of(i);
      all += weight;
      all_rate += weight * rate_rad_s;
      all_s += weight * since_s;
      all_s2 += weight * since_s * since_s;
      all_product += weight * since_s * rate_rad_s;
      if (i < first || i >= last) continue;
      rows += weight;
      rate_sum += weight * rate_rad_s;
      time_sum_s += weight * since_s;
    }
    if (rows == 0.0) return {};
    const double spread_s2 = all * all_s2 - all_s * all_s;
    if (!(spread_s2 > 0.0)) return {rate_sum / rows};
    const double slope_rad_s2 = (all * all_product - all_s * all_rate) / spread_s2;
    return {(rate_sum - slope_rad_s2 * time_sum_s) / rows, slope_rad_s2};
  }

  // From the first attitude to the last.
  Vec3 rate_between_attitudes_rad_s() const {
    size_t begin = last, end = last;
    for (size_t i = first; i < last; ++i) {
      if (!(from.attitude_rows[i] > 0.0)) continue;
      if (begin == last) begin = i;
      end = i;
    }
    if (begin == end) return Vec3::Zero();
    return rotation_vector(from.attitude[begin].conjugate() * from.attitude[end]) /
           (from.time_s[end] - from.time_s[begin]);
  }

  // Each attitude moved to the mean time of all, then their mean as rotations from the first of
  // them. A wrong rate does no harm: times before and after the mean count alike.
  Quat mean_attitude(double at_s, const std::array<Rate, 3>& gyro) const {
    Vec3 rate_rad_s = rate_between_attitudes_rad_s(), slope_rad_s2 = Vec3::Zero();
    const Vec3 by_gyro_rad_s(gyro[0].rad_s, gyro[1].rad_s, gyro[2].rad_s);
    // What the gyro's numbers mean is only found out later; here they count where they agree, as
    // far as two attitudes can tell.
    constexpr double cameras_rad_s = 0.01;
    if ((by_gyro_rad_s - rate_rad_s).norm() < cameras_rad_s + 0.1 * rate_rad_s.norm()) {
      rate_rad_s = by_gyro_rad_s;
      slope_rad_s2 = {gyro[0].slope_rad_s2, gyro[1].slope_rad_s2, gyro[2].slope_rad_s2};
    }
    const auto moved = [&](size_t i) {
      const double by_s = at_s - from.time_s[i];
      return from.attitude[i] * turned_by(by_s * (rate_rad_s - 0.5 * by_s * slope_rad_s2));
    };
    Quat reference(NAN, NAN, NAN, NAN);
    Vec3 sum = Vec3::Zero();
    double rows = 0.0;
    for (size_t i = first; i < last; ++i) {
      const double weight = from.attitude_rows[i];
      if (!(weight > 0.0)) continue;
      if (rows == 0.0) reference = moved(i);
      sum += weight * rotation_vector(moved(i) * reference.conjugate());
      rows += weight;
    }
    return rows > 0.0 ? (turned_by(sum / rows) * reference).normalized() : reference;
  }

  void append_to(Observation& seen) const {
    const double at_s = time_s();
    seen.time_s.push_back(at_s);
    const std::array<Rate, 3> gyro = {gyro_rate(0, at_s), gyro_rate(1, at_s), gyro_rate(2, at_s)};
    seen.attitude.push_back(mean_attitude(at_s, gyro));
    double attitude_rows = 0.0;
    Vec3 gyro_rows = Vec3::Zero();
    for (size_t i = first; i < last; ++i) {
      attitude_rows += from.attitude_rows[i];
      gyro_rows += from.gyro_rows[i];
    }
    seen.attitude_rows.push_back(attitude_rows);
    seen.gyro_rad_s.emplace_back(gyro[0].rad_s, gyro[1].rad_s, gyro[2].rad_s);
    seen.gyro_rows.push_back(gyro_rows);
    for (size_t s = 0; s < from.scalar.size(); ++s) {
      const ScalarReadings& all = from.scalar[s];
      if (all.rows.empty()) continue;
      const auto weight = [&](size_t i) { return all.rows[i]; };
      seen.scalar[s].value.push_back(
          mean_of(at_s, weight, [&](size_t i) { return all.value[i]; }).rad_s);
      double rows = 0.0;
      for (size_t i = first; i < last; ++i) rows += all.rows[i];
      seen.scalar[s].rows.push_back(rows);
    }
  }
};

// Angles that come again after a whole turn, made continuous so that means of them mean something.
void unwind(std::vector<double>& angle_rad) {
  double last_rad = NAN;
  for (double& angle : angle_rad) {
    if (!std::isfinite(angle)) continue;
    if (std::isfinite(last_rad)) angle = last_rad + std::remainder(angle - last_rad, 2.0 * pi);
    last_rad = angle;
  }
}

}  // namespace

Vec3 rotation_vector(const Quat& rotation) {
  const double sine = rotation.vec().norm(), side = std::copysign(1.0, rotation.w());
  if (sine < 1e-12) return 2.0 * side * rotation.vec();
  return 2.0 * side * std::atan2(sine, std::abs(rotation.w())) / sine * rotation.vec();
}

ChannelNoise NoiseLevels::of(int channel) const {
  if (channel >= vector_channels) {
    return {scalar[static_cast<size_t>(channel - vector_channels)], 0.0, 0.0};
  }
  const int k = channel % 3;
  if (channel < 3) return {camera_rad[k], camera_colour.fraction[k], camera_colour.time_s[k]};
  return {gyro_rad_s[k], gyro_colour.fraction[k], gyro_colour.time_s[k]};
}

void NoiseLevels::set(int channel, const ChannelNoise& noise) {
  if (channel >= vector_channels) {
    scalar[static_cast<size_t>(channel - vector_channels)] = noise.level;
    return;
  }
  const int k = channel % 3;
  (channel < 3 ? camera_rad : gyro_rad_s)[k] = noise.level;
  Colour& colour = channel < 3 ? camera_colour : gyro_colour;
  colour.fraction[k] = noise.coloured;
  colour.time_s[k] = noise.time_s;
}

NoiseLevels noise_levels(const Sensors& sensors) {
  NoiseLevels noise;
  if (states_camera_noise(sensors)) noise.camera_rad = sensors.camera->noise_rad;
  if (states_gyro_noise(sensors)) noise.gyro_rad_s = Vec3::Constant(sensors.gyro->noise_rad_s);
  for (int s = 0; s < scalar_count; ++s) {
    double& level = noise.scalar[static_cast<size_t>(s)];
    constexpr double usual_force_m_s2 = 0.01, usual_field_T = 1e-7;
    switch (channel_traits(vector_channels + s).measures) {
      case Measures::angle:  // as good as the camera about the vertical
        level = noise.camera_rad[2];
        break;
      case Measures::rate:  // a magnitude is as good as one of its axes
        level = noise.gyro_rad_s[2];
        break;
      case Measures::force:
        level = states_noise(sensors, vector_channels + s) ? sensors.accelerometer->noise_m_s2
                                                           : usual_force_m_s2;
        break;
      case Measures::length:
      case Measures::speed: {
        constexpr double usual_m = 1e-3, usual_m_s = 1e-2;
        const bool is_length = channel_traits(vector_channels + s).measures == Measures::length;
        level = is_length ? usual_m : usual_m_s;
        if (states_noise(sensors, vector_channels + s)) {
          level = is_length ? sensors.position->noise_m : sensors.position->noise_m_s;
        }
        break;
      }
      case Measures::field:
        level = states_noise(sensors, vector_channels + s) ? sensors.magnetometer->noise_T
                                                           : usual_field_T;
        break;
    }
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

bool states_noise(const Sensors& sensors, int channel) {
  switch (channel_traits(channel).measures) {
    case Measures::angle:
      return states_camera_noise(sensors);
    case Measures::rate:
      return states_gyro_noise(sensors);
    case Measures::force:
      return sensors.accelerometer && sensors.accelerometer->noise_m_s2 > 0.0;
    case Measures::length:
      return sensors.position && sensors.position->noise_m > 0.0;
    case Measures::speed:
      return sensors.position && sensors.position->noise_m_s > 0.0;
    case Measures::field:
      return sensors.magnetometer && sensors.magnetometer->noise_T > 0.0;
  }
  return false;
}

bool states_camera_noise(const Sensors& sensors) {
  return sensors.camera && sensors.camera->noise_rad.minCoeff() > 0.0;
}

bool states_gyro_noise(const Sensors& sensors) {
  return sensors.gyro && sensors.gyro->noise_rad_s > 0.0;
}

bool Observation::has_scalars() const {
  return std::any_of(scalar.begin(), scalar.end(),
                     [](const ScalarReadings& s) { return !s.rows.empty(); });
}

bool Observation::feels_attitude(const Platform& platform) const {
  if (sees_some_attitude()) return true;
  for (int s = 0; s < scalar_count; ++s) {
    if (scalar[static_cast<size_t>(s)].rows.empty()) continue;
    const Measures measures = channel_traits(vector_channels + s).measures;
    if (measures == Measures::length || measures == Measures::speed) continue;
    // What falls freely does not feel its weight.
    if (measures == Measures::force ? platform.has_bearing() : measures != Measures::rate) {
      return true;
    }
  }
  return false;
}

size_t Observation::readings(size_t first, size_t last) const {
  size_t count = 0;
  for (size_t i = first; i < last; ++i) {
    const bool has_place = has(Scalar::position_x) || has(Scalar::position_y);
    bool read = sees_some_attitude() && !has_place ? attitude_rows[i] > 0.0
                                                   : (gyro_rows[i].array() > 0.0).any();
    if (!sees_some_attitude() || has_place) {
      for (const ScalarReadings& s : scalar) read = read || (!s.rows.empty() && s.rows[i] > 0.0);
    }
    count += read ? 1 : 0;
  }
  return count;
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
                     "at least " + std::to_string(fewest_readings));
  }
  return seen.averaged(max_blocks);
}

Observation Observation::averaged(size_t max_blocks) const {
  if (blocks() <= max_blocks) return *this;
  Observation result = *this;
  result.time_s.clear();
  result.attitude.clear();
  result.attitude_rows.clear();
  result.gyro_rad_s.clear();
  result.gyro_rows.clear();
  result.scalar = {};
  const double block_s = duration_s() / static_cast<double>(max_blocks);
  for (size_t first = 0, last = 0; first < blocks(); first = last) {
    // Half a row of slack, so that rounding of the times does not make uneven blocks.
    const double end_s = time_s[first] + block_s - 0.5 * row_interval_s;
    for (last = first + 1; last < blocks() && time_s[last] <= end_s;) ++last;
    BlockRows{*this, first, last}.append_to(result);
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
  cut(result.attitude, attitude);
  cut(result.attitude_rows, attitude_rows);
  cut(result.gyro_rad_s, gyro_rad_s);
  cut(result.gyro_rows, gyro_rows);
  for (size_t s = 0; s < scalar.size(); ++s) {
    if (scalar[s].rows.empty()) continue;
    cut(result.scalar[s].value, scalar[s].value);
    cut(result.scalar[s].rows, scalar[s].rows);
  }
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

#include "tools/proof/instruments.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/constants.h"

namespace photorque::injected {
namespace {

constexpr double arcsecond = pi / 180.0 / 3600.0;

template <class... Numbers>
std::string print(const char* format, Numbers... numbers) {
  char text[160];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

}  // namespace

Rows draw_rows(RandomDraw& draw, const InjectedSensors& sensors, double duration_s) {
  Rows rows;
  const double interval_s = 1.0 / sensors.rate_Hz;
  const auto count = static_cast<size_t>(std::llround(duration_s * sensors.rate_Hz));
  for (size_t i = 0; i < count; ++i) {
    const double jitter = sensors.dirty ? std::clamp(0.05 * draw.normal(), -0.3, 0.3) : 0.0;
    const double t_s = (static_cast<double>(i) + jitter) * interval_s;
    rows.time_s.push_back(i == 0 ? 0.0 : std::round(1e6 * t_s) / 1e6);
  }
  rows.lost.assign(count, false);
  if (!sensors.dirty) return rows;
  for (size_t i = 1; i < count; ++i) rows.lost[i] = draw.chance(0.003);
  for (int gap = 0; gap < 2; ++gap) {
    const double from_s = draw.uniform(0.1, 0.9) * duration_s;
    const double length_s = draw.uniform(1.0, std::min(8.0, 0.05 * duration_s));
    for (size_t i = 1; i < count; ++i) {
      const double into_s = rows.time_s[i] - from_s;
      if (into_s >= 0.0 && into_s < length_s) rows.lost[i] = true;
    }
  }
  return rows;
}

Errors::Errors(const InjectedNoise& noise, double interval_s)
    : noise_(noise), alike_(noise.time_s > 0.0 ? std::exp(-interval_s / noise.time_s) : 0.0) {}

// Of unit variance but for outliers.
double Errors::one(RandomDraw& draw) const {
  if (noise_.student_degrees > 0) {
    double squares = 0.0;
    for (int i = 0; i < noise_.student_degrees; ++i) squares += std::pow(draw.normal(), 2);
    // Student's t has a variance of ν/(ν − 2).
    return draw.normal() * std::sqrt((noise_.student_degrees - 2) / squares);
  }
  return draw.normal();
}

Triple Errors::next(RandomDraw& draw) {
  Triple error;
  for (size_t k = 0; k < 3; ++k) {
    const double fresh = one(draw);
    last_[k] = begun_ ? alike_ * last_[k] + std::sqrt(1.0 - alike_ * alike_) * fresh : fresh;
    error[k] = noise_.scale * last_[k];
  }
  begun_ = true;
  if (noise_.outlier_share > 0.0 && draw.chance(noise_.outlier_share)) error = times(5.0, error);
  return error;
}

double Errors::rounded(double value, double unit) const {
  const double step = noise_.step_sigma * unit;
  return step > 0.0 ? std::round(value / step) * step : value;
}

Instruments::Instruments(RandomDraw& draw, const InjectedSensors& sensors)
    : draw_(draw),
      sensors_(sensors),
      camera_(sensors.camera, sensors.camera_every / sensors.rate_Hz),
      gyro_(sensors.gyro, 1.0 / sensors.rate_Hz) {}

std::string Instruments::attitude(const Quaternion& seen, size_t row) {
  const bool due = row % static_cast<size_t>(sensors_.camera_every) == 0;
  if (!due) return ",,,";
  const Triple& level = sensors_.camera_noise_arcsec;
  Triple noise = times(arcsecond, by_component(level, camera_.next(draw_)));
  if (sensors_.dirty && draw_.chance(0.002)) {
    noise = times(draw_.log_uniform(0.01, 0.3), draw_.direction());
  }
  Quaternion q = product(quaternion_of(noise), seen);
  if (sensors_.dirty && draw_.chance(0.01)) side_ = -side_;
  if (side_ * q[0] < 0.0 && !sensors_.dirty) side_ = -side_;  // most trackers report w ≥ 0
  if (sensors_.dirty && draw_.chance(0.01)) return ",,,";
  // A small turn changes the components by half of itself.
  const double unit = 0.5 * arcsecond * std::min({level[0], level[1], level[2]});
  for (double& x : q) x = camera_.rounded(side_ * x, unit);
  return print("%.9f,%.9f,%.9f,%.9f", q[0], q[1], q[2], q[3]);
}

std::string Instruments::gyro(const Triple& rate_rad_s) {
  if (!sensors_.has_gyro) return "";
  const double level = sensors_.gyro_noise_rad_s;
  Triple read = plus(rate_rad_s, times(level, gyro_.next(draw_)));
  if (sensors_.dirty && draw_.chance(0.001)) {
    read = plus(read, times(draw_.log_uniform(0.02, 1.0), draw_.direction()));
  }
  if (sensors_.dirty && draw_.chance(0.003)) return ",,,";
  for (double& x : read) x = gyro_.rounded(x, level);
  return print(",%.7e,%.7e,%.7e", read[0], read[1], read[2]);
}

}  // namespace photorque::injected

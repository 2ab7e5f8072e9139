// Machines by their experiment, recordings by their channels.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/attitude/diagnose.h"
#include "scenes/experiment/toml.h"
#include "tests/diagnosis/named.h"
#include "tests/noise.h"

namespace photorque {

inline NominalModel machine(const std::string& toml) {
  return read_attitude_model(Settings(parse_toml(toml, "machine.toml")));
}

// Rows of named channels at even times.
inline Recording recording_of(double interval_s, const std::vector<Channel>& channels) {
  Recording recording;
  recording.channels = channels;
  const size_t rows = channels.front().values.size();
  for (size_t i = 0; i < rows; ++i) recording.time_s.push_back(interval_s * static_cast<double>(i));
  recording.report.rows_read = recording.report.rows_kept = static_cast<int64_t>(rows);
  recording.report.median_interval_s = interval_s;
  return recording;
}

inline Diagnosis diagnosed(const NominalModel& nominal, double interval_s,
                           const std::vector<Channel>& channels) {
  return diagnose(nominal, {{"run.csv", recording_of(interval_s, channels)}}, {});
}

// A function of the time at even times from zero on.
template <class Function>
std::vector<double> sampled(double interval_s, int rows, const Function& at) {
  std::vector<double> all;
  for (int i = 0; i < rows; ++i) all.push_back(at(interval_s * i));
  return all;
}

// The values with independent errors.
inline Channel noisy(const std::string& name, std::vector<double> values, double sigma,
                     uint64_t seed) {
  Noise noise(seed, sigma);
  for (double& value : values) value += noise();
  return {name, std::move(values)};
}

// θ'' = −k θ − c θ' from a rest at 1.
struct DampedSwing {
  double k, c;

  double omega() const { return std::sqrt(k - 0.25 * c * c); }
  double at(double t) const {
    return std::exp(-0.5 * c * t) *
           (std::cos(omega() * t) + 0.5 * c / omega() * std::sin(omega() * t));
  }
  double rate(double t) const {
    return -k / omega() * std::exp(-0.5 * c * t) * std::sin(omega() * t);
  }
};

// θ'' = −k sin θ − d sign θ' − c θ' − q θ' |θ'| by the classical Runge–Kutta rule, at rest for good
// where the weight no longer overcomes d at a turning point.
struct Swing {
  double k, dry, viscous, form;

  std::vector<double> from(double angle_rad, double interval_s, int rows, double rate = 0.0) const {
    constexpr int parts = 50;
    const double h = interval_s / parts;
    double sign = rate > 0.0 || (rate == 0.0 && angle_rad < 0.0) ? 1.0 : -1.0;
    bool rests = false;
    const auto acceleration = [&](double a, double w) {
      return -k * std::sin(a) - dry * sign - viscous * w - form * w * std::abs(w);
    };
    std::vector<double> all;
    for (int i = 0; i < rows; ++i) {
      all.push_back(angle_rad);
      for (int part = 0; part < parts && !rests; ++part) {
        const double a1 = rate, w1 = acceleration(angle_rad, rate), a2 = rate + 0.5 * h * w1,
                     w2 = acceleration(angle_rad + 0.5 * h * a1, a2), a3 = rate + 0.5 * h * w2,
                     w3 = acceleration(angle_rad + 0.5 * h * a2, a3), a4 = rate + h * w3,
                     w4 = acceleration(angle_rad + h * a3, a4);
        angle_rad += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        rate += h / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4);
        if (rate * sign >= 0.0) continue;
        // Since the turning point its rate grew under the old sign.
        const double old = acceleration(angle_rad, 0.0);
        sign = -sign;
        rests = std::abs(k * std::sin(angle_rad)) <= dry;
        rate *= rests ? 0.0 : acceleration(angle_rad, 0.0) / old;
      }
    }
    return all;
  }
};

}  // namespace photorque

// Recordings of the rigid body whose instruments have other noise than is stated.
#pragma once

#include "tests/diagnosis/rigid_body_recording.h"

namespace photorque::rigid_body {

// A process of unit variance, drawn at equal intervals.
struct NoiseProcess {
  double level = 1.0;         // over what is stated
  double time_s = 0.0;        // correlation time of the coloured part
  double coloured = 1.0;      // fraction of the variance that is coloured, where time_s is not zero
  double degrees = 0.0;       // of freedom of Student's t, of the white part; 0: normal
  double contaminated = 0.0;  // fraction of the readings whose white noise is five times as large
};

class NoiseSource {
 public:
  NoiseSource(const NoiseProcess& process, double interval_s, uint64_t seed)
      : process_(process), random_(seed), t_(std::max(process.degrees, 1.0)) {
    if (process.time_s > 0.0) rho_ = std::exp(-interval_s / process.time_s);
    slow_ = normal_(random_);
  }

  double next() {
    const double fast = white();
    if (!(process_.time_s > 0.0)) return process_.level * fast;
    slow_ = rho_ * slow_ + std::sqrt(1.0 - rho_ * rho_) * normal_(random_);
    return process_.level *
           (std::sqrt(process_.coloured) * slow_ + std::sqrt(1.0 - process_.coloured) * fast);
  }

 private:
  double white() {
    // With the scale of Student's t, not with unit variance.
    if (process_.degrees > 0.0) return t_(random_);
    const bool is_outlier = uniform_(random_) < process_.contaminated;
    return (is_outlier ? 5.0 : 1.0) * normal_(random_);
  }

  NoiseProcess process_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  std::student_t_distribution<double> t_;
  double rho_ = 0.0, slow_ = 0.0;
};

struct Session {
  NoiseProcess camera, gyro;
  double duration_s = 300.0, interval_s = 0.1;
  bool has_gyro = true;
  double clock_drift = 0.0;  // by which the camera's clock runs behind the gyro's [s/s]
  double time_step_s = 0.0;  // to which time stamps are rounded
  Vec3 rate_rad_s{0.02, -0.03, 0.2};
  // Commanded torque about body axes in pulses of this height, two seconds in ten.
  double pulse_N_m = 0.0, pulse_gain = 1.0;
};

inline NamedRecording recorded_with(unsigned seed, const Session& session, const Extra& extra) {
  Recording recording;
  std::vector<Channel> channels = {{"q_w", {}}, {"q_x", {}}, {"q_y", {}}, {"q_z", {}}};
  if (session.has_gyro) {
    for (const char* name : {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"}) {
      channels.push_back({name, {}});
    }
  }
  const bool pulses = session.pulse_N_m != 0.0;
  if (pulses) {
    for (const char* name : {"command_x_N_m", "command_y_N_m", "command_z_N_m"}) {
      channels.push_back({name, {}});
    }
  }
  std::vector<NoiseSource> noise;
  for (uint64_t k = 0; k < 6; ++k) {
    noise.emplace_back(k < 3 ? session.camera : session.gyro, session.interval_s,
                       seed * 1000003ULL + k);
  }
  State state{Quat(Eigen::AngleAxisd(0.3 * seed, Vec3::UnitZ())) *
                  Quat(Eigen::AngleAxisd(0.12, Vec3::UnitX())),
              session.rate_rad_s};
  const auto rows = static_cast<int>(session.duration_s / session.interval_s);
  constexpr int steps = 8;
  for (int row = 0; row < rows; ++row) {
    const double t_s = session.interval_s * row;
    const double stamp_s = session.time_step_s > 0.0
                               ? session.time_step_s * std::round(t_s / session.time_step_s)
                               : t_s;
    recording.time_s.push_back(stamp_s);
    const double draws[] = {noise[0].next(), noise[1].next(), noise[2].next(),
                            noise[3].next(), noise[4].next(), noise[5].next()};
    const Vec3 late = -session.clock_drift * t_s * (state.lab_from_body * state.rate_rad_s);
    const Vec3 off = late + arcsecond_rad * Vec3(37 * draws[0], 37 * draws[1], 12 * draws[2]);
    const Quat seen = Quat(Eigen::AngleAxisd(off.norm(), off.normalized())) * state.lab_from_body;
    const Vec3 rate = state.rate_rad_s + 2e-4 * Vec3(draws[3], draws[4], draws[5]);
    const bool on = pulses && std::fmod(t_s, 10.0) < 2.0;
    const double torque = on ? session.pulse_N_m * (std::fmod(t_s, 20.0) < 10.0 ? 1.0 : -1.0) : 0.0;
    std::vector<double> cells = {seen.w(), seen.x(), seen.y(), seen.z()};
    if (session.has_gyro) cells.insert(cells.end(), {rate.x(), rate.y(), rate.z()});
    if (pulses) cells.insert(cells.end(), {torque, -torque, torque});
    for (size_t c = 0; c < channels.size(); ++c) channels[c].values.push_back(cells[c]);
    const Vec3 acts = session.pulse_gain * Vec3(torque, -torque, torque);
    for (int k = 0; k < steps; ++k) {
      state = after(state, session.interval_s / steps,
                    [&](const State& s) { return Vec3(extra(s) + acts); });
    }
  }
  recording.channels = channels;
  recording.report.rows_read = recording.report.rows_kept = rows;
  recording.report.median_interval_s = session.interval_s;
  return {"run" + std::to_string(seed) + ".csv", recording};
}

inline Vec3 nothing_more(const State&) {
  return Vec3::Zero();
}

}  // namespace photorque::rigid_body

// Recordings of a rigid body under gravity and drag, integrated here and nowhere else.
#pragma once

#include <functional>

#include "attitude/disturbances/kind.h"
#include "core/constants.h"
#include "diagnosis/attitude/diagnose.h"
#include "tests/noise.h"

namespace photorque::rigid_body {

inline const Vec3 offset_m(2e-6, -1e-6, -3e-5), field_lab_T(1e-6, 2.2e-5, -4.2e-5);
constexpr double mass_kg = 7.0, gravity_m_s2 = 9.80665, drag_N_m_s = 2e-5;

struct State {
  Quat lab_from_body;
  Vec3 rate_rad_s;
  double time_s = 0.0;
};

// Torques besides gravity and drag, in body axes.
using Extra = std::function<Vec3(const State&)>;

inline Mat3 inertia_kg_m2() {
  return Vec3(0.11, 0.12, 0.19).asDiagonal();
}

// d(q, ω)/dt by Euler's equation; q as (x, y, z, w).
inline std::pair<Eigen::Vector4d, Vec3> slope(const State& s, const Extra& extra) {
  const Vec3 gravity = s.lab_from_body.conjugate() * Vec3(0, 0, -gravity_m_s2);
  const Vec3 torque = mass_kg * offset_m.cross(gravity) - drag_N_m_s * s.rate_rad_s + extra(s);
  const Mat3 inertia = inertia_kg_m2();
  const Quat rate(0.0, s.rate_rad_s.x(), s.rate_rad_s.y(), s.rate_rad_s.z());
  return {0.5 * (s.lab_from_body * rate).coeffs(),
          inertia.inverse() * (torque - s.rate_rad_s.cross(inertia * s.rate_rad_s))};
}

// The classical Runge–Kutta step.
inline State after(const State& s, double step_s, const Extra& extra) {
  const auto along = [&](double h, const std::pair<Eigen::Vector4d, Vec3>& d) {
    State moved = s;
    moved.lab_from_body.coeffs() += h * d.first;
    moved.rate_rad_s += h * d.second;
    moved.time_s += h;
    return moved;
  };
  const auto a = slope(s, extra), b = slope(along(0.5 * step_s, a), extra);
  const auto c = slope(along(0.5 * step_s, b), extra), d = slope(along(step_s, c), extra);
  State next = along(step_s / 6.0, {a.first + 2.0 * b.first + 2.0 * c.first + d.first,
                                    a.second + 2.0 * b.second + 2.0 * c.second + d.second});
  next.time_s = s.time_s + step_s;
  next.lab_from_body.normalize();
  return next;
}

// 120 s at 5 Hz as a camera and a gyro with the contract's noise see them, started `spin_up` times
// as fast as usual.
inline NamedRecording recorded(unsigned seed, const Extra& extra, double gyro_unit = 1.0,
                               double spin_up = 1.0) {
  constexpr double interval_s = 0.2;
  constexpr int rows = 600, steps = 10;
  Noise normal(seed);
  const auto scatter = [&](const Vec3& sigma) {
    const double x = normal(), y = normal(), z = normal();
    return Vec3(sigma.x() * x, sigma.y() * y, sigma.z() * z);
  };
  Recording recording;
  std::vector<Channel> channels = {{"q_w", {}}, {"q_x", {}}, {"q_y", {}}, {"q_z", {}}};
  for (const char* name : {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"}) {
    channels.push_back({name, {}});
  }
  State state{Quat(Eigen::AngleAxisd(0.3 * seed, Vec3::UnitZ())) *
                  Quat(Eigen::AngleAxisd(0.12, Vec3::UnitX())),
              spin_up * Vec3(0.01, -0.02, 0.15)};
  for (int row = 0; row < rows; ++row) {
    recording.time_s.push_back(interval_s * row);
    const Vec3 off = arcsecond_rad * scatter(Vec3(37, 37, 12));
    const Quat seen = Quat(Eigen::AngleAxisd(off.norm(), off.normalized())) * state.lab_from_body;
    const Vec3 rate = gyro_unit * (state.rate_rad_s + scatter(Vec3::Constant(2e-4)));
    const double cells[] = {seen.w(), seen.x(), seen.y(), seen.z(), rate.x(), rate.y(), rate.z()};
    for (size_t c = 0; c < channels.size(); ++c) channels[c].values.push_back(cells[c]);
    for (int k = 0; k < steps; ++k) state = after(state, interval_s / steps, extra);
  }
  recording.channels = channels;
  recording.report.rows_read = recording.report.rows_kept = rows;
  recording.report.median_interval_s = interval_s;
  return {"run" + std::to_string(seed) + ".csv", recording};
}

// Gravity and drag with the uncertainty of a careful user.
inline NominalModel nominal_model() {
  NominalModel nominal;
  Platform& platform = nominal.model.platform;
  platform.topology = Topology::tabletop;
  platform.mass_kg = mass_kg;
  platform.inertia_kg_m2 = inertia_kg_m2();
  nominal.model.environment.magnetic_field_lab_T = field_lab_T;
  const DisturbanceContext context{platform, nominal.model.environment};
  Disturbance unbalance =
      make_disturbance_of("static_unbalance", {{"offset_m", {2.3e-6, -1.2e-6, -3.1e-5}}}, context);
  for (Parameter& p : unbalance.parameters) p.sigma = 1e-6;
  Disturbance drag =
      make_disturbance_of("bearing_drag", {{"coefficient_N_m_s", {1.8e-5}}}, context);
  drag.parameters[0].sigma = 4e-6;
  nominal.model.disturbances = {unbalance, drag};
  return nominal;
}

}  // namespace photorque::rigid_body

// A platform with chosen disturbances, and their effects.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "attitude/camera/tracking_camera.h"
#include "attitude/disturbances/kind.h"
#include "attitude/model/dynamics.h"
#include "attitude/propagation/propagator.h"
#include "core/files.h"
#include "tests/attitude/settings_bench.h"
#include "tests/files.h"

namespace photorque {

// The paper's tabletop platform in a plausible laboratory.
inline AttitudeModel bench_model() {
  AttitudeModel model;
  model.platform.mass_kg = 7.0;
  model.platform.inertia_kg_m2 = Vec3(0.11, 0.12, 0.19).asDiagonal();
  model.environment.magnetic_field_lab_T = {1e-6, 2.2e-5, -4.2e-5};
  model.environment.latitude_rad = 0.794;
  model.environment.earth_rate_lab_rad_s =
      earth_rate_rad_s * Vec3(0.0, std::cos(0.794), std::sin(0.794));
  return model;
}

// A camera a metre above five markers.
inline const TrackingCamera& bench_camera() {
  static const TrackingCamera camera = [] {
    TrackingCamera c;
    for (const Vec3& at_m : {Vec3(0, 0, 0.0255), Vec3(0.08, 0, 0.0255), Vec3(-0.08, 0, 0.0255),
                             Vec3(0, 0.08, 0.0255), Vec3(0, -0.08, 0.0255)}) {
      c.markers.push_back({at_m});
    }
    c.radiant_intensity_W_sr = 17e-6;
    c.exposure_s = 45e-6;
    c.lab_from_camera = frame_looking_along(-Vec3::UnitZ(), Vec3::UnitZ());
    return c;
  }();
  return camera;
}

inline DisturbanceContext context_of(const AttitudeModel& model) {
  return {model.platform, model.environment, &bench_camera()};
}

// A disturbance with its keys as TOML: "offset_m = [1e-6, 0, 0], scale = 2".
inline Disturbance make(const AttitudeModel& model, const std::string& kind,
                        const std::string& keys = "") {
  const Settings settings =
      settings_of("kind = '" + kind + "'" + (keys.empty() ? "" : ", ") + keys);
  Disturbance disturbance = read_disturbance(settings, context_of(model));
  settings.finish();
  return disturbance;
}

// The model with one more disturbance.
inline AttitudeModel with(AttitudeModel model, const std::string& kind,
                          const std::string& keys = "") {
  model.disturbances.push_back(make(model, kind, keys));
  return model;
}

inline PlatformState state_of(const AttitudeModel& model, const Quat& lab_from_body,
                              const Vec3& rate_body_rad_s = Vec3::Zero(), double time_s = 0.0,
                              double charge_drawn_C = 0.0) {
  PlatformState state = Dynamics(model).initial_state(rate_body_rad_s);
  state.lab_from_body = lab_from_body.normalized();
  state.time_s = time_s;
  state.charge_drawn_C = charge_drawn_C;
  return state;
}

inline Quat turned(double angle_rad, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle_rad, axis.normalized()));
}

// Torque of the model's last disturbance.
inline Vec3 torque_body_N_m(const AttitudeModel& model, const PlatformState& state) {
  return disturbance_torques_body_N_m(model, state).back();
}
inline Vec3 torque_body_N_m(const AttitudeModel& model, const Quat& lab_from_body,
                            const Vec3& rate_body_rad_s = Vec3::Zero(), double time_s = 0.0,
                            double charge_drawn_C = 0.0) {
  return torque_body_N_m(model,
                         state_of(model, lab_from_body, rate_body_rad_s, time_s, charge_drawn_C));
}

inline PlatformState propagated(const AttitudeModel& model, const PlatformState& start,
                                double end_s, double tolerance = 1e-12) {
  const Dynamics dynamics(model);
  const double times_s[] = {end_s};
  PropagationOptions options;
  options.tolerance = tolerance;
  return propagate(dynamics, start, times_s, options).states.back();
}

// A torque that is linear in the direction of light (body axes). sphere_table() writes a table of
// it over the sphere to a file and returns the path.
inline Vec3 sphere_table_torque_N_m(const Vec3& light_body) {
  Mat3 of_direction;
  of_direction << 1e-6, 2e-6, -1e-6, 0.5e-6, -3e-6, 2e-6, 4e-6, 1e-6, 0.2e-6;
  return of_direction * light_body;
}
inline std::string sphere_table() {
  std::ostringstream file;
  file.precision(17);
  file << "azimuth_deg,elevation_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n";
  for (int azimuth = -180; azimuth <= 180; azimuth += 10) {
    for (int elevation = -90; elevation <= 90; elevation += 10) {
      const double a = azimuth * degree_rad, e = elevation * degree_rad;
      const Vec3 torque = sphere_table_torque_N_m(
          {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)});
      file << azimuth << ',' << elevation << ',' << torque.x() << ',' << torque.y() << ','
           << torque.z() << '\n';
    }
  }
  return test_file("sphere_light.csv", file.str());
}

}  // namespace photorque

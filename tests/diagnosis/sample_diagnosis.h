// A finding with something in every field, for the tests of the writers.
#pragma once

#include <cmath>
#include <limits>

#include "diagnosis/diagnosis.h"

namespace photorque {

inline ChannelSeries sample_channel(const std::string& name) {
  ChannelSeries c;
  c.name = name;
  c.label = "Attitude about lab x";
  c.unit = "deg";
  c.residual_unit = "arcsec";
  c.noise = 37.0;
  for (int i = 0; i < 2000; ++i) {
    const double t_s = 0.1 * i;
    c.time_s.push_back(t_s);
    c.measured.push_back(i % 500 == 7 ? std::numeric_limits<double>::quiet_NaN()
                                      : 5.0 * std::sin(0.2 * t_s));
    c.before.push_back(4.9 * std::sin(0.2 * t_s));
    c.after.push_back(5.0 * std::sin(0.2 * t_s));
    c.residual_before.push_back(360.0 * std::sin(0.2 * t_s));
    c.residual_after.push_back(30.0 * std::sin(17.0 * t_s));
  }
  return c;
}

inline Diagnosis sample_diagnosis() {
  Diagnosis d;
  d.verdict = Verdict::missing_physics;
  d.confidence = 0.97;
  d.sentence = "A magnetic dipole acts & <explains> what differs.";
  d.where.channels = {{"attitude_z_arcsec", 8.5}, {"gyro_x_rad_s", 1.01}};
  d.where.intervals_s = {{120.0, 400.0}};
  d.where.band_Hz = Where::Interval{0.0, 0.1};
  d.where.depends_on = {{"yaw", 0.8}};
  d.effects = {
      {"magnetic_dipole",
       0.983,
       {{"dipole_A_m2", {0.0126, 0.0288, -0.0193}, {2e-4, 3e-4, 1.1e-3}}},
       {"room_draft"},
       "Magnets on board turn it like a compass needle."},
      {"attitude_latency", 0.9, {{"latency_s", {0.08}, {0.0003}}}, {}, "The camera lags."}};
  d.chi2_per_sample_before = 3.68;
  d.chi2_per_sample_after = 0.984;
  d.samples = 24000;
  d.holdout = Holdout{{{"attitude_z_arcsec", 95.0}}, {{"attitude_z_arcsec", 12.3}}, 4.1, 1.02, 900};
  d.alternatives = {{{"magnetic_dipole", "attitude_latency"}, "", 900.0, 1.02, ""},
                    {{"eddy_damping"}, "", 20.0, {}, "would feed energy"},
                    {{}, "", 0.0, 4.1, ""}};
  d.manoeuvres = {{{"magnetic_dipole", "room_draft"}, "Turn the coils off.", 40.0}};
  d.priors_refined = {{"disturbance[0].offset_m", {1e-6, 2e-6, -3e-5}, {1e-8, 1e-8, 1e-8}}};
  d.warnings = {"the clock jumps at 12 s"};
  d.data = {7000, 6957, {{"outlier", 31}, {"gap", 12}}, {{"flipped_quaternion", 4}}, 0.1,
            4e-4, 2.4};
  d.series = {{"run1.csv", {sample_channel("attitude_x_arcsec")}, {{150.0, 200.0}}}};
  d.replay = Replay{"run1.csv", false, 200.0, 10.0, {1, 0, 0, 0}, Vec3(0.01, 0.0, 0.1)};
  return d;
}

}  // namespace photorque

// Readings of the laboratory's instruments from the true motion.
//
// Errors with parameters (bias, scale, misalignment, latency) are disturbances of
// Stage::measurement, so that they can be fitted like other disturbances. This file has noise,
// drift, resolution and rate. Every random number is a hash of seed, instrument, row and axis, so
// one seed gives one noise, independent of other settings.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "attitude/camera/pose.h"
#include "attitude/disturbances/kind.h"
#include "attitude/model/dynamics.h"
#include "attitude/recordings/recording.h"

namespace photorque {

class Snapshot;  // core/snapshot.h

inline constexpr std::array<double, 3> usual_camera_noise_rad = {
    37 * arcsecond_rad, 37 * arcsecond_rad, 12 * arcsecond_rad};

// A camera that reports attitudes, like a star tracker. Defaults from the source paper: 12 arcsec
// in the image plane (about lab z, for a camera above) and 37 arcsec out of it.
struct CameraInstrument {
  Vec3 noise_rad =
      Vec3(usual_camera_noise_rad.data());  // about lab x, y, z; one standard deviation
  double rate_Hz = 0.0;                     // 0: in every row
  // If it is given, it determines the noise at every attitude and rate; noise_rad is then the noise
  // at zero tilt.
  std::optional<TrackingCamera> geometry = {};
};
struct GyroInstrument {
  double noise_rad_s = 0.0;           // per reading and axis
  double bias_drift_rad_s_1_s = 0.0;  // random walk of the bias, rad/s per √s
  double rate_Hz = 0.0;
};
// Instruments that `diagnose` uses and `propagate` does not record.
struct AccelerometerInstrument {
  double noise_m_s2 = 0.0;  // per reading and axis; 0: not stated
  Vec3 position_m =
      Vec3::Zero();  // from the centre of rotation, or of mass where nothing carries it
  Vec3 bias_m_s2 = Vec3::Zero();
};
struct MagnetometerInstrument {
  double noise_T = 0.0;
  Vec3 bias_T = Vec3::Zero();
};
// Measures the position of a platform that slides.
struct PositionInstrument {
  double noise_m = 0.0;    // per reading and axis; 0: not stated
  double noise_m_s = 0.0;  // noise of a velocity
};
// Measures the yaw in steps of the resolution.
struct EncoderInstrument {
  double resolution_rad = 0.0;
};
struct PowerInstrument {
  double current_noise_A = 0.0;
  double power_noise_W = 0.0;
};

struct Sensors {
  using Camera = CameraInstrument;
  using Gyro = GyroInstrument;
  using Accelerometer = AccelerometerInstrument;
  using Magnetometer = MagnetometerInstrument;
  using Position = PositionInstrument;
  using Encoder = EncoderInstrument;
  using Power = PowerInstrument;

  std::optional<Camera> camera;
  std::optional<Gyro> gyro;
  std::optional<Accelerometer> accelerometer;
  std::optional<Magnetometer> magnetometer;
  std::optional<Position> position;
  std::optional<Encoder> encoder;
  Power power;
  // The stated noise is used, independent of the recording.
  bool noise_is_stated = false;
  // Bias, scale, misalignment and latency, in the order of the file's instruments.
  std::vector<Disturbance> errors;
};

// Reads [sensors], whose keys are sensor_keys().
Sensors read_sensors(const Settings& settings, const DisturbanceContext& context);
// A camera and a gyro without errors (the default).
Sensors perfect_sensors();

// Covariance of the error of one attitude reading as a rotation vector about lab axes [rad²];
// nullopt if too few markers are visible to a camera with geometry.
std::optional<Mat3> camera_covariance_lab_rad2(const Sensors::Camera& camera,
                                               const Quat& lab_from_body,
                                               const Vec3& rate_body_rad_s);

// A standard normal random number, a hash of these counters.
double gaussian(uint64_t seed, uint64_t stream, uint64_t index, uint64_t dimension);

// The true state of one row.
struct Truth {
  double time_s = 0.0;
  Quat lab_from_body_seen = Quat::Identity();  // at time − camera delay
  Vec3 rate_body_rad_s = Vec3::Zero();
  double yaw_rad = 0.0;
  // Position [m] and velocity [m/s] of a platform that slides.
  std::optional<std::array<double, 4>> place_m_m_s = {};
  Vec3 gyro_rad_s = Vec3::Zero();  // Dynamics::Instants of this row
  Vec3 camera_error_rad = Vec3::Zero();
  Vec3 command_body_N_m = Vec3::Zero();
  Vec3 command_lab_N = Vec3::Zero();
  Vec3 wheel_rad_s = Vec3::Zero();
  double battery_current_A = 0.0;
  double array_power_W = 0.0;
};

// Fills a recording row by row.
class Recorder {
 public:
  Recorder(const Sensors& sensors, uint64_t seed);

  // Adds rows in order of time.
  void add(const Truth& truth);
  // Value of a channel in the row that was added last; NaN without such a channel.
  double last(std::string_view channel) const;
  // The recording. Channels of commands and power that are zero in all rows are left out.
  Recording finish();

  // Stores or restores the state between rows.
  void keep(Snapshot& snapshot);

 private:
  // Appends the next column of the present row.
  void put(const std::string& name, double value);
  bool is_due(double rate_Hz, double time_s) const;
  void add_camera(const Truth& truth);
  void add_gyro(const Truth& truth);
  void add_place(const Truth& truth);

  Sensors sensors_;
  uint64_t seed_;
  Recording recording_;
  size_t column_ = 0;
  Vec3 bias_walk_rad_s_ = Vec3::Zero();
};

// The instruments of the attitude in [sensors]; those of light and power are in
// diagnosis/light/model.
std::vector<Key> sensor_keys();

}  // namespace photorque

#include "attitude/recordings/sensors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/numerics/random.h"
#include "core/settings/typed_keys.h"
#include "core/snapshot.h"

namespace photorque {
namespace {

namespace sensor_key {
constexpr Vec3Key noise("noise_arcsec", usual_camera_noise_rad,
                        "standard deviation of a reading about lab x, y, z");
constexpr NumberKey rate("rate_Hz", 0.0, Range::not_negative(),
                         "rate of the readings; 0: one reading in every row");
constexpr TableKey camera("camera", "camera that measures the attitude",
                          {.usually = "without any `[sensors]` an ideal one"});
constexpr NumberKey angle_noise("noise_arcsec", Range::positive(),
                                "standard deviation of a reading");
constexpr TableKey angle("angle", "the angle of a one-axis platform, instead of a camera");
constexpr NumberKey gyro_noise("noise_rad_s", 0.0, Range::not_negative(),
                               "standard deviation per reading and axis");
constexpr NumberKey bias_drift("bias_drift", 0.0, Range::not_negative(),
                               "standard deviation of the random walk of the bias, rad/s per √s");
constexpr TableKey gyro("gyro", "gyro that measures the angular rate",
                        {.usually = "without any `[sensors]` an ideal one"});
constexpr NumberKey accelerometer_noise(
    "noise_m_s2", 0.0, Range::not_negative(),
    "standard deviation per reading and axis; 0: estimated from the readings");
constexpr Vec3Key position("position_m", {0.0, 0.0, 0.0},
                           "position in the body, relative to the centre of rotation (without "
                           "bearing: the centre of mass)");
constexpr Vec3Key bias("bias_m_s2", {0.0, 0.0, 0.0}, "constant offset of the readings");
constexpr TableKey accelerometer("accelerometer",
                                 "accelerometer that measures the specific force; for `diagnose`");
constexpr NumberKey magnetometer_noise(
    "noise_T", 0.0, Range::not_negative(),
    "standard deviation per reading and axis; 0: estimated from the readings");
constexpr Vec3Key magnetometer_bias("bias_T", {0.0, 0.0, 0.0},
                                    "constant field of the platform, body axes");
constexpr TableKey magnetometer(
    "magnetometer", "magnetometer that measures the field of the environment; for `diagnose`");
constexpr NumberKey place_noise(
    "noise_m", 0.0, Range::not_negative(),
    "standard deviation per reading and axis; 0: estimated from the readings");
constexpr NumberKey velocity_noise(
    "noise_m_s", 0.0, Range::not_negative(),
    "standard deviation of the velocity, per reading and axis; 0: no velocity is recorded");
constexpr TableKey place("position", "instrument for the position of a planar platform");
constexpr NumberKey resolution("resolution_arcsec", Range::positive(), "resolution of the yaw");
constexpr TableKey encoder("encoder", "encoder that measures the yaw");
constexpr NumberKey current_noise("current_noise_A", 0.0, Range::not_negative(),
                                  "standard deviation of the battery current");
constexpr NumberKey power_noise("power_noise_W", 0.0, Range::not_negative(),
                                "standard deviation of the power of the array");
constexpr TableKey power("power", "meters of the battery current and of the power of the array");
constexpr ChoiceKey noise_is(
    "noise_is",
    {{"found", "`diagnose` estimates level and correlation of the noise from the recordings"},
     {"stated", "it uses the values given here"}},
    0, "origin of the noise level");
}  // namespace sensor_key

// The errors of an instrument, which may be stated with it or in [[disturbance]].
std::vector<Key> errors_of(const std::string& instrument) {
  std::vector<Key> keys;
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    if (kind.instrument != instrument) continue;
    for (const Key& key : kind.keys) keys.push_back(Key(key).with_default_text("0"));
  }
  return keys;
}

// One stream of random numbers for each purpose.
enum Stream : uint64_t {
  camera_noise,
  gyro_noise,
  gyro_walk,
  current_noise,
  power_noise,
  place_noise
};

Vec3 gaussian_vector(uint64_t seed, Stream stream, uint64_t index) {
  return {gaussian(seed, stream, index, 0), gaussian(seed, stream, index, 1),
          gaussian(seed, stream, index, 2)};
}

// Reads the errors of an instrument. Each is active if the first key of its kind is given.
void read_errors(const Settings& settings, const DisturbanceContext& context,
                 const std::string& instrument, std::vector<Disturbance>& errors) {
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    if (kind.instrument != instrument) continue;
    if (!settings.has(kind.screening.parametrisations.front().keys.front().key)) continue;
    errors.push_back(kind.read(settings, context));
    errors.back().kind = kind.name;
    errors.back().per_recording = kind.screening.per_recording;
  }
}

void read_camera_noise(const Settings& s, Sensors::Camera& camera) {
  camera.geometry = read_tracking_camera(s);
  if (!camera.geometry) {
    camera.noise_rad = s.get(sensor_key::noise);
    if ((camera.noise_rad.array() < 0.0).any()) {
      throw s.error(sensor_key::noise, "a negative number", "numbers >= 0");
    }
    return;
  }
  if (s.has(sensor_key::noise)) {
    throw s.error(sensor_key::noise, "a noise beside markers_m", "one of them");
  }
  const auto covariance = attitude_covariance_lab_rad2(*camera.geometry, {});
  if (!covariance) {
    throw s.error("markers_m", "markers that do not fix the attitude at zero tilt",
                  "markers away from the centre and from each other");
  }
  camera.noise_rad = covariance->diagonal().cwiseSqrt();
}

// Rotation of the reading by wrong marker positions and distortion.
Quat marker_bias(const TrackingCamera& geometry, const Pose& pose) {
  if (!geometry.is_biased()) return Quat::Identity();
  return turn_by(marker_bias_lab_rad(geometry, pose).value_or(Vec3::Zero()));
}

Pose pose_of(const Quat& lab_from_body, const Vec3& rate_body_rad_s) {
  return {lab_from_body, lab_from_body * rate_body_rad_s, Vec3::Zero()};
}

}  // namespace

std::optional<Mat3> camera_covariance_lab_rad2(const Sensors::Camera& camera,
                                               const Quat& lab_from_body,
                                               const Vec3& rate_body_rad_s) {
  if (!camera.geometry) return camera.noise_rad.cwiseAbs2().asDiagonal().toDenseMatrix();
  return attitude_covariance_lab_rad2(*camera.geometry, pose_of(lab_from_body, rate_body_rad_s));
}

double gaussian(uint64_t seed, uint64_t stream, uint64_t index, uint64_t dimension) {
  // Box and Muller, Ann. Math. Stat. 29 (1958) 610.
  const double u = unit_interval(hash_words(seed, stream, index, 2 * dimension));
  const double v = unit_interval(hash_words(seed, stream, index, 2 * dimension + 1));
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * pi * v);
}

Sensors perfect_sensors() {
  Sensors sensors;
  sensors.camera.emplace().noise_rad.setZero();
  sensors.gyro.emplace();
  return sensors;
}

Sensors read_sensors(const Settings& settings, const DisturbanceContext& context) {
  Sensors sensors;
  if (settings.has(sensor_key::camera)) {
    const Settings s = settings.get(sensor_key::camera);
    Sensors::Camera& camera = sensors.camera.emplace();
    read_camera_noise(s, camera);
    camera.rate_Hz = s.get(sensor_key::rate);
    read_errors(s, context, "camera", sensors.errors);
  }
  if (settings.has(sensor_key::angle)) {
    const double noise_rad = settings.get(sensor_key::angle).get(sensor_key::angle_noise);
    sensors.camera.emplace().noise_rad = Vec3::Constant(noise_rad);
  }
  if (settings.has(sensor_key::gyro)) {
    const Settings s = settings.get(sensor_key::gyro);
    Sensors::Gyro& gyro = sensors.gyro.emplace();
    gyro.noise_rad_s = s.get(sensor_key::gyro_noise);
    gyro.bias_drift_rad_s_1_s = s.get(sensor_key::bias_drift);
    gyro.rate_Hz = s.get(sensor_key::rate);
    read_errors(s, context, "gyro", sensors.errors);
  }
  if (settings.has(sensor_key::accelerometer)) {
    const Settings s = settings.get(sensor_key::accelerometer);
    Sensors::Accelerometer& accelerometer = sensors.accelerometer.emplace();
    accelerometer.noise_m_s2 = s.get(sensor_key::accelerometer_noise);
    accelerometer.position_m = s.get(sensor_key::position);
    accelerometer.bias_m_s2 = s.get(sensor_key::bias);
  }
  if (settings.has(sensor_key::magnetometer)) {
    const Settings s = settings.get(sensor_key::magnetometer);
    Sensors::Magnetometer& magnetometer = sensors.magnetometer.emplace();
    magnetometer.noise_T = s.get(sensor_key::magnetometer_noise);
    magnetometer.bias_T = s.get(sensor_key::magnetometer_bias);
  }
  if (settings.has(sensor_key::place)) {
    const Settings s = settings.get(sensor_key::place);
    sensors.position = {s.get(sensor_key::place_noise), s.get(sensor_key::velocity_noise)};
  }
  if (settings.has(sensor_key::encoder)) {
    sensors.encoder.emplace().resolution_rad =
        settings.get(sensor_key::encoder).get(sensor_key::resolution);
  }
  if (settings.has(sensor_key::power)) {
    const Settings s = settings.get(sensor_key::power);
    sensors.power.current_noise_A = s.get(sensor_key::current_noise);
    sensors.power.power_noise_W = s.get(sensor_key::power_noise);
  }
  sensors.noise_is_stated = settings.get(sensor_key::noise_is) == 1;
  // Instruments of light are read by the light model; this marks them as read.
  for (const char* of_light : {"irradiance", "array"}) {
    if (settings.has(of_light)) settings.raw(of_light);
  }
  return sensors;
}

Recorder::Recorder(const Sensors& sensors, uint64_t seed) : sensors_(sensors), seed_(seed) {}

void Recorder::put(const std::string& name, double value) {
  if (column_ == recording_.channels.size()) recording_.channels.push_back({name, {}});
  recording_.channels[column_++].values.push_back(value);
}

// A reading is due in the first row, and in every row that contains a multiple of the period.
bool Recorder::is_due(double rate_Hz, double time_s) const {
  if (rate_Hz == 0.0 || recording_.time_s.empty()) return true;
  // Tolerance: with equal rates of rows and instrument, no reading may be missed by rounding.
  constexpr double slack = 1e-6;
  const double before = std::floor(recording_.time_s.back() * rate_Hz + slack);
  return std::floor(time_s * rate_Hz + slack) > before;
}

void Recorder::add_camera(const Truth& truth) {
  const uint64_t row = recording_.rows();
  Quat seen = Quat(empty_cell, empty_cell, empty_cell, empty_cell);
  const Sensors::Camera& camera = *sensors_.camera;
  const bool due = is_due(camera.rate_Hz, truth.time_s);
  const Vec3 draw = gaussian_vector(seed_, camera_noise, row);
  if (due && !camera.geometry) {
    const Vec3 noise_rad = camera.noise_rad.cwiseProduct(draw);
    seen = turn_by(noise_rad) * truth.lab_from_body_seen * turn_by(truth.camera_error_rad);
  } else if (due) {
    const Pose pose = pose_of(truth.lab_from_body_seen, truth.rate_body_rad_s);
    // If too few markers are visible, there is no reading.
    if (const auto covariance = attitude_covariance_lab_rad2(*camera.geometry, pose)) {
      const Vec3 noise_rad = Eigen::LLT<Mat3>(*covariance).matrixL() * draw;
      seen = turn_by(noise_rad) * marker_bias(*camera.geometry, pose) * truth.lab_from_body_seen *
             turn_by(truth.camera_error_rad);
    }
  }
  // Trackers report the quaternion with a positive scalar.
  if (seen.w() < 0.0) seen.coeffs() = -seen.coeffs();
  put("q_w", seen.w());
  put("q_x", seen.x());
  put("q_y", seen.y());
  put("q_z", seen.z());
}

void Recorder::add_gyro(const Truth& truth) {
  const Sensors::Gyro& gyro = *sensors_.gyro;
  const uint64_t row = recording_.rows();
  if (row > 0) {
    const double interval_s = truth.time_s - recording_.time_s.back();
    bias_walk_rad_s_ +=
        gyro.bias_drift_rad_s_1_s * std::sqrt(interval_s) * gaussian_vector(seed_, gyro_walk, row);
  }
  const Vec3 reading = truth.gyro_rad_s + bias_walk_rad_s_ +
                       gyro.noise_rad_s * gaussian_vector(seed_, gyro_noise, row);
  const bool due = is_due(gyro.rate_Hz, truth.time_s);
  for (int k = 0; k < 3; ++k)
    put(gyro_names[static_cast<size_t>(k)], due ? reading[k] : empty_cell);
}

void Recorder::add_place(const Truth& truth) {
  const uint64_t row = recording_.rows();
  const Sensors::Position noise = sensors_.position.value_or(Sensors::Position{});
  const auto& place = *truth.place_m_m_s;
  const auto read = [&](size_t k) {
    return place[k] + (k < 2 ? noise.noise_m : noise.noise_m_s) *
                          gaussian(seed_, place_noise, row, static_cast<uint64_t>(k));
  };
  put("x_m", read(0));
  put("y_m", read(1));
  put("command_x_N", truth.command_lab_N.x());
  put("command_y_N", truth.command_lab_N.y());
  // A velocity is recorded only if its noise is stated, because a position instrument does not
  // measure it.
  if (noise.noise_m_s > 0.0) {
    put("velocity_x_m_s", read(2));
    put("velocity_y_m_s", read(3));
  }
}

void Recorder::add(const Truth& truth) {
  const uint64_t row = recording_.rows();
  column_ = 0;
  if (sensors_.camera) add_camera(truth);
  if (sensors_.gyro) add_gyro(truth);
  if (truth.place_m_m_s) add_place(truth);
  if (sensors_.encoder) {
    const double step_rad = sensors_.encoder->resolution_rad;
    put("yaw_rad", step_rad * std::round(truth.yaw_rad / step_rad));
  }
  put("command_x_N_m", truth.command_body_N_m.x());
  put("command_y_N_m", truth.command_body_N_m.y());
  put("command_z_N_m", truth.command_body_N_m.z());
  put("wheel_x_rad_s", truth.wheel_rad_s.x());
  put("wheel_y_rad_s", truth.wheel_rad_s.y());
  put("wheel_z_rad_s", truth.wheel_rad_s.z());
  put("battery_current_A", truth.battery_current_A + sensors_.power.current_noise_A *
                                                         gaussian(seed_, current_noise, row, 0));
  put("array_power_W",
      truth.array_power_W + sensors_.power.power_noise_W * gaussian(seed_, power_noise, row, 0));
  recording_.time_s.push_back(truth.time_s);
}

double Recorder::last(std::string_view channel) const {
  const Channel* found = recording_.find(channel);
  return found != nullptr ? found->values.back() : empty_cell;
}

Recording Recorder::finish() {
  recording_.report.rows_read = recording_.report.rows_kept =
      static_cast<int64_t>(recording_.rows());
  std::erase_if(recording_.channels, [](const Channel& channel) {
    const bool optional = channel.name.starts_with("command") ||
                          channel.name.starts_with("wheel") ||
                          channel.name.starts_with("battery") || channel.name.starts_with("array");
    return optional && std::ranges::all_of(channel.values, [](double x) { return x == 0.0; });
  });
  return std::move(recording_);
}

void Recorder::keep(Snapshot& snapshot) {
  snapshot(recording_.time_s, bias_walk_rad_s_);
  snapshot.each(recording_.channels, [&](Channel& channel) {
    snapshot(channel.name);
    channel.values.resize(recording_.rows());
    snapshot.fixed(channel.values);
  });
}

std::vector<Key> sensor_keys() {
  using namespace sensor_key;
  return {camera.of(joined({{noise, rate}, errors_of("camera"), tracking_camera_keys()})),
          angle.of({angle_noise}),
          gyro.of(joined({{sensor_key::gyro_noise, bias_drift, rate}, errors_of("gyro")})),
          accelerometer.of({accelerometer_noise, position, bias}),
          magnetometer.of({magnetometer_noise, magnetometer_bias}),
          place.of({sensor_key::place_noise, velocity_noise}),
          encoder.of({resolution}),
          power.of({sensor_key::current_noise, sensor_key::power_noise}),
          noise_is};
}

}  // namespace photorque

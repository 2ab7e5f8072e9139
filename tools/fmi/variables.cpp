#include "tools/fmi/variables.h"

#include <cmath>

namespace photorque {
namespace {

constexpr uint32_t first_flag_reference =
    first_output_reference + static_cast<uint32_t>(UnitOutputs::numbers);

// Where each begins among the numbers.
enum Place : uint32_t {
  place_attitude = 0,
  place_gyro = 4,
  place_heading = 7,
  place_current = 8,
  place_power = 9,
  place_true_attitude = 10,
  place_true_rate = 14,
};

}  // namespace

std::vector<UnitVariable> unit_variables(const Sensors& sensors) {
  using Kind = UnitVariable::Kind;
  std::vector<UnitVariable> all = {{time_reference, "time", Kind::time, "s", "of the simulation"}};
  const auto add = [&](uint32_t place, const std::string& name, const std::string& unit,
                       const std::string& meaning) {
    all.push_back({first_output_reference + place, name, Kind::output, unit, meaning});
  };
  const std::string axes = "xyz", parts = "wxyz";
  for (uint32_t i = 0; i < 3; ++i) {
    all.push_back({first_input_reference + i, std::string("command_") + axes[i] + "_N_m",
                   Kind::input, "N.m", "commanded torque about a body axis, held between ticks"});
  }
  if (sensors.camera) {
    for (uint32_t i = 0; i < 4; ++i) {
      add(place_attitude + i, std::string("q_") + parts[i], "",
          "attitude by the camera: turns body vectors into the lab");
    }
    all.push_back({first_flag_reference, "camera_is_new", Kind::flag, "",
                   "the camera has read at this tick; else its last reading is held"});
  }
  if (sensors.gyro) {
    for (uint32_t i = 0; i < 3; ++i) {
      add(place_gyro + i, std::string("gyro_") + axes[i] + "_rad_s", "rad/s",
          "rate by the gyro, body axes");
    }
    all.push_back({first_flag_reference + 1, "gyro_is_new", Kind::flag, "",
                   "the gyro has read at this tick; else its last reading is held"});
  }
  if (sensors.encoder) add(place_heading, "heading_rad", "rad", "heading by the encoder");
  add(place_current, "battery_current_A", "A", "drawn from the battery until this tick");
  add(place_power, "array_power_W", "W", "of the solar array until this tick");
  for (uint32_t i = 0; i < 4; ++i) {
    add(place_true_attitude + i, std::string("true_q_") + parts[i], "",
        "the true attitude: turns body vectors into the lab");
  }
  for (uint32_t i = 0; i < 3; ++i) {
    add(place_true_rate + i, std::string("true_rate_") + axes[i] + "_rad_s", "rad/s",
        "the true rate, body axes");
  }
  return all;
}

void UnitOutputs::take(const LiveRow& row) {
  const auto put = [&](size_t place, double value) { numbers_[place] = value; };
  const auto put_attitude = [&](size_t place, const Quat& q) {
    put(place, q.w()), put(place + 1, q.x()), put(place + 2, q.y()), put(place + 3, q.z());
  };
  const auto put_vector = [&](size_t place, const Vec3& v) {
    for (int i = 0; i < 3; ++i) put(place + static_cast<size_t>(i), v[i]);
  };
  flags_[0] = std::isfinite(row.lab_from_body_seen.w());
  flags_[1] = std::isfinite(row.gyro_rad_s.x());
  if (flags_[0]) put_attitude(place_attitude, row.lab_from_body_seen);
  if (flags_[1]) put_vector(place_gyro, row.gyro_rad_s);
  if (std::isfinite(row.heading_rad)) put(place_heading, row.heading_rad);
  put(place_current, std::isfinite(row.battery_current_A) ? row.battery_current_A : 0.0);
  put(place_power, std::isfinite(row.array_power_W) ? row.array_power_W : 0.0);
  put_attitude(place_true_attitude, row.truth.lab_from_body);
  put_vector(place_true_rate, row.truth.rate_body_rad_s);
}

const double* UnitOutputs::number(uint32_t reference) const {
  const uint32_t place = reference - first_output_reference;
  return place < numbers ? &numbers_[place] : nullptr;
}

const bool* UnitOutputs::flag(uint32_t reference) const {
  const uint32_t place = reference - first_flag_reference;
  return place < flags ? &flags_[place] : nullptr;
}

}  // namespace photorque

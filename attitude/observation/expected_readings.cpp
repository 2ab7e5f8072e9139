#include "attitude/observation/expected_readings.h"

#include <algorithm>

#include "attitude/propagation/stage_system.h"

namespace photorque {

namespace {

// The delay of the attitude that a camera reports, in body axes. The angular acceleration is
// assumed to be constant during the delay. The error is of second order in delay over period.
struct Delay {
  double time_s = 0.0;
  Vec3 rate_rad_s = Vec3::Zero(), acceleration_rad_s2 = Vec3::Zero();  // now

  // The rotation during the delay.
  Vec3 turn_rad() const { return time_s * (rate_rad_s - 0.5 * time_s * acceleration_rad_s2); }
};

struct StateChange {
  Vec3 rotation_body_rad, rate_rad_s;
};

// Readings of accelerometer and magnetometer: f = ω' × r + ω × (ω × r) − g, without g in free fall,
// and the magnetic field of the lab.
class FieldReadings {
 public:
  FieldReadings(const Dynamics& dynamics, const Observation& seen)
      : place_m_(seen.fields.accelerometer_place_m),
        bias_m_s2_(seen.fields.accelerometer_bias_m_s2),
        bias_T_(seen.fields.magnetometer_bias_T),
        field_lab_T_(dynamics.model().environment.magnetic_field_lab_T) {
    if (dynamics.model().platform.has_bearing()) {
      gravity_lab_m_s2_ = dynamics.model().environment.gravity_lab_m_s2;
    }
  }

  bool depends_on_rotation() const { return place_m_.norm() > 0.0; }

  FieldRow at(const PlatformState& state, const Vec3& acceleration_rad_s2) const {
    const Vec3& w = state.rate_body_rad_s;
    FieldRow row;
    row << acceleration_rad_s2.cross(place_m_) + w.cross(w.cross(place_m_)) -
               state.lab_from_body.conjugate() * gravity_lab_m_s2_ + bias_m_s2_,
        state.lab_from_body.conjugate() * field_lab_T_ + bias_T_;
    return row;
  }

  // Derivatives for a change `by` of the state; `turning` is the change of ω'.
  FieldRow slope(const PlatformState& state, const StateChange& by, const Vec3& turning) const {
    const Vec3 &w = state.rate_body_rad_s, &dw = by.rate_rad_s;
    const Vec3 gravity = state.lab_from_body.conjugate() * gravity_lab_m_s2_,
               field = state.lab_from_body.conjugate() * field_lab_T_;
    FieldRow row;
    row << turning.cross(place_m_) + dw.cross(w.cross(place_m_)) + w.cross(dw.cross(place_m_)) -
               gravity.cross(by.rotation_body_rad),
        field.cross(by.rotation_body_rad);
    return row;
  }

 private:
  Vec3 place_m_, bias_m_s2_, bias_T_, field_lab_T_, gravity_lab_m_s2_ = Vec3::Zero();
};

// Readings of noiseless instruments at eight instants.
struct Sight {
  Vec3Of<Lanes> gyro_rad_s, camera_error_rad, acceleration_rad_s2;
  Lanes delay_s = 0.0;

  // The rate at the time of the attitude that the camera reports.
  Vec3Of<Lanes> rate_then_rad_s(const Lanes* y) const {
    Vec3Of<Lanes> rate;
    for (int k = 0; k < 3; ++k) rate[k] = y[component::rate + k] - delay_s * acceleration_rad_s2[k];
    return rate;
  }
};

// The acceleration is computed only if a reading depends on it, otherwise it is zero.
Sight sight_of(const Dynamics& dynamics, const Samples& samples, bool needs_acceleration) {
  Sight sight;
  const std::optional<Dynamics::Offsets>& offsets = dynamics.offsets();
  if (offsets && offsets->camera_delay_s == 0.0 && !needs_acceleration) {
    for (int k = 0; k < 3; ++k) {
      sight.gyro_rad_s[k] =
          samples.y[component::rate + static_cast<size_t>(k)] + offsets->gyro_rad_s[k];
      sight.camera_error_rad[k] = offsets->camera_rad[k];
      sight.acceleration_rad_s2[k] = 0.0;
    }
    return sight;
  }
  const Dynamics::Instants now = dynamics.at(samples.time_s, samples.held, samples.y.data());
  sight.gyro_rad_s = now.gyro_rad_s;
  sight.camera_error_rad = now.camera_error_rad;
  sight.delay_s = now.camera_delay_s;
  for (int k = 0; k < 3; ++k) {
    sight.acceleration_rad_s2[k] = now.rates[component::rate + static_cast<size_t>(k)];
  }
  return sight;
}

// Derivatives of the angular acceleration, one row of variables for each component: through the
// state, and directly through a parameter.
std::vector<Lanes> acceleration_slopes(const Sensitivity& sensitivity, const Samples& samples) {
  const Dynamics& dynamics = sensitivity.dynamics();
  const size_t count = sensitivity.variables().size();
  std::vector<Lanes> slopes(3 * count, Lanes(0.0));
  RateWorkspace room;
  for (const RateDerivative& entry :
       rate_derivatives(dynamics, state_blocks(dynamics), samples.time_s, samples.held[0],
                        samples.y.data(), room)) {
    if (entry.row < component::rate || entry.row >= component::charge) continue;
    Lanes* to = slopes.data() + (entry.row - component::rate) * count;
    const Lanes* by = samples.derivatives.data() + entry.column * count;
    for (size_t v = 0; v < count; ++v) to[v] += entry.value * by[v];
  }
  for (size_t v = 0; v < count; ++v) {
    const Variable& variable = sensitivity.variables()[v];
    if (variable.parameter < 0) continue;
    Dynamics::Block block;
    block.parameter[0] = dynamics.first_parameter(variable.disturbance) + variable.parameter;
    dynamics.derivatives(samples.time_s, samples.held[0], samples.y.data(), block,
                         room.partials.data(), room.evaluation);
    for (size_t a = 0; a < 3; ++a) {
      slopes[a * count + v] += room.partials[(component::rate + a) * DualLanes::block];
    }
  }
  return slopes;
}

// Derivatives of the attitude that the camera reports (lab axes) and of the gyro, one row of
// variables for each component.
std::vector<Lanes> vector_slopes(const Sensitivity& sensitivity, const Samples& samples,
                                 const Sight& sight) {
  const size_t count = sensitivity.variables().size();
  std::vector<Lanes> readings(Dynamics::reading_count * count), slopes(vector_channels * count);
  const Lanes* y = samples.y.data();
  sensitivity.readings(samples.time_s, samples.held, y, samples.derivatives.data(),
                       readings.data());
  const Vec3Of<Lanes> rate_then_rad_s = sight.rate_then_rad_s(y);
  const Lanes norm = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]);
  const QuatOf<Lanes> q(y[0] / norm, y[1] / norm, y[2] / norm, y[3] / norm);
  const Mat3Of<Lanes> lab_from_body = q.toRotationMatrix();
  for (size_t v = 0; v < count; ++v) {
    const auto by = [&](size_t c) -> const Lanes& { return samples.derivatives[c * count + v]; };
    const auto reading = [&](size_t r) -> const Lanes& { return readings[r * count + v]; };
    const QuatOf<Lanes> change(by(0), by(1), by(2), by(3));
    const Vec3Of<Lanes> turned = (q.conjugate() * change).vec();
    Vec3Of<Lanes> rotation_body;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<size_t>(k);
      rotation_body[k] = 2.0 * turned[k] + reading(3 + axis) - reading(6) * rate_then_rad_s[k] -
                         sight.delay_s * by(component::rate + axis);
    }
    const Vec3Of<Lanes> rotation_lab = lab_from_body * rotation_body;
    for (size_t k = 0; k < 3; ++k) {
      slopes[k * count + v] = rotation_lab[static_cast<Eigen::Index>(k)];
      slopes[(3 + k) * count + v] = reading(k);
    }
  }
  return slopes;
}

ExpectedInstant instant_at(const Samples& samples, int lane, const Sight& sight,
                           const FieldReadings* fields, int place) {
  const std::vector<double> y = lane_of(samples.y, lane);
  ExpectedInstant instant;
  instant.state = to_state(samples.time_s[lane], y);
  const Delay delay{sight.delay_s[lane], instant.state.rate_body_rad_s,
                    lane_of(sight.acceleration_rad_s2, lane)};
  instant.camera_offset_body = lane_of(sight.camera_error_rad, lane) - delay.turn_rad();
  instant.gyro_rad_s = lane_of(sight.gyro_rad_s, lane);
  if (fields != nullptr) instant.fields = fields->at(instant.state, delay.acceleration_rad_s2);
  for (int k = 0; place >= 0 && k < 4; ++k) instant.place[k] = y[static_cast<size_t>(place + k)];
  return instant;
}

// Adds the derivatives of the readings of accelerometer and magnetometer. `turning`: those of the
// angular acceleration; empty if no reading depends on it.
void put_field_slopes(const Samples& samples, const FieldReadings& fields,
                      const std::vector<Lanes>& turning, ExpectedReadings& to) {
  for (int lane = 0; lane < samples.count; ++lane) {
    const PlatformState& state = to.instant[static_cast<size_t>(lane)].state;
    SlopeRows& slope = to.slope[static_cast<size_t>(lane)];
    const auto count = static_cast<size_t>(slope.cols());
    for (size_t v = 0; v < count; ++v) {
      const auto by = [&](size_t c) { return samples.derivatives[c * count + v][lane]; };
      const Quat turned(by(0), by(1), by(2), by(3));
      const StateChange change{
          2.0 * (state.lab_from_body.conjugate() * turned).vec(),
          {by(component::rate), by(component::rate + 1), by(component::rate + 2)}};
      Vec3 acceleration = Vec3::Zero();
      for (size_t a = 0; a < 3 && !turning.empty(); ++a) {
        acceleration[static_cast<Eigen::Index>(a)] = turning[a * count + v][lane];
      }
      slope.col(static_cast<Eigen::Index>(v))
          .segment<first_place - first_field>(vector_channels + first_field) =
          fields.slope(state, change, acceleration);
    }
  }
}

}  // namespace

ExpectedReadings expected_readings(const Dynamics& dynamics, const Sensitivity* sensitivity,
                                   const Samples& samples, const Observation& seen,
                                   const std::vector<int>& scalars) {
  const FieldReadings fields(dynamics, seen);
  const bool has_fields =
      std::ranges::any_of(scalars, [](int s) { return s >= first_field && s < first_place; });
  const Sight sight = sight_of(dynamics, samples, has_fields);
  const int place = dynamics.first_of_translation();
  ExpectedReadings result;
  for (int lane = 0; lane < samples.count; ++lane) {
    result.instant[static_cast<size_t>(lane)] =
        instant_at(samples, lane, sight, has_fields ? &fields : nullptr, place);
  }
  if (sensitivity == nullptr) return result;
  const std::vector<Lanes> slopes = vector_slopes(*sensitivity, samples, sight);
  const size_t count = sensitivity->variables().size();
  for (int lane = 0; lane < samples.count; ++lane) {
    SlopeRows& slope = result.slope[static_cast<size_t>(lane)];
    slope.setZero(channel_count, static_cast<Eigen::Index>(count));
    const auto put = [&](int channel, const Lanes* from) {
      for (size_t v = 0; v < count; ++v) {
        slope(channel, static_cast<Eigen::Index>(v)) = from[v][lane];
      }
    };
    for (int k = 0; k < vector_channels; ++k) {
      put(k, slopes.data() + static_cast<size_t>(k) * count);
    }
    for (int k = 0; place >= 0 && k < scalar_count - first_place; ++k) {
      put(vector_channels + first_place + k,
          samples.derivatives.data() + static_cast<size_t>(place + k) * count);
    }
  }
  if (!has_fields) return result;
  put_field_slopes(samples, fields,
                   fields.depends_on_rotation() ? acceleration_slopes(*sensitivity, samples)
                                                : std::vector<Lanes>(),
                   result);
  return result;
}

}  // namespace photorque

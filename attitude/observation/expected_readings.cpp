#include "attitude/observation/expected_readings.h"

#include <algorithm>
#include <optional>

#include "attitude/propagation/stage_system.h"

namespace photorque {

// The parts of ExpectedReadings.
namespace expected {

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

// Derivatives of the angular acceleration with respect to each variable: through the state, and
// directly through a parameter.
class AccelerationSlopes {
 public:
  AccelerationSlopes(const Sensitivity& sensitivity, const Samples& samples)
      : count_(sensitivity.variables().size()), all_(3 * count_, Lanes(0.0)) {
    const Dynamics& dynamics = sensitivity.dynamics();
    const auto size = static_cast<size_t>(dynamics.size());
    std::vector<Lanes> partials(size * DualLanes::block);
    constexpr auto width = static_cast<size_t>(DualLanes::block);
    const auto partial = [&](size_t component, size_t k) {
      return partials[component * width + k];
    };
    Dynamics::Workspace room;
    const auto evaluate = [&](const Dynamics::Block& block) {
      dynamics.derivatives(samples.time_s, samples.held[0], samples.y.data(), block,
                           partials.data(), room);
    };
    for (const Dynamics::Block& block : state_blocks(dynamics)) {
      evaluate(block);
      for (size_t k = 0; k < width; ++k) {
        if (block.state[k] < 0) continue;
        const Lanes* by = samples.derivatives.data() + static_cast<size_t>(block.state[k]) * count_;
        for (size_t v = 0; v < count_; ++v) {
          for (size_t a = 0; a < 3; ++a) {
            all_[a * count_ + v] += partial(component::rate + a, k) * by[v];
          }
        }
      }
    }
    for (size_t v = 0; v < count_; ++v) {
      const Variable& variable = sensitivity.variables()[v];
      if (variable.parameter < 0) continue;
      Dynamics::Block block;
      block.parameter[0] = dynamics.first_parameter(variable.disturbance) + variable.parameter;
      evaluate(block);
      for (size_t a = 0; a < 3; ++a) all_[a * count_ + v] += partial(component::rate + a, 0);
    }
  }

  Vec3 of(size_t v, int lane) const {
    return {all_[v][lane], all_[count_ + v][lane], all_[2 * count_ + v][lane]};
  }

 private:
  size_t count_;
  std::vector<Lanes> all_;
};

// Derivatives of the six readings at one instant (lane), one row each.
class Slopes {
 public:
  Slopes(const Sensitivity& sensitivity, const Samples& samples)
      : count_(sensitivity.variables().size()),
        samples_(samples),
        readings_(Dynamics::reading_count * count_) {
    sensitivity.readings(samples.time_s, samples.held, samples.y.data(), samples.derivatives.data(),
                         readings_.data());
  }

  // Fills in the derivatives of one lane; see() must have been called before.
  template <class Matrix>
  void fill(int lane, Matrix& slope) const {
    for (Eigen::Index r = 0; r < 6; ++r) {
      const Lanes* from = seen_.data() + static_cast<size_t>(r) * count_;
      for (size_t v = 0; v < count_; ++v) slope(r, static_cast<Eigen::Index>(v)) = from[v][lane];
    }
  }

  // Computes the derivatives of the camera readings: attitude and misalignment, `delay_s` earlier.
  void see(const Lanes& delay_s, const Vec3Of<Lanes>& rate_then_rad_s) {
    const Lanes* y = samples_.y.data();
    const Lanes norm = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3]);
    const QuatOf<Lanes> q(y[0] / norm, y[1] / norm, y[2] / norm, y[3] / norm);
    const Mat3Of<Lanes> lab_from_body = q.toRotationMatrix();
    seen_.resize(6 * count_);
    for (size_t v = 0; v < count_; ++v) {
      const auto by = [&](size_t c) -> const Lanes& {
        return samples_.derivatives[c * count_ + v];
      };
      const auto reading = [&](size_t r) -> const Lanes& { return readings_[r * count_ + v]; };
      const QuatOf<Lanes> change(by(0), by(1), by(2), by(3));
      const Vec3Of<Lanes> turned = (q.conjugate() * change).vec();
      Vec3Of<Lanes> rotation_body;
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<size_t>(k);
        rotation_body[k] = 2.0 * turned[k] + reading(3 + axis) - reading(6) * rate_then_rad_s[k] -
                           delay_s * by(component::rate + axis);
      }
      const Vec3Of<Lanes> rotation_lab = lab_from_body * rotation_body;
      for (size_t k = 0; k < 3; ++k) {
        seen_[k * count_ + v] = rotation_lab[static_cast<Eigen::Index>(k)];
        seen_[(3 + k) * count_ + v] = reading(k);
      }
    }
  }

  // Derivative of component `c` of the state.
  double of_component(int c, size_t v, int lane) const {
    return samples_.derivatives[static_cast<size_t>(c) * count_ + v][lane];
  }

  // Derivative of the state: rotation of the body, in body axes, and change of the rate.
  StateChange change(size_t v, int lane, const PlatformState& state) const {
    const auto by = [&](size_t c) { return samples_.derivatives[c * count_ + v][lane]; };
    const Quat turned(by(0), by(1), by(2), by(3));
    return {2.0 * (state.lab_from_body.conjugate() * turned).vec(),
            {by(component::rate), by(component::rate + 1), by(component::rate + 2)}};
  }

 private:
  size_t count_;
  const Samples& samples_;
  std::vector<Lanes> readings_;
  std::vector<Lanes> seen_;  // slopes of the attitude (lab axes) and of the gyro, a row each
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

bool any_field(const std::vector<int>& scalars) {
  return std::any_of(scalars.begin(), scalars.end(),
                     [](int s) { return s >= first_field && s < first_place; });
}

}  // namespace expected

struct ExpectedReadings::Parts {
  Parts(const Dynamics& dynamics, const Sensitivity* sensitivity, const Samples& of,
        const Observation& seen, const std::vector<int>& scalars)
      : samples(of),
        fields(dynamics, seen),
        has_fields(expected::any_field(scalars)),
        sight(expected::sight_of(dynamics, of, has_fields)),
        place(dynamics.first_of_translation()),
        y(of.y.size()) {
    if (sensitivity == nullptr) return;
    slopes.emplace(*sensitivity, of);
    slopes->see(sight.delay_s, sight.rate_then_rad_s(of.y.data()));
    if (has_fields && fields.depends_on_rotation()) turning.emplace(*sensitivity, of);
  }

  const Samples& samples;
  expected::FieldReadings fields;
  bool has_fields;
  expected::Sight sight;
  int place;
  std::vector<double> y;  // of one lane
  std::optional<expected::Slopes> slopes;
  std::optional<expected::AccelerationSlopes> turning;
};

ExpectedReadings::ExpectedReadings(const Dynamics& dynamics, const Sensitivity* sensitivity,
                                   const Samples& samples, const Observation& seen,
                                   const std::vector<int>& scalars)
    : parts_(std::make_unique<Parts>(dynamics, sensitivity, samples, seen, scalars)) {}

ExpectedReadings::~ExpectedReadings() = default;

ExpectedInstant ExpectedReadings::at(int lane) const {
  Parts& p = *parts_;
  for (size_t c = 0; c < p.y.size(); ++c) p.y[c] = p.samples.y[c][lane];
  ExpectedInstant instant;
  instant.state = to_state(p.samples.time_s[lane], p.y);
  const expected::Delay delay{p.sight.delay_s[lane], instant.state.rate_body_rad_s,
                              lane_of(p.sight.acceleration_rad_s2, lane)};
  instant.camera_offset_body = lane_of(p.sight.camera_error_rad, lane) - delay.turn_rad();
  instant.gyro_rad_s = lane_of(p.sight.gyro_rad_s, lane);
  if (p.has_fields) instant.fields = p.fields.at(instant.state, delay.acceleration_rad_s2);
  for (int k = 0; p.place >= 0 && k < 4; ++k) {
    instant.place[k] = p.y[static_cast<size_t>(p.place + k)];
  }
  return instant;
}

void ExpectedReadings::fill_slopes(int lane, const ExpectedInstant& instant,
                                   SlopeRows& slope) const {
  const Parts& p = *parts_;
  if (!p.slopes) return;
  p.slopes->fill(lane, slope);
  for (Eigen::Index v = 0; v < slope.cols(); ++v) {
    const auto column = static_cast<size_t>(v);
    if (p.has_fields) {
      slope.col(v).segment<first_place - first_field>(vector_channels + first_field) =
          p.fields.slope(instant.state, p.slopes->change(column, lane, instant.state),
                         p.turning ? p.turning->of(column, lane) : Vec3::Zero());
    }
    for (int k = 0; p.place >= 0 && k < scalar_count - first_place; ++k) {
      slope(vector_channels + first_place + k, v) =
          p.slopes->of_component(p.place + k, column, lane);
    }
  }
}

}  // namespace photorque

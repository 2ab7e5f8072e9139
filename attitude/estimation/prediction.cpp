#include "attitude/estimation/prediction.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/whitening.h"
#include "attitude/propagation/sampling.h"
#include "core/errors.h"

namespace photorque {
namespace {

Vec3 in_lane(const Vec3Of<Lanes>& v, int lane) {
  return {v[0][lane], v[1][lane], v[2][lane]};
}

// By how much the attitude that a camera reports is the past's. Body axes; the rate changes evenly
// meanwhile: for delays far below the periods of the motion, as the square of their ratio.
struct Delay {
  double time_s = 0.0;
  Vec3 rate_rad_s = Vec3::Zero(), acceleration_rad_s2 = Vec3::Zero();  // now

  // From the attitude then to that now.
  Vec3 turn_rad() const { return time_s * (rate_rad_s - 0.5 * time_s * acceleration_rad_s2); }
};

struct StateChange {
  Vec3 rotation_body_rad, rate_rad_s;
};

// Accelerometer and magnetometer, in the order of their scalars.
using FieldRow = Eigen::Matrix<double, first_place - first_field, 1>;

// What they read: f = ω' × r + ω × (ω × r) − g, without g in free fall, and the field of the lab.
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

  bool feels_turning() const { return place_m_.norm() > 0.0; }

  FieldRow at(const PlatformState& state, const Vec3& acceleration_rad_s2) const {
    const Vec3& w = state.rate_body_rad_s;
    FieldRow row;
    row << acceleration_rad_s2.cross(place_m_) + w.cross(w.cross(place_m_)) -
               state.lab_from_body.conjugate() * gravity_lab_m_s2_ + bias_m_s2_,
        state.lab_from_body.conjugate() * field_lab_T_ + bias_T_;
    return row;
  }

  // `turning`: the change of ω'.
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

// How the angular acceleration changes by each variable: through the state, and by a parameter
// itself.
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
    const auto evaluate = [&](const Dynamics::Block& block) {
      dynamics.derivatives(samples.time_s, samples.held[0], samples.y.data(), block,
                           partials.data());
    };
    for (size_t first = 0; first < size; first += width) {
      Dynamics::Block block = nothing();
      for (size_t k = 0; k < width && first + k < size; ++k) {
        block.state[k] = static_cast<int>(first + k);
      }
      evaluate(block);
      for (size_t k = 0; k < width && first + k < size; ++k) {
        for (size_t v = 0; v < count_; ++v) {
          for (size_t a = 0; a < 3; ++a) {
            all_[a * count_ + v] +=
                partial(component::rate + a, k) * samples.derivatives[(first + k) * count_ + v];
          }
        }
      }
    }
    for (size_t v = 0; v < count_; ++v) {
      const Variable& variable = sensitivity.variables()[v];
      if (variable.parameter < 0) continue;
      Dynamics::Block block = nothing();
      block.parameter[0] = dynamics.first_parameter(variable.disturbance) + variable.parameter;
      evaluate(block);
      for (size_t a = 0; a < 3; ++a) all_[a * count_ + v] += partial(component::rate + a, 0);
    }
  }

  Vec3 of(size_t v, int lane) const {
    return {all_[v][lane], all_[count_ + v][lane], all_[2 * count_ + v][lane]};
  }

 private:
  static Dynamics::Block nothing() {
    Dynamics::Block block;
    block.state.fill(-1);
    block.parameter.fill(-1);
    return block;
  }

  size_t count_;
  std::vector<Lanes> all_;
};

// The slopes of the six readings in one lane, a row each.
class Slopes {
 public:
  Slopes(const Sensitivity& sensitivity, const Samples& samples)
      : count_(sensitivity.variables().size()),
        samples_(samples),
        readings_(Dynamics::reading_count * count_) {
    sensitivity.readings(samples.time_s, samples.held, samples.y.data(), samples.derivatives.data(),
                         readings_.data());
  }

  // Those of one lane, once see() was called.
  template <class Matrix>
  void fill(int lane, Matrix& slope) const {
    for (Eigen::Index r = 0; r < 6; ++r) {
      const Lanes* from = seen_.data() + static_cast<size_t>(r) * count_;
      for (size_t v = 0; v < count_; ++v) slope(r, static_cast<Eigen::Index>(v)) = from[v][lane];
    }
  }

  // The camera sees the attitude, its own misalignment, and all of it late, by `delay_s`.
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

  // Of one component of the state.
  double of_component(int c, size_t v, int lane) const {
    return samples_.derivatives[static_cast<size_t>(c) * count_ + v][lane];
  }

  // Of the state itself: the rotation of the body, in body axes, and the rate.
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

// How fast a scalar says that it turns: an angle from one reading to the next, a rate as it is.
double fastest_of_scalar(const ScalarReadings& read, Measures measures,
                         const std::vector<double>& time_s) {
  if (measures != Measures::angle && measures != Measures::rate) return 0.0;
  const bool is_angle = measures == Measures::angle;
  double fastest = 0.0;
  size_t before = time_s.size();
  for (size_t i = 0; i < read.rows.size(); ++i) {
    if (!(read.rows[i] > 0.0)) continue;
    if (!is_angle) fastest = std::max(fastest, read.value[i]);
    if (is_angle && before < i) {
      fastest = std::max(
          fastest, std::abs(read.value[i] - read.value[before]) / (time_s[i] - time_s[before]));
    }
    before = i;
  }
  return fastest;
}

// By the gyro, or from one attitude to the next; 0.1 at least.
double fastest_rad_s(const Observation& seen) {
  double fastest = 0.1;
  for (int s = 0; s < scalar_count; ++s) {
    fastest = std::max(
        fastest, fastest_of_scalar(seen.scalar[static_cast<size_t>(s)],
                                   channel_traits(vector_channels + s).measures, seen.time_s));
  }
  size_t before = seen.blocks();
  for (size_t i = 0; i < seen.blocks(); ++i) {
    if (seen.has_gyro) {
      double square = 0.0;
      for (int k = 0; k < 3; ++k) {
        if (seen.gyro_rows[i][k] > 0.0) square += seen.gyro_rad_s[i][k] * seen.gyro_rad_s[i][k];
      }
      fastest = std::max(fastest, std::sqrt(square));
    } else if (seen.attitude_rows[i] > 0.0) {
      if (before < i) {
        const Quat turn = seen.attitude[before].conjugate() * seen.attitude[i];
        fastest = std::max(fastest,
                           rotation_vector(turn).norm() / (seen.time_s[i] - seen.time_s[before]));
      }
      before = i;
    }
  }
  return fastest;
}

// What noiseless instruments read at eight instants.
struct Sight {
  Vec3Of<Lanes> gyro_rad_s, camera_error_rad, acceleration_rad_s2;
  Lanes delay_s = 0.0;

  // When the attitude was as the camera reports it.
  Vec3Of<Lanes> rate_then_rad_s(const Lanes* y) const {
    Vec3Of<Lanes> rate;
    for (int k = 0; k < 3; ++k) rate[k] = y[component::rate + k] - delay_s * acceleration_rad_s2[k];
    return rate;
  }
};

// The acceleration is zero where nothing that is read depends on it.
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

class Comparison {
 public:
  Comparison(const Observation& seen, size_t variables, bool keep, double max_chi2)
      : seen_(seen),
        max_chi2_(max_chi2),
        max_rate_rad_s_(runaway * fastest_rad_s(seen)),
        sums_(static_cast<Eigen::Index>(variables)),
        slope_(Eigen::Index{channel_count}, static_cast<Eigen::Index>(variables)),
        keep_(keep) {
    slope_.setZero();
    for (int channel = 0; channel < channel_count; ++channel) {
      whitening_.emplace_back(seen, channel, slope_.cols() + 1);
      const bool is_scalar = channel >= vector_channels;
      if (is_scalar && seen.has(static_cast<Scalar>(channel - vector_channels))) {
        scalars_.push_back(channel - vector_channels);
      }
    }
  }

  void add(const Dynamics& dynamics, const Sensitivity* sensitivity, const Samples& samples) {
    const FieldReadings fields(dynamics, seen_);
    const bool has_fields = std::any_of(scalars_.begin(), scalars_.end(),
                                        [](int s) { return s >= first_field && s < first_place; });
    const Sight sight = sight_of(dynamics, samples, has_fields);
    std::optional<Slopes> slopes;
    if (sensitivity != nullptr) {
      slopes.emplace(*sensitivity, samples);
      slopes->see(sight.delay_s, sight.rate_then_rad_s(samples.y.data()));
    }
    const int place = dynamics.first_of_translation();
    std::optional<AccelerationSlopes> turning;
    if (has_fields && sensitivity != nullptr && fields.feels_turning()) {
      turning.emplace(*sensitivity, samples);
    }
    // Nothing of what follows would be worth its steps.
    if (chi2_ > max_chi2_) throw NumericalError("the prediction has left the readings");
    std::vector<double> y(samples.y.size());
    for (int lane = 0; lane < samples.count; ++lane) {
      for (size_t c = 0; c < y.size(); ++c) y[c] = samples.y[c][lane];
      const PlatformState state = to_state(samples.time_s[lane], y);
      if (!(state.rate_body_rad_s.norm() < max_rate_rad_s_)) {
        throw NumericalError("the motion runs away");
      }
      const Delay delay{sight.delay_s[lane], state.rate_body_rad_s,
                        in_lane(sight.acceleration_rad_s2, lane)};
      if (slopes) slopes->fill(lane, slope_);
      for (Eigen::Index v = 0; has_fields && slopes && v < slope_.cols(); ++v) {
        const auto column = static_cast<size_t>(v);
        slope_.col(v).segment<first_place - first_field>(vector_channels + first_field) =
            fields.slope(state, slopes->change(column, lane, state),
                         turning ? turning->of(column, lane) : Vec3::Zero());
      }
      for (Eigen::Index v = 0; place >= 0 && slopes && v < slope_.cols(); ++v) {
        for (int k = 0; k < scalar_count - first_place; ++k) {
          slope_(vector_channels + first_place + k, v) =
              slopes->of_component(place + k, static_cast<size_t>(v), lane);
        }
      }
      place_ = place < 0 ? nullptr : &y[static_cast<size_t>(place)];
      const Vec3 camera_offset_body = in_lane(sight.camera_error_rad, lane) - delay.turn_rad();
      add_block(samples.first + static_cast<size_t>(lane), state, camera_offset_body,
                in_lane(sight.gyro_rad_s, lane),
                has_fields ? fields.at(state, delay.acceleration_rad_s2) : FieldRow::Zero());
    }
  }

  Prediction finish() {
    result_.sums = sums_.finish();
    return std::move(result_);
  }

 private:
  void add_block(size_t block, const PlatformState& state, const Vec3& camera_offset_body,
                 const Vec3& gyro_rad_s, const FieldRow& fields) {
    WhiteRow white = WhiteRow::Constant(NAN), off = white;
    if (seen_.attitude_rows[block] > 0.0 && seen_.sees_some_attitude()) {
      off.head<3>() = rotation_vector(seen_.attitude[block] * state.lab_from_body.conjugate()) -
                      state.lab_from_body * camera_offset_body;
    }
    off.segment<3>(3) = seen_.gyro_rad_s[block] - gyro_rad_s;
    Eigen::Matrix<double, scalar_count, 1> scalars = Eigen::Matrix<double, scalar_count, 1>::Zero();
    for (const int s : scalars_) {
      const ScalarReadings& read = seen_.scalar[static_cast<size_t>(s)];
      if (s >= first_field) {
        scalars[s] = s < first_place ? fields[s - first_field] : place_[s - first_place];
        off[vector_channels + s] = read.value[block] - scalars[s];
        continue;  // its slopes are filled
      }
      const auto which = static_cast<Scalar>(s);
      const Vec3 camera_offset_lab = state.lab_from_body * camera_offset_body;
      const double angle = camera_offset_lab.norm();
      const Quat as_seen = angle > 0.0 ? Quat(Eigen::AngleAxisd(angle, camera_offset_lab / angle)) *
                                             state.lab_from_body
                                       : state.lab_from_body;
      const ScalarReading reading = scalar_reading(which, as_seen, gyro_rad_s);
      scalars[s] = reading.value;
      off[vector_channels + s] = scalar_difference(which, read.value[block], reading.value);
      slope_.row(vector_channels + s) = reading.by_rotation_lab.transpose() * slope_.topRows<3>() +
                                        reading.by_rate.transpose() * slope_.middleRows<3>(3);
    }
    for (int channel = 0; channel < channel_count; ++channel) {
      const double rows = seen_.rows_of(block, channel);
      if (rows > 0.0) white[channel] = put(channel, block, rows, off[channel]);
      if (!(rows > 0.0)) off[channel] = NAN;
    }
    if (!keep_) return;
    result_.residual.push_back(white);
    result_.off.push_back(off);
    result_.states.push_back(state);
    result_.camera_offset_lab_rad.emplace_back(state.lab_from_body * camera_offset_body);
    result_.gyro_rad_s.push_back(gyro_rad_s);
    result_.scalars.push_back(scalars);
  }

  // Slopes and residual, whitened alike. Returns the whitened residual.
  double put(int channel, size_t block, double rows, double off) {
    auto row = sums_.next();
    const Eigen::Index n = slope_.cols();
    row.head(n) = slope_.row(channel);
    row[n] = off;
    whitening_[static_cast<size_t>(channel)].apply(seen_.time_s[block], rows, row);
    chi2_ += row[n] * row[n];
    return row[n];
  }

  // Times the fastest motion seen: no trial of parameters is worth more.
  static constexpr double runaway = 20.0;

  const Observation& seen_;
  double max_chi2_, max_rate_rad_s_, chi2_ = 0.0;
  inference::SumsOfRows sums_;
  Eigen::Matrix<double, channel_count, Eigen::Dynamic, Eigen::RowMajor> slope_;
  std::vector<int> scalars_;          // that were read
  const double* place_ = nullptr;     // place and velocity of the state that is compared
  std::vector<Whitening> whitening_;  // of each channel
  bool keep_;
  Prediction result_;
};

}  // namespace

Prediction predict(const Dynamics& dynamics, const PlatformState& initial, const Observation& seen,
                   const std::vector<Variable>& variables, const PredictionOptions& options) {
  const size_t blocks = std::min(options.blocks, seen.blocks());
  Comparison comparison(seen, variables.size(), options.keep_residuals, options.max_chi2);
  PropagationOptions propagation = options.propagation;
  // A trial of parameters that make the motion run away is not worth its steps.
  // What rubs and stops needs thousands in a short time.
  constexpr int64_t steps_at_least = 20000;
  constexpr double steps_per_second = 40.0;
  propagation.max_steps =
      steps_at_least +
      static_cast<int64_t>(steps_per_second * (seen.time_s[blocks - 1] - initial.time_s));
  Propagator propagator(dynamics, initial, seen.time_s[blocks - 1], propagation, variables);
  sample(
      propagator, blocks, [&](size_t i) { return seen.time_s[i]; },
      [&](const Samples& samples) {
        comparison.add(dynamics, variables.empty() ? nullptr : &*propagator.sensitivity(), samples);
      });
  return comparison.finish();
}

}  // namespace photorque

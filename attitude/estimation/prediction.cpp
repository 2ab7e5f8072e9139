#include "attitude/estimation/prediction.h"

#include <algorithm>
#include <cmath>

namespace photorque {
namespace {

Vec3 in_lane(const Vec3Of<Lanes>& v, int lane) {
  return {v[0][lane], v[1][lane], v[2][lane]};
}

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

  // The camera sees the attitude, its own misalignment, and all of it late.
  void fill(int lane, const PlatformState& state, Eigen::Matrix<double, 6, Eigen::Dynamic>& slope) {
    const Quat& q = state.lab_from_body;
    const Mat3 lab_from_body = q.toRotationMatrix();
    for (size_t v = 0; v < count_; ++v) {
      const auto by = [&](size_t c) { return samples_.derivatives[c * count_ + v][lane]; };
      const auto reading = [&](size_t r) { return readings_[r * count_ + v][lane]; };
      const Quat change(by(0), by(1), by(2), by(3));
      const Vec3 rotation_body = 2.0 * (q.conjugate() * change).vec() +
                                 Vec3(reading(3), reading(4), reading(5)) -
                                 reading(6) * state.rate_body_rad_s;
      const auto column = static_cast<Eigen::Index>(v);
      slope.col(column).head<3>() = lab_from_body * rotation_body;
      for (int k = 0; k < 3; ++k) slope(3 + k, column) = reading(static_cast<size_t>(k));
    }
  }

 private:
  size_t count_;
  const Samples& samples_;
  std::vector<Lanes> readings_;
};

class Comparison {
 public:
  Comparison(const Observation& seen, size_t variables, bool keep)
      : seen_(seen),
        sums_(static_cast<Eigen::Index>(variables)),
        slope_(6, static_cast<Eigen::Index>(variables)),
        keep_(keep) {
    slope_.setZero();
  }

  void add(const Dynamics& dynamics, const Sensitivity* sensitivity, const Samples& samples) {
    const Dynamics::Instants now = dynamics.at(samples.time_s, samples.held, samples.y.data());
    std::optional<Slopes> slopes;
    if (sensitivity != nullptr) slopes.emplace(*sensitivity, samples);
    std::vector<double> y(samples.y.size());
    for (int lane = 0; lane < samples.count; ++lane) {
      for (size_t c = 0; c < y.size(); ++c) y[c] = samples.y[c][lane];
      const PlatformState state = to_state(samples.time_s[lane], y);
      if (slopes) slopes->fill(lane, state, slope_);
      const Vec3 camera_offset_body =
          in_lane(now.camera_error_rad, lane) - now.camera_delay_s[lane] * state.rate_body_rad_s;
      add_block(samples.first + static_cast<size_t>(lane), state, camera_offset_body,
                in_lane(now.gyro_rad_s, lane));
    }
  }

  Prediction finish() {
    result_.sums = sums_.finish();
    return std::move(result_);
  }

 private:
  void add_block(size_t block, const PlatformState& state, const Vec3& camera_offset_body,
                 const Vec3& gyro_rad_s) {
    WhiteRow white = WhiteRow::Constant(NAN);
    if (seen_.attitude_rows[block] > 0.0) {
      const Vec3 off = rotation_vector(seen_.attitude[block] * state.lab_from_body.conjugate()) -
                       state.lab_from_body * camera_offset_body;
      const double root = std::sqrt(seen_.attitude_rows[block]);
      for (int k = 0; k < 3; ++k) put(k, off[k], root / seen_.noise.camera_rad[k], white);
    }
    for (int k = 0; k < 3; ++k) {
      const double rows = seen_.gyro_rows[block][k];
      if (!(rows > 0.0)) continue;
      put(3 + k, seen_.gyro_rad_s[block][k] - gyro_rad_s[k],
          std::sqrt(rows) / seen_.noise.gyro_rad_s[k], white);
    }
    if (!keep_) return;
    result_.residual.push_back(white);
    result_.states.push_back(state);
    result_.camera_offset_lab_rad.emplace_back(state.lab_from_body * camera_offset_body);
    result_.gyro_rad_s.push_back(gyro_rad_s);
  }

  void put(int reading, double off, double weight, WhiteRow& white) {
    white[reading] = off * weight;
    auto row = sums_.next();
    const Eigen::Index n = slope_.cols();
    row.head(n) = weight * slope_.row(reading);
    row[n] = white[reading];
  }

  const Observation& seen_;
  inference::SumsOfRows sums_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> slope_;
  bool keep_;
  Prediction result_;
};

}  // namespace

Prediction predict(const Dynamics& dynamics, const PlatformState& initial, const Observation& seen,
                   const std::vector<Variable>& variables, const PredictionOptions& options) {
  const size_t blocks = std::min(options.blocks, seen.blocks());
  Comparison comparison(seen, variables.size(), options.keep_residuals);
  PropagationOptions propagation = options.propagation;
  // A trial of parameters that make the motion run away is not worth its steps.
  constexpr double steps_per_second = 40.0;
  propagation.max_steps =
      2000 + static_cast<int64_t>(steps_per_second * (seen.time_s[blocks - 1] - initial.time_s));
  Propagator propagator(dynamics, initial, seen.time_s[blocks - 1], propagation, variables);
  sample(
      propagator, blocks, [&](size_t i) { return seen.time_s[i]; },
      [&](const Samples& samples) {
        comparison.add(dynamics, variables.empty() ? nullptr : &*propagator.sensitivity(), samples);
      });
  return comparison.finish();
}

}  // namespace photorque

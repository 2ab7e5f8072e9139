#include "attitude/filtering/kalman.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/numerics/linear.h"

namespace photorque {

double AttitudeEstimate::attitude_sigma_rad() const {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
}

double AttitudeEstimate::rate_sigma_rad_s() const {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

namespace {

// Inverse of `covariance` times `right`, computed with a unit diagonal. Directions without variance
// give zero.
MatX solved_by(const MatX& covariance, const MatX& right) {
  VecX scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (double& s : scale) s = s > 0.0 ? 1.0 / s : 0.0;
  MatX even = scale.asDiagonal() * covariance * scale.asDiagonal();
  for (Eigen::Index i = 0; i < even.rows(); ++i) {
    if (scale[i] == 0.0) even(i, i) = 1.0;
  }
  return scale.asDiagonal() * solve_symmetric(even, scale.asDiagonal() * right);
}

void update(const MotionModel& model, FilterState& state, const Measurement& read,
            InnovationSum& innovations, double& log_likelihood) {
  const MatX cross = state.covariance * read.derivative.transpose();
  const MatX innovation = read.derivative * cross + read.noise;
  const Eigen::LLT<MatX> factor(innovation);
  const VecX weighted = factor.solve(read.residual);
  const double chi2 = read.residual.dot(weighted);
  innovations.chi2 += chi2;
  innovations.numbers += static_cast<double>(read.residual.size());
  const VecX diagonal = MatX(factor.matrixL()).diagonal();
  log_likelihood -= 0.5 * chi2 + diagonal.array().log().sum() +
                    0.5 * static_cast<double>(read.residual.size()) * std::log(2.0 * pi);
  const MatX gain = factor.solve(cross.transpose()).transpose();
  const MatX rest =
      MatX::Identity(state.covariance.rows(), state.covariance.cols()) - gain * read.derivative;
  state.covariance =
      rest * state.covariance * rest.transpose() + gain * read.noise * gain.transpose();
  state.covariance = 0.5 * (state.covariance + state.covariance.transpose()).eval();
  model.add(state, gain * read.residual);
}

// If the prior of the rate is wide, the derivatives of the gyro reading with respect to its scale
// and the rate of the Earth are unknown before the update. The update is therefore iterated at its
// result (A. Jazwinski, Stochastic Processes and Filtering Theory, 1970, theorem 8.2). Otherwise
// the change of the derivative between the first two readings would be attributed to the scale.
void update_by_gyro(const MotionModel& model, FilterState& state, const Vec3& gyro_rad_s,
                    InnovationSum& innovations, double& log_likelihood) {
  const double sigma_rad_s =
      std::sqrt(state.covariance.block<3, 3>(MotionModel::rate, MotionModel::rate).trace());
  constexpr double known_rad_s = 1e-3;
  const int rounds = sigma_rad_s > known_rad_s ? 4 : 1;
  const FilterState before = state;
  FilterState at = state;
  for (int round = 1; round <= rounds; ++round) {
    Measurement read = model.of_gyro(at, gyro_rad_s);
    read.residual -= read.derivative * model.difference(before, at);
    state = before;
    InnovationSum sum = innovations;
    double likelihood = log_likelihood;
    update(model, state, read, sum, likelihood);
    at = state;
    if (round < rounds) continue;
    innovations = sum;
    log_likelihood = likelihood;
  }
}

AttitudeEstimate estimate_of(const MotionModel& model, const FilterState& state) {
  return {state.mean.time_s, state.mean.lab_from_body, state.mean.rate_body_rad_s,
          model.inertial_rate_rad_s(state), state.covariance.topLeftCorner<6, 6>()};
}

// Quantities of one reading that the smoother needs.
struct Passed {
  FilterState after;      // after the reading
  FilterState predicted;  // at this reading, before its update
  MatX phi;               // transition to this reading
  bool begins_anew = false;
};

class FilterRun {
 public:
  FilterRun(const MotionModel& model, const Readings& readings, const EstimationOptions& options)
      : model_(model), readings_(readings), options_(options) {
    last_ = std::min(options.max_readings, readings.all.size());
    for (first_ = 0; first_ < last_; ++first_) {
      if (readings.all[first_].lab_from_body) break;
    }
    if (first_ == last_) first_ = 0;
  }

  Estimation run() {
    out_.filtered.resize(readings_.rows);
    FilterState state = begin();
    std::vector<FilterState> checkpoints;
    for (size_t i = first_; i < last_; ++i) {
      if (options_.smooths && (i - first_) % checkpoint_rows == 0) checkpoints.push_back(state);
      pass(state, i, nullptr, true);
      put(out_.filtered, i, state);
      if (options_.progress && i % checkpoint_rows == 0) {
        const double part = static_cast<double>(i) / static_cast<double>(last_);
        options_.progress(options_.smooths ? 0.4 * part : part);
      }
    }
    fill_before_first(out_.filtered);
    out_.parameter_names = model_.parameter_names();
    out_.prior_mean = model_.prior_mean();
    out_.prior_sigma = model_.prior_sigma();
    out_.parameters = state.parameters;
    out_.sigma = state.covariance.diagonal().tail(state.parameters.size()).cwiseSqrt();
    if (options_.smooths) smooth(state, checkpoints);
    return std::move(out_);
  }

 private:
  static constexpr size_t checkpoint_rows = 256;

  FilterState begin() const {
    const Reading& first = readings_.all[first_];
    if (!first.lab_from_body) {
      return model_.start(first.time_s, Quat::Identity(), options_.unread_attitude_rad2);
    }
    const Quat attitude = *first.lab_from_body;
    // Wider than the noise of any camera: the first reading is an update like the others.
    constexpr double wide_rad = 0.05;
    return model_.start(first.time_s, attitude, Mat3::Identity() * wide_rad * wide_rad);
  }

  // Processes one reading. Its likelihood counts only if `counts`, in the first pass.
  void pass(FilterState& state, size_t i, Passed* passed, bool counts) {
    const Reading& reading = readings_.all[i];
    const FilterSettings& settings = model_.settings();
    const Transition way = model_.advance(state, reading.time_s, reading.gyro_rad_s);
    if (reading.begins_anew) model_.reset_after_kick(state);
    if (passed != nullptr) {
      passed->predicted = state;
      passed->phi = way.phi;
      passed->begins_anew = reading.begins_anew;
    }
    InnovationSum unused;
    double unused_likelihood = 0.0;
    double& likelihood = counts ? out_.log_likelihood : unused_likelihood;
    const auto sum = [&](InnovationSum& own) -> InnovationSum& { return counts ? own : unused; };
    if (reading.lab_from_body && i == first_) {
      // The first attitude initialises the state; it has no innovation.
      update(model_, state, model_.of_attitude(state, *reading.lab_from_body, readings_.sees_axis),
             unused, unused_likelihood);
    } else if (reading.lab_from_body && settings.uses_attitude) {
      update(model_, state, model_.of_attitude(state, *reading.lab_from_body, readings_.sees_axis),
             sum(out_.attitude), likelihood);
    }
    const bool drove =
        settings.motion == Motion::gyro_drives && reading.gyro_rad_s.allFinite() && i != first_;
    if (settings.uses_gyro && reading.has_gyro() && !drove) {
      // The first rate initialises the state too.
      update_by_gyro(model_, state, reading.gyro_rad_s, i == first_ ? unused : sum(out_.gyro),
                     i == first_ ? unused_likelihood : likelihood);
    }
    if (settings.uses_attitude && std::isfinite(reading.yaw_rad)) {
      update(model_, state, model_.of_yaw(state, reading.yaw_rad), sum(out_.yaw), likelihood);
    }
    if (passed != nullptr) passed->after = state;
  }

  void put(std::vector<AttitudeEstimate>& rows, size_t i, const FilterState& state) const {
    if (const auto row = readings_.all[i].row) rows[*row] = estimate_of(model_, state);
  }

  void fill_before_first(std::vector<AttitudeEstimate>& rows) const {
    const auto row = std::find_if(readings_.all.begin() + static_cast<std::ptrdiff_t>(first_),
                                  readings_.all.end(), [](const Reading& r) { return r.row; });
    for (size_t i = 0; row != readings_.all.end() && i < *row->row; ++i) rows[i] = rows[*row->row];
  }

  void smooth(FilterState later, const std::vector<FilterState>& checkpoints) {
    out_.smoothed.resize(readings_.rows);
    put(out_.smoothed, last_ - 1, later);
    // `later` is the smoothed estimate at the reading of `ahead`.
    std::optional<Passed> ahead;
    for (size_t c = checkpoints.size(); c-- > 0;) {
      const size_t from = first_ + c * checkpoint_rows,
                   to = std::min(last_, from + checkpoint_rows);
      std::vector<Passed> passed(to - from);
      FilterState state = checkpoints[c];
      for (size_t i = from; i < to; ++i) pass(state, i, &passed[i - from], false);
      for (size_t i = to; i-- > from;) {
        Passed& here = passed[i - from];
        if (ahead) later = smoothed_at(here.after, *ahead, later);
        put(out_.smoothed, i, later);
        ahead = std::move(here);
      }
      if (options_.progress) {
        options_.progress(1.0 - 0.6 * static_cast<double>(from) / static_cast<double>(last_));
      }
    }
    fill_before_first(out_.smoothed);
  }

  FilterState smoothed_at(const FilterState& here, const Passed& ahead,
                          const FilterState& later) const {
    // After a kick, readings determine only the parameters before it, and weakly. The estimate
    // before it remains that of the filter.
    if (ahead.begins_anew) return here;
    const MatX gain =
        solved_by(ahead.predicted.covariance, ahead.phi * here.covariance).transpose();
    FilterState smoothed = here;
    model_.add(smoothed, gain * model_.difference(later, ahead.predicted));
    smoothed.covariance =
        here.covariance + gain * (later.covariance - ahead.predicted.covariance) * gain.transpose();
    smoothed.covariance = 0.5 * (smoothed.covariance + smoothed.covariance.transpose()).eval();
    return smoothed;
  }

  const MotionModel& model_;
  const Readings& readings_;
  const EstimationOptions& options_;
  size_t first_ = 0, last_ = 0;
  Estimation out_;
};

}  // namespace

Estimation estimate_attitude(const MotionModel& model, const Readings& readings,
                             const EstimationOptions& options) {
  return FilterRun(model, readings, options).run();
}

double max_likelihood_rate_walk(const AttitudeModel& model, const Sensors& sensors,
                                FilterSettings settings, const Readings& readings,
                                size_t max_readings) {
  double best = 0.0, most = -std::numeric_limits<double>::infinity();
  EstimationOptions options;
  options.smooths = false;
  options.max_readings = max_readings;
  const auto look = [&](double walk, double min_gain) {
    settings.rate_walk_rad_s_rts = walk;
    const MotionModel motion(model, sensors, settings, readings.schedule);
    const double likelihood = estimate_attitude(motion, readings, options).log_likelihood;
    if (!std::isfinite(likelihood) || likelihood <= most + min_gain) return;
    most = likelihood;
    best = walk;
  };
  // A larger random walk is used only if it increases the log-likelihood by more than this.
  constexpr double min_gain = 0.5;
  constexpr int lowest = -28, highest = 4;
  for (int half = lowest; half <= highest; ++half) look(std::pow(10.0, 0.5 * half), min_gain);
  if (best == std::pow(10.0, 0.5 * lowest)) return best;
  for (const double exponent : {0.25, 0.125}) {
    const double middle = best;
    for (const double side : {-exponent, exponent}) look(middle * std::pow(10.0, side), 0.0);
  }
  return best;
}

}  // namespace photorque

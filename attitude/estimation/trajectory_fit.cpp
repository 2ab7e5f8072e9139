#include "attitude/estimation/trajectory_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace {

constexpr int initial_variables = 6;  // rotation and rate

// The inverse of normal equations. What they leave open, but for rounding, gets an error as large
// as rounding lets it be known, not the zero of a pivot that is left out.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& normal) {
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().unaryExpr(
      [](double root) { return root > 0.0 ? 1.0 / root : 1.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(scale.asDiagonal() * normal * scale.asDiagonal()));
  const double least = 1e-15 * static_cast<double>(normal.rows());
  const Eigen::MatrixXd half =
      scale.asDiagonal() * eigen.eigenvectors() *
      eigen.eigenvalues().cwiseMax(least).cwiseSqrt().cwiseInverse().asDiagonal();
  return half * half.transpose();
}

// The measured channels, NaN where there is nothing.
struct Measurements {
  const Recording& recording;
  std::array<const Channel*, 4> q{};
  std::array<const Channel*, 3> gyro{};
  bool has_gyro = false;

  explicit Measurements(const Recording& r) : recording(r) {
    const char* q_names[] = {"q_w", "q_x", "q_y", "q_z"};
    const char* gyro_names[] = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};
    for (size_t k = 0; k < 4; ++k) q[k] = r.find(q_names[k]);
    for (size_t k = 0; k < 3; ++k) gyro[k] = r.find(gyro_names[k]);
    if (std::find(q.begin(), q.end(), nullptr) != q.end()) {
      throw InputError({}, "recording", "no attitude", "the channels q_w, q_x, q_y, q_z");
    }
    has_gyro = std::find(gyro.begin(), gyro.end(), nullptr) == gyro.end();
  }

  Quat attitude(size_t row) const {
    return {q[0]->values[row], q[1]->values[row], q[2]->values[row], q[3]->values[row]};
  }
  Vec3 rate_rad_s(size_t row) const {
    return {gyro[0]->values[row], gyro[1]->values[row], gyro[2]->values[row]};
  }
};

bool is_complete(const Quat& q) {
  return std::isfinite(q.norm());
}

// The rotation vector of a quaternion that is close to unity.
template <class Quaternion>
Vec3 rotation_vector(const Quaternion& q) {
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec() / q.w();
  return 2.0 * std::atan2(sine, std::abs(q.w())) / sine * std::copysign(1.0, q.w()) * q.vec();
}

// Weighted squares of one pass over a window, ready to be solved.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double chi2 = 0.0;
  int64_t samples = 0;

  explicit NormalEquations(size_t variables)
      : matrix(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(variables),
                                     static_cast<Eigen::Index>(variables))),
        gradient(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(variables))) {}

  // One number: residual = measured − predicted, both over the noise.
  void add(double residual, const Eigen::VectorXd& slope) {
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(slope);
    gradient += residual * slope;
    chi2 += residual * residual;
    ++samples;
  }
};

class Fitter {
 public:
  Fitter(const AttitudeModel& model, const Sensors& sensors, const Recording& recording,
         const std::vector<FreeParameter>& parameters, const FitOptions& options)
      : measured_(recording),
        parameters_(parameters),
        options_(options),
        camera_noise_rad_(options.camera_noise_rad),
        gyro_noise_rad_s_(options.gyro_noise_rad_s) {
    if (sensors.camera && sensors.camera->noise_rad.minCoeff() > 0.0) {
      camera_noise_rad_ = sensors.camera->noise_rad;
    }
    if (sensors.gyro && sensors.gyro->noise_rad_s > 0.0) {
      gyro_noise_rad_s_ = sensors.gyro->noise_rad_s;
    }
    fit_.model = model;
    for (int i = 0; i < initial_variables; ++i) fit_.variables.push_back({i, 0, -1});
    for (const FreeParameter& free : parameters) {
      fit_.variables.push_back(Variable::of(free.disturbance, free.parameter));
      nominal_.push_back(model.disturbances[free.disturbance]
                             .parameters[static_cast<size_t>(free.parameter)]
                             .value);
    }
    start();
  }

  TrajectoryFit run() {
    const size_t rows = measured_.recording.rows() - first_row_;
    std::optional<NormalEquations> last;
    for (const double fraction : options_.windows) {
      const size_t count = std::max<size_t>(
          std::min<size_t>(rows, 20), static_cast<size_t>(fraction * static_cast<double>(rows)));
      last = fit_window(count);
    }
    fit_.samples = last->samples;
    fit_.chi2_per_sample = last->chi2 / static_cast<double>(std::max<int64_t>(1, last->samples));
    const Eigen::MatrixXd full = last->matrix.selfadjointView<Eigen::Lower>();
    fit_.covariance = covariance_of(full);
    if (!fit_.covariance.allFinite()) {
      throw NumericalError("the recording does not determine what is fitted");
    }
    return std::move(fit_);
  }

 private:
  void start() {
    const Recording& recording = measured_.recording;
    while (first_row_ < recording.rows() && !is_complete(measured_.attitude(first_row_))) {
      ++first_row_;
    }
    size_t next = first_row_ + 1;
    while (next < recording.rows() && !is_complete(measured_.attitude(next))) ++next;
    if (next >= recording.rows()) {
      throw InputError({}, "recording", "fewer than two attitudes", "a recording with attitudes");
    }
    const Quat q = measured_.attitude(first_row_).normalized();
    Vec3 rate = measured_.has_gyro ? measured_.rate_rad_s(first_row_) : Vec3(NAN, NAN, NAN);
    if (!rate.allFinite()) {
      rate = rotation_vector(q.conjugate() * measured_.attitude(next)) /
             (recording.time_s[next] - recording.time_s[first_row_]);
    }
    fit_.initial = Dynamics(fit_.model).initial_state(rate);
    fit_.initial.time_s = recording.time_s[first_row_];
    fit_.initial.lab_from_body = q;
  }

  NormalEquations fit_window(size_t rows) {
    double damping = 1e-6;
    NormalEquations now = evaluate(fit_.model, fit_.initial, rows, false);
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      Eigen::MatrixXd matrix = now.matrix.selfadjointView<Eigen::Lower>();
      matrix.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd step = matrix.ldlt().solve(now.gradient);
      if (!step.allFinite()) {
        throw NumericalError("the recording does not determine what is fitted");
      }
      AttitudeModel model = fit_.model;
      PlatformState initial = fit_.initial;
      apply(step, model, initial);
      NormalEquations tried = evaluate(model, initial, rows, false);
      if (!(tried.chi2 <= now.chi2 * (1.0 + 1e-12))) {
        damping = std::max(damping, 1e-8) * 10.0;
        if (damping > 1e12) break;
        continue;
      }
      const double gain = now.chi2 - tried.chi2;
      fit_.model = std::move(model);
      fit_.initial = std::move(initial);
      now = std::move(tried);
      damping *= 0.1;
      // A step far inside the error bars changes nothing that could be told.
      if (gain < 1e-3 && step.dot(now.matrix.selfadjointView<Eigen::Lower>() * step) < 1e-4) break;
    }
    return evaluate(fit_.model, fit_.initial, rows, true);
  }

  void apply(const Eigen::VectorXd& step, AttitudeModel& model, PlatformState& initial) const {
    const Vec3 rotation = step.head<3>(), rate = step.segment<3>(3);
    const double angle = rotation.norm();
    if (angle > 0.0) {
      initial.lab_from_body =
          (initial.lab_from_body * Quat(Eigen::AngleAxisd(angle, rotation / angle))).normalized();
    }
    initial.rate_body_rad_s += rate;
    size_t e = 0;
    for (const Disturbance& d : model.disturbances) {
      for (const ExtraState& state : d.states) initial.extra[e++] += state.per_body_rate.dot(rate);
    }
    for (size_t i = 0; i < parameters_.size(); ++i) {
      model.disturbances[parameters_[i].disturbance]
          .parameters[static_cast<size_t>(parameters_[i].parameter)]
          .value += step[static_cast<Eigen::Index>(initial_variables + i)];
    }
  }

  // One pass over the first rows of the recording. A trajectory that cannot be computed counts as
  // infinitely bad.
  NormalEquations evaluate(const AttitudeModel& model, const PlatformState& initial, size_t rows,
                           bool keep_residuals) {
    NormalEquations sums(fit_.variables.size());
    if (keep_residuals) {
      fit_.residual_time_s.clear();
      fit_.camera_residual_rad.clear();
    }
    const Dynamics dynamics(model);
    const std::vector<double>& times_s = measured_.recording.time_s;
    const auto time_s = [&](size_t i) { return times_s[first_row_ + i]; };
    try {
      Propagator propagator(dynamics, initial, time_s(rows - 1), options_.propagation,
                            fit_.variables);
      sample(propagator, rows, time_s, [&](const Samples& samples) {
        add_samples(*propagator.sensitivity(), samples, sums, keep_residuals);
      });
    } catch (const NumericalError&) {
      sums.chi2 = std::numeric_limits<double>::infinity();
    }
    for (size_t i = 0; i < parameters_.size(); ++i) {
      if (!parameters_[i].sigma) continue;
      const auto v = static_cast<Eigen::Index>(initial_variables + i);
      const double value = model.disturbances[parameters_[i].disturbance]
                               .parameters[static_cast<size_t>(parameters_[i].parameter)]
                               .value;
      const double off = (nominal_[i] - value) / *parameters_[i].sigma;
      sums.matrix(v, v) += 1.0 / (*parameters_[i].sigma * *parameters_[i].sigma);
      sums.gradient[v] += off / *parameters_[i].sigma;
      sums.chi2 += off * off;
    }
    return sums;
  }

  void add_samples(const Sensitivity& sensitivity, const Samples& samples, NormalEquations& sums,
                   bool keep_residuals) {
    const Dynamics& dynamics = sensitivity.dynamics();
    const size_t count = fit_.variables.size();
    const Dynamics::Instants now = dynamics.at(samples.time_s, samples.held, samples.y.data());
    std::vector<Lanes> readings(Dynamics::reading_count * count);
    sensitivity.readings(samples.time_s, samples.held, samples.y.data(), samples.derivatives.data(),
                         readings.data());
    Eigen::MatrixXd slope(6, static_cast<Eigen::Index>(count));
    std::vector<double> y(samples.y.size()), change(samples.y.size());
    for (int lane = 0; lane < samples.count; ++lane) {
      for (size_t c = 0; c < y.size(); ++c) y[c] = samples.y[c][lane];
      const PlatformState state = to_state(samples.time_s[lane], y);
      const auto in_lane = [&](const Vec3Of<Lanes>& v) {
        return Vec3(v[0][lane], v[1][lane], v[2][lane]);
      };
      for (size_t v = 0; v < count; ++v) {
        const auto column = static_cast<Eigen::Index>(v);
        for (size_t c = 0; c < y.size(); ++c) change[c] = samples.derivatives[c * count + v][lane];
        const std::vector<double> seen = tangent(y, change);
        const auto reading = [&](size_t r) { return readings[r * count + v][lane]; };
        // The camera sees the attitude, its own misalignment, and all of it late.
        const Vec3 rotation_body = Vec3(seen[0], seen[1], seen[2]) +
                                   Vec3(reading(3), reading(4), reading(5)) -
                                   reading(6) * state.rate_body_rad_s;
        slope.col(column).head<3>() = state.lab_from_body * rotation_body;
        for (int k = 0; k < 3; ++k) slope(3 + k, column) = reading(static_cast<size_t>(k));
      }
      const size_t row = first_row_ + samples.first + static_cast<size_t>(lane);
      const Vec3 offset_body =
          in_lane(now.camera_error_rad) - now.camera_delay_s[lane] * state.rate_body_rad_s;
      add_row(row, state, offset_body, in_lane(now.gyro_rad_s), slope, sums, keep_residuals);
    }
  }

  void add_row(size_t row, const PlatformState& state, const Vec3& camera_offset_body,
               const Vec3& gyro_rad_s, const Eigen::MatrixXd& slope, NormalEquations& sums,
               bool keep_residuals) {
    const Quat measured = measured_.attitude(row);
    if (is_complete(measured)) {
      const Vec3 residual = rotation_vector(measured * state.lab_from_body.conjugate()) -
                            state.lab_from_body * camera_offset_body;
      for (int k = 0; k < 3; ++k) {
        sums.add(residual[k] / camera_noise_rad_[k],
                 slope.row(k).transpose() / camera_noise_rad_[k]);
      }
      if (keep_residuals) {
        fit_.residual_time_s.push_back(state.time_s);
        fit_.camera_residual_rad.push_back(residual);
      }
    }
    if (!measured_.has_gyro) return;
    const Vec3 residual = measured_.rate_rad_s(row) - gyro_rad_s;
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(residual[k])) continue;
      sums.add(residual[k] / gyro_noise_rad_s_, slope.row(3 + k).transpose() / gyro_noise_rad_s_);
    }
  }

  Measurements measured_;
  std::vector<FreeParameter> parameters_;
  FitOptions options_;
  Vec3 camera_noise_rad_;
  double gyro_noise_rad_s_;
  std::vector<double> nominal_;
  size_t first_row_ = 0;
  TrajectoryFit fit_;
};

}  // namespace

TrajectoryFit fit_trajectory(const AttitudeModel& model, const Sensors& sensors,
                             const Recording& recording,
                             const std::vector<FreeParameter>& parameters,
                             const FitOptions& options) {
  return Fitter(model, sensors, recording, parameters, options).run();
}

}  // namespace photorque

#include "attitude/observation/camera_noise.h"

#include <algorithm>
#include <cmath>

#include "attitude/observation/prediction.h"
#include "core/numerics/simplex.h"

namespace photorque {

namespace {

// The effect of a correlated noise on one reading or on a mean. `reach`: factor of the process at
// the centre of the mean. `alone`: variance that the process at the centre does not explain.
struct Seen {
  double reach = 1.0, alone = 0.0;
};

Seen seen_by(double rows, double interval_s, double variance, double time_s) {
  if (!(variance > 0.0)) return {};
  const MeanOfCorrelated mean = mean_of_correlated(rows, interval_s / time_s);
  return {mean.reach, variance * (mean.variance - mean.reach * mean.reach)};
}

// Kalman filter with the states angle, rate, acceleration, the camera's correlated noise and, as a
// fifth state, the gyro's. All columns of states have the same covariance.
template <int States, int Columns>
class AngleFilter {
 public:
  using Vector = Eigen::Matrix<double, States, 1>;
  using Square = Eigen::Matrix<double, States, States>;
  using Row = Eigen::Matrix<double, 1, Columns>;

  AngleFilter(const AngleNoise& noise, double start_s, Eigen::Index columns)
      : noise_(noise), last_s_(start_s) {
    const double level2 = noise.camera.level * noise.camera.level;
    coloured_ = noise.camera.time_s > 0.0 ? noise.camera.coloured * level2 : 0.0;
    white_ = level2 - coloured_;
    if (States > 4) gyro_coloured_ = noise.gyro_coloured * noise.gyro_rad_s.squaredNorm() / 3.0;
    states_.setZero(States, columns);
    covariance_.setZero();
    covariance_.diagonal().template head<4>() << 1.0, 1.0, free_acceleration, coloured_;
    if (States > 4) covariance_(States - 1, States - 1) = gyro_coloured_;
    noise_step_.setZero();
    step_.setIdentity();
  }

  void advance(double to_s, bool jumps) {
    const double t = to_s - last_s_;
    last_s_ = to_s;
    if (t != step_s_) set_step(t);
    // The time of a change of the command within the interval is unknown.
    if (jumps) covariance_(2, 2) += free_acceleration;
    covariance_ = (step_ * covariance_ * step_.transpose() + noise_step_).eval();
    if (jumps) covariance_(2, 2) += free_acceleration;
    states_ = (step_ * states_).eval();
  }

  // read_angle() and read_rate() return the variance of the innovations, which replace `reading`.
  double read_angle(double rows, double interval_s, Row& reading) {
    const Seen seen = seen_by(rows, interval_s, coloured_, noise_.camera.time_s);
    Vector of = Vector::Zero();
    of[0] = 1.0;
    of[3] = seen.reach;
    return read(of, white_ / rows + seen.alone, reading);
  }
  // `variance`: the variance of the rate if all of the noise were white.
  double read_rate(double rows, double interval_s, double variance, Row& reading) {
    Vector of = Vector::Unit(1);
    if (States == 4) return read(of, variance, reading);
    const Seen seen = seen_by(rows, interval_s, gyro_coloured_, noise_.gyro_time_s);
    of[States - 1] = seen.reach;
    return read(of, (1.0 - noise_.gyro_coloured) * variance + seen.alone, reading);
  }

 private:
  // Prior variance of the unknown initial acceleration [rad²/s⁴].
  static constexpr double free_acceleration = 1.0;

  void set_step(double t) {
    step_s_ = t;
    const auto slow = [&](Eigen::Index state, double variance, double time_s) {
      const double decay = variance > 0.0 ? std::exp(-t / time_s) : 0.0;
      step_(state, state) = decay;
      noise_step_(state, state) = variance * (1.0 - decay * decay);
    };
    step_(0, 1) = step_(1, 2) = t;
    step_(0, 2) = 0.5 * t * t;
    const double q = noise_.roughness * t, a = t * t;
    noise_step_.template topLeftCorner<3, 3>() << q * a * a / 20.0, q * a * t / 8.0, q * a / 6.0,
        q * a * t / 8.0, q * a / 3.0, q * t / 2.0, q * a / 6.0, q * t / 2.0, q;
    slow(3, coloured_, noise_.camera.time_s);
    if (States > 4) slow(States - 1, gyro_coloured_, noise_.gyro_time_s);
  }

  double read(const Vector& of, double variance, Row& reading) {
    const Vector towards = covariance_ * of;
    const double total = std::max(of.dot(towards) + variance, 1e-6 * of.dot(towards) + 1e-300);
    reading -= of.transpose() * states_;
    const Vector gain = towards / total;
    states_ += gain * reading;
    covariance_ -= gain * towards.transpose();
    return total;
  }

  const AngleNoise& noise_;
  double last_s_, step_s_ = -1.0;
  double coloured_, white_, gyro_coloured_ = 0.0;
  Eigen::Matrix<double, States, Columns> states_;
  Square covariance_, step_, noise_step_;
};

// Calls use(innovations, variance) for every reading; `put` fills a row for a block.
template <int States, int Columns, typename Put, typename Use>
void filter_with(const KinematicSeries& s, const AngleNoise& noise, Eigen::Index columns, Put put,
                 Use use) {
  using Filter = AngleFilter<States, Columns>;
  Filter filter(noise, s.time_s.front(), columns);
  typename Filter::Row row(1, columns);
  const Vec3 gyro2 = noise.gyro_rad_s.cwiseAbs2();
  for (size_t i = 0; i < s.blocks(); ++i) {
    filter.advance(s.time_s[i], s.jumps[i] != 0);
    if (std::isfinite(s.angle_rad[i])) {
      put(i, true, row);
      const double variance = filter.read_angle(s.rows[i], s.interval_s, row);
      use(row, variance);
    }
    if (std::isfinite(s.rate_rad_s[i])) {
      put(i, false, row);
      const double variance =
          filter.read_rate(s.gyro_rows[i], s.gyro_interval_s, s.gyro_share[i].dot(gyro2), row);
      use(row, variance);
    }
  }
}

template <int Columns, typename Put, typename Use>
void filter_all(const KinematicSeries& s, const AngleNoise& noise, Eigen::Index columns, Put put,
                Use use) {
  if (noise.gyro_coloured > 0.0) {
    filter_with<5, Columns>(s, noise, columns, put, use);
  } else {
    filter_with<4, Columns>(s, noise, columns, put, use);
  }
}

}  // namespace

double minus_two_log_likelihood(const KinematicSeries& series, const AngleNoise& noise) {
  double sum = 0.0, product = 1.0;
  filter_all<1>(
      series, noise, 1,
      [&](size_t i, bool angle, auto& row) {
        row[0] = angle ? series.angle_rad[i] : series.rate_rad_s[i];
      },
      [&](const auto& row, double variance) {
        sum += row[0] * row[0] / variance;
        // One logarithm for many factors.
        product *= variance;
        if (product < 1e-200 || product > 1e200) {
          sum += std::log(product);
          product = 1.0;
        }
      });
  return sum + std::log(product);
}

void add_normal_equations(const KinematicSeries& series, const AngleNoise& noise,
                          Eigen::MatrixXd& matrix, Eigen::VectorXd& right) {
  const Eigen::Index columns = series.angle_by.cols();
  filter_all<Eigen::Dynamic>(
      series, noise, columns + 1,
      [&](size_t i, bool angle, auto& row) {
        const auto at = static_cast<Eigen::Index>(i);
        row.head(columns) = angle ? series.angle_by.row(at) : series.rate_by.row(at);
        row[columns] = angle ? series.angle_rad[i] : series.rate_rad_s[i];
      },
      [&](const auto& row, double variance) {
        matrix.noalias() += row.head(columns).transpose() * row.head(columns) / variance;
        right += row.head(columns).transpose() * (row[columns] / variance);
      });
}

namespace {

constexpr double tolerance = 0.1;  // of twice the logarithm of the likelihood
// Range of correlation times that is searched [s]. Longer ones are equivalent to a gyro drift.
constexpr double shortest_s = 0.02, longest_s = 12.0;

// ln(level / stated level), coloured fraction, ln(time), ln(roughness).
struct Point {
  double level = 0.0, coloured = 0.0, time = 0.0, roughness = 0.0;
};

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

class Search {
 public:
  Search(const std::vector<const KinematicSeries*>& runs, const ChannelNoise& stated,
         const AngleNoise& gyro, const Thresholds::Noise& limits)
      : runs_(runs), stated_(stated), gyro_(gyro), limits_(limits) {}

  CameraNoise run() {
    const auto plain = [&](const Eigen::VectorXd& x) { return of({x[0], 0.0, 0.0, x[1]}); };
    Minimum white{Eigen::Vector2d::Zero(), INFINITY};
    // Two rounds, because another level may need another roughness.
    for (int round = 0; round < 2; ++round) {
      const Eigen::Vector2d start(white.at[0], max_likelihood_roughness(white.at[0]));
      const Minimum next = simplex_minimum(plain, start, Eigen::Vector2d(0.2, 1.0), tolerance);
      if (next.value < white.value) white = next;
    }
    best_ = {white.at[0], 0.0, 0.0, white.at[1]};
    CameraNoise result;
    FoundNoise& found = result.found;
    found.noise = stated_;
    found.level_sigma = likelihood_errors(plain, white)[0];
    find_colour(white, found);
    found.level_found = is_off(best_.level, found.level_sigma, limits_);
    if (found.level_found) found.noise.level = std::exp(best_.level) * stated_.level;
    result.axis = noise_of(best_);
    result.value = of(best_);
    return result;
  }

 private:
  AngleNoise noise_of(const Point& p) const {
    AngleNoise noise = gyro_;
    noise.camera = {stated_.level * std::exp(p.level), p.coloured,
                    p.coloured > 0.0 ? std::exp(p.time) : 0.0};
    noise.roughness = std::exp(p.roughness);
    return noise;
  }

  double of(const Point& p) const {
    // Limits far beyond real instruments, for the search.
    if (std::abs(p.level) > 7.0 || p.roughness < -60.0 || p.roughness > 20.0) return INFINITY;
    const bool is_coloured = p.coloured > 0.0;
    if (is_coloured && (p.time < std::log(shortest_s) || p.time > std::log(longest_s))) {
      return INFINITY;
    }
    double sum = 0.0;
    for (const KinematicSeries* run : runs_) {
      if (is_coloured && p.time < std::log(run->shortest_correlation_s)) return INFINITY;
    }
    for (const KinematicSeries* run : runs_) sum += minus_two_log_likelihood(*run, noise_of(p));
    return std::isfinite(sum) ? sum : INFINITY;
  }

  // The likelihood may have several maxima in the roughness.
  double max_likelihood_roughness(double level) const {
    double best = 0.0, least = INFINITY;
    for (double roughness = -44.0; roughness <= 4.0; roughness += 3.0) {
      const double value = of({level, 0.0, 0.0, roughness});
      if (value < least) {
        least = value;
        best = roughness;
      }
    }
    return best;
  }

  void find_colour(const Minimum& white, FoundNoise& found) {
    const auto coloured = [&](const Eigen::VectorXd& x) { return of({x[0], 1.0, x[1], x[2]}); };
    Minimum start{Eigen::VectorXd(), INFINITY};
    for (const double time_s : {0.2, 0.7, 2.5}) {
      for (const double roughness : {white.at[1], white.at[1] - 6.0}) {
        const Eigen::Vector3d at(0.0, std::log(time_s), roughness);
        const double value = coloured(at);
        if (value < start.value) start = {at, value};
      }
    }
    if (!std::isfinite(start.value)) return;
    const Minimum best =
        simplex_minimum(coloured, start.at, Eigen::Vector3d(0.2, 0.4, 1.5), tolerance);
    found.gain = white.value - best.value;
    if (found.gain < limits_.min_colour_gain) return;
    found.colour_found = true;
    best_ = {best.at[0], 1.0, best.at[1], best.at[2]};
    const Eigen::VectorXd sigma = likelihood_errors(coloured, best);
    found.level_sigma = sigma[0];
    double time_sigma = sigma[1];
    find_white_part(best, time_sigma, found);
    // A level that agrees with the stated one is fixed, which determines the time much better. It
    // is also fixed if a curve through the attitudes may have absorbed part of the slow noise.
    const bool may_hide =
        best_.level < 0.0 &&
        std::any_of(runs_.begin(), runs_.end(), [](auto* run) { return run->about_readings; });
    if (may_hide || !is_off(best_.level, found.level_sigma, limits_)) {
      const auto at_stated = [&](const Eigen::VectorXd& x) {
        return of({0.0, best_.coloured, x[0], x[1]});
      };
      const Minimum held = simplex_minimum(at_stated, Eigen::Vector2d(best_.time, best_.roughness),
                                           Eigen::Vector2d(0.2, 0.5), tolerance);
      time_sigma = likelihood_errors(at_stated, held)[0];
      best_ = {0.0, best_.coloured, held.at[0], held.at[1]};
    }
    found.noise.coloured = best_.coloured;
    found.noise.time_s = std::exp(best_.time);
    found.time_sigma_s = found.noise.time_s * time_sigma;
  }

  void find_white_part(const Minimum& pure, double& time_sigma, FoundNoise& found) {
    const auto mixed = [&](const Eigen::VectorXd& x) {
      return of({x[0], sigmoid(x[3]), x[1], x[2]});
    };
    const Eigen::Vector4d start(pure.at[0], pure.at[1], pure.at[2], 1.5);
    const Minimum best =
        simplex_minimum(mixed, start, Eigen::Vector4d(0.1, 0.3, 0.7, 1.5), tolerance);
    if (pure.value - best.value < limits_.min_mixture_gain) return;
    best_ = {best.at[0], sigmoid(best.at[3]), best.at[1], best.at[2]};
    const Eigen::VectorXd sigma = likelihood_errors(mixed, best);
    found.level_sigma = sigma[0];
    time_sigma = sigma[1];
  }

  const std::vector<const KinematicSeries*>& runs_;
  ChannelNoise stated_;
  AngleNoise gyro_;
  const Thresholds::Noise& limits_;
  Point best_;
};

}  // namespace

CameraNoise camera_noise(const std::vector<const KinematicSeries*>& runs,
                         const ChannelNoise& stated, const AngleNoise& gyro,
                         const Thresholds::Noise& limits) {
  return Search(runs, stated, gyro, limits).run();
}

bool is_off(double log_factor, double sigma, const Thresholds::Noise& limits) {
  const double allowed =
      std::max(std::log1p(limits.min_correction), limits.correction_sigma * sigma);
  return std::abs(log_factor) > allowed;
}

}  // namespace photorque

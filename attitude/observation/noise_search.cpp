#include "attitude/observation/noise_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "attitude/observation/noise_levels.h"
#include "core/numerics/simplex.h"

namespace photorque {

namespace {

class NoiseSearch {
 public:
  NoiseSearch(const std::vector<Observation>& runs, const std::vector<Prediction>& about,
              const Thresholds::Noise& limits)
      : runs_(runs), limits_(limits), stated_(runs.front().noise) {
    for (size_t run = 0; run < runs.size(); ++run) {
      left_.push_back(kinematic_run(runs[run], about.empty() ? nullptr : &about[run]));
      has_gyro_ = has_gyro_ || runs[run].has_gyro;
    }
    for (int channel = 0; channel < 6; ++channel) {
      result_.channel[static_cast<size_t>(channel)].noise = stated_.of(channel);
    }
  }

  NoiseFindings run() {
    // Relative to a curve through the attitudes, noise is not distinguishable from a fast motion.
    result_.is_open = std::any_of(left_.begin(), left_.end(),
                                  [](const KinematicRun& run) { return run.about_readings; });
    if (result_.is_open) return result_;
    gyro_.gyro_rad_s = stated_.levels(3);
    for (int k = 0; k < 3; ++k) find_gyro_level(k);
    if (has_gyro_) {
      // First with a roughness that allows any torque.
      constexpr double any_roughness = 1e-2;
      for (size_t k = 0; k < 3; ++k) {
        axes_[k].axis = gyro_;
        axes_[k].axis.camera = stated_.of(static_cast<int>(k));
        axes_[k].axis.roughness = any_roughness;
      }
      remove_instruments();
    }
    find_cameras();
    if (has_gyro_) {
      find_gyro_colour();
      remove_instruments();
      if (any_colour()) find_cameras();
    }
    for (size_t k = 0; k < 3; ++k) result_.channel[k] = axes_[k].found;
    return result_;
  }

 private:
  bool any_colour() const {
    return gyro_.gyro_coloured > 0.0 ||
           std::any_of(axes_.begin(), axes_.end(),
                       [](const CameraNoise& axis) { return axis.found.colour_found; });
  }

  void find_gyro_level(int k) {
    FoundNoise& found = result_.channel[3 + static_cast<size_t>(k)];
    const std::optional<NoiseLevel> level = gyro_level(runs_, left_, k, limits_);
    if (!level) return;
    found.level_sigma = level->log_sigma;
    found.level_found =
        is_off(std::log(level->level / found.noise.level), level->log_sigma, limits_);
    if (found.level_found) found.noise.level = gyro_.gyro_rad_s[k] = level->level;
  }

  std::vector<const KinematicSeries*> axis_of_all(size_t k) const {
    std::vector<const KinematicSeries*> all;
    for (const KinematicRun& run : left_) all.push_back(&run.axis[k]);
    return all;
  }

  void find_cameras() {
    for (size_t k = 0; k < 3; ++k) {
      axes_[k] = camera_noise(axis_of_all(k), stated_.of(static_cast<int>(k)), gyro_, limits_);
    }
  }

  // Searches for correlated noise of the gyro, with a common time and fraction for all axes. It is
  // tried in addition to that of the camera, and instead of it.
  void find_gyro_colour() {
    double now = 0.0;
    std::array<AngleNoise, 3> as_found, camera_alone;
    for (size_t k = 0; k < 3; ++k) {
      now += axes_[k].value;
      as_found[k] = camera_alone[k] = axes_[k].axis;
      camera_alone[k].camera = stated_.of(static_cast<int>(k));
    }
    const double wanted = now - limits_.min_colour_gain;
    Minimum best{{}, wanted};
    const std::array<AngleNoise, 3>* beside = nullptr;
    const auto try_beside = [&](const std::array<AngleNoise, 3>& cameras) {
      const Minimum next = max_likelihood_gyro(cameras);
      if (!(next.value < best.value)) return;
      best = next;
      beside = &cameras;
    };
    try_beside(as_found);
    if (any_colour()) try_beside(camera_alone);
    if (beside == nullptr) return;
    best = at_stated_level(with_white_part(best, *beside), *beside);
    // A lower level with a correlated part may fit better than the stated level with one.
    if (!(best.value < wanted)) return;
    use_gyro(best);
    find_cameras();
  }

  // If the level agrees with the stated one, fixes it and fits the other parameters.
  Minimum at_stated_level(const Minimum& free, const std::array<AngleNoise, 3>& cameras) const {
    if (is_off(free.at[0], gyro_log_sigma, limits_)) return free;
    const auto whole = [](const Eigen::VectorXd& rest) {
      Eigen::VectorXd x(rest.size() + 1);
      x << 0.0, rest;
      return x;
    };
    const auto of = [&](const Eigen::VectorXd& rest) { return of_gyro(cameras, whole(rest)); };
    const Eigen::VectorXd start = free.at.tail(free.at.size() - 1);
    Eigen::VectorXd steps(start.size());
    steps.head(2) << 0.3, 0.7;
    if (steps.size() > 2) steps[2] = 1.5;
    const Minimum held = simplex_minimum(of, start, steps, 0.3, 200);
    return {whole(held.at), held.value};
  }

  // Minus twice the logarithm of the likelihood of all axes. `x`: ln(level / stated level),
  // ln(time), ln(roughness / present roughness) and, as an optional fourth, the logit of the
  // coloured fraction, which is else one.
  double of_gyro(const std::array<AngleNoise, 3>& cameras, const Eigen::VectorXd& x) const {
    // Correlations of neighbours below one third hardly change the levels and resemble roughness.
    double shortest_s = 0.05;
    constexpr double longest_s = 12.0;
    for (const KinematicRun& run : left_) {
      shortest_s =
          std::max({shortest_s, run.axis[0].gyro_interval_s, run.axis[0].shortest_correlation_s});
    }
    if (x[1] < std::log(shortest_s) || x[1] > std::log(longest_s)) return INFINITY;
    if (std::abs(x[0]) > 5.0 || std::abs(x[2]) > 40.0) return INFINITY;
    double sum = 0.0;
    for (size_t k = 0; k < 3; ++k) {
      AngleNoise noise = cameras[k];
      noise.gyro_rad_s = std::exp(x[0]) * stated_.levels(3);
      noise.gyro_coloured = coloured_fraction(x);
      noise.gyro_time_s = std::exp(x[1]);
      noise.roughness *= std::exp(x[2]);
      for (const KinematicSeries* run : axis_of_all(k)) {
        sum += minus_two_log_likelihood(*run, noise);
      }
    }
    return std::isfinite(sum) ? sum : INFINITY;
  }

  static double coloured_fraction(const Eigen::VectorXd& x) {
    return x.size() > 3 ? 1.0 / (1.0 + std::exp(-x[3])) : 1.0;
  }

  // Lower limit of the errors, due to the steps of the search and the number of readings.
  static constexpr double gyro_log_sigma = 0.05;

  // A gyro with coarse steps has a white part in addition to a correlated one.
  Minimum with_white_part(const Minimum& pure, const std::array<AngleNoise, 3>& cameras) const {
    const auto of = [&](const Eigen::VectorXd& x) { return of_gyro(cameras, x); };
    const Eigen::Vector4d start(pure.at[0], pure.at[1], pure.at[2], 1.5);
    const Minimum mixed = simplex_minimum(of, start, Eigen::Vector4d(0.1, 0.5, 0.7, 1.5), 0.3, 200);
    return pure.value - mixed.value < limits_.min_mixture_gain ? pure : mixed;
  }

  Minimum max_likelihood_gyro(const std::array<AngleNoise, 3>& cameras) const {
    const auto of = [&](const Eigen::VectorXd& x) { return of_gyro(cameras, x); };
    Minimum start{Eigen::Vector3d::Zero(), INFINITY};
    for (const double time_s : {0.2, 0.8, 3.0}) {
      for (const double rougher : {0.0, -6.0, -14.0}) {
        const Eigen::Vector3d at(0.0, std::log(time_s), rougher);
        const double value = of(at);
        if (value < start.value) start = {at, value};
      }
    }
    if (!std::isfinite(start.value)) return start;
    return simplex_minimum(of, start.at, Eigen::Vector3d(0.2, 0.4, 2.0), 0.3, 120);
  }

  void use_gyro(const Minimum& best) {
    const double factor = std::exp(best.at[0]);
    const bool off = is_off(best.at[0], gyro_log_sigma, limits_);
    gyro_.gyro_rad_s = (off ? factor : 1.0) * stated_.levels(3);
    gyro_.gyro_coloured = coloured_fraction(best.at);
    gyro_.gyro_time_s = std::exp(best.at[1]);
    for (int k = 0; k < 3; ++k) {
      FoundNoise& found = result_.channel[3 + static_cast<size_t>(k)];
      found.level_found = off;
      found.level_sigma = gyro_log_sigma;
      found.colour_found = true;
      found.noise = {gyro_.gyro_rad_s[k], gyro_.gyro_coloured, gyro_.gyro_time_s};
      found.time_sigma_s = gyro_log_sigma * gyro_.gyro_time_s;
    }
  }

  // Fits the contributions of instrument errors with the noise of each axis, and removes them.
  void remove_instruments() {
    double weight = 0.0, sum = 0.0;
    const Eigen::VectorXd prior = instrument_widths().cwiseAbs2().cwiseInverse();
    for (KinematicRun& run : left_) {
      const Eigen::Index columns = run.axis[0].angle_by.cols();
      if (columns == 0) continue;
      Eigen::MatrixXd matrix = prior.asDiagonal();
      Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
      for (size_t k = 0; k < 3; ++k) {
        add_normal_equations(run.axis[k], axes_[k].axis, matrix, right);
      }
      const auto solver = matrix.ldlt();
      const Eigen::VectorXd wrong = solver.solve(right);
      const double variance =
          solver.solve(Eigen::VectorXd::Unit(columns, clock_drift_column))[clock_drift_column];
      if (!wrong.allFinite()) continue;
      if (variance > 0.0) {
        weight += 1.0 / variance;
        sum += wrong[clock_drift_column] / variance;
      }
      for (KinematicSeries& axis : run.axis) {
        const Eigen::VectorXd angle = axis.angle_by * wrong, rate = axis.rate_by * wrong;
        for (size_t i = 0; i < axis.blocks(); ++i) {
          axis.angle_rad[i] -= angle[static_cast<Eigen::Index>(i)];
          axis.rate_rad_s[i] -= rate[static_cast<Eigen::Index>(i)];
        }
      }
    }
    if (!(weight > 0.0)) return;
    const double before = result_.drift ? result_.drift->rate : 0.0;
    result_.drift = {before + sum / weight, 1.0 / std::sqrt(weight)};
  }

  const std::vector<Observation>& runs_;
  const Thresholds::Noise& limits_;
  const NoiseLevels stated_;
  std::vector<KinematicRun> left_;
  bool has_gyro_ = false;
  AngleNoise gyro_;  // only the gyro's part
  std::array<CameraNoise, 3> axes_;
  NoiseFindings result_;
};

}  // namespace

NoiseFindings find_noise(const std::vector<Observation>& runs, const std::vector<Prediction>& about,
                         const Thresholds::Noise& limits) {
  return NoiseSearch(runs, about, limits).run();
}

}  // namespace photorque

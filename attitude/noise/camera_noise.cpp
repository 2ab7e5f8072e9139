#include "attitude/noise/camera_noise.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/simplex.h"

namespace photorque {
namespace {

constexpr double tolerance = 0.1;  // of twice the logarithm of the likelihood
// Correlation times that are looked for [s]. Longer ones cannot be told from a gyro that drifts.
constexpr double shortest_s = 0.02, longest_s = 12.0;

// ln(level over the stated), coloured fraction, ln(time), ln(roughness).
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
    // Twice, because another level may want another roughness.
    for (int round = 0; round < 2; ++round) {
      const Eigen::Vector2d start(white.at[0], likeliest_roughness(white.at[0]));
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
    // Far beyond what instruments do; the search is to stay inside.
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
  double likeliest_roughness(double level) const {
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
    // A level as stated is taken as known: the time then is much better determined. So it is where
    // a curve through the attitudes may have taken up part of the slow noise.
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

// Whether 95 % intervals hold the truth 95 % of the time, for everything that a run reports.
//
// Parallel light of Gaussian profile falls on a tilted rectangle that sees part of it. Every truth
// is a closed form: power between two lines is a difference of error functions, its first moment a
// difference of Gaussians.
#include <gtest/gtest.h>

#include "core/product.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

constexpr double beam_power_W = 2.0;
constexpr double beam_radius_m = 0.1;  // where the irradiance is 1/e² of its maximum
constexpr double shadow_x_low = -0.083, shadow_x_high = 0.121, shadow_y_low = -0.057,
                 shadow_y_high = 0.094;  // of the shadow
constexpr double plate_slope = 0.7,
                 plate_height_m = 0.2;  // z of the rectangle over x, and at x = 0
constexpr int shadow_columns = 4, shadow_rows = 3;

class GaussianParallelBeam final : public Emitter {
 public:
  double power_W() const override { return beam_power_W; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    for (int i = 0; i < ray_block; ++i) {
      const double u = sobol_fraction(samples.bits[0][i]), v = sobol_fraction(samples.bits[1][i]);
      const double radius = beam_radius_m * std::sqrt(-0.5 * std::log(u));
      fixtures::set_ray(rays, i,
                        {radius * std::cos(2 * pi * v), radius * std::sin(2 * pi * v), 0.0},
                        Vec3::UnitZ());
    }
  }
  double relative_intensity(double angle_rad) const override { return angle_rad == 0.0 ? 1 : 0; }
};

// Power on the rectangle in shadow_columns by shadow_rows, seen from above.
class ShadowBins final : public Receiver {
 public:
  size_t bins() const override { return shadow_columns * shadow_rows; }
  void score(const Hits& hits, std::span<double> sums) const override {
    for (int i = 0; i < hits.count; ++i) {
      const double x = (hits.position_m[0][i] - shadow_x_low) / (shadow_x_high - shadow_x_low);
      const double y = (hits.position_m[1][i] - shadow_y_low) / (shadow_y_high - shadow_y_low);
      const auto column = static_cast<size_t>(std::clamp(x, 0.0, 0.999999) * shadow_columns);
      const auto row = static_cast<size_t>(std::clamp(y, 0.0, 0.999999) * shadow_rows);
      sums[row * shadow_columns + column] += hits.incident_W[0][i];
    }
  }
  Product product(const BinSums&) const override { return {}; }
};

// Fractions of the beam between two lines, and their first moment about the axis: marginals of the
// beam are Gaussian with standard deviation w/2.
double fraction(double low, double high) {
  const double unit = beam_radius_m / std::sqrt(2.0);
  return 0.5 * (std::erf(high / unit) - std::erf(low / unit));
}
double moment_m(double low, double high) {
  const double sigma = 0.5 * beam_radius_m;
  const auto density = [&](double x) {
    return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(2 * pi));
  };
  return sigma * sigma * (density(low) - density(high));
}

Scene tilted_rectangle(const OpticalSurface& surface) {
  const Vec3 centre(0.5 * (shadow_x_low + shadow_x_high), 0.5 * (shadow_y_low + shadow_y_high),
                    plate_height_m + plate_slope * 0.5 * (shadow_x_low + shadow_x_high));
  return fixtures::scene_of_part(
      fixtures::rectangle(centre, (shadow_x_high - shadow_x_low) * Vec3(1, 0, plate_slope),
                          Vec3(0, shadow_y_high - shadow_y_low, 0)),
      surface, "rectangle");
}

// Power, force along x and z (along y there is none), torque, bins; where a fraction `s` is
// mirrored, `d` scattered by Lambert's law and the rest absorbed.
std::vector<double> exact_figures(double s, double d) {
  const double power_W =
      beam_power_W * fraction(shadow_x_low, shadow_x_high) * fraction(shadow_y_low, shadow_y_high);
  const Vec3 light = -Vec3::UnitZ(), normal = Vec3(-plate_slope, 0, 1).normalized();
  const Vec3 mirrored = light - 2 * light.dot(normal) * normal;
  const Vec3 push = (light - s * mirrored - d * 2 / 3 * normal) / speed_of_light_m_s;
  const Vec3 moment_W_m =
      beam_power_W *
          Vec3(moment_m(shadow_x_low, shadow_x_high) * fraction(shadow_y_low, shadow_y_high),
               fraction(shadow_x_low, shadow_x_high) * moment_m(shadow_y_low, shadow_y_high),
               plate_slope * moment_m(shadow_x_low, shadow_x_high) *
                   fraction(shadow_y_low, shadow_y_high)) +
      Vec3(0, 0, plate_height_m * power_W);
  const Vec3 torque = moment_W_m.cross(push);
  std::vector<double> exact = {power_W,    power_W * push.x(), power_W * push.z(),
                               torque.x(), torque.y(),         torque.z()};
  for (int row = 0; row < shadow_rows; ++row) {
    for (int column = 0; column < shadow_columns; ++column) {
      const double dx = (shadow_x_high - shadow_x_low) / shadow_columns,
                   dy = (shadow_y_high - shadow_y_low) / shadow_rows;
      exact.push_back(beam_power_W *
                      fraction(shadow_x_low + column * dx, shadow_x_low + (column + 1) * dx) *
                      fraction(shadow_y_low + row * dy, shadow_y_low + (row + 1) * dy));
    }
  }
  return exact;
}

std::vector<Estimate> estimated_figures(const TraceResult& result) {
  const BinSums &wrench = result.sums[0], &bins = result.sums[1];
  std::vector<Estimate> all = {bins.estimate([](std::span<const double> each) {
                                 double sum = 0.0;
                                 for (const double bin : each) sum += bin;
                                 return sum;
                               }),
                               wrench.estimate(0),
                               wrench.estimate(2),
                               wrench.estimate(3),
                               wrench.estimate(4),
                               wrench.estimate(5)};
  for (size_t bin = 0; bin < shadow_columns * shadow_rows; ++bin) all.push_back(bins.estimate(bin));
  return all;
}

// The fractions of 1000 seeds whose intervals hold the truth, figure by figure.
struct Coverage {
  std::vector<double> held;
  std::vector<double> held_by_less;  // with standard errors a fifth smaller than they are
};

// Two-sided 97.5 % quantile of Student's t with seven degrees of freedom.
// Source: M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, table 26.10.
constexpr int replicates = 8;
constexpr double student_t_975 = 2.365;

Coverage coverage_of_seeds() {
  constexpr int seeds = 1000;
  constexpr double specular = 0.3, diffuse = 0.2;
  const TraceableScene scene(tilted_rectangle(grey_surface("s", specular, diffuse)));
  const Beam beam =
      fixtures::beam(std::make_shared<GaussianParallelBeam>(), Vec3(0, 0, 3), -Vec3::UnitZ());
  const std::vector<double> exact = exact_figures(specular, diffuse);
  const fixtures::TotalWrench wrench;
  const ShadowBins bins;
  const Receiver* const receivers[] = {&wrench, &bins};
  Coverage coverage{std::vector<double>(exact.size()), std::vector<double>(exact.size())};
  for (int seed = 0; seed < seeds; ++seed) {
    const std::vector<Estimate> found =
        estimated_figures(trace(scene, {}, std::span(&beam, 1), receivers,
                                {.rays = replicates * 1024,
                                 .replicates = replicates,
                                 .seed = 1000 + static_cast<uint64_t>(seed),
                                 .threads = 1}));
    for (size_t i = 0; i < exact.size(); ++i) {
      const double error = std::abs(found[i].value - exact[i]);
      const double reach = student_t_975 * found[i].standard_error;
      coverage.held[i] += (error <= reach) / static_cast<double>(seeds);
      coverage.held_by_less[i] += (error <= 0.8 * reach) / static_cast<double>(seeds);
    }
  }
  return coverage;
}

constexpr const char* figure_names[] = {"power",    "force x",  "force z",
                                        "torque x", "torque y", "torque z"};

// 1000 seeds resolve a fraction of 95 % to 0.7 %, and errors that are a fifth too small are found
// out.
TEST(Coverage, IntervalsHoldPowerForceTorqueAndBinsNinetyFivePercentOfTheTime) {
  const Coverage coverage = coverage_of_seeds();
  double in_bins = 0.0;
  for (size_t i = 0; i < coverage.held.size(); ++i) {
    const bool is_bin = i >= std::size(figure_names);
    const std::string name = is_bin ? "bin " + std::to_string(i) : figure_names[i];
    EXPECT_NEAR(coverage.held[i], 0.95, is_bin ? 0.025 : 0.015) << name;
    EXPECT_LT(coverage.held_by_less[i], 0.935) << name;
    if (is_bin) in_bins += coverage.held[i] / (shadow_columns * shadow_rows);
  }
  EXPECT_NEAR(in_bins, 0.95, 0.015);
}

}  // namespace
}  // namespace photorque

// Sun shapes against closed forms and the numbers of Buie's law.
#include <gmock/gmock.h>

#include <cmath>

#include "core/constants.h"
#include "sampling.h"
#include "sources/profiles/beam_shape.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using test::make_beams;
using test::numbers_node;
using test::vector_node;

constexpr double mrad = 1e-3;

Beam sun_of(SettingsNode::Table shape) {
  shape["direction"] = vector_node(0, 0, -1);
  shape["irradiance_W_m2"] = {1000.0};
  return make_beams("sun", std::move(shape)).at(0);
}
Beam gaussian(double sigma_mrad) {
  return sun_of({{"sun_shape", {"gaussian"}}, {"sun_shape_sigma_mrad", {sigma_mrad}}});
}
Beam buie(double ratio) {
  return sun_of({{"sun_shape", {"buie"}}, {"circumsolar_ratio", {ratio}}});
}
Beam pillbox(double radius_deg) {
  return sun_of({{"angular_radius_deg", {radius_deg}}});
}
Beam table() {
  return sun_of({{"sun_shape", {"table"}},
                 {"sun_shape_angle_mrad", numbers_node({0, 3, 5, 5.5, 20})},
                 {"sun_shape_radiance", numbers_node({50, 40, 20, 0, 1})}});
}

// χ² of random rays over 32 rings that should hold the same light; `within` is the fraction of the
// light within an angle in mrad.
template <typename Within>
double rings_chi2(const Beam& beam, const Within& within) {
  constexpr uint64_t blocks = 1 << 11, classes = 32;
  std::array<double, classes> counted{};
  for (uint64_t block = 0; block < blocks; ++block) {
    SampleBlock samples;
    RayBlock rays;
    for (size_t d = 0; d < samples.bits.size(); ++d) {
      for (size_t i = 0; i < ray_block; ++i) {
        samples.bits[d][i] = static_cast<uint32_t>(hash_words(block * ray_block + i, d + 1));
      }
    }
    beam.emitter->emit(samples, rays);
    for (size_t i = 0; i < ray_block; ++i) {
      const double angle = std::asin(std::hypot(rays.direction[0][i], rays.direction[1][i]));
      const auto ring = static_cast<uint64_t>(classes * within(angle / mrad));
      counted[std::min(ring, classes - 1)] += 1.0;
    }
  }
  double chi2 = 0.0;
  for (const double count : counted) {
    const double expected = static_cast<double>(blocks * ray_block) / classes;
    chi2 += (count - expected) * (count - expected) / expected;
  }
  return chi2;
}

// 31 degrees of freedom: 99.99 % are below 69.1.
constexpr double most_chi2 = 69.1;

// ∫ radiance θ dθ in steps of 1 µrad, by midpoints: angles here are their own sines to 1e-5.
template <typename Radiance>
std::vector<double> encircled(const Radiance& radiance, double end) {
  std::vector<double> sum = {0.0};
  for (double at = 0.0005; at < end; at += 0.001) sum.push_back(sum.back() + radiance(at) * at);
  return sum;
}
double fraction_in(const std::vector<double>& sum, double angle) {
  const double place = std::min(angle / 0.001, static_cast<double>(sum.size() - 1) - 1e-9);
  const auto i = static_cast<size_t>(place);
  const double t = place - static_cast<double>(i);
  return ((1 - t) * sum[i] + t * sum[i + 1]) / sum.back();
}

// The law as the paper prints it, with a given χ.
double buie_radiance(double chi, double angle) {
  if (angle <= 4.65) return std::cos(0.326 * angle) / std::cos(0.308 * angle);
  const double kappa = 0.9 * std::log(13.5 * chi) * std::pow(chi, -0.3);
  const double gamma = 2.2 * std::log(0.52 * chi) * std::pow(chi, 0.43) - 0.1;
  return std::exp(kappa) * std::pow(angle, gamma);
}

TEST(SunShape, RaysFollowTheClosedForms) {
  const auto even = [](double angle) { return angle * angle / (4.65 * 4.65); };
  EXPECT_LT(rings_chi2(pillbox(4.65 * mrad / deg), even), most_chi2);
  EXPECT_GT(rings_chi2(pillbox(4.70 * mrad / deg), even), most_chi2);
  const auto normal = [](double angle) { return -std::expm1(-angle * angle / (2 * 4.0 * 4.0)); };
  EXPECT_LT(rings_chi2(gaussian(4.0), normal), most_chi2);
  EXPECT_GT(rings_chi2(gaussian(4.04), normal), most_chi2);
  // The table by parts: ∫ (a + b θ) θ dθ.
  const auto measured = encircled(
      [](double at) {
        return at < 3     ? 50 - 10 * at / 3
               : at < 5   ? 40 - 10 * (at - 3)
               : at < 5.5 ? 20 - 40 * (at - 5)
                          : (at - 5.5) / 14.5;
      },
      20);
  EXPECT_LT(rings_chi2(table(), [&](double at) { return fraction_in(measured, at); }), most_chi2);
}

// χ by SciPy's brentq for the ratio that its quad() finds.
TEST(SunShape, RaysFollowBuiesLaw) {
  for (const auto& [ratio, chi] :
       {std::pair(0.02, 0.032635819369), {0.1, 0.099732556337}, {0.6, 0.608846433400}}) {
    const auto law = encircled([chi](double angle) { return buie_radiance(chi, angle); }, 43.6);
    EXPECT_LT(rings_chi2(buie(ratio), [&](double at) { return fraction_in(law, at); }), most_chi2)
        << ratio;
    // Mutants: the ratio itself as χ; a tenth more aureole.
    const auto plain =
        encircled([ratio](double angle) { return buie_radiance(ratio, angle); }, 43.6);
    EXPECT_GT(rings_chi2(buie(ratio == 0.1 ? 0.11 : ratio),
                         [&](double at) { return fraction_in(plain, at); }),
              most_chi2)
        << ratio;
  }
}

// The paper's definition: the aureole lies between 4.65 and 43.6 mrad, and the ratio is its flux
// over that of disc and aureole. On the disc the law leaves cos(0.326 · 4.65)/cos(0.308 · 4.65) =
// 0.397159 at the limb; outside it falls as θ^γ. γ and the step at the limb are SciPy's.
TEST(SunShape, BuiesCircumsolarRatioAndLimbAreThePapers) {
  for (const auto& [ratio, gamma, outside] : {std::tuple(0.001, -1.7726270136, 0.000146364782),
                                              {0.02, -2.1586115577, 0.004621591790},
                                              {0.3, -2.5099400154, 0.136997534000},
                                              {0.6, -2.1441018998, 0.334521975000}}) {
    const Beam beam = buie(ratio);
    const EncircledFlux flux(*beam.emitter);
    EXPECT_NEAR(1.0 - flux.within(4.65 * mrad), ratio, 1e-8 + 1e-6 * ratio);
    EXPECT_NEAR(flux.within(43.6 * mrad), 1.0, 1e-9);
    const auto radiance = [&](double angle) {
      return beam.emitter->relative_intensity(angle * mrad);
    };
    EXPECT_EQ(radiance(0.0), 1.0);
    EXPECT_NEAR(radiance(4.65 * (1 - 1e-9)), 0.397159, 1e-6);
    EXPECT_NEAR(radiance(4.65 * (1 + 1e-9)) / outside, 1.0, 1e-6) << ratio;
    EXPECT_NEAR(std::log(radiance(40.0) / radiance(5.0)) / std::log(8.0), gamma, 1e-6) << ratio;
    EXPECT_EQ(radiance(43.7), 0.0);
  }
}

// The irradiance on a plane normal to the axis is the stated one: E = power/(π R²) times the mean
// cosine of the rays.
TEST(SunShape, KeepsTheIrradiance) {
  for (const Beam& beam : {pillbox(20.0), gaussian(100.0), buie(0.3), table()}) {
    double cosine = 0.0;
    constexpr uint32_t count = 1u << 16;
    for (const auto& ray : test::rays_of(*beam.emitter, count)) cosine += ray.direction.z() / count;
    constexpr double radius_m = 1.001;  // of the scene, with the margin that sun.cpp states
    EXPECT_NEAR(beam.emitter->power_W() / (pi * radius_m * radius_m) * cosine, 1000.0, 2e-3);
  }
}

TEST(SunShape, ReportsTheMistake) {
  const auto refuses = [](SettingsNode::Table shape, const std::string& words) {
    EXPECT_THAT(refusal_of([&] { sun_of(std::move(shape)); }), ::testing::HasSubstr(words));
  };
  refuses({{"sun_shape", {"pill"}}}, "disc");
  refuses({{"sun_shape", {"buie"}}}, "circumsolar_ratio");
  refuses({{"sun_shape", {"buie"}}, {"circumsolar_ratio", {0.9}}}, "0.84");
  refuses({{"sun_shape", {"gaussian"}}, {"sun_shape_sigma_mrad", {0.0}}}, "sigma");
  refuses(
      {{"sun_shape", {"gaussian"}}, {"sun_shape_sigma_mrad", {4.0}}, {"angular_radius_deg", {0.3}}},
      "angular_radius_deg");
  const auto table_with = [](std::initializer_list<double> angles,
                             std::initializer_list<double> radiance) {
    return SettingsNode::Table{{"sun_shape", {"table"}},
                               {"sun_shape_angle_mrad", numbers_node(angles)},
                               {"sun_shape_radiance", numbers_node(radiance)}};
  };
  refuses(table_with({0}, {1}), "at least two angles");
  refuses(table_with({1, 2}, {1, 1}), "rise from 0");
  refuses(table_with({0, 2, 2}, {1, 1, 1}), "rise from 0");
  refuses(table_with({0, 2}, {1, 1, 1}), "one for each angle");
  refuses(table_with({0, 2}, {0, 0}), "some light");
  // Squares of such angles are zero; the flux of the light was none.
  refuses(table_with({0, 1e-300}, {1, 1}), "sun_shape_angle_mrad");
  refuses({{"angular_radius_deg", {1e-90}}, {"limb_darkening", numbers_node({0.47, 0.23})}},
          "limb_darkening");
  refuses(table_with({0, 2}, {1, -1}), "sun_shape_radiance");
}

}  // namespace
}  // namespace photorque

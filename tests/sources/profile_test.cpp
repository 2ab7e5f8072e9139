// The angular profiles against closed forms, as tables, as quadrature, and as sampled rays.
#include <numbers>

#include "core/constants.h"
#include "core/numerics/random.h"
#include "sampling.h"
#include "sources/lamps/settings.h"
#include "sources/profiles/beam_shape.h"
#include "sources/profiles/inverse_flux.h"
#include "sources/profiles/sampling.h"

namespace photorque {
namespace {

using test::largest_deviation;
using test::rays_of;
using test::sorted_angles;

// A profile and the flux within a cone in closed form.
struct Case {
  std::string name;
  AngularProfile profile;
  std::function<double(double)> flux_within;
  double closed_form_error;  // of the small-angle approximation, where it is one
};

// Small angles: ∫ I θ dθ instead of ∫ I sin θ dθ; the relative error is of the order θ²/6.
std::vector<Case> cases() {
  const auto small_gaussian = [](double fwhm) {
    return [fwhm](double t) { return 1.0 - std::exp2(-std::pow(2.0 * t / fwhm, 2)); };
  };
  const auto small_quartic = [](double fwhm) {
    return [fwhm](double t) {
      return std::erf(std::sqrt(std::numbers::ln2) * std::pow(2.0 * t / fwhm, 2));
    };
  };
  const auto pillbox = [](double edge, const std::function<double(double)>& measure) {
    return [=](double t) { return measure(std::min(t, edge)) / measure(edge); };
  };
  const auto angle = [](double t) { return t * t; };
  const auto solid = [](double t) { return std::pow(std::sin(0.5 * t), 2); };
  const auto projected = [](double t) { return std::pow(std::sin(t), 2); };
  const auto cosine = [](double m) {
    return [m](double t) {
      return -std::expm1(0.5 * (m + 1.0) * std::log1p(-std::pow(std::sin(t), 2)));
    };
  };
  return {
      {"gaussian, 0.01 mrad", gaussian_profile(1e-5), small_gaussian(1e-5), 1e-9},
      {"gaussian, 3 deg", gaussian_profile(3 * deg), small_gaussian(3 * deg), 2e-4},
      {"super-Gaussian 4, 0.01 mrad", super_gaussian_profile(1e-5, 4), small_quartic(1e-5), 1e-9},
      {"super-Gaussian 4, 3 deg", super_gaussian_profile(3 * deg, 4), small_quartic(3 * deg), 1e-4},
      {"pillbox in angle, 1.5 deg", pillbox_profile(1.5 * deg, PillboxMeasure::angle),
       pillbox(1.5 * deg, angle), 0.0},
      {"pillbox in angle, 90 deg", pillbox_profile(90 * deg, PillboxMeasure::angle),
       pillbox(90 * deg, angle), 0.0},
      {"pillbox in solid angle, 60 deg", pillbox_profile(60 * deg, PillboxMeasure::solid_angle),
       pillbox(60 * deg, solid), 0.0},
      {"pillbox projected, 1.5 deg", pillbox_profile(1.5 * deg, PillboxMeasure::projected),
       pillbox(1.5 * deg, projected), 0.0},
      {"pillbox projected, 90 deg", pillbox_profile(90 * deg, PillboxMeasure::projected),
       pillbox(90 * deg, projected), 0.0},
      {"isotropic", cosine_power_profile(0), cosine(0), 0.0},
      {"cosine to the 1/2", cosine_power_profile(0.5), cosine(0.5), 0.0},
      {"Lambertian", cosine_power_profile(1), cosine(1), 0.0},
      {"cosine to the 80th", cosine_power_profile(80), cosine(80), 0.0},
      {"cosine to the 1e9th", cosine_power_profile(1e9), cosine(1e9), 0.0},
  };
}

double angle_of(double rise) {
  return 2.0 * std::asin(std::sqrt(0.5 * rise));
}

TEST(InverseFlux, MatchesClosedFormsToAMillionthOfTheFlux) {
  for (const Case& c : cases()) {
    const InverseFlux inverse(c.profile);
    for (uint64_t i = 0; i < 20000; ++i) {
      const double outside = std::max(unit_interval(mix_bits(i)), InverseFlux::smallest_fraction);
      EXPECT_NEAR(c.flux_within(angle_of(inverse.rise(outside))), 1.0 - outside,
                  1e-6 + c.closed_form_error)
          << c.name;
    }
  }
}

TEST(InverseFlux, RisesFromTheAxisToTheEdge) {
  for (const Case& c : cases()) {
    const InverseFlux inverse(c.profile);
    const double first = inverse.rise(1.0 - 0x1p-33);
    EXPECT_GE(first, 0.0) << c.name;
    EXPECT_LT(angle_of(first), 2e-4 * c.profile.end_rad) << c.name;
    EXPECT_LE(angle_of(inverse.rise(InverseFlux::smallest_fraction)),
              c.profile.end_rad * (1 + 1e-15))
        << c.name;
    double before = first;
    for (double outside = 1.0 - 1e-4; outside > 1e-9; outside *= 0.999) {
      const double rise = inverse.rise(outside);
      EXPECT_GT(rise, before) << c.name << " at " << outside;
      before = rise;
    }
  }
}

// Wide and steep profiles against integrals by mpmath 1.3 (quad, 30 digits).
TEST(InverseFlux, MatchesIndependentQuadratureOfWideAndSteepProfiles) {
  struct Known {
    AngularProfile profile;
    double angle_deg, within;
  };
  const std::vector<Known> table = {
      {gaussian_profile(3 * deg), 0.75, 0.159127600345125},
      {gaussian_profile(3 * deg), 1.5, 0.500057117573920},
      {gaussian_profile(40 * deg), 20, 0.510210943459493},
      {gaussian_profile(120 * deg), 30, 0.230101991897816},
      {gaussian_profile(120 * deg), 60, 0.681570045505576},
      {super_gaussian_profile(3 * deg, 4), 1.5, 0.760988310388187},
      {super_gaussian_profile(60 * deg, 3), 20, 0.366200006394849},
      {super_gaussian_profile(60 * deg, 3), 40, 0.901444816076616},
      {super_gaussian_profile(3 * deg, 20), 1.5, 0.959450393849722},
      {super_gaussian_profile(3 * deg, 20), 1.6, 0.997131038766501},
  };
  for (const Known& known : table) {
    const InverseFlux inverse(known.profile);
    const double angle_rad = angle_of(inverse.rise(1.0 - known.within));
    // An error of 1e-6 in the flux, turned into one of the angle by dθ = dF/(2π I sin θ).
    const double slope = 2.0 * pi * known.profile(angle_rad) * std::sin(angle_rad) / inverse.flux();
    EXPECT_NEAR(angle_rad * slope, known.angle_deg * deg * slope, 1e-6) << known.angle_deg;
  }
}

TEST(InverseFlux, EveryProfileInRangeCanBeTabulated) {
  for (const double width_deg : {1e-4, 0.1, 10.0, 90.0, 179.9}) {
    EXPECT_NO_THROW(InverseFlux{gaussian_profile(width_deg * deg)}) << width_deg;
    for (const double order : {2.0, 2.5, 3.0, 7.0, 30.0, 100.0}) {
      EXPECT_NO_THROW(InverseFlux{super_gaussian_profile(width_deg * deg, order)})
          << width_deg << ", order " << order;
    }
  }
  for (const double exponent : {0.01, 0.3, 1.5, 1e3, 1e6}) {
    EXPECT_NO_THROW(InverseFlux{cosine_power_profile(exponent)}) << exponent;
  }
}

TEST(AngularProfile, RaysFollowTheClosedForm) {
  for (const Case& c : cases()) {
    const DiscLamp lamp(1.0, 0.01, AngularDistribution(c.profile));
    EXPECT_LT(largest_deviation(sorted_angles(rays_of(lamp, 65536)), c.flux_within),
              1e-4 + c.closed_form_error)
        << c.name;
  }
}

// The mutant: a beam one percent wider must not pass for the right one.
TEST(AngularProfile, TheDistanceOfDistributionsSeesOnePercentOfWidth) {
  const DiscLamp lamp(1.0, 0.01, AngularDistribution(gaussian_profile(1.01e-5)));
  EXPECT_GT(
      largest_deviation(sorted_angles(rays_of(lamp, 65536)),
                        [](double t) { return 1.0 - std::exp2(-std::pow(2.0 * t / 1e-5, 2)); }),
      5e-3);
}

TEST(AngularProfile, QuadratureOfTheIntensityGivesTheClosedForm) {
  for (const Case& c : cases()) {
    const DiscLamp lamp(1.0, 0.01, AngularDistribution(c.profile));
    const EncircledFlux flux(lamp);
    for (const double fraction : {0.03, 0.2, 0.5, 0.77, 0.93, 0.999}) {
      const double angle_rad = flux.half_angle_rad(fraction);
      EXPECT_NEAR(c.flux_within(angle_rad), fraction, 1e-8 + c.closed_form_error) << c.name;
      EXPECT_NEAR(flux.within(angle_rad), fraction, 1e-10) << c.name;
    }
  }
}

TEST(AngularDistribution, CoreAndHaloShareTheFlux) {
  // Small angles, so that the closed form is exact.
  const double core = 1e-5, wide = 4e-5, fraction = 0.2;
  const AngularDistribution both(gaussian_profile(core), Halo{gaussian_profile(wide), fraction});
  const DiscLamp lamp(1.0, 0.01, both);
  const auto gaussian = [](double t, double fwhm) {
    return 1.0 - std::exp2(-std::pow(2.0 * t / fwhm, 2));
  };
  const auto within = [&](double t) {
    return (1.0 - fraction) * gaussian(t, core) + fraction * gaussian(t, wide);
  };
  EXPECT_LT(largest_deviation(sorted_angles(rays_of(lamp, 65536)), within), 1e-4);
  const EncircledFlux flux(lamp);
  for (const double t : {0.5e-5, 1e-5, 2e-5, 5e-5}) EXPECT_NEAR(flux.within(t), within(t), 1e-8);
  // On the axis a Gaussian of unit flux has the intensity 4 ln 2/(π fwhm²); halfway out it has 1/2.
  const double on_axis = (1.0 - fraction) / (core * core) + fraction / (wide * wide);
  const double half_out =
      (1.0 - fraction) / (core * core) * 0.5 + fraction / (wide * wide) * std::exp2(-1.0 / 16.0);
  EXPECT_NEAR(lamp.relative_intensity(0.5 * core), half_out / on_axis, 1e-8);
  EXPECT_NEAR(both.effective_solid_angle_sr(), pi / (4.0 * std::numbers::ln2 * on_axis),
              1e-8 * core * core);
}

TEST(AngularDistribution, ThinHalosAndEdgesStayInRange) {
  for (const double fraction : {0.0, 1e-12, 1e-9, 0.5, 1.0 - 1e-12}) {
    const AngularDistribution both(pillbox_profile(0.02, PillboxMeasure::angle),
                                   Halo{gaussian_profile(0.5), fraction});
    FractionBlock bits{};
    for (int i = 0; i < ray_block; ++i) bits[i] = 0x01010101u * static_cast<uint32_t>(i);
    ValueBlock rise{};
    both.rises(bits, rise);
    for (const double h : rise) {
      EXPECT_GE(h, 0.0) << fraction;
      EXPECT_LE(h, 1.0) << fraction;
    }
  }
}

TEST(DiscLamp, FillsItsApertureEvenly) {
  const double diameter_m = 0.4;
  const DiscLamp lamp(1.0, diameter_m, AngularDistribution(gaussian_profile(0.05)));
  std::vector<double> area_fractions, turns;
  double xx = 0.0, xy = 0.0;
  for (const auto& ray : rays_of(lamp, 65536)) {
    const double radius_m = std::hypot(ray.origin_m.x(), ray.origin_m.y());
    area_fractions.push_back(std::pow(radius_m / (0.5 * diameter_m), 2));
    turns.push_back(std::atan2(ray.origin_m.y(), ray.origin_m.x()) / (2.0 * pi) + 0.5);
    xx += ray.origin_m.x() * ray.direction.x();
    xy += ray.origin_m.x() * ray.direction.y();
  }
  std::sort(area_fractions.begin(), area_fractions.end());
  std::sort(turns.begin(), turns.end());
  const auto uniform = [](double x) { return x; };
  EXPECT_LT(largest_deviation(area_fractions, uniform), 2e-5);
  EXPECT_LT(largest_deviation(turns, uniform), 2e-5);
  // Position and direction are independent: correlations vanish against 0.1 m × 0.02.
  EXPECT_LT(std::abs(xx / 65536), 2e-6);
  EXPECT_LT(std::abs(xy / 65536), 2e-6);
}

}  // namespace
}  // namespace photorque

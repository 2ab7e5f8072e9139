// The Sun, or a simulator of it: parallel light from every point of a small disc in the sky.
//
//   [[source]]
//   kind = "sun"
//   name = "sun"                   # default "sun"
//   irradiance_W_m2 = 1361         # on a plane normal to `direction`; default: mean at 1 au
//   angular_radius_deg = 0.2665    # of the disc, [0, 45]; 0: collimated; default: Sun at 1 au
//   direction = [0, 0, -1]         # in which the light travels, lab frame
//   spectrum = "AM0"               # or "AM1.5G", or a "blackbody" (default)
//   temperature_K = 5772           # of the blackbody
//   limb_darkening = [0.47, 0.23]  # default: none
//
// Without limb darkening the disc has the same radiance L all over: directions are even in solid
// angle. With it L falls towards the edge, see LimbDarkening. For each direction the rays fill a
// disc of radius R normal to THAT direction and centred on the lab origin, so that a sphere of
// radius R there is lit evenly. The irradiance on a plane normal to the axis is E = L π sin²α, and
// the power of all rays L · 2π(1 − cos α) · πR² = E πR² / cos²(α/2); with limb darkening both
// integrals carry its weight.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/constants.h"
#include "core/numerics/vector_math.h"
#include "sources/lamps/keys.h"
#include "sources/lamps/settings.h"
#include "sources/profiles/sampling.h"

namespace photorque::kinds::sun {
namespace {

namespace key {
constexpr NumberKey angular_radius("angular_radius_deg", solar_angular_radius_rad,
                                   {0.0, 0.25 * pi, false, false},
                                   "of the disc in the sky; 0 is parallel light");
constexpr NumbersKey limb_darkening(
    "limb_darkening", {-1.0, 1.0},
    "[u1, u2]: radiance 1 − u1 (1 − μ) − u2 (1 − μ)², μ = √(1 − r²) at r radii from the "
    "middle; [0.47, 0.23] in visible light",
    {.usually = "none", .size = 2});
}  // namespace key

// A disc in the sky that is brighter in its middle than at its edge, as stars are.
//
// Radiance L(μ)/L(1) = 1 − u₁ (1 − μ) − u₂ (1 − μ)², μ the cosine between the line of sight and the
// normal of the star's surface: μ² = 1 − (sin θ/sin α)² at an angle θ from the middle of a disc of
// angular radius α. The Sun in visible light has about u₁ = 0.47, u₂ = 0.23 (550 nm).
// Source of the law: A. N. Cox, ed., Allen's Astrophysical Quantities, 4th ed., section 14.7.
class LimbDarkening {
 public:
  // `angular_radius_rad` ∈ (0, π/4]; u₁ ≥ 0, u₁ + 2 u₂ ≥ 0, u₁ + u₂ ≤ 1: falls to no less than 0.
  LimbDarkening(double angular_radius_rad, double u1, double u2);

  // Over that of the middle; `cosine` is μ.
  double radiance(double cosine) const;
  // μ at θ ≤ α.
  double cosine_at(double angle_rad) const;

  // The mean of cos θ over the light.
  double mean_cosine() const { return mean_cosine_; }
  // 1 − cos θ of the cone about the middle that holds `fraction` ∈ [0, 1] of the light. To 1e-6 of
  // the disc's.
  double rise_within(double fraction) const;

  // Circles about the middle, rising to the disc's edge, between which L is a smooth function of
  // 1 − cos θ: at the edge its slope is infinite, so they crowd there.
  std::vector<double> edges_rad() const;

 private:
  double rise_at(double cosine) const;

  double sine2_;  // sin²α
  double u1_, u2_;
  double mean_cosine_ = 1.0;
  std::vector<double> cosine_of_fraction_;  // μ at even steps of the fraction
};

constexpr size_t steps = 4096;

// With sin²θ = (1 − μ²) sin²α the element of solid angle is 2π d(−cos θ) = 2π sin²α μ dμ/cos θ.
LimbDarkening::LimbDarkening(double angular_radius_rad, double u1, double u2)
    : sine2_(std::sin(angular_radius_rad) * std::sin(angular_radius_rad)), u1_(u1), u2_(u2) {
  // From the middle, μ = 1, outwards; by the middle of each step.
  std::vector<double> within = {0.0};
  double projected = 0.0;
  for (size_t i = 0; i < steps; ++i) {
    const double cosine = 1.0 - (static_cast<double>(i) + 0.5) / steps;
    const double light = radiance(cosine) * cosine;
    const double facing = std::sqrt(1.0 - (1.0 - cosine * cosine) * sine2_);
    within.push_back(within.back() + light / facing);
    projected += light;
  }
  mean_cosine_ = projected / within.back();
  size_t at = 1;
  for (size_t k = 0; k <= steps; ++k) {
    const double wanted = within.back() * static_cast<double>(k) / steps;
    while (at < steps && within[at] < wanted) ++at;
    const double place = (wanted - within[at - 1]) / (within[at] - within[at - 1]);
    cosine_of_fraction_.push_back(1.0 - (static_cast<double>(at - 1) + place) / steps);
  }
}

double LimbDarkening::radiance(double cosine) const {
  const double depth = 1.0 - cosine;
  return 1.0 - u1_ * depth - u2_ * depth * depth;
}

double LimbDarkening::cosine_at(double angle_rad) const {
  const double sine = std::sin(angle_rad);
  return std::sqrt(std::max(0.0, 1.0 - sine * sine / sine2_));
}

double LimbDarkening::rise_at(double cosine) const {
  const double sine2 = (1.0 - cosine * cosine) * sine2_;
  return sine2 / (1.0 + std::sqrt(1.0 - sine2));
}

double LimbDarkening::rise_within(double fraction) const {
  const double place = fraction * steps;
  const size_t i = std::min(static_cast<size_t>(place), steps - 1);
  const double t = place - static_cast<double>(i);
  // Linear in the rise, which goes like the fraction itself near the middle.
  return (1.0 - t) * rise_at(cosine_of_fraction_[i]) + t * rise_at(cosine_of_fraction_[i + 1]);
}

std::vector<double> LimbDarkening::edges_rad() const {
  std::vector<double> edges;
  for (double cosine = 0.5; cosine > 0.03; cosine *= 0.5) {
    edges.push_back(std::asin(std::sqrt((1.0 - cosine * cosine) * sine2_)));
  }
  edges.push_back(std::asin(std::sqrt(sine2_)));
  return edges;
}

class Sun : public Emitter {
 public:
  // Lights the sphere of radius `radius_m` about (0, 0, radius_m).
  Sun(double irradiance_W_m2, double angular_radius_rad, double radius_m,
      std::optional<LimbDarkening> limb)
      : angular_radius_rad_(angular_radius_rad), radius_m_(radius_m), limb_(std::move(limb)) {
    const double sine = std::sin(0.5 * angular_radius_rad);
    edge_rise_ = 2.0 * sine * sine;
    const double mean_cosine = limb_ ? limb_->mean_cosine() : 1.0 - sine * sine;
    power_W_ = irradiance_W_m2 * pi * radius_m * radius_m / mean_cosine;
  }

  double power_W() const override { return power_W_; }

  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    ValueBlock rise;
    for (int i = 0; i < ray_block; ++i) rise[i] = edge_rise_ * fraction_of(samples.bits[2][i]);
    if (limb_) {
      for (int i = 0; i < ray_block; ++i) {
        rise[i] = limb_->rise_within(fraction_of(samples.bits[2][i]));
      }
    }
    fill_directions(rise, samples.bits[3], rays.direction);
    fill_disc(radius_m_, samples.bits[0], samples.bits[1], rays.origin_m);
    tilt_discs(rays);
  }

  double relative_intensity(double angle_rad) const override {
    if (angle_rad > angular_radius_rad_) return 0.0;
    return limb_ ? limb_->radiance(limb_->cosine_at(angle_rad)) : 1.0;
  }

 private:
  // Turns each point of the disc by the shortest rotation from z to the direction, moves it to the
  // centre of the sphere, and back along the ray to the plane z = 0.
  // Source of the axes: J. R. Frisvad, J. Graphics Tools 16 (2012) 151.
  void tilt_discs(RayBlock& rays) const {
    for (int i = 0; i < ray_block; ++i) {
      const double dx = rays.direction[0][i], dy = rays.direction[1][i], dz = rays.direction[2][i];
      const double a_m = rays.origin_m[0][i], b_m = rays.origin_m[1][i];
      const double along_m = a_m * dx + b_m * dy;
      const double bend_m = along_m / (1.0 + dz);
      const double back_m = (radius_m_ - along_m) / dz;
      rays.origin_m[0][i] = a_m - bend_m * dx - back_m * dx;
      rays.origin_m[1][i] = b_m - bend_m * dy - back_m * dy;
    }
  }

  double angular_radius_rad_;
  double radius_m_;
  std::optional<LimbDarkening> limb_;
  double edge_rise_ = 0.0;
  double power_W_ = 0.0;
};

std::optional<LimbDarkening> read_limb_darkening(const Settings& settings,
                                                 double angular_radius_rad) {
  if (!settings.has(key::limb_darkening)) return std::nullopt;
  const std::vector<double> u = settings.get(key::limb_darkening);
  const bool two = u.size() == 2;
  // The edge shines with 1 − u₁ − u₂, the slope at the middle is −(u₁ + 2 u₂ (1 − μ)) ≤ 0.
  if (!two || u[0] < 0.0 || u[0] + u[1] > 1.0 || u[0] + 2.0 * u[1] < 0.0) {
    throw settings.error(key::limb_darkening,
                         two ? "coefficients of a disc that does not darken towards its edge"
                             : std::to_string(u.size()) + " numbers",
                         "[u1, u2] with u1 >= 0, u1 + 2 u2 >= 0 and u1 + u2 <= 1");
  }
  if (!(angular_radius_rad > 0.0)) {
    throw settings.error(key::limb_darkening, "a Sun without a disc", "angular_radius_deg above 0");
  }
  return LimbDarkening(angular_radius_rad, u[0], u[1]);
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  // The sphere that holds the scene may only just hold it.
  constexpr double margin = 1.001;
  const std::string name = settings.get(source_key::name.with_default("sun"));
  const Vec3 direction = read_direction_vector(settings);
  const Sunlight light = read_sunlight(settings);
  const double angular_radius_rad = settings.get(key::angular_radius);
  if (!(context.scene_radius_m > 0.0)) {
    throw settings.error("kind", "\"sun\" over a scene without extent", "a scene to shine on");
  }
  const double radius_m = margin * context.scene_radius_m;
  const std::optional<LimbDarkening> limb = read_limb_darkening(settings, angular_radius_rad);
  auto sun = std::make_shared<Sun>(light.irradiance_W_m2, angular_radius_rad, radius_m, limb);
  const double exitance_W_m2 = sun->power_W() / (pi * radius_m * radius_m);
  return {{name, std::move(sun), frame_looking_along(direction, -radius_m * direction),
           light.spectrum,
           UniformAperture{std::numeric_limits<double>::infinity(), exitance_W_m2,
                           limb ? limb->edges_rad() : std::vector<double>{angular_radius_rad}}}};
}

}  // namespace

SourceKind kind() {
  return {"sun",
          "Parallel light from a disc in the sky, of a given irradiance",
          make,
          {{"direction", {SettingsNode::Array{{0.3}, {0.0}, {-1.0}}}}},
          joined({{source_key::name.with_default("sun"), source_key::light_direction},
                  sunlight_keys(),
                  {key::angular_radius, key::limb_darkening}})};
}

}  // namespace photorque::kinds::sun

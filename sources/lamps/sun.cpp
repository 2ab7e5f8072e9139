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
// angle. With it L falls towards the edge, see limb_darkening.h. For each direction the rays fill a
// disc of radius R normal to THAT direction and centred on the lab origin, so that a sphere of
// radius R there is lit evenly. The irradiance on a plane normal to the axis is E = L π sin²α, and
// the power of all rays L · 2π(1 − cos α) · πR² = E πR² / cos²(α/2); with limb darkening both
// integrals carry its weight.
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/numerics/vector_math.h"
#include "sources/lamps/keys.h"
#include "sources/lamps/limb_darkening.h"
#include "sources/lamps/settings.h"
#include "sources/profiles/block_maps.h"

namespace photorque::kinds::sun {
namespace {

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
  if (!settings.has("limb_darkening")) return std::nullopt;
  const std::vector<double> u = settings.numbers("limb_darkening", {-1.0, 1.0});
  const bool two = u.size() == 2;
  // The edge shines with 1 − u₁ − u₂, the slope at the middle is −(u₁ + 2 u₂ (1 − μ)) ≤ 0.
  if (!two || u[0] < 0.0 || u[0] + u[1] > 1.0 || u[0] + 2.0 * u[1] < 0.0) {
    throw settings.error("limb_darkening",
                         two ? "coefficients of a disc that does not darken towards its edge"
                             : std::to_string(u.size()) + " numbers",
                         "[u1, u2] with u1 >= 0, u1 + 2 u2 >= 0 and u1 + u2 <= 1");
  }
  if (!(angular_radius_rad > 0.0)) {
    throw settings.error("limb_darkening", "a Sun without a disc", "angular_radius_deg above 0");
  }
  return LimbDarkening(angular_radius_rad, u[0], u[1]);
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  // The sphere that holds the scene may only just hold it.
  constexpr double margin = 1.001;
  const std::string name = settings.text_or("name", "sun");
  const Vec3 direction = read_direction_vector(settings);
  const Sunlight light = read_sunlight(settings);
  const double angular_radius_rad = settings.number_or(
      "angular_radius_deg", solar_angular_radius_rad, {0.0, 0.25 * pi, false, false});
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
  return {
      "sun",
      "Parallel light from a disc in the sky, of a given irradiance",
      make,
      {{"direction", {SettingsNode::Array{{0.3}, {0.0}, {-1.0}}}}},
      joined(
          {{source_name_key("sun"), direction_key("in which light travels, lab axes, any length")},
           sunlight_keys(),
           {Key::number_or("angular_radius_deg", solar_angular_radius_rad,
                           {0.0, 0.25 * pi, false, false},
                           "of the disc in the sky; 0 is parallel light"),
            Key::numbers("limb_darkening", {-1.0, 1.0},
                         "[u1, u2]: radiance 1 − u1 (1 − μ) − u2 (1 − μ)², μ = √(1 − r²) at r "
                         "radii from the middle; [0.47, 0.23] in visible light")
                .of_size(2)
                .usually_is("none")}})};
}

}  // namespace photorque::kinds::sun

// The Sun: parallel light from every point of a small disc in the sky and of its aureole.
//
// Without limb darkening the disc has a uniform radiance L: directions are uniform in solid angle.
// For each direction the rays fill a disc of radius R that is normal to this direction and centred
// on the lab origin, so that a sphere of radius R is lit evenly. The irradiance on a plane normal
// to the axis is E = ∫ L cos θ dΩ. The power of all rays is ∫ L dΩ · πR² = E πR²/⟨cos θ⟩ with the
// mean over the light; for the uniform disc this mean is cos²(α/2).
#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/constants.h"
#include "core/numerics/vector_math.h"
#include "core/text/parse.h"
#include "raytrace/emitter.h"
#include "sources/lamps/settings.h"
#include "sources/profiles/sampling.h"
#include "sources/profiles/sun_shape.h"

namespace photorque::kinds::sun {
namespace {

namespace key {
enum Shape : size_t { disc, gaussian, buie, table };
constexpr ChoiceKey sun_shape("sun_shape",
                              {{"disc", "a disc of uniform or limb-darkened radiance"},
                               {"gaussian", "radiance falls as exp(−θ²/2σ²)"},
                               {"buie",
                                "a disc of 4.65 mrad with an aureole to 43.6 mrad, by Buie, "
                                "Monger and Dey (2003)"},
                               {"table", "measured radiance over the angle"}},
                              disc, "how radiance falls with the angle θ from the middle");
constexpr NumberKey angular_radius("angular_radius_deg", solar_angular_radius_rad,
                                   {0.0, 0.25 * pi, false, false},
                                   "angular radius of the disc in the sky; 0: parallel light");
constexpr NumbersKey limb_darkening(
    "limb_darkening", {-1.0, 1.0},
    "[u1, u2]: radiance 1 − u1 (1 − μ) − u2 (1 − μ)², μ = √(1 − r²) at r radii from the "
    "middle; [0.47, 0.23] in visible light",
    {.usually = "none", .size = 2});
// Minimum angle of integrated shapes: squares of smaller angles underflow.
constexpr double least_rad = 1e-9;
constexpr NumberKey sigma("sun_shape_sigma_mrad", {least_rad, pi / 24.0},
                          "σ, the standard deviation of angles along each of two axes");
constexpr NumberKey circumsolar_ratio("circumsolar_ratio", {1e-4, 0.84, false, false},
                                      "flux of the aureole over that of disc and aureole");
constexpr NumbersKey table_angle("sun_shape_angle_mrad", {0.0, 0.25 * pi},
                                 "angles θ from 0 on, rising");
constexpr NumbersKey table_radiance("sun_shape_radiance", {0.0, 1e30},
                                    "one for each angle, of any scale; linear between them");
}  // namespace key

class Sun : public ParallelLight {
 public:
  // Lights the sphere of radius `radius_m` about (0, 0, radius_m). Without `shape`: a uniform disc.
  Sun(double irradiance_W_m2, double angular_radius_rad, double radius_m,
      std::optional<SunShape> shape)
      : ParallelLight(radius_m), angular_radius_rad_(angular_radius_rad), shape_(std::move(shape)) {
    edge_rise_ = rise_at(angular_radius_rad);
    const double mean_cosine = shape_ ? shape_->mean_cosine() : 1.0 - 0.5 * edge_rise_;
    power_W_ = irradiance_W_m2 * pi * radius_m * radius_m / mean_cosine;
  }

  double power_W() const override { return power_W_; }

  void fill_directions(const SampleBlock& samples, RayBlock& rays) const override {
    ValueBlock rise;
    if (shape_) {
      for (int i = 0; i < ray_block; ++i) {
        rise[i] = static_cast<float>(shape_->rise_within(fraction_of(samples.bits[2][i])));
      }
    } else {
      for (int i = 0; i < ray_block; ++i) rise[i] = edge_rise_ * fraction_of(samples.bits[2][i]);
    }
    photorque::fill_directions(rise, samples.bits[3], rays.direction);
  }

  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    fill_directions(samples, rays);
    fill_disc(radius_m(), samples.bits[0], samples.bits[1], rays.origin_m);
    place_on_discs(radius_m(), rays);
  }

  double relative_intensity(double angle_rad) const override {
    if (shape_) return shape_->radiance(angle_rad);
    return angle_rad <= angular_radius_rad_ ? 1.0 : 0.0;
  }

  std::vector<double> edges_rad() const {
    return shape_ ? shape_->edges_rad() : std::vector<double>{angular_radius_rad_};
  }

 private:
  double angular_radius_rad_;  // of the uniform disc
  std::optional<SunShape> shape_;
  double edge_rise_ = 0.0;
  double power_W_ = 0.0;
};

std::optional<SunShape> read_limb_darkening(const Settings& settings, double angular_radius_rad) {
  if (!settings.has(key::limb_darkening)) return std::nullopt;
  const std::vector<double> u = settings.get(key::limb_darkening);
  const bool two = u.size() == 2;
  // The radiance at the edge is 1 − u₁ − u₂; the slope at the centre is −(u₁ + 2 u₂ (1 − μ)) ≤ 0.
  if (!two || u[0] < 0.0 || u[0] + u[1] > 1.0 || u[0] + 2.0 * u[1] < 0.0) {
    throw settings.error(key::limb_darkening,
                         two ? "coefficients of a disc that does not darken towards its edge"
                             : std::to_string(u.size()) + " numbers",
                         "[u1, u2] with u1 >= 0, u1 + 2 u2 >= 0 and u1 + u2 <= 1");
  }
  if (angular_radius_rad < key::least_rad) {
    throw settings.error(key::limb_darkening, "a Sun without a disc",
                         "angular_radius_deg of at least 1e-7");
  }
  return limb_darkened_disc(angular_radius_rad, u[0], u[1]);
}

SunShape read_table(const Settings& settings) {
  const std::vector<double> angle_rad = settings.get(key::table_angle);
  const std::vector<double> radiance = settings.get(key::table_radiance);
  const auto count = [](const std::vector<double>& of) {
    return std::to_string(of.size()) + " numbers";
  };
  if (angle_rad.size() < 2) {
    throw settings.error(key::table_angle, count(angle_rad), "at least two angles");
  }
  if (angle_rad.front() != 0.0 ||
      std::ranges::adjacent_find(angle_rad, std::greater_equal()) != angle_rad.end()) {
    throw settings.error(key::table_angle, "angles that do not rise from 0", "0 and rising angles");
  }
  if (angle_rad[1] < key::least_rad) {
    throw settings.error(key::table_angle, shortest(1e3 * angle_rad[1]),
                         "a first angle after 0 of at least 1e-6 mrad");
  }
  if (radiance.size() != angle_rad.size()) {
    throw settings.error(key::table_radiance, count(radiance),
                         count(angle_rad) + ", one for each angle");
  }
  if (std::ranges::none_of(radiance, [](double value) { return value > 0.0; })) {
    throw settings.error(key::table_radiance, "no radiance above 0", "some light");
  }
  return tabulated_sun(angle_rad, radiance);
}

std::optional<SunShape> read_shape(const Settings& settings, double angular_radius_rad) {
  switch (settings.get(key::sun_shape)) {
    case key::gaussian:
      return gaussian_sun(settings.get(key::sigma));
    case key::buie:
      return buie_sun(settings.get(key::circumsolar_ratio));
    case key::table:
      return read_table(settings);
    default:
      return read_limb_darkening(settings, angular_radius_rad);
  }
}

std::vector<Beam> make(const Settings& settings, const SourceContext& context) {
  // A margin, because the sphere of scene_radius_m may touch the scene.
  constexpr double margin = 1.001;
  const std::string name = settings.get(source_key::name.with_default("sun"));
  const Vec3 direction = read_direction_vector(settings);
  const Sunlight light = read_sunlight(settings);
  const bool is_disc = settings.get(key::sun_shape) == key::disc;
  const double angular_radius_rad = is_disc ? settings.get(key::angular_radius) : 0.0;
  if (!(context.scene_radius_m > 0.0)) {
    throw settings.error("kind", "\"sun\" over a scene without extent", "a scene to shine on");
  }
  const double radius_m = margin * context.scene_radius_m;
  auto sun = std::make_shared<Sun>(light.irradiance_W_m2, angular_radius_rad, radius_m,
                                   read_shape(settings, angular_radius_rad));
  const double exitance_W_m2 = sun->power_W() / (pi * radius_m * radius_m);
  UniformAperture aperture{std::numeric_limits<double>::infinity(), exitance_W_m2,
                           sun->edges_rad()};
  return {{name, std::move(sun), frame_looking_along(direction, -radius_m * direction),
           light.spectrum, std::move(aperture)}};
}

}  // namespace

SourceKind kind() {
  return {"sun", "Parallel light from a disc in the sky, of a given irradiance", make,
          joined({{source_key::name.with_default("sun"), source_key::light_direction},
                  sunlight_keys(),
                  {key::sun_shape.bringing({{key::angular_radius, key::limb_darkening},
                                            {key::sigma},
                                            {key::circumsolar_ratio},
                                            {key::table_angle, key::table_radiance}})}})};
}

}  // namespace photorque::kinds::sun

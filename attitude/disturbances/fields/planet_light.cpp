// The pressure of the light from the planet: reflected sunlight and thermal infrared, by Knocke,
// Ries and Tapley (attitude/environment/planet_light.h). Needs an `orbit`. Surfaces have other
// optical properties for infrared light, hence its table. The night side reflects nothing, so an
// eclipse needs no extra term. Infrared remains.
#include "attitude/environment/planet_light.h"
#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/disturbances/fields/torque_surface.h"
#include "attitude/disturbances/kind.h"
#include "core/constants.h"

namespace photorque::kinds::planet_light {
namespace {

constexpr ScalarKey planet_factor("scale", 1.0, {}, "factor on the torque");

namespace key {
constexpr PlanetSurface earth;

constexpr TextKey table("table",
                        "CSV of `torque-map` over the sphere (`elevation_deg`, `azimuth_deg`; "
                        "`torque_x_N_m`, …), traced in sunlight");
constexpr TextKey infrared_table("infrared_table", "table for the infrared light of the planet",
                                 {.usually = "`table`: surfaces treat infrared as sunlight"});
constexpr NumberKey table_irradiance("table_irradiance_W_m2", solar_irradiance_W_m2,
                                     Range::positive(),
                                     "irradiance of the light with which the tables were traced");
constexpr NumberKey irradiance("irradiance_W_m2", solar_irradiance_W_m2, Range::positive(),
                               "irradiance of sunlight at the planet");
constexpr Vec3Key sun_direction("sun_direction", "towards the Sun, any length",
                                {.usually = "that of `orbit`"});
constexpr NumberKey albedo("albedo", earth.albedo.mean, Range::fraction(),
                           "mean albedo of the planet");
constexpr NumberKey emissivity(
    "emissivity", earth.emissivity.mean, Range::fraction(),
    "mean emissivity of the planet: infrared exitance divided by `irradiance_W_m2`/4");
constexpr FlagKey zonal(
    "zonal", true,
    "variation with latitude, as on the Earth: albedo + 0.29 P₂, emissivity − 0.18 P₂");
constexpr NumberKey date_year(
    "date_year", {1900.0, 2100.0, false, false},
    "date, for the seasonal variation of the Earth: ± 0.10 P₁ and ∓ 0.07 P₁",
    {.usually = "no season"});
}  // namespace key

struct PlanetOptions {
  PlanetSurface surface;
  double season = 0.0;  // cosine of the phase of the year
  Vec3 to_sun = Vec3::UnitX();
  double irradiance_W_m2 = solar_irradiance_W_m2;
  double table_W_m2 = solar_irradiance_W_m2;
};

class PlanetLight final : public TorqueLaw<PlanetLight> {
 public:
  PlanetLight(PlanetOptions options, TorqueSurface sunlight, std::optional<TorqueSurface> infrared)
      : options_(std::move(options)),
        sunlight_(std::move(sunlight)),
        infrared_(std::move(infrared)) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    Vec3Of<T> sum = Vec3Of<T>::Constant(T(0.0));
    std::array<Mat3, Lanes::count> axes;
    std::array<std::vector<PlanetPart>, Lanes::count> parts;
    const Lanes gradient_1_s2 = values(now.gravity_gradient_1_s2);
    for (int i = 0; i < Lanes::count; ++i) {
      const Vec3 up(values(now.up_lab.x())[i], values(now.up_lab.y())[i],
                    values(now.up_lab.z())[i]);
      const auto lane = static_cast<size_t>(i);
      axes[lane] = planet_axes(up.normalized(), options_.to_sun);
      if (i > 0 && gradient_1_s2[i] == gradient_1_s2[i - 1]) {
        parts[lane] = parts[lane - 1];
        continue;
      }
      const double distance_m = std::cbrt(earth_gravitation_m3_s2 / gradient_1_s2[i]);
      if (!(distance_m > 1.001 * reference_radius_of_earth_m)) return sum;  // on the ground
      parts[lane] = planet_parts(reference_radius_of_earth_m, distance_m);
    }
    for (size_t k = 0; k < parts[0].size(); ++k) {
      Vec3Of<Lanes> towards;
      Lanes reflected = 0.0, emitted = 0.0;
      for (int i = 0; i < Lanes::count; ++i) {
        const Mat3& of = axes[static_cast<size_t>(i)];
        const PlanetPart& part = parts[static_cast<size_t>(i)][k];
        const Vec3 way = of * part.towards;
        for (int axis = 0; axis < 3; ++axis) towards[axis].set(i, way[axis]);
        const PlanetIrradiance light =
            planet_irradiance(part, options_.surface, of, options_.to_sun, options_.season,
                              options_.irradiance_W_m2 / options_.table_W_m2);
        reflected.set(i, infrared_ ? light.reflected_W_m2 : light.sum_W_m2());
        emitted.set(i, light.infrared_W_m2);
      }
      const Vec3Of<T> way = now.to_body(Vec3Of<T>(T(towards.x()), T(towards.y()), T(towards.z())));
      sum += T(reflected) * look_up_towards<T>(sunlight_, way);
      if (infrared_) sum += T(emitted) * look_up_towards<T>(*infrared_, way);
    }
    return own[planet_factor] * sum;
  }

 private:
  PlanetOptions options_;
  TorqueSurface sunlight_;
  std::optional<TorqueSurface> infrared_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  PlanetOptions options;
  PlanetSurface& surface = options.surface;
  if (!settings.get(key::zonal)) {
    surface.albedo.season = surface.albedo.second = 0.0;
    surface.emissivity.season = surface.emissivity.second = 0.0;
  }
  surface.albedo.mean = settings.get(key::albedo);
  surface.emissivity.mean = settings.get(key::emissivity);
  if (settings.has(key::date_year)) {
    options.season = season_cosine(settings.get(key::date_year));
  }
  options.to_sun = direction_of(settings, key::sun_direction).normalized();
  options.irradiance_W_m2 = settings.get(key::irradiance);
  options.table_W_m2 = settings.get(key::table_irradiance);
  std::optional<TorqueSurface> infrared;
  if (settings.has(key::infrared_table))
    infrared = sphere_of(settings, key::infrared_table, "the planet's light");
  return make_disturbance<PlanetLight>(
      {parameters_of(settings, planet_factor)}, Stage::torque, {}, options,
      sphere_of(settings, key::table, "the planet's light"), std::move(infrared));
}

}  // namespace

DisturbanceKind kind() {
  return {
      .name = "planet_light",
      .summary = "sunlight that the planet reflects, and its infrared, push on a spacecraft",
      .read = read,
      .screening = {.reason_against = "needs a table that torque-map traces for this spacecraft"},
      .keys = {key::table, key::infrared_table, key::table_irradiance, key::irradiance,
               key::sun_direction, key::albedo, key::emissivity, key::zonal, key::date_year,
               planet_factor}};
}

}  // namespace photorque::kinds::planet_light

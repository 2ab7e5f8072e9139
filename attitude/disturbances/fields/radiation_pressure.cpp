// The pressure of light, in one of two forms. It is proportional to the illumination in an eclipse.
//
// From a table of the ray tracer (torque_surface.h): T = scale · table(attitude). A table over tilt
// and heading applies to light that is symmetric about the vertical (a projector overhead). A table
// over azimuth and elevation applies to distant light from one direction. The tracer sums the
// momentum in minus the momentum out for each ray; the cosine of eq. 29 is already part of the
// irradiance (docs/physics.md).
//
// Of sunlight on a spacecraft with few known properties: T = p s × a. p = 4.54e-6 Pa/r² is the
// pressure at r au from the Sun and s the unit vector towards it. a is the sum over the lit
// surfaces of projected area times position from the centre of mass, times one plus the reflected
// fraction (J. R. Wertz, Spacecraft Attitude Determination and Control, 1978, sec. 17.2.2). The
// projected area is assumed to be independent of the direction of the Sun.
#include "attitude/disturbances/fields/torque_surface.h"
#include "attitude/disturbances/kind.h"
#include "core/constants.h"

namespace photorque::kinds::radiation_pressure {
namespace {

constexpr ScalarKey factor("scale", 1.0, {}, "factor on the torque");

class RadiationPressure final : public TorqueLaw<RadiationPressure> {
 public:
  RadiationPressure(TorqueSurface surface, const Vec3& sun_direction_lab)
      : surface_(std::move(surface)), sun_direction_lab_(sun_direction_lab) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    if (surface_.angles() == WrenchTable::Angles::azimuth_elevation) {
      return own[factor] * now.illumination *
             look_up_towards<T>(surface_, now.to_body(sun_direction_lab_.template cast<T>()));
    }
    // Small distance from the pole, where the second angle has no derivative.
    constexpr double pole_offset = 1e-9;
    const Vec3Of<T> up = now.lab_from_body.row(2).transpose();
    const T x = up.x() + pole_offset, y = up.y(), across = sqrt(x * x + y * y);
    return own[factor] * now.illumination *
           look_up<T>(surface_, atan2(across, up.z()), atan2(-y, -x));
  }

 private:
  TorqueSurface surface_;
  Vec3 sun_direction_lab_;
};

constexpr auto area_moment = VectorKey("area_moment_m3",
                                       "projected area times its position from the centre of mass, "
                                       "body axes; needs `[environment.sun]`")
                                 .optional();

namespace key {
constexpr TextKey table("table",
                        "CSV of `torque-map` (`wrench_table_body.csv`): `tilt_deg`, "
                        "`heading_deg` or `elevation_deg`, `azimuth_deg`; `torque_x_N_m`, "
                        "`…_y_…`, `…_z_…`. The motion must stay within it; *or*",
                        {.optional = true});
constexpr Vec3Key sun_direction_lab(
    "sun_direction_lab",
    "towards the light, any length; required for a table with elevation and azimuth, else not "
    "allowed",
    {.optional = true});
}  // namespace key

// The vector from the spacecraft to the Sun [au], lab axes.
template <class T>
Vec3Of<T> towards_sun(const SunPath& sun, const T& time_s) {
  const auto [value, slope] = sun.at(values(time_s));
  return {chain(time_s, value[0], slope[0]), chain(time_s, value[1], slope[1]),
          chain(time_s, value[2], slope[2])};
}

class SunPressure final : public TorqueLaw<SunPressure> {
 public:
  explicit SunPressure(SunPath sun) : sun_(std::move(sun)) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    constexpr double at_1_au_Pa = solar_irradiance_W_m2 / speed_of_light_m_s;
    const Vec3Of<T> towards = towards_sun(sun_, now.time_s);
    const T square = towards.dot(towards);
    const T pressure = at_1_au_Pa * now.illumination / (square * sqrt(square));
    return pressure * now.to_body(towards).cross(own[area_moment]);
  }

 private:
  SunPath sun_;
};

Disturbance read_of_sun(const Settings& settings, const DisturbanceContext& context) {
  if (!context.environment.sun) {
    throw settings.error(area_moment, "no [environment.sun]", "where the Sun is");
  }
  return make_disturbance<SunPressure>({parameters_of(settings, area_moment)}, Stage::torque, {},
                                       *context.environment.sun);
}

// If the experiment gives the Sun's direction, its pressure may be a missing effect.
std::vector<Parametrisation> of_experiment(const DisturbanceContext& context) {
  if (!context.environment.sun) return {};
  return {
      {"sunlight exerts a torque about the centre of mass that changes with the direction of the "
       "Sun",
       {EffectKey::vector(area_moment.name, 1.0)}}};
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  if (settings.has(area_moment.name)) return read_of_sun(settings, context);
  const TorqueSurface surface(read_wrench_table(file_of(settings, key::table)));
  Vec3 sun_direction_lab = Vec3::UnitZ();
  if (surface.angles() == WrenchTable::Angles::azimuth_elevation) {
    sun_direction_lab = direction_of(settings, key::sun_direction_lab);
  }
  return make_disturbance<RadiationPressure>({parameters_of(settings, factor)}, Stage::torque, {},
                                             surface, sun_direction_lab.normalized());
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "radiation_pressure",
          .summary = "light exerts pressure on the surfaces that it meets",
          .read = read,
          .screening = {.of_experiment = of_experiment,
                        .widths = "`area_moment_m3` 1 each; needs `[environment.sun]`"},
          .budget = {.paper_figure = "radiation_torque_at_30_deg_N_m"},
          .keys = {key::table, area_moment, key::sun_direction_lab, factor}};
}

}  // namespace photorque::kinds::radiation_pressure

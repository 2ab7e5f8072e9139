// The pressure of light, from a table that the tracer made: T = scale · table(attitude).
//
// table: a CSV file (torque_surface.h), its path relative to the experiment's. A table over tilt
// and heading holds for light that is the same all round the vertical (a beamer overhead); a table
// over azimuth and elevation for far light from one direction, sun_direction_lab[3], towards the
// light. scale: default 1. In eclipse the torque falls with the illumination.
//
// Per ray, the tracer counts momentum in minus momentum out; eq. 29's cosine is inside the
// irradiance already (docs/physics.md).
#include "attitude/disturbances/fields/surface_lookup.h"
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

constexpr ScalarKey factor{"scale"};

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
    // A hair off the pole, where the second angle has no derivative.
    constexpr double hair = 1e-9;
    const Vec3Of<T> up = now.lab_from_body.row(2).transpose();
    const T x = up.x() + hair, y = up.y(), across = sqrt(x * x + y * y);
    return own[factor] * now.illumination *
           look_up<T>(surface_, atan2(across, up.z()), atan2(-y, -x));
  }

 private:
  TorqueSurface surface_;
  Vec3 sun_direction_lab_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  const TorqueSurface surface(read_wrench_table(file_of(settings, "table")));
  Vec3 sun_direction_lab = Vec3::UnitZ();
  if (surface.angles() == WrenchTable::Angles::azimuth_elevation) {
    sun_direction_lab = settings.vector3("sun_direction_lab");
    if (!(sun_direction_lab.norm() > 0.0)) {
      throw settings.error("sun_direction_lab", "a zero vector", "a direction");
    }
  }
  return make_disturbance<RadiationPressure>({scalar_parameter_or(settings, factor, 1.0)},
                                             Stage::torque, {}, surface,
                                             sun_direction_lab.normalized());
}

}  // namespace

DisturbanceKind radiation_pressure_kind() {
  return {
      .name = "radiation_pressure",
      .summary = "light pushes on what it falls on",
      .read = read,
      .screening = {.reason_against = "needs a table that torque-map traces for this platform"},
      .injection = {.reason_against = "needs a traced table"},
      .budget = {.paper_figure = "radiation_torque_at_30_deg_N_m"},
      .keys = {Key::text("table",
                         "CSV of `torque-map` (`wrench_table_body.csv`): `tilt_deg`, `heading_deg` "
                         "or `elevation_deg`, `azimuth_deg`; `torque_x_N_m`, `…_y_…`, `…_z_…`. The "
                         "motion must stay within it"),
               Key::vector3(
                   "sun_direction_lab",
                   "towards the light, any length; only, and always, with elevation and azimuth")
                   .optional(),
               Key::uncertain_or("scale", 1.0, {}, "factor")}};
}

}  // namespace photorque

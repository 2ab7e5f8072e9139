// The pressure of light, from a table that the tracer made: T = scale · table(attitude).
//
// table: a CSV file (torque_surface.h), its path relative to the experiment's. A table over tilt
// and heading holds for light that is the same all round the vertical (a beamer overhead); a table
// over azimuth and elevation for far light from one direction, sun_direction_lab[3], towards the
// light. scale: default 1. In eclipse the torque falls with the illumination.
//
// Per ray, the tracer counts momentum in minus momentum out; eq. 29's cosine is inside the
// irradiance already (docs/physics.md).
#include "attitude/disturbances/fields/torque_surface.h"
#include "attitude/disturbances/kind.h"

namespace photorque {
namespace {

constexpr ScalarKey factor{"scale"};

// f(x, y) with its derivatives, from lanes of numbers.
Lanes combine(const Lanes&, const Lanes&, const Lanes& f, const Lanes&, const Lanes&) {
  return f;
}
DualLanes combine(const DualLanes& x, const DualLanes& y, const Lanes& f, const Lanes& by_x,
                  const Lanes& by_y) {
  return DualLanes::chain(x, y, f, by_x, by_y);
}

class RadiationPressure final : public TorqueLaw<RadiationPressure> {
 public:
  RadiationPressure(TorqueSurface surface, const Vec3& sun_direction_lab)
      : surface_(std::move(surface)), sun_direction_lab_(sun_direction_lab) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    // A hair off the pole, where the second angle has no derivative.
    constexpr double hair = 1e-9;
    const bool tilt = surface_.angles() == WrenchTable::Angles::tilt_heading;
    const Vec3Of<T> light = tilt ? Vec3Of<T>(now.lab_from_body.row(2).transpose())
                                 : now.to_body(sun_direction_lab_.template cast<T>());
    const T x = light.x() + hair, y = light.y(), across = sqrt(x * x + y * y);
    return own[factor] * now.illumination *
           (tilt ? look_up<T>(atan2(across, light.z()), atan2(-y, -x))
                 : look_up<T>(atan2(light.z(), across), atan2(y, x)));
  }

 private:
  template <class T>
  Vec3Of<T> look_up(const T& polar_rad, const T& around_rad) const {
    std::array<Lanes, 3> value, by_polar, by_around;
    for (int i = 0; i < Lanes::count; ++i) {
      const TorqueSurface::Sample at = surface_.at({values(polar_rad)[i], values(around_rad)[i]});
      for (int k = 0; k < 3; ++k) {
        value[k].set(i, at.torque_body_N_m[k]);
        by_polar[k].set(i, at.by_polar[k]);
        by_around[k].set(i, at.by_around[k]);
      }
    }
    Vec3Of<T> torque;
    for (int k = 0; k < 3; ++k) {
      torque[k] = combine(polar_rad, around_rad, value[k], by_polar[k], by_around[k]);
    }
    return torque;
  }

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

// The residual atmosphere pushes on a spacecraft in a low orbit: T = scale ½ρv² table(direction
// that the wind comes from). Needs an `orbit`, which does not change. v is the velocity of the
// orbit less that of an atmosphere that turns with the Earth.
//
// The table is per pascal of dynamic pressure; speed ratio, accommodation and temperatures are
// those of its gas flow. The mean atmosphere is attitude/environment/thermosphere.h.

#include "attitude/disturbances/fields/torque_surface.h"
#include "attitude/disturbances/kind.h"
#include "attitude/environment/thermosphere.h"
#include "attitude/environment/time_series.h"

namespace photorque::kinds::aerodynamic_drag {
namespace {

constexpr ScalarKey factor("scale", 1.0, {}, "factor on the torque");
constexpr auto stated_density = ScalarKey("density_kg_m3", Range::not_negative(),
                                          "density of the atmosphere; *or*", factor.end())
                                    .optional();

namespace key {
constexpr TextKey table("table",
                        "CSV of `torque-map` over the sphere (`elevation_deg`, `azimuth_deg`; "
                        "`torque_x_N_m`, …) for `[torque_map.molecular_flow]`");
constexpr TextKey density_file(
    "density_file", "CSV: `t_s`, `density_kg_m3`, constant before its first and after its last row",
    {.usually = "a mean atmosphere by the altitude above WGS 84"});
}  // namespace key

struct StatedDensity {
  template <class T>
  T at(const ParametersAndStates<T>& own, const EvaluationContext<T>&) const {
    return own[stated_density];
  }
};

struct RecordedDensity {
  TimeSeries density_kg_m3;

  template <class T>
  T at(const ParametersAndStates<T>&, const EvaluationContext<T>& now) const {
    return from_values(now.time_s, [&](double t_s) { return density_kg_m3.at(t_s, 0); });
  }
};

struct MeanDensity {
  Thermosphere atmosphere;

  template <class T>
  T at(const ParametersAndStates<T>&, const EvaluationContext<T>& now) const {
    return from_values(ellipsoid_altitude_m<T>(now.orbit_position_lab_m),
                       [&](double altitude_m) { return atmosphere.at(altitude_m); });
  }
};

template <class Density>
class AerodynamicDrag final : public TorqueLaw<AerodynamicDrag<Density>> {
 public:
  AerodynamicDrag(TorqueSurface surface, Density density)
      : surface_(std::move(surface)), density_(std::move(density)) {}

  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& at_m = now.orbit_position_lab_m;
    const T square_m2 = at_m.dot(at_m);
    if (values(square_m2)[0] == 0.0) return Vec3Of<T>::Constant(T(0.0));  // on the ground
    Vec3Of<T> velocity_m_s = now.orbit_velocity_lab_m_s;
    velocity_m_s.x() += earth_rate_rad_s * at_m.y();
    velocity_m_s.y() -= earth_rate_rad_s * at_m.x();
    const T pressure_Pa = 0.5 * density_.at(own, now) * velocity_m_s.dot(velocity_m_s);
    return own[factor] * pressure_Pa * look_up_towards<T>(surface_, now.to_body(velocity_m_s));
  }

  std::vector<Switch> switches(std::span<const Parameter>) const override {
    if constexpr (std::is_same_v<Density, RecordedDensity>) {
      return switches_at(density_.density_kg_m3.ends_s());
    }
    return {};
  }

 private:
  TorqueSurface surface_;
  Density density_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  const TorqueSurface surface = sphere_of(settings, key::table, "the wind");
  const PlacedParameters scale = parameters_of(settings, factor);
  const auto drag = [&](std::initializer_list<PlacedParameters> parameters, auto density) {
    return make_disturbance<AerodynamicDrag<decltype(density)>>(parameters, Stage::torque, {},
                                                                surface, std::move(density));
  };
  if (settings.has(stated_density.name)) {
    if (settings.has(key::density_file)) {
      throw settings.error(key::density_file, "a file beside density_kg_m3", "one of the two");
    }
    return drag({scale, parameters_of(settings, stated_density)}, StatedDensity{});
  }
  if (!settings.has(key::density_file)) return drag({scale}, MeanDensity{});
  const std::string column = "density_kg_m3";
  return drag({scale}, RecordedDensity{read_time_series(file_of(settings, key::density_file),
                                                        {column, column, column})});
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "aerodynamic_drag",
          .summary = "the residual atmosphere pushes on a spacecraft in a low orbit",
          .read = read,
          .screening = {.reason_against = "needs a table that torque-map computes for this "
                                          "spacecraft"},
          .keys = {key::table, stated_density, key::density_file, factor}};
}

}  // namespace photorque::kinds::aerodynamic_drag

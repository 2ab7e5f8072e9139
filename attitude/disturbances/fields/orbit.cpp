// A spacecraft on a circular orbit instead of a platform in a laboratory: free fall, the direction
// of the Earth and its gravity gradient, its field, and its shadow. The lab axes stand for inertial
// ones, z along the Earth's axis.
//
// altitude_m above 6371.2 km, inclination_deg, ascending_node_deg (0), phase_deg (0; argument of
// latitude at time 0), greenwich_angle_deg (0);
// date_year: the field is IGRF along the orbit (none without it), known for duration_s (default
//   86400);
// sun_direction[3] (any length): full light and shadow of the Earth with its penumbra; without it
//   there is light all the time.
#include <cmath>

#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/disturbances/kind.h"
#include "attitude/environment/sun.h"
#include "core/constants.h"

namespace photorque::kinds::orbit {
namespace {

constexpr double interval_s = 20.0;  // of the table of the field

namespace key {
constexpr NumberKey altitude("altitude_m", Range::positive(), "above 6371.2 km");
constexpr NumberKey inclination("inclination_deg", {}, "of the orbit");
constexpr NumberKey ascending_node("ascending_node_deg", 0.0, {}, "of the orbit");
constexpr NumberKey phase("phase_deg", 0.0, {}, "argument of latitude at t = 0");
constexpr NumberKey greenwich_angle("greenwich_angle_deg", 0.0, {}, "at t = 0");
constexpr NumberKey date_year("date_year", {1900.0, 2035.0, false, false},
                              "field by IGRF along the orbit",
                              {.usually = "the field of `[environment]`"});
constexpr NumberKey duration("duration_s", 86400.0, {0.0, 1e6 * interval_s, true, false},
                             "with `date_year`: duration of the field; its end is held");
constexpr Vec3Key sun_direction("sun_direction",
                                "towards the Sun, any length: shadow with penumbra",
                                {.usually = "always light"});
}  // namespace key

constexpr double mean_radius_m = 6371.2e3;

class Orbit final : public LawOf<Orbit> {
 public:
  Orbit(const CircularOrbit& orbit, std::optional<TimeSeries> field_T,
        std::optional<Vec3> sun_direction)
      : orbit_(orbit), field_T_(std::move(field_T)), sun_direction_(std::move(sun_direction)) {}

  template <class T>
  void apply(const ParametersAndStates<T>&, EvaluationContext<T>& now) const {
    const T u = orbit_.phase_rad + orbit_.motion_rad_s() * now.time_s;
    const Vec3 node = orbit_.node(), ahead = orbit_.ahead();
    now.up_lab = cos(u) * node.cast<T>() + sin(u) * ahead.cast<T>();
    now.gravity_gradient_1_s2 = std::pow(orbit_.motion_rad_s(), 2);
    now.gravity_lab_m_s2 = Vec3Of<T>::Constant(T(0.0));
    if (field_T_) now.magnetic_field_lab_T = field_T_->sample(now.time_s);
    if (sun_direction_) now.illumination *= T(light(values(now.time_s)));
  }

 private:
  Lanes light(const Lanes& time_s) const {
    return each_lane(time_s, [this](double t_s) {
      return sunlit_fraction(orbit_.radius_m * orbit_.up(t_s),
                             astronomical_unit_m * *sun_direction_, mean_radius_m);
    });
  }

  CircularOrbit orbit_;
  std::optional<TimeSeries> field_T_;
  std::optional<Vec3> sun_direction_;
};

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  const CircularOrbit orbit{mean_radius_m + settings.get(key::altitude),
                            settings.get(key::inclination), settings.get(key::ascending_node),
                            settings.get(key::phase), settings.get(key::greenwich_angle)};
  std::optional<TimeSeries> field_T;
  if (settings.has(key::date_year)) {
    field_T =
        orbit_field_T(orbit, settings.get(key::date_year), settings.get(key::duration), interval_s);
  }
  std::optional<Vec3> sun_direction;
  if (settings.has(key::sun_direction)) {
    const Vec3 direction = settings.get(key::sun_direction);
    if (!(direction.norm() > 0.0)) {
      throw settings.error(key::sun_direction, "a zero vector", "a direction");
    }
    sun_direction = direction.normalized();
  }
  return make_disturbance<Orbit>({}, Stage::conditions, {}, orbit, field_T, sun_direction);
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "orbit",
          .summary = "a circular orbit around the Earth: free fall, gradient, field and shadow",
          .read = read,
          .screening = {.reason_against = "the orbit of a platform is known"},
          .budget = {.reason_against = "an orbit is the environment of the others"},
          .has_eclipses = true,
          .sets = "the magnetic field",
          .keys = {key::altitude, key::inclination, key::ascending_node, key::phase,
                   key::greenwich_angle, key::date_year, key::duration, key::sun_direction}};
}

}  // namespace photorque::kinds::orbit

// A spacecraft in orbit instead of a platform in a laboratory: free fall, the direction of the
// Earth, the gravity gradient, the magnetic field and the Earth's shadow with its penumbra. The lab
// axes are inertial, with z along the Earth's axis. The orbit is a circle or the states of an OEM.
#include <algorithm>
#include <cmath>
#include <memory>

#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/disturbances/kind.h"
#include "attitude/environment/environment.h"
#include "attitude/environment/sun.h"
#include "attitude/recordings/oem.h"
#include "core/constants.h"
#include "core/text/parse.h"

namespace photorque::kinds::orbit {
namespace {

constexpr double interval_s = 20.0;  // of the table of the field

namespace key {
constexpr NumberKey altitude("altitude_m", Range::positive(),
                             "altitude of a circular orbit above a radius of 6371.2 km",
                             {.optional = true});
constexpr NumberKey inclination("inclination_deg", {}, "inclination of a circular orbit",
                                {.optional = true});
constexpr NumberKey ascending_node("ascending_node_deg", 0.0, {},
                                   "right ascension of the ascending node of a circular orbit");
constexpr NumberKey phase("phase_deg", 0.0, {},
                          "argument of latitude at t = 0 on a circular orbit");
constexpr NumberKey greenwich_angle(
    "greenwich_angle_deg", 0.0, {},
    "rotation angle of the Earth (Greenwich) at t = 0, for a circular orbit");
constexpr TextKey ephemeris("ephemeris",
                            "instead of a circle: file of states around the Earth, CCSDS OEM (KVN "
                            "or XML)",
                            {.optional = true});
constexpr TextKey epoch("epoch", "with `ephemeris`: calendar time of t = 0, UTC",
                        {.usually = "`propagate.epoch`, else that of `propagate.initial_apm`, else "
                                    "the first usable state"});
constexpr NumberKey date_year("date_year", {1900.0, 2035.0, false, false},
                              "field by IGRF along the orbit",
                              {.usually = "the field of `[environment]`"});
constexpr NumberKey duration(
    "duration_s", 86400.0, {0.0, 1e6 * interval_s, true, false},
    "duration of the field of a circular orbit with `date_year`; afterwards the field is constant");
constexpr Vec3Key sun_direction("sun_direction",
                                "towards the Sun, any length: shadow with penumbra",
                                {.usually = "that of `[environment.sun]`, else always light"});
}  // namespace key

class Circle {
 public:
  explicit Circle(const CircularOrbit& orbit) : orbit_(orbit) {}

  template <class T>
  void apply(EvaluationContext<T>& now) const {
    const T u = orbit_.phase_rad + orbit_.motion_rad_s() * now.time_s;
    const Vec3 node = orbit_.node(), ahead = orbit_.ahead();
    now.up_lab = cos(u) * node.cast<T>() + sin(u) * ahead.cast<T>();
    now.gravity_gradient_1_s2 = std::pow(orbit_.motion_rad_s(), 2);
    const double speed_m_s = orbit_.radius_m * orbit_.motion_rad_s();
    now.orbit_position_lab_m = T(orbit_.radius_m) * now.up_lab;
    now.orbit_velocity_lab_m_s =
        T(speed_m_s) * (cos(u) * ahead.cast<T>() - sin(u) * node.cast<T>());
  }
  Vec3 position_m(double time_s) const { return orbit_.radius_m * orbit_.up(time_s); }

 private:
  CircularOrbit orbit_;
};

class Ephemeris {
 public:
  // `zero_s`: the time of t = 0 since the start of the ephemeris.
  Ephemeris(std::shared_ptr<const OrbitEphemeris> states, double zero_s)
      : states_(std::move(states)), zero_s_(zero_s) {}

  template <class T>
  void apply(EvaluationContext<T>& now) const {
    Vec3Of<T> position_m, velocity_m_s;
    for (int k = 0; k < 3; ++k) {
      position_m[k] = from_values(now.time_s, [&](double t_s) {
        const auto [value, slope] = states_->at(zero_s_ + t_s);
        return std::array<double, 2>{value[k], slope[k]};
      });
      velocity_m_s[k] = from_values(now.time_s, [&](double t_s) {
        const auto [position, velocity] = states_->at(zero_s_ + t_s);
        const double fall_1_s2 = earth_gravitation_m3_s2 / std::pow(position.norm(), 3);
        return std::array<double, 2>{velocity[k], -fall_1_s2 * position[k]};
      });
    }
    now.orbit_position_lab_m = position_m;
    now.orbit_velocity_lab_m_s = velocity_m_s;
    const T square_m2 = position_m.dot(position_m), distance_m = sqrt(square_m2);
    now.up_lab = position_m / distance_m;
    now.gravity_gradient_1_s2 = earth_gravitation_m3_s2 / (square_m2 * distance_m);
  }
  Vec3 position_m(double time_s) const { return states_->at(zero_s_ + time_s)[0]; }

 private:
  std::shared_ptr<const OrbitEphemeris> states_;
  double zero_s_;
};

template <class Path>
class Orbit final : public LawOf<Orbit<Path>> {
 public:
  Orbit(Path path, std::optional<TimeSeries> field_T, std::optional<SunPath> sun)
      : path_(std::move(path)), field_T_(std::move(field_T)), sun_(std::move(sun)) {}

  template <class T>
  void apply(const ParametersAndStates<T>&, EvaluationContext<T>& now) const {
    path_.apply(now);
    now.gravity_lab_m_s2 = Vec3Of<T>::Constant(T(0.0));
    if (field_T_) now.magnetic_field_lab_T = field_T_->sample(now.time_s);
    if (sun_) now.illumination *= T(light(values(now.time_s)));
  }

 private:
  Lanes light(const Lanes& time_s) const {
    return each_lane(time_s, [this](double t_s) {
      return sunlit_fraction(path_.position_m(t_s), astronomical_unit_m * sun_->at(t_s)[0],
                             reference_radius_of_earth_m);
    });
  }

  Path path_;
  std::optional<TimeSeries> field_T_;
  std::optional<SunPath> sun_;
};

std::optional<SunPath> read_sun_path(const Settings& settings, const DisturbanceContext& context) {
  if (!settings.has(key::sun_direction)) return context.environment.sun;
  return SunPath::fixed(direction_of(settings, key::sun_direction).normalized());
}

Disturbance read_circle(const Settings& settings, const DisturbanceContext& context) {
  if (settings.has(key::epoch)) {
    throw settings.error(key::epoch, "a calendar time of a circle",
                         "`ephemeris` beside it, or `phase_deg`");
  }
  const CircularOrbit orbit{reference_radius_of_earth_m + settings.get(key::altitude),
                            settings.get(key::inclination), settings.get(key::ascending_node),
                            settings.get(key::phase), settings.get(key::greenwich_angle)};
  std::optional<TimeSeries> field_T;
  if (settings.has(key::date_year)) {
    field_T =
        orbit_field_T(orbit, settings.get(key::date_year), settings.get(key::duration), interval_s);
  }
  return make_disturbance<Orbit<Circle>>({}, Stage::conditions, {}, Circle(orbit), field_T,
                                         read_sun_path(settings, context));
}

Disturbance read(const Settings& settings, const DisturbanceContext& context) {
  if (!settings.has(key::ephemeris)) return read_circle(settings, context);
  for (const std::string_view of_circle :
       {std::string_view(key::altitude), std::string_view(key::inclination),
        std::string_view(key::ascending_node), std::string_view(key::phase),
        std::string_view(key::greenwich_angle), std::string_view(key::duration)}) {
    if (settings.has(of_circle)) {
      throw settings.error(of_circle, "a key of a circle beside `ephemeris`", "one of the two");
    }
  }
  const auto states = std::make_shared<const OrbitEphemeris>(file_of(settings, key::ephemeris));
  double zero_s = 0.0;
  if (settings.has(key::epoch)) {
    const std::optional<Epoch> zero = parse_epoch(settings.get(key::epoch));
    if (!zero) {
      throw settings.error(key::epoch, in_quotes(settings.get(key::epoch)),
                           "a time as 2000-01-01T12:00:00");
    }
    zero_s = zero->seconds_since(states->start());
    if (zero_s < 0.0 || zero_s > states->duration_s()) {
      throw settings.error(key::epoch, settings.get(key::epoch) + ", outside the ephemeris",
                           "a time from " + epoch_text(states->start()) + " to " +
                               epoch_text(states->start().after(states->duration_s())));
    }
  }
  const Ephemeris path(states, zero_s);
  std::optional<TimeSeries> field_T;
  if (settings.has(key::date_year)) {
    constexpr double most_instants = 1e6;
    const double duration_s = states->duration_s();
    field_T = orbit_field_T([&path](double t_s) { return path.position_m(t_s); },
                            states->greenwich_angle_rad() + earth_rate_rad_s * zero_s,
                            settings.get(key::date_year), -zero_s, duration_s,
                            std::max(interval_s, duration_s / most_instants));
  }
  return make_disturbance<Orbit<Ephemeris>>({}, Stage::conditions, {}, path, field_T,
                                            read_sun_path(settings, context));
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "orbit",
          .summary = "an orbit around the Earth: free fall, gradient, field and shadow",
          .read = read,
          .screening = {.reason_against = "the orbit of a platform is known"},
          .budget = {.reason_against = "an orbit is the environment of the others"},
          .has_eclipses = true,
          .sets = "the magnetic field",
          .keys = {key::altitude, key::inclination, key::ascending_node, key::phase,
                   key::greenwich_angle, key::ephemeris, key::epoch, key::date_year, key::duration,
                   key::sun_direction}};
}

}  // namespace photorque::kinds::orbit

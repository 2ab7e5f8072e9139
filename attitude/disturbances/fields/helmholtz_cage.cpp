// A coil cage that sets the field at the platform, in lab axes: it cancels the ambient field or
// applies a history. The axes of the lab are the inertial axes of an orbit (coil_cage.h). The field
// is assumed to be uniform over the platform.
#include "attitude/disturbances/fields/coil_cage.h"
#include "attitude/disturbances/kind.h"
#include "core/constants.h"
#include "core/text/parse.h"

namespace photorque::kinds::helmholtz_cage {
namespace {

constexpr ScalarKey gain_error(
    "gain_error", 0.0, {},
    "the coils produce (1 + this) times the difference to the field of `[environment]`");

namespace key {
constexpr Vec3Key field_lab("field_lab_T", {0.0, 0.0, 0.0},
                            "field set by the coils, lab axes; *or*");
constexpr TextKey field_file(
    "field_file",
    "a CSV: `t_s`, `field_x_T`, `field_y_T`, `field_z_T`, constant before its "
    "first and after its last row; *or*",
    {.optional = true});
constexpr NumberKey altitude("altitude_m", Range::not_negative(),
                             "altitude of the orbit above a radius of 6371.2 km");
constexpr NumberKey inclination("inclination_deg", {}, "inclination of the orbit");
constexpr NumberKey date_year("date_year", {1900.0, 2035.0, false, false},
                              "date of the field (IGRF)");
constexpr NumberKey duration("duration_s", Range::positive(), "duration of the table of the field");
constexpr NumberKey ascending_node("ascending_node_deg", 0.0, {},
                                   "right ascension of the ascending node");
constexpr NumberKey phase("phase_deg", 0.0, {}, "argument of latitude at t = 0");
constexpr NumberKey greenwich_angle("greenwich_angle_deg", 0.0, {},
                                    "rotation angle of the Earth (Greenwich) at t = 0");
constexpr NumberKey interval("interval_s", 20.0, Range::positive(),
                             "time between rows of the table of the field");
constexpr TableKey orbit("orbit", "the field of IGRF on a circular orbit");
}  // namespace key

class HelmholtzCage final : public LawOf<HelmholtzCage> {
 public:
  explicit HelmholtzCage(TimeSeries wanted_lab_T) : wanted_lab_T_(std::move(wanted_lab_T)) {}

  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const Vec3Of<T> missing_T =
        wanted_lab_T_.sample(now.time_s) - now.environment.magnetic_field_lab_T.template cast<T>();
    now.magnetic_field_lab_T += (1.0 + own[gain_error]) * missing_T;
  }

  std::vector<Switch> switches(std::span<const Parameter>) const override {
    return switches_at(wanted_lab_T_.ends_s());
  }

 private:
  TimeSeries wanted_lab_T_;
};

TimeSeries read_wanted_field_T(const Settings& settings) {
  if (settings.has(key::field_file)) {
    return read_time_series(file_of(settings, key::field_file),
                            {"field_x_T", "field_y_T", "field_z_T"});
  }
  if (settings.has(key::orbit)) {
    const Settings s = settings.get(key::orbit);
    const CircularOrbit orbit{reference_radius_of_earth_m + s.get(key::altitude),
                              s.get(key::inclination), s.get(key::ascending_node),
                              s.get(key::phase), s.get(key::greenwich_angle)};
    const double date_year = s.get(key::date_year);
    const double duration_s = s.get(key::duration);
    const double interval_s = s.get(key::interval);
    constexpr double most_instants = 1e6;
    if (duration_s > most_instants * interval_s) {
      throw s.error(key::duration, shortest(duration_s / interval_s) + " intervals",
                    "at most a million");
    }
    return orbit_field_T(orbit, date_year, duration_s, interval_s);
  }
  const Vec3 field_lab_T = settings.get(key::field_lab);
  return TimeSeries({0.0, 1.0}, {field_lab_T, field_lab_T});
}

Disturbance read(const Settings& settings, const DisturbanceContext&) {
  return make_disturbance<HelmholtzCage>({parameters_of(settings, gain_error)}, Stage::conditions,
                                         {}, read_wanted_field_T(settings));
}

}  // namespace

DisturbanceKind kind() {
  return {.name = "helmholtz_cage",
          .summary = "coils around the platform set the magnetic field",
          .read = read,
          .screening = {.reason_against = "the coils are a known part of the laboratory"},
          .sets = "the magnetic field",
          .keys = {
              key::field_lab, key::field_file,
              key::orbit.of({key::altitude, key::inclination, key::date_year, key::duration,
                             key::ascending_node, key::phase, key::greenwich_angle, key::interval}),
              gain_error}};
}

}  // namespace photorque::kinds::helmholtz_cage

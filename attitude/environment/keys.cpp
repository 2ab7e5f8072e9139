#include "attitude/environment/keys.h"

#include "attitude/environment/environment.h"
#include "core/constants.h"

namespace photorque {

namespace {

Key date_key(const char* name, const char* what) {
  return Key::text(name, what);
}

Key sun_table() {
  const Range declinations{-0.5 * pi, 0.5 * pi, false, false};
  return Key::table(
      "sun",
      {Key::vector3("direction", "towards the Sun, lab axes, any length; *or*").optional(),
       Key::text("table",
                 "CSV: `t_s`, `sun_x`, `sun_y`, `sun_z`, towards the Sun, lab axes, any length; "
                 "*or*")
           .optional(),
       Key::number_or("distance_au", astronomical_unit_m, Range::positive(),
                      "of the Sun, with `direction` or `table`"),
       date_key("date",
                "calendar time of t = 0, \"2015-04-27T03:00\": the Sun moves as the orbit "
                "says")
           .optional(),
       Key::table("orbit",
                  {Key::number("semi_major_axis_au", Range::positive(), "of the ellipse"),
                   Key::number_or("eccentricity", 0.0, {0.0, 1.0, false, true}, "of the ellipse"),
                   Key::number_or("inclination_deg", 0.0, {}, "to the ecliptic of J2000"),
                   Key::number_or("ascending_node_deg", 0.0, {}, "longitude"),
                   Key::number_or("perihelion_deg", 0.0, {}, "argument, from the node"),
                   Key::number("mean_anomaly_deg", {}, "at the epoch"),
                   date_key("epoch", "of the mean anomaly").usually_is("`date`")},
                  "of the spacecraft about the Sun, with `date`")
           .usually_is("the Earth's"),
       Key::table("pointing",
                  {Key::choice_or("axis", words({"x", "y", "z"}), 2, "the lab axis that points"),
                   Key::number("right_ascension_deg", {}, "J2000"),
                   Key::number("declination_deg", declinations, "J2000"),
                   Key::number_or("roll_deg", 0.0, {},
                                  "of the next axis (y after x) about it, from celestial north")},
                  "where a lab axis points in the sky, with `date`")
           .usually_is("lab axes are equatorial, J2000")},
      "where the Sun is, for `radiation_pressure`");
}

}  // namespace

Key environment_table() {
  const Environment usual;
  const Range latitudes{-0.5 * pi, 0.5 * pi, false, false}, years{1900.0, 2035.0, false, false};
  return Key::table(
      "environment",
      {Key::number_or("gravity_m_s2", standard_gravity_m_s2, Range::not_negative(),
                      "along lab −z; without it a free platform, and any with `[environment.sun]`, "
                      "feels no weight"),
       Key::number("latitude_deg", latitudes, "for `earth_rotation`")
           .usually_is("that of `igrf`, else 0"),
       Key::vector3_or("magnetic_field_T", Vec3::Zero(), "lab axes: east, north, up; *or*"),
       Key::table(
           "igrf",
           {Key::other("date", Key::a_number | Key::a_text | Key::a_date,
                       "2025-06-30, the same in quotes, or 2025.5; 1900 … 2035")
                .optional(),
            Key::number("date_year", years, "instead of `date`").optional(),
            Key::number("latitude_deg", latitudes, "geodetic"),
            Key::number("longitude_deg", {}, "east"),
            Key::number_or("height_m", 0.0, {-12e3, 1e10, false, false}, "above the ellipsoid")},
           "the field by IGRF-14"),
       sun_table().optional(),
       Key::number_or("air_temperature_K", usual.air_temperature_K, {100.0, 1000.0, false, false},
                      "of the air around"),
       Key::number_or("air_pressure_Pa", usual.air_pressure_Pa, Range::not_negative(),
                      "of the air around"),
       Key::number("air_density_kg_m3", Range::not_negative(), "from the two above")
           .usually_is("ideal gas, dry"),
       Key::number("air_viscosity_Pa_s", Range::positive(), "from the temperature")
           .usually_is("Sutherland's law")},
      "what surrounds the platform");
}

}  // namespace photorque

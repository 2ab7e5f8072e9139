#include "attitude/environment/keys.h"

#include "attitude/environment/environment.h"
#include "core/constants.h"

namespace photorque {

Key environment_table() {
  const Environment usual;
  const Range latitudes{-0.5 * pi, 0.5 * pi, false, false}, years{1900.0, 2035.0, false, false};
  return Key::table(
      "environment",
      {Key::number_or("gravity_m_s2", standard_gravity_m_s2, Range::not_negative(),
                      "along lab −z; without it a free platform feels no weight"),
       Key::number("latitude_deg", latitudes, "for `earth_rotation`")
           .usually_is("that of `igrf`, else 0"),
       Key::vector3_or("magnetic_field_T", Vec3::Zero(), "lab axes: east, north, up; *or*"),
       Key::table("igrf",
                  {Key::other("date", Key::a_number | Key::a_text | Key::a_date,
                              "2025-06-30, the same in quotes, or 2025.5; 1900 … 2035")
                       .optional(),
                   Key::number("date_year", years, "instead of `date`").optional(),
                   Key::number("latitude_deg", latitudes, "geodetic"),
                   Key::number("longitude_deg", {}, "east"),
                   Key::number_or("height_m", 0.0, {}, "above the ellipsoid")},
                  "the field by IGRF-14"),
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

#include "attitude/environment/environment.h"

#include <cmath>

#include "attitude/environment/epoch.h"
#include "attitude/environment/igrf.h"
#include "core/dry_air.h"

namespace photorque {
namespace {

namespace environment_key {
constexpr Range latitudes{-0.5 * pi, 0.5 * pi, false, false}, years{1900.0, 2035.0, false, false};
constexpr NumberKey gravity("gravity_m_s2", standard_gravity_m_s2, Range::not_negative(),
                            "acceleration of gravity along lab −z; if it is not stated, a free "
                            "platform, or one with `[environment.sun]`, is weightless");
constexpr NumberKey latitude("latitude_deg", latitudes,
                             "latitude of the laboratory, used by `earth_rotation`",
                             {.usually = "that of `igrf`, else 0"});
constexpr Vec3Key magnetic_field("magnetic_field_T", {0.0, 0.0, 0.0},
                                 "magnetic field, lab axes (east, north, up); *or*");
constexpr OtherKey date("date", Key::a_number | Key::a_text | Key::a_date,
                        "date from 1900 to 2035: 2025-06-30 (also in quotes) or 2025.5",
                        {.optional = true});
constexpr NumberKey date_year("date_year", years, "date as a decimal year, instead of `date`",
                              {.optional = true});
constexpr NumberKey igrf_latitude("latitude_deg", latitudes, "geodetic latitude");
constexpr NumberKey longitude("longitude_deg", {}, "longitude, positive to the east");
constexpr NumberKey height("height_m", 0.0, {-12e3, 1e10, false, false},
                           "height above the ellipsoid");
constexpr TableKey igrf("igrf", "magnetic field by the model IGRF-14 at a place and date");
constexpr NumberKey air_temperature("air_temperature_K", room_temperature_K,
                                    {100.0, 1000.0, false, false},
                                    "temperature of the surrounding air");
constexpr NumberKey air_pressure("air_pressure_Pa", room_pressure_Pa, Range::not_negative(),
                                 "pressure of the surrounding air");
constexpr NumberKey air_density(
    "air_density_kg_m3", Range::not_negative(),
    "density of the surrounding air; by default from temperature and pressure",
    {.usually = "ideal gas, dry"});
constexpr NumberKey air_viscosity(
    "air_viscosity_Pa_s", Range::positive(),
    "dynamic viscosity of the surrounding air; by default from the temperature",
    {.usually = "Sutherland's law"});
constexpr TableKey environment("environment", "fields, air and light around the platform");
}  // namespace environment_key

// Decimal year of `date_year`, or of `date` = 2025-06-30 or a decimal year.
double read_year(const Settings& igrf) {
  if (igrf.has(environment_key::date_year)) return igrf.get(environment_key::date_year);
  if (!igrf.has(environment_key::date))
    throw igrf.error(environment_key::date, "nothing", "a date");
  if (igrf.raw(environment_key::date).is_number())
    return igrf.number(environment_key::date, environment_key::years);
  const std::string date = igrf.text(environment_key::date);
  const auto day = parse_epoch(date.find('T') == std::string::npos ? date + "T00:00:00" : date);
  const auto year = day ? parse_epoch(date.substr(0, 4) + "-001T00:00:00") : std::nullopt;
  const auto next =
      year ? parse_epoch(std::to_string(std::stoi(date.substr(0, 4)) + 1) + "-001T00:00:00")
           : std::nullopt;
  if (!next) throw igrf.error(environment_key::date, "\"" + date + "\"", "a date like 2025-06-30");
  const double decimal_year =
      std::stoi(date.substr(0, 4)) + day->seconds_since(*year) / next->seconds_since(*year);
  if (decimal_year < environment_key::years.low || decimal_year > environment_key::years.high) {
    throw igrf.error(environment_key::date, date, "a date from 1900 to 2035");
  }
  return decimal_year;
}

Vec3 read_field_lab_T(const Settings& settings) {
  const bool measured = settings.has(environment_key::magnetic_field);
  if (!settings.has(environment_key::igrf)) {
    return settings.get(environment_key::magnetic_field);
  }
  if (measured)
    throw settings.error(environment_key::igrf, "a field beside magnetic_field_T",
                         "one of the two");
  const Settings igrf = settings.get(environment_key::igrf);
  const GeomagneticModel model(read_year(igrf));
  return model.lab_T(GeodeticPosition{igrf.get(environment_key::igrf_latitude),
                                      igrf.get(environment_key::longitude),
                                      igrf.get(environment_key::height)});
}

}  // namespace

Environment read_environment(const Settings& settings) {
  Environment e;
  const double gravity_m_s2 = settings.get(environment_key::gravity);
  e.gravity_lab_m_s2 = {0.0, 0.0, -gravity_m_s2};
  e.gravity_gradient_1_s2 = gravity_m_s2 / earth_radius_m;
  e.magnetic_field_lab_T = read_field_lab_T(settings);
  const double of_field_rad =
      settings.has(environment_key::igrf)
          ? settings.get(environment_key::igrf).get(environment_key::igrf_latitude)
          : 0.0;
  e.latitude_rad = settings.get_or(environment_key::latitude, of_field_rad);
  e.earth_rate_lab_rad_s =
      earth_rate_rad_s * Vec3(0.0, std::cos(e.latitude_rad), std::sin(e.latitude_rad));

  if (settings.has("sun")) e.sun = read_sun(settings.table("sun"));

  e.air_temperature_K = settings.get(environment_key::air_temperature);
  e.air_pressure_Pa = settings.get(environment_key::air_pressure);
  e.air_density_kg_m3 = settings.get_or(
      environment_key::air_density, dry_air_density_kg_m3(e.air_pressure_Pa, e.air_temperature_K));
  e.air_viscosity_Pa_s =
      settings.get_or(environment_key::air_viscosity, dry_air_viscosity_Pa_s(e.air_temperature_K));
  return e;
}

Key environment_table() {
  using namespace environment_key;
  return environment.of({gravity, latitude, magnetic_field,
                         igrf.of({date, date_year, igrf_latitude, longitude, height}),
                         sun_table().optional(), air_temperature, air_pressure, air_density,
                         air_viscosity});
}

}  // namespace photorque

#include "attitude/environment/environment.h"

#include <cmath>

#include "attitude/environment/epoch.h"
#include "attitude/environment/igrf.h"

namespace photorque {
namespace {

// Specific gas constant of dry air, and Sutherland's law: see environment.h.
double dry_air_density_kg_m3(double pressure_Pa, double temperature_K) {
  return pressure_Pa / (287.05 * temperature_K);
}
double dry_air_viscosity_Pa_s(double temperature_K) {
  constexpr double reference_K = 273.15, sutherland_K = 110.4;
  return 1.716e-5 * std::pow(temperature_K / reference_K, 1.5) * (reference_K + sutherland_K) /
         (temperature_K + sutherland_K);
}

// date = 2025-06-30, or a decimal year.
double read_year(const Settings& igrf) {
  constexpr Range known{1900.0, 2035.0, false, false};
  if (igrf.has("date_year")) return igrf.number("date_year", known);
  if (!igrf.has("date")) throw igrf.error("date", "nothing", "a date");
  if (igrf.raw("date").is_number()) return igrf.number("date", known);
  const std::string date = igrf.text("date");
  const auto day = parse_epoch(date.find('T') == std::string::npos ? date + "T00:00:00" : date);
  const auto year = day ? parse_epoch(date.substr(0, 4) + "-001T00:00:00") : std::nullopt;
  const auto next =
      year ? parse_epoch(std::to_string(std::stoi(date.substr(0, 4)) + 1) + "-001T00:00:00")
           : std::nullopt;
  if (!next) throw igrf.error("date", "\"" + date + "\"", "a date like 2025-06-30");
  const double decimal_year =
      std::stoi(date.substr(0, 4)) + day->seconds_since(*year) / next->seconds_since(*year);
  if (decimal_year < known.low || decimal_year > known.high) {
    throw igrf.error("date", date, "a date from 1900 to 2035");
  }
  return decimal_year;
}

Vec3 read_field_lab_T(const Settings& settings) {
  const bool measured = settings.has("magnetic_field_T");
  if (!settings.has("igrf")) {
    return settings.vector3_or("magnetic_field_T", Vec3::Zero());
  }
  if (measured) throw settings.error("igrf", "a field beside magnetic_field_T", "one of the two");
  const Settings igrf = settings.table("igrf");
  const GeomagneticModel model(read_year(igrf));
  return model.lab_T(GeodeticPosition{
      igrf.number("latitude_deg", {-pi / 2, pi / 2, false, false}), igrf.number("longitude_deg"),
      igrf.number_or("height_m", 0.0, {-12e3, 1e10, false, false})});
}

}  // namespace

Environment read_environment(const Settings& settings) {
  Environment e;
  const double gravity_m_s2 =
      settings.number_or("gravity_m_s2", standard_gravity_m_s2, Range::not_negative());
  e.gravity_lab_m_s2 = {0.0, 0.0, -gravity_m_s2};
  e.gravity_gradient_1_s2 = gravity_m_s2 / earth_radius_m;
  e.magnetic_field_lab_T = read_field_lab_T(settings);
  const Range latitudes{-pi / 2, pi / 2, false, false};
  const double of_field_rad =
      settings.has("igrf") ? settings.table("igrf").number("latitude_deg", latitudes) : 0.0;
  e.latitude_rad = settings.number_or("latitude_deg", of_field_rad, latitudes);
  e.earth_rate_lab_rad_s =
      earth_rate_rad_s * Vec3(0.0, std::cos(e.latitude_rad), std::sin(e.latitude_rad));

  if (settings.has("sun")) e.sun = read_sun(settings.table("sun"));

  e.air_temperature_K =
      settings.number_or("air_temperature_K", e.air_temperature_K, {100.0, 1000.0, false, false});
  e.air_pressure_Pa =
      settings.number_or("air_pressure_Pa", e.air_pressure_Pa, Range::not_negative());
  e.air_density_kg_m3 = settings.number_or(
      "air_density_kg_m3", dry_air_density_kg_m3(e.air_pressure_Pa, e.air_temperature_K),
      Range::not_negative());
  e.air_viscosity_Pa_s = settings.number_or(
      "air_viscosity_Pa_s", dry_air_viscosity_Pa_s(e.air_temperature_K), Range::positive());
  return e;
}

}  // namespace photorque

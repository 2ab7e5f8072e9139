#include "attitude/environment/sun.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "attitude/environment/epoch.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/settings/files.h"

namespace photorque {

namespace {

namespace sun_key {
constexpr Range declinations{-0.5 * pi, 0.5 * pi, false, false};
constexpr Vec3Key direction("direction", "direction towards the Sun, lab axes, any length; *or*",
                            {.optional = true});
constexpr TextKey table(
    "table", "CSV: `t_s`, `sun_x`, `sun_y`, `sun_z`, towards the Sun, lab axes, any length; *or*",
    {.optional = true});
constexpr NumberKey distance("distance_au", astronomical_unit_m, Range::positive(),
                             "distance of the Sun, with `direction` or `table`");
constexpr TextKey date("date",
                       "calendar time of t = 0, \"2015-04-27T03:00\": the Sun follows the orbit",
                       {.optional = true});
// Larger than the radius of the Sun.
constexpr NumberKey semi_major_axis("semi_major_axis_au", {0.005 * astronomical_unit_m, 1e308},
                                    "semi-major axis of the orbit");
constexpr NumberKey eccentricity("eccentricity", 0.0, {0.0, 1.0, false, true},
                                 "eccentricity of the orbit");
constexpr NumberKey inclination("inclination_deg", 0.0, {}, "inclination to the ecliptic of J2000");
constexpr NumberKey ascending_node("ascending_node_deg", 0.0, {},
                                   "longitude of the ascending node");
constexpr NumberKey perihelion("perihelion_deg", 0.0, {}, "argument of perihelion");
constexpr NumberKey mean_anomaly("mean_anomaly_deg", {}, "mean anomaly at `epoch`");
constexpr TextKey epoch("epoch", "calendar time of the mean anomaly", {.usually = "`date`"});
constexpr TableKey orbit("orbit", "orbit of the spacecraft about the Sun, with `date`",
                         {.usually = "the Earth's"});
constexpr ChoiceKey axis("axis", {"x", "y", "z"}, 2, "lab axis whose direction is given");
constexpr NumberKey right_ascension("right_ascension_deg", {},
                                    "right ascension of the axis, J2000");
constexpr NumberKey declination("declination_deg", declinations, "declination of the axis, J2000");
constexpr NumberKey roll(
    "roll_deg", 0.0, {},
    "angle of the next lab axis (y after x) about this axis, from celestial north");
constexpr TableKey pointing("pointing", "direction of a lab axis in the sky, with `date`",
                            {.usually = "lab axes are equatorial, J2000"});
constexpr TableKey sun("sun", "direction of the Sun, for `radiation_pressure`");
}  // namespace sun_key

// Obliquity of the ecliptic at J2000, IAU 1976.
constexpr double obliquity_rad = 23.4392911 * degree_rad;
// Gaussian mean motion: of a massless body at 1 au.
constexpr double gaussian_motion_rad_s = 0.01720209895 / 86400.0;

Mat3 equatorial_from_ecliptic() {
  return Eigen::AngleAxisd(obliquity_rad, Vec3::UnitX()).toRotationMatrix();
}

struct Direction {
  Lanes cosine, sine;
};

// The direction after a further small rotation, with an error of fourth order in the step.
Direction turned(const Direction& from, const Lanes& step_rad) {
  const Lanes square = step_rad * step_rad, c = 1.0 - 0.5 * square,
              s = step_rad * (1.0 - square / 6.0);
  return {c * from.cosine - s * from.sine, c * from.sine + s * from.cosine};
}

// Solves Kepler's equation for the eccentric anomaly with Newton's method, and Halley's method near
// the end. The start is the series to third order in the eccentricity. For large eccentricities,
// for which the series is inaccurate, it is the aphelion. Between aphelion and root, Kepler's
// equation is convex, so Newton steps do not pass the root.
Direction eccentric_anomaly(const Lanes& any_mean_rad, double eccentricity) {
  const auto to_nearest_turn = [](double x) {
    return x - 2.0 * pi * std::nearbyint(x / (2.0 * pi));
  };
  const Lanes mean_rad = each_lane(any_mean_rad, to_nearest_turn);
  const Lanes c = cos(mean_rad), s = eccentricity * sin(mean_rad);
  Lanes e_rad = eccentricity < 0.3
                    ? mean_rad + s * (1.0 + eccentricity * (c + eccentricity) - 1.5 * s * s)
                    : where_at_least(mean_rad, 0.0, pi, -pi);
  constexpr int most = 100;
  for (int i = 0; i < most; ++i) {
    const Direction at{cos(e_rad), sin(e_rad)};
    const Lanes slope = 1.0 - eccentricity * at.cosine, bend = eccentricity * at.sine;
    Lanes step_rad = (mean_rad - e_rad + bend) / slope;
    constexpr double near_rad = 1e-2;
    const Lanes halley = step_rad / (1.0 + 0.5 * step_rad * bend / slope);
    step_rad =
        where_at_least(larger_magnitude(step_rad, 0.0) - near_rad * slope, 0.0, step_rad, halley);
    const Lanes error_rad = step_rad * step_rad * step_rad / (slope * slope);
    if (largest(larger_magnitude(error_rad, 0.0)) < 1e-16) return turned(at, step_rad);
    e_rad += step_rad;
  }
  throw NumericalError("Kepler's equation: no solution at an eccentricity of " +
                       std::to_string(eccentricity));
}

Epoch read_date(const Settings& settings, const char* key) {
  std::string date = settings.text(key);
  const bool has_seconds = std::count(date.begin(), date.end(), ':') != 1;
  if (date.find('T') == std::string::npos) date += "T00:00:00";
  const auto epoch = parse_epoch(has_seconds ? date : date + ":00");
  if (!epoch) throw settings.error(key, "\"" + date + "\"", "a time as \"2015-04-27T03:00:00\"");
  return *epoch;
}

HeliocentricOrbit read_orbit(const Settings& settings, const Epoch& date) {
  HeliocentricOrbit orbit;
  orbit.semi_major_axis_au = settings.get(sun_key::semi_major_axis) / astronomical_unit_m;
  orbit.eccentricity = settings.get(sun_key::eccentricity);
  orbit.inclination_rad = settings.get(sun_key::inclination);
  orbit.ascending_node_rad = settings.get(sun_key::ascending_node);
  orbit.perihelion_rad = settings.get(sun_key::perihelion);
  orbit.mean_anomaly_rad = settings.get(sun_key::mean_anomaly);
  if (settings.has(sun_key::epoch)) {
    orbit.mean_anomaly_rad += gaussian_motion_rad_s / std::pow(orbit.semi_major_axis_au, 1.5) *
                              date.seconds_since(read_date(settings, "epoch"));
  }
  return orbit;
}

// Orientation of a lab from one axis and a roll angle. The axis points to right ascension and
// declination (equator and equinox of J2000). At a roll of zero, the next axis is as close to the
// celestial north pole as possible. The roll rotates it about the first.
Mat3 read_lab_from_equatorial(const Settings& pointing) {
  const auto axis = static_cast<Eigen::Index>(pointing.get(sun_key::axis));
  const double right_ascension_rad = pointing.get(sun_key::right_ascension),
               declination_rad = pointing.get(sun_key::declination),
               roll_rad = pointing.get(sun_key::roll);
  const double c = std::cos(declination_rad);
  const Vec3 towards(c * std::cos(right_ascension_rad), c * std::sin(right_ascension_rad),
                     std::sin(declination_rad));
  // At the pole, north is opposite to the direction of the right ascension.
  const Vec3 north(-std::sin(declination_rad) * std::cos(right_ascension_rad),
                   -std::sin(declination_rad) * std::sin(right_ascension_rad), c);
  const Vec3 next = std::cos(roll_rad) * north + std::sin(roll_rad) * towards.cross(north);
  Mat3 lab_from;
  lab_from.row(axis) = towards;
  lab_from.row((axis + 1) % 3) = next;
  lab_from.row((axis + 2) % 3) = towards.cross(next);
  return lab_from;
}

}  // namespace

HeliocentricOrbit::InPlane HeliocentricOrbit::in_plane(const Lanes& time_s) const {
  const double motion_rad_s =
      gaussian_motion_rad_s / (semi_major_axis_au * std::sqrt(semi_major_axis_au));
  const auto [cosine, sine] =
      eccentric_anomaly(mean_anomaly_rad + motion_rad_s * time_s, eccentricity);
  const double minor_au = semi_major_axis_au * std::sqrt(1.0 - eccentricity * eccentricity);
  const Lanes rate_rad_s = motion_rad_s / (1.0 - eccentricity * cosine);
  return {{semi_major_axis_au * (cosine - eccentricity), minor_au * sine},
          {-semi_major_axis_au * sine * rate_rad_s, minor_au * cosine * rate_rad_s}};
}

Mat3 HeliocentricOrbit::ecliptic_from_plane() const {
  return (Eigen::AngleAxisd(ascending_node_rad, Vec3::UnitZ()) *
          Eigen::AngleAxisd(inclination_rad, Vec3::UnitX()) *
          Eigen::AngleAxisd(perihelion_rad, Vec3::UnitZ()))
      .toRotationMatrix();
}

HeliocentricOrbit orbit_of_earth(double since_J2000_s) {
  // Mean longitude and anomaly of the Sun. The longitude is relative to the equinox of date, which
  // moves by 1.397 degrees per century relative to that of J2000.
  const double days = since_J2000_s / 86400.0, centuries = days / 36525.0;
  const double longitude_deg = 280.460 + 0.9856474 * days - 1.397 * centuries,
               anomaly_deg = 357.528 + 0.9856003 * days;
  HeliocentricOrbit orbit;
  orbit.semi_major_axis_au = 1.00000011;
  orbit.eccentricity = 0.01671;
  orbit.perihelion_rad = std::remainder(longitude_deg - anomaly_deg + 180.0, 360.0) * degree_rad;
  orbit.mean_anomaly_rad = std::remainder(anomaly_deg, 360.0) * degree_rad;
  return orbit;
}

SunPath SunPath::fixed(const Vec3& towards_lab_au) {
  SunPath path;
  path.fixed_au_ = towards_lab_au;
  return path;
}

SunPath SunPath::table(TimeSeries towards_lab, double distance_au) {
  SunPath path;
  path.fixed_au_ = distance_au * Vec3::UnitX();
  path.table_ = std::move(towards_lab);
  return path;
}

SunPath SunPath::orbit(const HeliocentricOrbit& orbit, const Mat3& lab_from_ecliptic) {
  SunPath path;
  path.orbit_ = orbit;
  path.lab_from_plane_ = (lab_from_ecliptic * orbit.ecliptic_from_plane()).leftCols<2>();
  return path;
}

std::array<Vec3Of<Lanes>, 2> SunPath::at(const Lanes& time_s) const {
  std::array<Vec3Of<Lanes>, 2> result;
  if (orbit_) {
    const HeliocentricOrbit::InPlane now = orbit_->in_plane(time_s);
    const auto towards = [&](const std::array<Lanes, 2>& v, Eigen::Index k) {
      return -(lab_from_plane_(k, 0) * v[0] + lab_from_plane_(k, 1) * v[1]);
    };
    for (Eigen::Index k = 0; k < 3; ++k) {
      result[0][k] = towards(now.position_au, k);
      result[1][k] = towards(now.velocity_au_s, k);
    }
    return result;
  }
  for (int lane = 0; lane < Lanes::count; ++lane) {
    const std::array<Vec3, 2> one = of_table(time_s[lane]);
    for (size_t of = 0; of < 2; ++of) {
      for (Eigen::Index k = 0; k < 3; ++k) result[of][k].set(lane, one[of][k]);
    }
  }
  return result;
}

std::array<Vec3, 2> SunPath::at(double time_s) const {
  if (!orbit_) return of_table(time_s);
  const auto [value, slope] = at(Lanes(time_s));
  return {Vec3(value[0][0], value[1][0], value[2][0]), Vec3(slope[0][0], slope[1][0], slope[2][0])};
}

std::array<Vec3, 2> SunPath::of_table(double time_s) const {
  if (!table_) return {fixed_au_, Vec3::Zero()};
  Vec3 value, slope;
  for (int k = 0; k < 3; ++k) {
    const auto [x, rate] = table_->at(time_s, k);
    value[k] = x;
    slope[k] = rate;
  }
  const double length = value.norm();
  if (!(length > 0.0)) {
    throw NumericalError("environment.sun.table: no direction at " + std::to_string(time_s) + " s");
  }
  const Vec3 unit = value / length;
  return {fixed_au_.norm() * unit, fixed_au_.norm() / length * (slope - unit * unit.dot(slope))};
}

SunPath read_sun(const Settings& settings) {
  const int ways = (settings.has(sun_key::direction) ? 1 : 0) +
                   (settings.has(sun_key::table) ? 1 : 0) + (settings.has(sun_key::date) ? 1 : 0);
  if (ways != 1) {
    throw settings.error(sun_key::date,
                         ways == 0 ? "nothing" : "several of direction, table and date",
                         "one of direction, table and date");
  }
  if (settings.has(sun_key::date)) {
    const Epoch date = read_date(settings, "date");
    const Epoch J2000 = *parse_epoch("2000-01-01T12:00:00");
    const HeliocentricOrbit orbit = settings.has(sun_key::orbit)
                                        ? read_orbit(settings.get(sun_key::orbit), date)
                                        : orbit_of_earth(date.seconds_since(J2000));
    Mat3 lab_from_equatorial = Mat3::Identity();
    if (settings.has(sun_key::pointing)) {
      lab_from_equatorial = read_lab_from_equatorial(settings.get(sun_key::pointing));
    }
    return SunPath::orbit(orbit, lab_from_equatorial * equatorial_from_ecliptic());
  }
  const double distance_au = settings.get(sun_key::distance) / astronomical_unit_m;
  if (settings.has(sun_key::table)) {
    const std::filesystem::path path = existing_file(
        settings, sun_key::table, std::filesystem::path(settings.where().file).parent_path());
    return SunPath::table(read_time_series(path, {"sun_x", "sun_y", "sun_z"}), distance_au);
  }
  return SunPath::fixed(distance_au * direction_of(settings, sun_key::direction).normalized());
}

namespace {

// Area of the segment that a chord at `distance` from the centre separates from a circle.
double segment_area(double radius, double distance) {
  const double cosine = std::clamp(distance / radius, -1.0, 1.0);
  return radius * radius * (std::acos(cosine) - cosine * std::sqrt(1.0 - cosine * cosine));
}

}  // namespace

double uncovered_fraction(double source_radius_rad, double cover_radius_rad,
                          double separation_rad) {
  const double a = source_radius_rad, b = cover_radius_rad, c = separation_rad;
  if (c >= a + b) return 1.0;
  if (c <= b - a) return 0.0;
  if (c <= a - b) return 1.0 - (b / a) * (b / a);
  // The lens between the circles, divided along the common chord.
  const double to_chord = (c * c + a * a - b * b) / (2.0 * c);
  const double covered = segment_area(a, to_chord) + segment_area(b, c - to_chord);
  return 1.0 - covered / (pi * a * a);
}

double sunlit_fraction(const Vec3& satellite_m, const Vec3& sun_m, double planet_radius_m,
                       double sun_radius_m) {
  const Vec3 to_sun = sun_m - satellite_m, to_planet = -satellite_m;
  const double separation = std::atan2(to_sun.cross(to_planet).norm(), to_sun.dot(to_planet));
  return uncovered_fraction(std::asin(sun_radius_m / to_sun.norm()),
                            std::asin(std::min(1.0, planet_radius_m / to_planet.norm())),
                            separation);
}

Key sun_table() {
  using namespace sun_key;
  return sun.of({direction, table, distance, date,
                 orbit.of({semi_major_axis, eccentricity, inclination, ascending_node, perihelion,
                           mean_anomaly, epoch}),
                 pointing.of({axis, right_ascension, declination, roll})});
}

}  // namespace photorque

#include "attitude/disturbances/fields/coil_cage.h"

#include <algorithm>
#include <cmath>

#include "attitude/environment/environment.h"

namespace photorque {

Vec3 polygon_area_m2(std::span<const Vec3> corners_m) {
  Vec3 twice_m2 = Vec3::Zero();
  for (size_t i = 0; i < corners_m.size(); ++i) {
    twice_m2 += corners_m[i].cross(corners_m[(i + 1) % corners_m.size()]);
  }
  return 0.5 * twice_m2;
}

Vec3 dipole_A_m2(std::span<const CurrentLoop> loops) {
  Vec3 sum_A_m2 = Vec3::Zero();
  for (const CurrentLoop& loop : loops) {
    sum_A_m2 += loop.turns * loop.current_A * loop.area_body_m2;
  }
  return sum_A_m2;
}

namespace {

namespace loop_key {
constexpr NumberKey current("current_A", {}, "current, right-handed about the area vector");
constexpr NumberKey turns("turns", 1.0, Range::positive(), "number of turns of the loop");
constexpr Vec3Key area("area_m2",
                       "area vector (normal times area) of the loop, body axes; or `corners_m`",
                       {.optional = true});
constexpr Vec3sKey corners("corners_m", "corners of the loop, at least three, body axes",
                           {.optional = true});
}  // namespace loop_key

}  // namespace

std::vector<CurrentLoop> read_current_loops(const std::vector<Settings>& loops) {
  std::vector<CurrentLoop> all;
  for (const Settings& s : loops) {
    CurrentLoop loop;
    loop.current_A = s.get(loop_key::current);
    loop.turns = s.get(loop_key::turns);
    if (s.has(loop_key::corners)) {
      const std::vector<Vec3> corners_m = s.get(loop_key::corners);
      if (corners_m.size() < 3) {
        throw s.error(loop_key::corners, std::to_string(corners_m.size()) + " points",
                      "at least 3 corners of a loop");
      }
      loop.area_body_m2 = polygon_area_m2(corners_m);
    } else {
      loop.area_body_m2 = s.get(loop_key::area);
    }
    all.push_back(loop);
  }
  return all;
}

std::vector<Key> current_loop_keys() {
  using namespace loop_key;
  return {current, turns, area, corners};
}

double CircularOrbit::motion_rad_s() const {
  return std::sqrt(earth_gravitation_m3_s2 / std::pow(radius_m, 3));
}

Vec3 CircularOrbit::node() const {
  return {std::cos(ascending_node_rad), std::sin(ascending_node_rad), 0.0};
}

Vec3 CircularOrbit::ahead() const {
  const Vec3 pole = Vec3::UnitZ();
  return std::cos(inclination_rad) * pole.cross(node()) + std::sin(inclination_rad) * pole;
}

Vec3 CircularOrbit::up(double time_s) const {
  const double u = phase_rad + motion_rad_s() * time_s;
  return std::cos(u) * node() + std::sin(u) * ahead();
}

TimeSeries orbit_field_T(const CircularOrbit& orbit, double decimal_year, double duration_s,
                         double interval_s) {
  return orbit_field_T([&orbit](double t_s) { return Vec3(orbit.radius_m * orbit.up(t_s)); },
                       orbit.greenwich_angle_rad, decimal_year, 0.0, duration_s, interval_s);
}

TimeSeries orbit_field_T(const std::function<Vec3(double)>& position_m, double greenwich_angle_rad,
                         double decimal_year, double from_s, double duration_s, double interval_s) {
  const GeomagneticModel model(decimal_year);
  const auto samples = static_cast<int>(std::ceil(duration_s / interval_s)) + 1;
  std::vector<double> times_s;
  std::vector<Vec3> fields_T;
  for (int i = 0; i < samples; ++i) {
    const double t_s = from_s + i * interval_s;
    const Vec3 at_m = position_m(t_s), up = at_m.normalized();
    const double right_ascension_rad = std::atan2(up.y(), up.x());
    const Vec3 ned_T = model.north_east_down_T(
        GeocentricPosition{at_m.norm(), std::acos(std::clamp(up.z(), -1.0, 1.0)),
                           right_ascension_rad - greenwich_angle_rad - earth_rate_rad_s * t_s});
    const Vec3 east(-std::sin(right_ascension_rad), std::cos(right_ascension_rad), 0.0);
    times_s.push_back(t_s);
    fields_T.push_back(ned_T.x() * up.cross(east) + ned_T.y() * east - ned_T.z() * up);
  }
  return TimeSeries(std::move(times_s), fields_T);
}

}  // namespace photorque

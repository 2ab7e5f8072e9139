#include "attitude/disturbances/fields/current_loop.h"

#include "core/constants.h"

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

std::vector<CurrentLoop> read_current_loops(const std::vector<Settings>& loops) {
  std::vector<CurrentLoop> all;
  for (const Settings& s : loops) {
    CurrentLoop loop;
    loop.current_A = s.number("current_A");
    loop.turns = s.number_or("turns", 1.0, Range::positive());
    if (s.has("corners_m")) {
      const std::vector<Vec3> corners_m = s.vectors3("corners_m");
      if (corners_m.size() < 3) {
        throw s.error("corners_m", std::to_string(corners_m.size()) + " points",
                      "at least 3 corners of a loop");
      }
      loop.area_body_m2 = polygon_area_m2(corners_m);
    } else {
      loop.area_body_m2 = s.vector3("area_m2");
    }
    all.push_back(loop);
  }
  return all;
}

// μ₀I/4π (a × b)(|a| + |b|) / (|a||b|(|a||b| + a·b)), a and b from the point to the ends: Biot and
// Savart integrated along the wire, in the form that does not cancel far from it.
Vec3 straight_wire_field_T(const Vec3& from_m, const Vec3& to_m, double current_A,
                           const Vec3& at_m) {
  const Vec3 a = from_m - at_m, b = to_m - at_m;
  const double product = a.norm() * b.norm();
  return vacuum_permeability_N_A2 * current_A / (4.0 * pi) * (a.norm() + b.norm()) /
         (product * (product + a.dot(b))) * a.cross(b);
}

Vec3 polygon_field_T(std::span<const Vec3> corners_m, double current_A, const Vec3& at_m) {
  Vec3 sum_T = Vec3::Zero();
  for (size_t i = 0; i < corners_m.size(); ++i) {
    sum_T +=
        straight_wire_field_T(corners_m[i], corners_m[(i + 1) % corners_m.size()], current_A, at_m);
  }
  return sum_T;
}

}  // namespace photorque

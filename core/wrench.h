// Force and torque on a body, and tables of them over its attitude.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/transform.h"

namespace photorque {

enum class Frame { body, lab };

// A force and its torque about the point `about_m`; all three are components in `frame`.
struct Wrench {
  Vec3 force_N = Vec3::Zero();
  Vec3 torque_N_m = Vec3::Zero();
  Vec3 about_m = Vec3::Zero();
  Frame frame = Frame::body;
};

// A wrench that was estimated. `covariance` is that of the mean, in the order (force, torque) and
// the units N², N² m, N² m²: errors of force and torque are correlated, and only the whole matrix
// can be moved to another point or frame.
struct WrenchEstimate {
  Wrench mean;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  // One standard error per component, in the frame of `mean`. After a rotation, rounding may make
  // the variance of an exact component negative.
  Vec3 force_error_N() const { return covariance.diagonal().head<3>().cwiseMax(0.0).cwiseSqrt(); }
  Vec3 torque_error_N_m() const {
    return covariance.diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt();
  }
};

// Force and torque (x, y, z each) as one row of numbers.
using WrenchComponents = std::array<double, 6>;

// Mean and covariance of the mean from independent, identically distributed replicates, at least
// two. With R replicates the covariance has rank ≤ R − 1.
WrenchEstimate wrench_from_replicates(std::span<const WrenchComponents> replicates,
                                      const Vec3& about_m, Frame frame = Frame::body);

// The wrench with its torque about another point of the same frame: T(p') = T(p) + (p − p') × F.
Wrench wrench_about(const Wrench& wrench, const Vec3& about_m);
WrenchEstimate wrench_about(const WrenchEstimate& wrench, const Vec3& about_m);

// The wrench on a body as a table over two angles. With it, a simulation of the attitude includes
// light without tracing.

// The two angles of a table.
struct TableAngles {
  double polar_rad = 0.0;   // tilt or elevation
  double around_rad = 0.0;  // heading or azimuth
};

// Body-frame wrenches on the grid `around_rad` × `polar_rad`, around outermost.
struct WrenchTable {
  enum class Angles {
    // Attitude of a platform under fixed light: polar is the tilt from the vertical in [0, π],
    // around the heading of the tilt, as in lab_from_body_at().
    tilt_heading,
    // Direction towards a distant light, in body axes: polar is the elevation in [−π/2, π/2]
    // above the xy plane, around the azimuth from x towards y.
    azimuth_elevation,
  };

  Angles angles = Angles::tilt_heading;
  std::vector<double> polar_rad;   // strictly ascending, at least one
  std::vector<double> around_rad;  // strictly ascending, at least one, spanning at most 2π
  Vec3 about_body_m = Vec3::Zero();
  std::vector<Vec3> force_body_N;
  std::vector<Vec3> torque_body_N_m;
  std::vector<Vec3> force_error_N;     // one standard error per component; zero where exact
  std::vector<Vec3> torque_error_N_m;  // zero where exact

  size_t nodes() const { return polar_rad.size() * around_rad.size(); }
  size_t node(size_t around, size_t polar) const { return around * polar_rad.size() + polar; }
};

// A table of zeros on the given grid. Throws InputError if an axis is empty, not ascending or
// outside the range stated above.
WrenchTable make_wrench_table(WrenchTable::Angles angles, std::vector<double> polar_rad,
                              std::vector<double> around_rad,
                              const Vec3& about_body_m = Vec3::Zero());

// Sets the wrench of a node from one in the body frame; its torque is converted to the reference
// point of the table.
void set_node(WrenchTable& table, size_t node, const WrenchEstimate& wrench);

// The wrench between the nodes, bilinear in the two angles. The second angle is periodic if
// the table covers the full circle (the gap between last and first node is at most its widest
// step); at a pole it has no effect. NumericalError outside the grid (by more than 1e-9 rad).
Wrench wrench_at(const WrenchTable& table, const TableAngles& angles);

// Azimuth and elevation of a direction in body axes (any length but zero), and back (unit length).
TableAngles azimuth_and_elevation(const Vec3& towards_light_body);
Vec3 towards_light(const TableAngles& azimuth_elevation);

// The table with equivalent nodes replaced by their mean: nodes at a pole (tilt 0 or 180 deg,
// elevation ±90 deg), and nodes whose azimuths differ by 360 deg.
WrenchTable single_valued(const WrenchTable& table);

// All forces and torques times `factor`: from a table per unit pressure to one at a given pressure.
WrenchTable scaled(const WrenchTable& table, double factor);

// For azimuth and elevation: the mean over the sphere of the force along the light's travel [N].
// Positive for every passive body; a negative value indicates the opposite sign convention.
double mean_push_N(const WrenchTable& table);

}  // namespace photorque

// A function of attitude, tabulated at chosen attitudes and refined until the interpolation is
// accurate.
//
// The coordinates are chosen so that functions of an attitude are smooth. u is a direction fixed in
// the lab, expressed in body axes. Its position is given on the half of the sphere about +z or −z
// of the body by its stereographic projection from the opposite pole: p = 2 tan(θ/2) towards u,
// with |p| ≤ 2 on the half and p = 0 at its pole. The remaining rotation is about u: the twist ψ of
// the swing–twist decomposition. In quaternions q = (0, 0, ψ) ⊗ swing(p). Both maps are rational
// and have no singularity on their half. Light that is symmetric about u depends on p alone.
//
// Over p, the leaves of a quadtree contain a polynomial of degree 4 in each coordinate through 5 ×
// 5 values. Over ψ, a trigonometric polynomial goes through equidistant values in one period.
// Samples of the function determine its number of periods in a turn, and whether it depends on ψ.
// Between leaves of different size, the interpolant jumps by less than its error.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/transform.h"

namespace photorque {

class Snapshot;

struct RotationPoint {
  int half = 0;  // 0: u within 90 deg of body +z; 1: of body −z, with body x turned by half a turn
  double x = 0.0, y = 0.0;  // p
  double twist_rad = 0.0;   // any angle; values that differ by 2π are equal
};

// ∂(x, y, twist)/∂(w, x, y, z) of the quaternion, row by row.
using RotationSlopes = std::array<std::array<double, 4>, 3>;

// The table coordinates of an attitude. The fixed direction is z of the outer frame (multiply
// lab_from_body from the left to rotate another direction there). The quaternion may have any
// length except zero; q and −q give the same result. `slopes`, if not null, receives the
// derivatives.
RotationPoint point_of(const Quat& q, RotationSlopes* slopes = nullptr);

// The attitude at a point; the inverse of point_of().
Quat rotation_at(const RotationPoint& point);

// |p| at an angle from the pole of a half, in [0, π).
double radius_at(double angle_rad);

// Values of all channels at one attitude, and their standard errors (as many, zero where exact).
struct RotationSample {
  std::vector<double> value, error;
};

// The function, for several attitudes at a time.
using RotationFunction = std::function<std::vector<RotationSample>(std::span<const Quat>)>;

struct RotationTableOptions {
  // Turns the lab so that the direction about which the function changes least is its z axis.
  Quat axis_from_lab = Quat::Identity();
  // Largest angle between that direction and body z at which the table is used, in (0, π].
  double max_angle_rad = 0.0;
  // Allowed error of each channel, relative to the largest size of any channel of its group.
  double tolerance = 1e-3;
  std::vector<int> group_of_channel;  // from 0
  size_t max_samples = 20000;
  uint64_t seed = 1;         // seed of the attitudes of the final check
  size_t check_points = 24;  // minimum number of new attitudes in the final check
};

// Interpolation error of a table at independent attitudes.
struct RotationTableError {
  std::vector<double> scale;  // per group: the largest size of any of its channels
  std::vector<double> rms;    // per group, of the deviations, in the unit of the channels
  std::vector<double> max;
  std::vector<double> noise;  // per group: root mean square of the standard errors of the samples
  size_t points = 0;
};

// Error for an attitude outside a table.
class BeyondTable : public NumericalError {
 public:
  explicit BeyondTable(
      const std::string& what = "an attitude beyond the table of light over attitude")
      : NumericalError(what) {}
};

class RotationTable {
 public:
  static constexpr int degree = 4, side = degree + 1, nodes = side * side;

  RotationTable() = default;

  // Values of the channels from `first` on, as many as `values` has elements. Throws BeyondTable
  // for an attitude more than a twentieth beyond max_angle_rad.
  void at(const Quat& lab_from_body, size_t first, std::span<double> values) const;
  // Values and their derivatives by w, x, y, z of the quaternion: slopes[4 · channel + component].
  void at(const Quat& lab_from_body, size_t first, std::span<double> values,
          std::span<double> slopes) const;

  // A table of some channels alone, which is evaluated faster. The error is that of all channels.
  RotationTable only(size_t first, size_t count) const;

  size_t channels() const { return channels_; }
  size_t samples() const { return channels_ == 0 ? 0 : values_.size() / (channels_ * twists_); }
  // Number of values over one period of ψ; 1: the function does not depend on ψ within the
  // tolerance.
  size_t twists() const { return twists_; }
  // Number of periods of the function in a turn of ψ.
  int fold() const { return fold_; }
  size_t leaves() const { return leaves_; }
  const RotationTableError& error() const { return error_; }

  // The table as bytes, and back. read() returns false for bytes that are not a valid table.
  std::string bytes() const;
  bool read(const std::string& bytes);

 private:
  friend class RotationTableBuilder;
  // Without padding, so that equal tables are equal bytes.
  struct Box {
    double x = 0.0, y = 0.0, width = 0.0;  // lower corner
    // The polynomial that is valid here: its corner and width, and its values.
    double node_x = 0.0, node_y = 0.0, node_width = 0.0;
    std::array<uint32_t, nodes> sample{};
    int32_t children = -1;  // the first of four, −1 for a leaf
  };
  struct Place {
    const Box* box;
    double x, y;  // in units of the nodes' spacing, 0 … degree
    double twist_rad;
  };
  Place place(const Quat& lab_from_body, RotationSlopes* slopes) const;
  void keep(Snapshot& snapshot);

  Quat axis_from_lab_ = Quat::Identity();
  double half_width_ = 0.0;  // half-width of the squares of p
  size_t channels_ = 0, twists_ = 1, leaves_ = 0;
  int fold_ = 1;
  std::array<int32_t, 2> roots_{-1, -1};
  std::vector<Box> boxes_;
  std::vector<double> values_;  // [sample][harmonic of ψ][channel]
  RotationTableError error_;
};

// Samples `function` and refines. `progress` receives the number of samples so far and the task.
// Throws NumericalError if `max_samples` do not suffice.
RotationTable make_rotation_table(
    const RotationFunction& function, const RotationTableOptions& options,
    const std::function<void(size_t, const std::string&)>& progress = {});

}  // namespace photorque

// The shape of a torque that follows no known law: its axes, functions and variables.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/settings/keys.h"

namespace photorque {

// Cubic Hermite interpolation with the slopes of the parabolas through three neighbouring knots
// (Catmull and Rom, for knots at any distances). It is once continuously differentiable, linear in
// the values and exact for parabolas. Each value acts within two intervals of its knot. The error
// is of third order in the distance of the knots.
class SmoothTable {
 public:
  SmoothTable() = default;
  // NumericalError unless there are at least four increasing knots.
  explicit SmoothTable(std::vector<double> knots);

  // Weights of four neighbouring values at x, and their slopes. x may lie slightly outside the
  // knots (the last cubic is extended).
  struct Weights {
    int first = 0;  // index of the first of the four knots
    std::array<double, 4> value = {}, slope = {};
  };
  Weights at(double x) const;

  const std::vector<double>& knots() const { return knots_; }

 private:
  // The slope at a knot is the sum of three neighbouring values with these weights.
  struct Slope {
    size_t first = 0;
    std::array<double, 3> weight = {};
  };
  Slope slope_at(size_t knot) const;

  std::vector<double> knots_;
  std::vector<Slope> slopes_;
};

// Axes of the torque. Each has one or more components, with one coefficient per component.
enum class TorqueAxes {
  body,          // body x, y, z
  lab,           // lab x, y, z
  vertical,      // lab z
  lean,          // the horizontal tilt axis; positive: reduces the tilt
  rate,          // against the rate: positive brakes
  rate_by_axis,  // against the rate, body x, y, z with separate coefficients
  command,       // along the commanded torque
  cross_talk,    // the commanded torque's components about other axes: xy, xz, yx, yz, zx, zy, the
                 // first the axis of the torque, the second that of the command
};

enum class MotionVariable { yaw, tilt, rate, time, charge, command };

enum class FunctionForm {
  harmonics,  // cos n x, sin n x of the yaw, or of 2π t/period, for each order n
              // (0: a constant)
  power,      // (x/reference)^exponent
  powers,     // (x/reference)^n for each order n
  decay,      // exp(−t/τ)
  cosines,    // cos(n π t/span) for each order n
  table,      // a smooth table: one term for each knot
};

// A function of one variable, a sum of terms with free coefficients. SI.
struct MotionFunction {
  MotionVariable of = MotionVariable::tilt;
  FunctionForm form = FunctionForm::power;
  std::vector<int> orders = {};
  double reference = 1.0;  // of powers; of cosines the span
  double own = 0.0;        // exponent, time constant or period, where the form has one
  SmoothTable table = {};
  // Beyond this range the variable is constant, after a smooth transition of at most a twentieth of
  // the range.
  std::optional<std::array<double, 2>> range = {};

  size_t terms() const;
  // The key of its exponent, time constant or period; empty: it has none.
  std::string own_key() const;
};

struct EmpiricalShape {
  std::vector<TorqueAxes> axes;
  std::vector<MotionFunction> functions;  // one or two, whose terms are multiplied

  size_t components() const;
  size_t terms() const;
  // Index of the first coefficient among the parameters, after those of the functions.
  size_t first_coefficient() const;
  size_t coefficients() const { return components() * terms(); }
};

inline constexpr const char* empirical_coefficients = "coefficients_N_m";

size_t components_of(TorqueAxes axes);
std::string name_of(TorqueAxes axes);
std::string name_of(MotionVariable variable);
// Unit of the variable in files and reports: "deg", "rad_s", "s", "Ah", "N_m".
std::string unit_of(MotionVariable variable);
// Default value at which the powers of the variable are 1, SI.
double usual_reference(MotionVariable variable);

// Reads a shape from the keys of an experiment file (listed in empirical_torque.cpp). InputError
// for keys that are missing, duplicate or inconsistent.
EmpiricalShape read_shape(const Settings& settings);
// The shape as keys and values of TOML that read_shape() reads, without the parameters of the
// functions and the coefficients, which may have sigmas.
std::vector<std::pair<std::string, std::string>> shape_as_written(const EmpiricalShape& shape);

// The disturbance with zero coefficients and the functions' parameters at their values.
// Coefficients are in the order of the terms; each term has all components.
Disturbance empirical_torque(const EmpiricalShape& shape);

// The keys of an empirical torque.
std::vector<Key> empirical_shape_keys();

}  // namespace photorque

// The keys of an empirical torque, which shape.cpp reads: those of all variables and functions.
#include "attitude/disturbances/unknown/shape.h"
#include "core/settings/typed_keys.h"

namespace photorque {
namespace {

constexpr double most_order = 200.0;

// Keys of all variables, one property after the other, so that documents show each property once.
std::vector<Key> function_keys() {
  std::vector<Key> exponents, powers, knots, references, ranges;
  for (const MotionVariable variable :
       {MotionVariable::tilt, MotionVariable::rate, MotionVariable::charge, MotionVariable::command,
        MotionVariable::time}) {
    const std::string name = name_of(variable), unit = "_" + unit_of(variable);
    const double least_power = variable == MotionVariable::time ? 0.0 : 1.0;
    exponents.push_back(UncertainNumberKey(name + "_exponent", Range::positive(),
                                           "exponent of a power of the variable; *or*",
                                           {.optional = true}));
    powers.push_back(NumbersKey(
        name + "_powers", {least_power, most_order},
        "integer powers of the variable in rising order, one term each; *or*", {.optional = true}));
    knots.push_back(
        NumbersKey(name + "_knots" + unit, {},
                   "knots of a smooth table over the variable: at least 4, in rising order, one "
                   "coefficient for each; cubic in between",
                   {.optional = true}));
    references.push_back(NumberKey(name + "_reference" + unit, usual_reference(variable),
                                   Range::positive(), name + " at which the powers are 1"));
    ranges.push_back(NumbersKey(
        name + "_range" + unit, {},
        "[from, to]: measured range. Beyond it the variable is constant, after a smooth transition "
        "of at most a twentieth of the range",
        {.usually = "everywhere; of a table its knots", .size = 2}));
  }
  return joined({exponents, powers, knots, references, ranges});
}

}  // namespace

std::vector<Key> empirical_shape_keys() {
  return joined(
      {{TextsKey(
            "axes",
            "axes of the torque, each at most once: `\"body\"` x, y, z; `\"lab\"` x, y, z; "
            "`\"vertical\"`; `\"lean\"` (the tilt axis; positive: reduces the tilt); `\"rate\"` "
            "(against the rate if positive); `\"rate_by_axis\"` (the same about body x, y, z); "
            "`\"command\"`; `\"cross_talk\"` (of the command about the other axes: xy, xz, yx, yz, "
            "zx, zy)"),
        NumbersKey("yaw_orders", {1.0, most_order},
                   "integers n in rising order: cos nψ and sin nψ of the yaw ψ (azimuth of body x) "
                   "for each n",
                   {.optional = true})},
       function_keys(),
       {UncertainNumberKey("time_constant_s", Range::positive(),
                           "time constant τ of a factor exp(−t/τ); *or*", {.optional = true}),
        UncertainNumberKey("time_period_s", Range::positive(),
                           "period of the sines and cosines of `time_orders`", {.optional = true}),
        NumbersKey("time_orders", {0.0, most_order},
                   "integers n in rising order: cos and sin of 2π n t/period for each n (0: a "
                   "constant); *or*",
                   {.optional = true}),
        NumberKey("time_span_s", Range::positive(), "span of the cosines of `time_cosines`",
                  {.optional = true}),
        NumbersKey("time_cosines", {0.0, most_order},
                   "integers n in rising order: cos(π n t/span) for each n", {.optional = true}),
        UncertainNumberKey(empirical_coefficients, {},
                           "one coefficient for each combination, the last index fastest: term of "
                           "the first variable, term of the second variable, component of the "
                           "axes; at most 200 numbers are practical",
                           {.several = true})}});
}

}  // namespace photorque

// Dry friction of a platform that turns about one axis: when it comes to rest, and whether it then
// slips the other way or sticks.
//
// Within a step the direction of slip is constant (ZeroOrderHold::slip), so that the equations are
// smooth. The friction is −τ times the direction, and a platform that sticks does not accelerate.
// Let f₊ and f₋ be the accelerations during forward and backward slip. A platform at rest slips
// forward if f₊ > 0, backward if f₋ < 0, and sticks otherwise.
//
// Source: M. di Bernardo, C. J. Budd, A. R. Champneys, P. Kowalczyk, "Piecewise-smooth Dynamical
// Systems", Springer (2008), chapters 2 and 8.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "attitude/propagation/collocation.h"

namespace photorque {

class DryContact {
 public:
  // `dynamics` must outlive it.
  explicit DryContact(const Dynamics& dynamics);

  // Whether the model has dry contact. Other functions require it.
  bool exists() const { return exists_; }
  // Component of the state: the rate about the axis.
  size_t component() const { return component_; }

  // Slip of a platform at rest in state `y`. `held.slip` is ignored.
  Slip at_rest(double time_s, const ZeroOrderHold& held, std::span<const double> y) const;
  // Direction of slip directly after the static friction is exceeded.
  Slip released(double time_s, const ZeroOrderHold& held, std::span<const double> y) const;

  // Positive where the slip or sticking that `held` states has ended: the rate has changed its
  // sign, or the other torques exceed the static friction.
  Lanes beyond(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y) const;
  // The first interval, between start, stages and end of a step, in which the slip ends.
  struct SlipEnd {
    double low_s, high_s;
  };
  std::optional<SlipEnd> ends_within(const CollocationStep& step, const ZeroOrderHold& held,
                                     double end_s) const;
  // Whether the stages of an attempted step resolve the change of the torques on a sticking body.
  bool resolves(const CollocationStep& step, const ZeroOrderHold& held) const;

  // dy/dt just before `time_s`, so that a jump at `time_s` is not included.
  std::vector<double> rates(double time_s, const ZeroOrderHold& held,
                            std::span<const double> y) const;

 private:
  struct Accelerations {
    Lanes forward, backward;
    // Margin for rounding errors.
    Lanes margin() const { return 1e-9 * (backward - forward); }
  };
  Accelerations accelerations(const Lanes& time_s, ZeroOrderHold held, const Lanes* y) const;

  const Dynamics& dynamics_;
  bool exists_ = false;
  size_t component_ = component::rate;
};

}  // namespace photorque

// Dry friction of a platform that turns about one axis: when it comes to rest, and whether it then
// slips the other way or sticks.
//
// Within a step the direction of slip is held (ZeroOrderHold::slip), so that the equations are
// smooth: the friction is −τ times it, and what sticks does not accelerate. With f₊ and f₋ the
// accelerations while it slips forward and backward, a platform at rest slips forward where f₊ > 0,
// backward where f₋ < 0, and sticks between.
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

  // The slip of a platform at rest; that of `held` is ignored.
  Slip at_rest(double time_s, const ZeroOrderHold& held, std::span<const double> y) const;
  // The slip after the static friction is exceeded.
  Slip released(double time_s, const ZeroOrderHold& held, std::span<const double> y) const;

  // Positive if the state of `held` has ended: the rate has changed its sign, or the other torques
  // exceed the static friction.
  Lanes beyond(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y) const;
  // The first interval, between start, stages and end of a step, in which the slip ends.
  struct SlipEnd {
    double low_s, high_s;
  };
  std::optional<SlipEnd> ends_within(const CollocationStep& step, const ZeroOrderHold& held,
                                     double end_s) const;
  // Whether the stages of an attempted step resolve the change of the torques on a sticking body.
  bool resolves(const CollocationStep& step, const ZeroOrderHold& held) const;

  // dy/dt, just before `time_s`.
  std::vector<double> rates(double time_s, const ZeroOrderHold& held,
                            std::span<const double> y) const;

 private:
  struct Accelerations {
    Lanes forward, backward;
    // A margin for rounding errors.
    Lanes margin() const { return 1e-9 * (backward - forward); }
  };
  Accelerations accelerations(const Lanes& time_s, ZeroOrderHold held, const Lanes* y) const;

  const Dynamics& dynamics_;
  bool exists_ = false;
  size_t component_ = component::rate;
};

}  // namespace photorque

// The exact derivatives of a collocation solution with respect to the initial state and the
// parameters of disturbances.
//
// Differentiating the collocation equations gives a linear system, which is solved on the same
// stages. The result is the exact derivative of the computed trajectory. DualLanes gives the
// partial derivatives of the right-hand side, once per step.
#pragma once

#include <vector>

#include "attitude/propagation/collocation.h"
#include "attitude/propagation/stage_system.h"

namespace photorque {

// A quantity with respect to which the trajectory is differentiated.
struct Variable {
  // Component of the initial state, in the order of tangent() below; −1: a parameter.
  int initial = -1;
  // Parameter `parameter` of disturbance `disturbance` of the model.
  size_t disturbance = 0;
  int parameter = -1;

  static Variable initial_extra(int index) { return {7 + index, 0, -1}; }
  static Variable of(size_t disturbance, int parameter) { return {-1, disturbance, parameter}; }
};

// Derivative of a state in tangent coordinates: the rotation vector of the attitude's change in
// body axes [rad] (3), rate (3), charge (1), extra states. `change` is the derivative of the
// components of `y`.
std::vector<double> tangent(std::span<const double> y, std::span<const double> change);

class Sensitivity {
 public:
  // `y` is the initial state. `dynamics` must outlive this.
  Sensitivity(const Dynamics& dynamics, std::vector<Variable> variables, std::span<const double> y);

  const Dynamics& dynamics() const { return dynamics_; }
  const std::vector<Variable>& variables() const { return variables_; }

  // Differentiates an attempted step, to `tolerance` of each derivative's size. False when the
  // iteration does not converge or the step is too long to resolve the derivatives.
  bool solve(const CollocationStep& step, const ZeroOrderHold& held, double tolerance);
  // Moves the start to the end of the attempted step.
  void accept();
  // Starts the next step without the previous polynomial, after a jump of the right-hand side.
  void restart() { has_polynomial_ = false; }
  // Adds `change` (a derivative of the state) to the derivatives by variable `v`.
  void add(size_t v, std::span<const double> change);

  // Derivatives at fractions of the step: component c, variable v at [c · variables + v].
  void dense(const Lanes& fraction, Lanes* derivatives) const;
  // Derivatives at the start of the step, in the same layout.
  const std::vector<double>& start() const { return start_; }

  // Derivatives of the instruments' readings (Dynamics::reading_derivatives) at given states, from
  // the derivatives of those states; reading r by variable v at [r · variables + v].
  void readings(const Lanes& time_s, const std::array<ZeroOrderHold, Lanes::count>& held,
                const Lanes* y, const Lanes* derivatives, Lanes* readings) const;

 private:
  // Variables of one evaluation with DualLanes: `variable[k]` is the index in variables_, or −1.
  struct ParameterBlock {
    Dynamics::Block block;
    std::array<int, DualLanes::block> variable;
  };
  void seed_bound_states(size_t v, int axis);
  void seed_states_of_axis(size_t v, const Vec3& rate_body_rad_s);
  void make_blocks();
  void read_offsets();
  void differentiate_rates(const CollocationStep& step, const ZeroOrderHold& held);

  const Dynamics& dynamics_;
  std::vector<Variable> variables_;
  std::vector<Dynamics::Block> state_blocks_;
  std::vector<ParameterBlock> parameter_blocks_;
  std::vector<double> start_;
  std::vector<Lanes> increments_, accepted_increments_;  // as in CollocationStep
  // For each variable, the largest component at the start of any step, and the largest in units of
  // the scales. Derivatives that have decayed far below these need no full precision; an example is
  // a platform that dry friction has stopped.
  std::vector<double> largest_, largest_scaled_;
  static constexpr double next_to_nothing = 1e-10;
  double h_s_ = 0.0, accepted_h_s_ = 0.0;
  bool has_polynomial_ = false;
  void note_extent();
  void predict();
  void sort_jacobian();
  static constexpr size_t group_size = 2;
  bool settle(size_t first, double tolerance);
  void solve_at_once(const CollocationStep& step);
  bool is_resolved(const CollocationStep& step) const;
  std::vector<size_t> moving_;  // variables on which the motion depends
  // Derivatives of the instruments' offsets with respect to the variables, in the layout of
  // readings(). Used where a reading is the platform's rate or attitude plus an offset
  // (Dynamics::offsets).
  std::vector<double> offset_slopes_;
  RateWorkspace room_;         // its `jacobian` is that of the step
  std::vector<Lanes> source_;  // ∂(dy_c/dt)/∂(variable)
};

}  // namespace photorque

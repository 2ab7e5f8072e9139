// One step of Gauss collocation with eight stages. It has order 16 at its end; between the ends it
// is a polynomial of degree 8.
//
// The stages are found by fixed-point iteration, which starts from the extrapolated polynomial of
// the previous step. Newton's method is used where the equations are stiff. All eight stages are
// evaluated at once. The method is symmetric and symplectic: the norm of the quaternion, and the
// energy and momentum of a free body, change only by rounding. Between the ends the polynomial is
// less accurate than at the end itself. The error estimate is that of the polynomial, so the dense
// output meets the tolerance and the ends are more accurate.
//
// Source: M. Antoñana, E. Alberdi, J. Makazaga, A. Murua, "SIMD-vectorized implicit symplectic
// integrators can outperform explicit symplectic ones", arXiv:2211.03655 (2022).
#pragma once

#include <span>
#include <vector>

#include "attitude/propagation/stage_system.h"
#include "core/numerics/collocation_points.h"

namespace photorque {

class Snapshot;  // core/snapshot.h

class CollocationStep {
 public:
  // Starts at `y` (Dynamics::size() components). `dynamics` must outlive the step.
  CollocationStep(const Dynamics& dynamics, double time_s, std::vector<double> y);

  // Attempts a step of length `h_s` from the current start with constant commands; the start does
  // not move. The iteration ends when its error is below `settled`, relative to the scales.
  struct Outcome {
    bool converged = false;
    int iterations = 0;
    double error = 0.0;  // of the polynomial, relative to the scales; an upper estimate
  };
  Outcome attempt(double h_s, const ZeroOrderHold& held, double settled);
  // Solves the stages by Newton's method: about 50 times the work, but it converges for equations
  // of any stiffness. stiffness() then shows whether fixed-point iteration would converge too.
  Outcome attempt_stiff(double h_s, const ZeroOrderHold& held, double settled);
  // Method of the last attempt, and step length · stiffness_1_s() of its last iteration.
  bool is_stiff() const { return is_stiff_; }
  double stiffness() const { return stiffness_; }
  // Moves the start to the end of the attempted step, with compensated summation. The new time is
  // `end_s`, which is start + length except for rounding.
  void accept(double end_s);
  // Forgets the polynomial (after a jump of the right-hand side), and starts the next attempt from
  // constant rates.
  void restart() { has_polynomial_ = false; }

  // Replaces one component of the start.
  void set_component(int index, double value);

  double start_s() const { return time_s_; }
  const std::vector<double>& start() const { return y_; }
  double length_s() const { return h_s_; }
  // Results of the last attempt, accepted or not. `stages` are the states at stage_times_s().
  std::span<const Lanes> stages() const { return stages_; }
  Lanes stage_times_s() const;
  std::vector<double> end() const;

  // The polynomial at fractions θ ∈ [0, 1] of the attempted step; `y` receives size() components.
  // Valid until accept().
  void dense(const Lanes& fraction, Lanes* y) const;

  // Stores or restores the state after an attempt, without the stages.
  void keep(Snapshot& snapshot);

 private:
  template <class Improve>
  Outcome iterate(const ZeroOrderHold& held, int most_iterations, Settling settling,
                  const Improve& improve);
  double estimate_error() const;
  double estimate_error_of_ends(const ZeroOrderHold& held) const;
  void predict(double h_s, const ZeroOrderHold& held);
  double begin_attempt(double h_s, const ZeroOrderHold& held);
  void place_stages();

  const Dynamics& dynamics_;
  std::vector<double> inverse_scales_;
  double time_s_;
  double h_s_ = 0.0;
  bool is_abrupt_ = false;  // some law is abrupt (Disturbance::is_abrupt)
  bool is_stiff_ = false;
  double stiffness_ = 0.0;
  std::vector<Dynamics::Block> state_blocks_;
  RateWorkspace room_;
  bool has_polynomial_ = false;             // accepted_increments_ are valid
  std::vector<double> y_, carry_;           // the start, and its rounding error
  std::vector<Lanes> increments_;           // h b_j f_j of the attempt
  std::vector<Lanes> accepted_increments_;  // those of the previous step
  double accepted_h_s_ = 0.0;
  std::vector<Lanes> stages_, rates_;
  double continuation_ratio_ = 0.0;
  std::array<gauss::Row, gauss::points> continuation_{};
};

}  // namespace photorque

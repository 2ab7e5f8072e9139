// The attitude as the estimator sees it: platforms that are propagated beside their recordings.
//
// A run's own parameters are its initial state, along the tangent of the attitude (rotation about
// body axes, rate, the extra states of disturbances), and the per-run parameters of the hypothesis.
// A point holds, for every run, the quaternion w, x, y, z, the rate, the extra states and the
// per-run values; then the values of the shared parameters.
#pragma once

#include "attitude/estimation/hypothesis.h"
#include "attitude/propagation/propagator.h"
#include "inference/estimator/forward_model.h"

namespace photorque {

class AttitudeForwardModel final : public inference::ForwardModel {
 public:
  // `nominal` holds everything that a point does not; the runs are those of nominal.runs. `extra`:
  // parameters that are not free, differentiated after the shared ones, without prior. `runs` must
  // outlive this.
  AttitudeForwardModel(Hypothesis nominal, const std::vector<Observation>& runs,
                       std::vector<Free> extra, double tolerance);

  Eigen::VectorXd point_of(const Hypothesis& h) const;
  Hypothesis hypothesis_at(const Eigen::VectorXd& at) const;

  inference::Parameters parameters(const Eigen::VectorXd& at) const override;
  // By a window of a run: its first blocks, 20 at least.
  inference::NormalSums sums(const Eigen::VectorXd& at, Eigen::Index run,
                             const inference::Request& request) const override;
  Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const override;

 private:
  Hypothesis nominal_;
  const std::vector<Observation>& runs_;
  std::vector<Free> extra_;
  double tolerance_;
  std::vector<Variable> variables_;  // of one run, in the order of its sums
};

}  // namespace photorque

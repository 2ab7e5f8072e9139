// The forward model of attitude motion for the estimator. It propagates the motion of the platform
// in each run and compares it with the recording of that run.
//
// The parameters of a run are its initial state and the per-run parameters of the hypothesis. The
// initial state is parametrised in the tangent space: rotation vector about body axes, angular
// rate, extra states of disturbances.
//
// The vector of a point contains for every run: the quaternion w, x, y, z, the angular rate, the
// extra states and the values of the per-run parameters. After all runs it contains the values of
// the shared parameters.
#pragma once

#include "attitude/estimation/hypothesis.h"
#include "attitude/propagation/propagator.h"
#include "inference/estimator/forward_model.h"

namespace photorque {

class AttitudeForwardModel final : public inference::ForwardModel {
 public:
  // `nominal` supplies everything that a point does not contain. `runs` are the recordings of
  // nominal.runs, in the same order, and must outlive this object. `extra`: parameters that the
  // hypothesis does not vary. Derivatives with respect to them follow those with respect to the
  // shared parameters; they have no prior.
  AttitudeForwardModel(Hypothesis nominal, const std::vector<Observation>& runs,
                       std::vector<Free> extra, double tolerance);

  // The point of a hypothesis, and the hypothesis at a point.
  Eigen::VectorXd point_of(const Hypothesis& h) const;
  Hypothesis hypothesis_at(const Eigen::VectorXd& at) const;

  inference::Parameters parameters(const Eigen::VectorXd& at) const override;
  // request.window selects the fraction of a run's blocks from its start, at least 20 blocks.
  inference::NormalSums sums(const Eigen::VectorXd& at, Eigen::Index run,
                             const inference::Request& request) const override;
  Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const override;

 private:
  Hypothesis nominal_;
  const std::vector<Observation>& runs_;
  std::vector<Free> extra_;
  double tolerance_;
  std::vector<Variable> variables_;  // the parameters of one run, in the order of its sums
};

}  // namespace photorque

// What the readings of an injected run can tell, to first order.
//
// Differences of simulated readings, in units of their noise, are the columns of a linear model.
// The initial state and the uncertain priors (with their priors) may take up what they can; what
// is left of an effect's own difference is what can be seen of it.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "tools/proof/case.h"

namespace photorque {

// Columns for the first run of a case, about its true motion.
class InjectedInformation {
 public:
  explicit InjectedInformation(const InjectedCase& injected);

  // How the readings change by effect `index` of the case's world: `share` of it taken away,
  // divided by `share`, which must be small where the effect is strong. What has no strength to
  // which it is proportional is taken away whole.
  Eigen::VectorXd change_by(size_t index, double fraction) const;

  // The columns of a kind's numbers, about the true motion; none where it is not linear in them.
  const Eigen::MatrixXd& columns_of(const std::string& kind) const;

  // The part of `change`, squared, that neither the start, the uncertain priors nor the columns of
  // `others` can take up: what chi² gains by knowing.
  double gain(const Eigen::VectorXd& change, const std::vector<Eigen::MatrixXd>& others = {}) const;

  // Kinds of the catalogue with a linear strength, as competitors: all that could act here.
  std::vector<std::string> competitors() const;

 private:
  struct Sampled {
    std::vector<std::array<double, 4>> camera;
    std::vector<Triple> gyro_rad_s;
  };
  Sampled sample(const InjectedWorld& world, const InjectedStart& start) const;
  // From the base, in units of the noise.
  Eigen::VectorXd difference(const Sampled& sampled) const;
  void add_nuisances();
  Eigen::MatrixXd made_columns_of(const std::string& kind) const;

  InjectedCase case_;
  std::vector<double> times_s_;
  double step_s_ = 0.05;
  // Roots of the independent readings that one of times_s_ stands for; 0: none are taken.
  double camera_weight_ = 1.0, gyro_weight_ = 1.0;
  mutable std::map<std::string, Eigen::MatrixXd> columns_;
  Sampled base_;
  Eigen::MatrixXd nuisance_;  // the last rows are those of the priors
};

}  // namespace photorque

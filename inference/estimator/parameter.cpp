#include "inference/estimator/parameter.h"

#include <algorithm>
#include <vector>

namespace photorque::inference {

namespace {

enum class Place { free, on_lowest, on_highest };

class BoundedStep {
 public:
  BoundedStep(const ArrowMatrix& information, const Parameters& at)
      : information_(information),
        at_(at),
        scale_(inverse_roots(information.diagonal())),
        place_(static_cast<size_t>(at.size()), Place::free),
        step_(Eigen::VectorXd::Zero(at.size())) {}

  // Active-set iteration. Each turn fixes one parameter on the bound that it violates, or releases
  // one whose release lowers χ². At first the worst one is chosen, which is fast but may cycle.
  // After 3 n turns the first one is chosen, which guarantees termination (K. G. Murty, Opsearch 11
  // (1974) 123).
  Eigen::VectorXd run() {
    constexpr Eigen::Index most_turns = 1000;
    for (Eigen::Index turn = 0; turn < most_turns; ++turn) {
      const Change change = wrong_one(turn >= 3 * at_.size());
      if (change.parameter < 0) break;
      place_[static_cast<size_t>(change.parameter)] = change.place;
      solve();
      if (!step_.allFinite()) return Eigen::VectorXd::Zero(at_.size());
    }
    return step_;
  }

 private:
  struct Change {
    Eigen::Index parameter = -1;  // −1: none
    Place place = Place::free;
  };

  Change wrong_one(bool first_of_all) const {
    const Eigen::VectorXd slope = (information_ * step_).cwiseProduct(scale_);
    const double rounding = 1e-9 * (1.0 + slope.norm());
    Change change;
    double most = rounding;
    for (Eigen::Index i = 0; i < at_.size(); ++i) {
      const double reached = at_[i].value + step_[i];
      // Bound violation, or half the slope of χ² towards the interior [standard errors].
      double wrong = 0.0;
      Place to = Place::free;
      switch (place_[static_cast<size_t>(i)]) {
        case Place::free:
          to = reached < at_[i].lowest ? Place::on_lowest : Place::on_highest;
          wrong = std::max(at_[i].lowest - reached, reached - at_[i].highest) / scale_[i];
          break;
        case Place::on_lowest:
          wrong = -slope[i];
          break;
        case Place::on_highest:
          wrong = slope[i];
          break;
      }
      if (!(wrong > most)) continue;
      most = wrong;
      change = {i, to};
      if (first_of_all) break;
    }
    return change;
  }

  // Minimum-cost step of all free parameters, with the others on their bounds.
  void solve() {
    ArrowMatrix scaled = information_.scaled(scale_);
    Eigen::VectorXd fixed = Eigen::VectorXd::Zero(at_.size());
    for (Eigen::Index i = 0; i < at_.size(); ++i) {
      const Place place = place_[static_cast<size_t>(i)];
      if (place == Place::free) continue;
      const double bound = place == Place::on_lowest ? at_[i].lowest : at_[i].highest;
      fixed[i] = (bound - at_[i].value) / scale_[i];
    }
    Eigen::VectorXd right = -(scaled * fixed);
    for (Eigen::Index i = 0; i < at_.size(); ++i) {
      if (place_[static_cast<size_t>(i)] == Place::free) continue;
      scaled.hold(i);
      right[i] = fixed[i];
    }
    step_ = scale_.cwiseProduct(scaled.solve(right));
  }

  const ArrowMatrix& information_;
  const Parameters& at_;
  Eigen::VectorXd scale_;  // inverse root of the diagonal
  std::vector<Place> place_;
  Eigen::VectorXd step_;
};

}  // namespace

Eigen::VectorXd step_to_bounds(const ArrowMatrix& information, const Parameters& at) {
  return BoundedStep(information, at).run();
}

}  // namespace photorque::inference

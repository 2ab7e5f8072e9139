// Fits that end before they converge, because they are not worth their time.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "inference/estimator/fit.h"
#include "inference/estimator/forward_model.h"

namespace photorque::inference {
namespace {

// χ² = 100 + x²; slopes that claim twenty times too much make every step too short.
TEST(Fit, EndsWhereItFallsTooSlowlyToBeWorthIt) {
  const ResidualModel model({{"x", "", 100.0}},
                            [](const Eigen::VectorXd& at, Eigen::Index, Eigen::VectorXd& residuals,
                               Eigen::MatrixXd* slopes) {
                              residuals = Eigen::Vector2d(10.0, at[0]);
                              if (slopes != nullptr) *slopes = Eigen::Vector2d(0.0, -20.0);
                            });
  Options options;
  options.max_iterations = 60;
  const Fit converging = fit(model, model.start(), options);
  EXPECT_EQ(converging.termination, Termination::converged);  // far from the minimum of 100
  options.worth_chi2 = 50.0;                                  // below any that the model has
  const Fit lost = fit(model, model.start(), options);
  EXPECT_EQ(lost.termination, Termination::out_of_reach);
  EXPECT_LT(lost.iterations, converging.iterations);
  EXPECT_GT(lost.iterations, 6);
  options.worth_chi2 = 1.1 * converging.chi2;  // χ² that more steps reach
  const Fit worth = fit(model, model.start(), options);
  EXPECT_EQ(worth.iterations, converging.iterations);
  EXPECT_EQ(worth.chi2, converging.chi2);
}

// χ² = 1e6 + x²: every step is too short, as above, and its gain is less than a thousandth. Where
// as much is left of a million samples, it fits, and goes on.
TEST(Fit, EndsWhereItFitsBadlyAndCreeps) {
  const auto model = [](Eigen::Index samples) {
    return ResidualModel({{"x", "", 100.0}},
                         [samples](const Eigen::VectorXd& at, Eigen::Index,
                                   Eigen::VectorXd& residuals, Eigen::MatrixXd* slopes) {
                           residuals = Eigen::VectorXd::Zero(samples);
                           residuals.head<2>() = Eigen::Vector2d(1e3, at[0]);
                           if (slopes == nullptr) return;
                           *slopes = Eigen::MatrixXd::Zero(samples, 1);
                           (*slopes)(1, 0) = -20.0;
                         });
  };
  Options options;
  options.max_iterations = 60;
  options.min_gain_fraction = 0.0;
  const ResidualModel bad = model(100), good = model(1'000'000);
  const Fit all_the_way = fit(bad, bad.start(), options);
  options.min_relative_decrease = 5e-4;
  const Fit creeping = fit(bad, bad.start(), options);
  EXPECT_EQ(creeping.termination, Termination::max_iterations);
  EXPECT_LT(creeping.iterations, all_the_way.iterations);
  EXPECT_GT(creeping.iterations, 6);
  EXPECT_EQ(fit(good, good.start(), options).iterations, all_the_way.iterations);
}

// χ² = x² + what a window adds to it; counts the evaluations of whole runs that a fit asks for
// while it goes on.
class WindowedModel final : public ForwardModel {
 public:
  explicit WindowedModel(std::function<double(double window)> added) : added_(std::move(added)) {}

  Parameters parameters(const Eigen::VectorXd& at) const override {
    Parameters all;
    all.of_run.resize(1);
    all.shared = {{"x", "", at[0]}};
    return all;
  }
  NormalSums sums(const Eigen::VectorXd& at, Eigen::Index, const Request& request) const override {
    if (request.window == 1.0 && request.give_up_above > 0.0) {
      ++whole_;
      whole_with_slopes_ += request.derivatives ? 1 : 0;
    }
    const double x = at[0];
    return {Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Constant(1, -x),
            added_(request.window) + x * x, 2};
  }
  Eigen::VectorXd stepped(const Eigen::VectorXd& at, const Eigen::VectorXd& step) const override {
    return at + step;
  }

  // A twentieth of the run, then the whole.
  Fit fitted(double worth_chi2) {
    whole_ = whole_with_slopes_ = 0;
    Options options;
    options.windows = {0.05, 1.0};
    options.worth_chi2 = worth_chi2;
    return fit(*this, Eigen::VectorXd::Constant(1, 10.0), options);
  }
  int whole() const { return whole_; }
  int whole_with_slopes() const { return whole_with_slopes_; }

 private:
  std::function<double(double window)> added_;
  mutable int whole_ = 0, whole_with_slopes_ = 0;
};

// χ² a million times what is worth it where the whole begins, though its part fits: no slope is
// asked for there.
TEST(Fit, EndsWhereThePartsLeadFarFromTheWhole) {
  WindowedModel model([](double window) { return window == 1.0 ? 3e8 : 0.0; });
  EXPECT_EQ(model.fitted(301.0).termination, Termination::converged);
  EXPECT_GT(model.whole_with_slopes(), 0);
  const Fit lost = model.fitted(299.0);
  EXPECT_EQ(lost.termination, Termination::not_evaluable);
  EXPECT_EQ(model.whole_with_slopes(), 0);
  EXPECT_FALSE(std::isfinite(lost.chi2));
}

// χ² of a part is χ² of the whole at the least: 100 in a twentieth of the run.
TEST(Fit, EndsInAWindowThatAloneIsMoreThanIsWorthIt) {
  WindowedModel model([](double window) { return 100.0 * window / 0.05; });
  EXPECT_EQ(model.fitted(3000.0).termination, Termination::converged);
  EXPECT_GT(model.whole(), 0);
  const Fit lost = model.fitted(99.0);
  EXPECT_EQ(lost.termination, Termination::out_of_reach);
  EXPECT_EQ(model.whole(), 0);
  EXPECT_FALSE(std::isfinite(lost.chi2));
}

}  // namespace
}  // namespace photorque::inference

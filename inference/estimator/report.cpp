// A fit in words.
#include <cmath>
#include <cstdio>

#include "inference/estimator/fit.h"

namespace photorque::inference {
namespace {

const char* words_of(Termination termination) {
  switch (termination) {
    case Termination::converged:
      return "converged";
    case Termination::no_step_lowers:
      return "no step lowers chi2 any more";
    case Termination::max_iterations:
      return "stopped at the largest number of iterations";
    case Termination::out_of_reach:
      return "given up: too far from what is worth a fit";
    case Termination::not_evaluable:
      return "the model cannot be evaluated";
  }
  return "";
}

// What holds a parameter where it is.
const char* determined_by(const Parameter& p, double standard_error, bool is_determined) {
  if (!is_determined) return "undetermined";
  if (p.value <= p.lowest || p.value >= p.highest) return "on its bound";
  // The data shrink the prior's width by less than a hundredth.
  constexpr double by_prior_alone = 0.99;
  if (p.has_prior() && standard_error > by_prior_alone * p.sigma) return "by its prior alone";
  return "";
}

}  // namespace

std::string Fit::report() const {
  char text[200];
  std::snprintf(text, sizeof text,
                "%s after %d iterations: chi2 %.6g (data %.6g) of %lld samples, %lld parameters\n",
                words_of(termination), iterations, chi2, data_chi2, static_cast<long long>(samples),
                static_cast<long long>(parameters.size()));
  std::string all = text;
  const Covariance known = covariance();
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double error = known.standard_error(i);
    std::snprintf(text, sizeof text, "  %-32s %14.8g +- %-10.3g %-8s %s", p.name.c_str(), p.value,
                  error, p.unit.c_str(), determined_by(p, error, known.is_determined(i)));
    all += text;
    all.erase(all.find_last_not_of(' ') + 1);
    all += '\n';
  }
  return all;
}

}  // namespace photorque::inference

// Evidence of a fitted model, and physical objections to it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/numerics/linear.h"
#include "diagnosis/attitude/effects/trial.h"
#include "inference/estimator/evidence.h"

namespace photorque {
namespace {

// Largest relative change of a moment of inertia within three standard deviations of the stated
// uncertainties.
double stated_inertia_change(const Trial& trial) {
  constexpr double sigmas = 3.0;
  const Mat3& nominal_kg_m2 = trial.fit.best.model.platform.inertia_kg_m2;
  double largest = 0.0;
  for (const Free& f : trial.fit.best.free) {
    const auto& found = trial.disturbances;
    const bool is_found = std::find(found.begin(), found.end(), f.disturbance) != found.end();
    const Disturbance& stated = trial.fit.best.model.disturbances[f.disturbance];
    if (is_found || !changes_inertia(stated) || f.parameter > 2) continue;
    largest = std::max(largest, sigmas * f.sigma / nominal_kg_m2(f.parameter, f.parameter));
  }
  return largest;
}

// Largest relative change of a principal moment by fitted inertia errors. The torque equation is
// homogeneous, so nearly zero inertia would explain almost anything, but platforms are measured
// more accurately.
double inertia_change(const Trial& trial) {
  const Mat3& nominal_kg_m2 = trial.fit.best.model.platform.inertia_kg_m2;
  const Vec3 nominal = nominal_kg_m2.selfadjointView<Eigen::Lower>().eigenvalues();
  double largest = 0.0;
  // Errors of an uncertain nominal inertia count too.
  for (const Disturbance& d : trial.fit.best.model.disturbances) {
    if (!changes_inertia(d)) continue;
    const Mat3 found = nominal_kg_m2 + find_kind(d.kind)->screening.inertia_change_kg_m2(d);
    const Vec3 moments = found.selfadjointView<Eigen::Lower>().eigenvalues();
    largest = std::max(largest, (moments - nominal).cwiseQuotient(nominal).cwiseAbs().maxCoeff());
  }
  return largest;
}

// A correction of a kind in the nominal model may be negative, but the sum must remain within its
// physical bound.
std::string sum_objection(const AttitudeModel& model) {
  for (const DisturbanceKind& kind : disturbance_kinds()) {
    const std::optional<MinimumSum>& least = kind.screening.minimum_sum;
    if (!least) continue;
    double sum = 0.0;
    for (const Disturbance& d : model.disturbances) {
      if (d.kind != kind.name) continue;
      for (const Parameter& p : d.parameters) sum += p.value;
    }
    if (sum < least->lowest) return least->objection;
  }
  return "";
}

std::string objection_to(const Trial& trial, const Candidates& all) {
  const Thresholds::Objection& limits = all.limits.objection;
  if (!std::isfinite(trial.fit.chi2)) return "cannot be propagated";
  const Eigen::MatrixXd covariance = trial.fit.shared_posterior();
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Candidate& c = all[trial.candidates[i]];
    for (const auto& [disturbance, p, at, value] : fitted_numbers(trial, i)) {
      const double sigma = std::sqrt(std::max(0.0, covariance(at, at)));
      const double beyond = limits.bound_sigma * sigma;
      if (value < c.lowest[p] - beyond || value > c.highest[p] + beyond) {
        return c.name + " would have the wrong sign";
      }
    }
  }
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Candidate& c = all[trial.candidates[i]];
    if (c.effect.how.scan != Scan::frequency) continue;
    const Disturbance& tone = trial.fit.best.model.disturbances[trial.disturbances[i]];
    if (parameter_of(tone, "frequency_Hz").value * all.longest_run_s < limits.min_periods) {
      return "the recording contains too few periods: any slow torque has the same effect";
    }
  }
  const double allowed = std::max(limits.max_inertia_change, stated_inertia_change(trial));
  if (const double change = inertia_change(trial); change > allowed) {
    return "a principal moment of inertia would change by " +
           std::to_string(static_cast<int>(std::lround(100.0 * change))) + " %";
  }
  return sum_objection(trial.fit.best.model);
}

// The key without which the effect is zero or another effect (a spring without stiffness is a
// slope): the first with strengths, otherwise the moment of inertia of the swinging part. Empty:
// the effect has no size.
std::string key_of_size(const Candidate& c) {
  for (size_t p = 0; p < c.scale.size(); ++p) {
    if (c.is_strength(p)) return c.start.parameters[p].key;
  }
  for (const EffectKey& key : c.effect.keys) {
    if (key.times_inertia && !key.is_fixed) return key.key;
  }
  return "";
}

// Significance in standard errors: of all parameters of the size together, and of the largest
// alone; NaN for an effect without a size.
struct Significance {
  double together = std::numeric_limits<double>::quiet_NaN();
  double largest_component = std::numeric_limits<double>::quiet_NaN();
};

Significance significance(const Trial& trial, const Candidates& all, size_t which) {
  const Candidate& c = all[trial.candidates[which]];
  const std::string size = key_of_size(c);
  if (size.empty()) return {};
  std::vector<Eigen::Index> where;
  std::vector<double> values;
  for (const auto& [disturbance, p, at, value] : fitted_numbers(trial, which)) {
    // All coefficients of an empirical law together are its size; its searched shape is not.
    const bool is_size = c.is_empirical ? !c.searched[p] : c.start.parameters[p].key == size;
    if (!is_size) continue;
    where.push_back(at);
    values.push_back(value);
  }
  if (where.empty()) return {0.0, 0.0};
  const Eigen::MatrixXd C = trial.fit.shared_posterior()(where, where);
  const Eigen::VectorXd theta =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return {std::sqrt(std::max(0.0, squared_distance(theta, C))),
          theta.cwiseAbs().cwiseQuotient(C.diagonal().cwiseSqrt()).maxCoeff()};
}

}  // namespace

bool changes_inertia(const Disturbance& d) {
  const DisturbanceKind* kind = find_kind(d.kind);
  return kind != nullptr && kind->screening.inertia_change_kg_m2 != nullptr;
}

double log_evidence(const Trial& trial, const Candidates& all) {
  const Fit& fit = trial.fit;
  const Thresholds::Evidence& limits = all.limits.evidence;
  if (!std::isfinite(fit.chi2)) return -1e300;
  inference::ArrowMatrix hessian = fit.hessian;
  double result = -0.5 * fit.chi2;
  // Strengths: the fitted parameters that are not searched, in units of their expected sizes.
  inference::Strengths strengths;
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Candidate& c = all[trial.candidates[i]];
    result += c.is_empirical ? limits.log_prior_empirical : limits.log_prior_effect;
    for (const auto& [disturbance, p, at, value] : fitted_numbers(trial, i)) {
      if (!c.searched[p]) {
        strengths.at.push_back(at);
        strengths.owner.push_back(i);
        strengths.value.push_back(value);
        strengths.scale.push_back(c.scale[p]);
        if (c.lowest[p] == 0.0) result += std::log(2.0);  // half-Gaussian prior
        continue;
      }
      const double sigma = c.scale[p], wide = sigma * limits.fit_prior_widths;
      hessian.add_to_diagonal(fit.first_shared + at, 1.0 / (sigma * sigma) - 1.0 / (wide * wide));
      result -= std::log(sigma);
    }
    for (size_t s = 0; s < c.start.states.size(); ++s) {
      result -= static_cast<double>(fit.best.runs.size()) *
                std::log(limits.own_state_sigma);  // prior of its initial value
    }
  }
  result -= 0.5 * hessian.log_determinant();
  return result + inference::log_strength_evidence(strengths, fit.shared_posterior(),
                                                   trial.candidates.size(), limits);
}

void judge(Trial& trial, const Candidates& all) {
  trial.significance.clear();
  trial.largest_component.clear();
  for (size_t i = 0; i < trial.candidates.size(); ++i) {
    const Significance found = significance(trial, all, i);
    trial.significance.push_back(found.together);
    trial.largest_component.push_back(found.largest_component);
  }
  trial.log_evidence = log_evidence(trial, all);
  if (!std::isfinite(trial.log_evidence)) trial.log_evidence = -1e300;
  trial.objection = objection_to(trial, all);
}

}  // namespace photorque

#include "diagnosis/whiteness.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace {

constexpr size_t neighbours = 20;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// One channel of one run without its gaps.
std::vector<double> channel(const Prediction& p, Eigen::Index k) {
  std::vector<double> values;
  for (const WhiteRow& row : p.residual) {
    if (std::isfinite(row[k])) values.push_back(row[k]);
  }
  return values;
}

}  // namespace

std::vector<Prediction> residuals_of(const Fit& fit, const std::vector<Observation>& runs) {
  PredictionOptions options;
  options.keep_residuals = true;
  std::vector<Prediction> all;
  for (size_t run = 0; run < runs.size(); ++run) {
    const Dynamics dynamics(fit.best.model_of(run, runs[run]));
    all.push_back(predict(dynamics, fit.best.runs[run].initial, runs[run], {}, options));
  }
  return all;
}

Whiteness whiteness(const std::vector<Prediction>& residuals) {
  Whiteness result;
  double sum = 0.0, variance = 0.0;
  int64_t means = 0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    std::vector<double> differences;
    for (const Prediction& p : residuals) {
      const std::vector<double> r = channel(p, k);
      for (size_t i = 1; i + 1 < r.size(); ++i) {
        differences.push_back(std::abs(r[i - 1] - 2.0 * r[i] + r[i + 1]));
      }
      for (size_t i = 0; i + neighbours <= r.size(); i += neighbours) {
        double mean = 0.0;
        for (size_t j = i; j < i + neighbours; ++j) mean += r[j];
        sum += mean * mean / static_cast<double>(neighbours);
        ++means;
      }
    }
    if (differences.size() < 50) continue;
    // The median of |x| is 0.6745 σ, and second differences have six times the variance.
    result.noise_ratio[static_cast<size_t>(k)] =
        median(std::move(differences)) / (0.67449 * std::sqrt(6.0));
  }
  if (means == 0) return result;
  variance = 2.0 / static_cast<double>(means);
  result.slow_chi2_per_mean = sum / static_cast<double>(means);
  result.excess_sigma = (result.slow_chi2_per_mean - 1.0) / std::sqrt(variance);
  return result;
}

bool correct_noise(const Whiteness& found, std::vector<Observation>& runs) {
  bool any = false;
  for (size_t k = 0; k < 6; ++k) {
    const double ratio = found.noise_ratio[k];
    if (!(std::abs(ratio - 1.0) > 0.05) || !(ratio > 0.0)) continue;
    any = true;
    for (Observation& seen : runs) {
      (k < 3 ? seen.noise.camera_rad[static_cast<Eigen::Index>(k)]
             : seen.noise.gyro_rad_s[static_cast<Eigen::Index>(k - 3)]) *= ratio;
    }
  }
  return any;
}

int64_t drop_outliers(const std::vector<Prediction>& residuals, std::vector<Observation>& runs) {
  constexpr double furthest = 9.0;
  int64_t dropped = 0;
  for (size_t run = 0; run < runs.size(); ++run) {
    const std::vector<WhiteRow>& rows = residuals[run].residual;
    for (size_t i = 2; i + 2 < rows.size(); ++i) {
      for (Eigen::Index k = 0; k < 6; ++k) {
        const auto r = [&](size_t j) { return rows[j][k]; };
        // What both sides and either side alone expect here: one bad neighbour does not decide, and
        // a residual that runs away steadily is no outlier.
        const std::vector<double> expected = {0.5 * (r(i - 1) + r(i + 1)),
                                              2.0 * r(i - 1) - r(i - 2), 2.0 * r(i + 1) - r(i + 2)};
        if (!(std::abs(r(i) - median(expected)) > furthest)) continue;
        ++dropped;
        // An attitude is right or wrong as a whole.
        if (k < 3) runs[run].attitude_rows[i] = 0.0;
        if (k >= 3) runs[run].gyro_rows[i][k - 3] = 0.0;
      }
    }
  }
  return dropped;
}

}  // namespace photorque

#include "diagnosis/attitude/whiteness.h"

#include <algorithm>
#include <cmath>

#include "core/errors.h"

namespace photorque {
namespace {

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

// What the neighbours of reading n lead to expect: the middle of what both sides and either side
// alone say, so that one bad neighbour does not decide and a residual that runs away steadily is no
// outlier. At an end the one side speaks alone.
double expected(const std::vector<double>& r, size_t n) {
  std::vector<double> says;
  const bool left = n >= 1, right = n + 1 < r.size();
  if (left && right) says.push_back(0.5 * (r[n - 1] + r[n + 1]));
  if (n >= 2) says.push_back(2.0 * r[n - 1] - r[n - 2]);
  if (n + 2 < r.size()) says.push_back(2.0 * r[n + 1] - r[n + 2]);
  if (n >= 2 && says.size() < 3) says.push_back(r[n - 2]);
  if (n + 2 < r.size() && says.size() < 3) says.push_back(r[n + 2]);
  if (says.size() < 3) says.push_back(left ? r[n - 1] : r[n + 1]);
  return median(says);
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

Whiteness whiteness(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits) {
  const size_t neighbours = limits.neighbours;
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
    if (differences.size() < limits.min_differences) continue;
    result.readings[static_cast<size_t>(k)] = static_cast<int64_t>(differences.size());
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

double excess_sigma(const Fit& fit, const std::vector<Observation>& runs,
                    const Thresholds::Noise& limits) {
  try {
    return whiteness(residuals_of(fit, runs), limits).excess_sigma;
  } catch (const NumericalError&) {
    return limits.excess_unknown;
  }
}

bool correct_noise(const Whiteness& found, std::vector<Observation>& runs,
                   const Thresholds::Noise& limits) {
  bool any = false;
  for (size_t k = 0; k < 6; ++k) {
    const double ratio = found.noise_ratio[k];
    const double scatter = limits.difference_scatter /
                           std::sqrt(static_cast<double>(std::max<int64_t>(found.readings[k], 1)));
    if (!(std::abs(ratio - 1.0) >
          std::max(limits.min_correction, limits.correction_sigma * scatter)) ||
        !(ratio > 0.0))
      continue;
    any = true;
    for (Observation& seen : runs) {
      (k < 3 ? seen.noise.camera_rad[static_cast<Eigen::Index>(k)]
             : seen.noise.gyro_rad_s[static_cast<Eigen::Index>(k - 3)]) *= ratio;
    }
  }
  return any;
}

int64_t drop_outliers(const std::vector<Prediction>& residuals, std::vector<Observation>& runs,
                      const Thresholds::Noise& limits) {
  int64_t dropped = 0;
  for (size_t run = 0; run < runs.size(); ++run) {
    for (Eigen::Index k = 0; k < 6; ++k) {
      // Neighbours are the next that were read: gaps and empty cells lie in between.
      std::vector<size_t> rows;
      for (size_t i = 0; i < residuals[run].residual.size(); ++i) {
        if (std::isfinite(residuals[run].residual[i][k])) rows.push_back(i);
      }
      const std::vector<double> r = channel(residuals[run], k);
      for (size_t n = 0; n < r.size() && r.size() >= limits.min_neighbourhood; ++n) {
        if (!(std::abs(r[n] - expected(r, n)) > limits.outlier_sigma)) continue;
        ++dropped;
        // An attitude is right or wrong as a whole.
        if (k < 3) runs[run].attitude_rows[rows[n]] = 0.0;
        if (k >= 3) runs[run].gyro_rows[rows[n]][k - 3] = 0.0;
      }
    }
  }
  return dropped;
}

}  // namespace photorque

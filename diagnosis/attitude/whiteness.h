// Whether what is left of a fit is noise: its size at the finest scale and over longer ones.
#pragma once

#include <array>
#include <vector>

#include "diagnosis/attitude/fit.h"
#include "inference/thresholds.h"

namespace photorque {

// All whitened residuals of a fit, by run.
std::vector<Prediction> residuals_of(const Fit& fit, const std::vector<Observation>& runs);

struct Whiteness {
  // Standard deviation of each channel (camera x, y, z, gyro x, y, z) from the second
  // differences of neighbours: the noise itself, over that which was assumed. 1 where there are no
  // readings.
  std::array<double, 6> noise_ratio{1, 1, 1, 1, 1, 1};
  std::array<int64_t, 6> readings{};  // that noise_ratio comes from
  // χ² of the means of some twenty neighbours over their number: 1 for white noise, much more where
  // structure is left. `excess_sigma` is its distance from 1 in standard errors.
  double slow_chi2_per_mean = 1.0;
  double excess_sigma = 0.0;
};
Whiteness whiteness(const std::vector<Prediction>& residuals, const Thresholds::Noise& limits);

// The excess of what is left of a fit; huge where it cannot be propagated.
double excess_sigma(const Fit& fit, const std::vector<Observation>& runs,
                    const Thresholds::Noise& limits);

// Gives every channel of the runs the noise that was found, where it is off beyond doubt. Returns
// whether any was.
bool correct_noise(const Whiteness& found, std::vector<Observation>& runs,
                   const Thresholds::Noise& limits);

// Drops readings that stand out from what their neighbours' residuals lead to. Returns their
// number.
int64_t drop_outliers(const std::vector<Prediction>& residuals, std::vector<Observation>& runs,
                      const Thresholds::Noise& limits);

}  // namespace photorque

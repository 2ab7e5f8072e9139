// Tests of the residuals of a fit for whiteness, and of paired differences for a positive location.
#pragma once

#include <vector>

#include "inference/estimator/thresholds.h"

namespace photorque::inference {

// Residuals divided by the assumed noise, per channel, in order of time and without gaps.
using ChannelResiduals = std::vector<std::vector<double>>;

struct Whiteness {
  // χ² of the means of neighbouring residuals divided by the number of means: 1 for white noise,
  // much larger for autocorrelated residuals. `excess_sigma` is its distance from 1 in standard
  // errors.
  double slow_chi2_per_mean = 1.0;
  double excess_sigma = 0.0;
};

// Tests residuals of several runs with the same channels.
Whiteness whiteness(const std::vector<ChannelResiduals>& runs, const Thresholds::Noise& limits);

// Excess of the χ² per residual over `most` ≥ 1 [standard errors of white noise]. Structure as fast
// as the readings raises it, but cancels in means of neighbours. 0 without residuals.
double size_excess_sigma(const std::vector<ChannelResiduals>& runs, double most);

// Indices of outliers of one channel: their deviation from the prediction by their neighbours is
// large compared with the noise and with the typical deviation.
std::vector<size_t> outliers(const std::vector<double>& residuals, const Thresholds::Noise& limits);

// Tests whether differences lie above zero.

// The mean of some differences in standard errors, as a normal deviate: Student's t is converted at
// about equal probability (D. L. Wallace, Annals of Mathematical Statistics 30 (1959) 1121).
// Differences are clipped at three times the median size, so that no single one dominates. 0 for
// fewer than three.
double mean_sigma(std::vector<double> differences);

// Wilcoxon's signed-rank statistic (F. Wilcoxon, Biometrics Bulletin 1 (1945) 80), Σ of the ranks
// of the positive differences, as a normal deviate of equal probability. Up to 50 differences the
// distribution is exact. The normal approximation, (Σ − n (n + 1)/4) over √(n (n + 1) (2n + 1)/24),
// cannot exceed 3.5 for n = 16. The exact value reaches 4.2, because one sign assignment in 65,536
// has no negative sign. Zeros are omitted; ties have the mean of their ranks. 0 if no difference
// remains.
double signed_rank_sigma(const std::vector<double>& differences);

// Significance [standard errors] with which one explanation predicts segments better, from the χ²
// of each segment: by the mean of the differences of log scores or, robust where sizes differ by
// orders, by their ranks; the larger of the two.
double gain_sigma(const std::vector<double>& chi2_of_worse,
                  const std::vector<double>& chi2_of_better);

}  // namespace photorque::inference

// Tests of the residuals of a fit: whether it is noise, and whether differences lie above zero.
#pragma once

#include <cstdint>
#include <vector>

#include "inference/estimator/thresholds.h"

namespace photorque::inference {

// Residuals over the noise that was assumed, by channel, in order of time and without gaps.
using ChannelResiduals = std::vector<std::vector<double>>;

struct Whiteness {
  // χ² of the means of some neighbours over their number: 1 for white noise, much more where
  // structure is left. `excess_sigma` is its distance from 1 in standard errors.
  double slow_chi2_per_mean = 1.0;
  double excess_sigma = 0.0;
};

// Of several runs with the same channels.
Whiteness whiteness(const std::vector<ChannelResiduals>& runs, const Thresholds::Noise& limits);

// Indices of outliers of one channel, compared with the prediction from their neighbours: by the
// noise, and far more than most readings do.
std::vector<size_t> outliers(const std::vector<double>& residuals, const Thresholds::Noise& limits);

// Whether differences lie above zero.

// The mean of some differences in its standard errors, as those of a normal variable: Student's t
// turned into a normal deviate of about the same probability (D. L. Wallace, Annals of Mathematical
// Statistics 30 (1959) 1121). A difference beyond three times the median size counts as that much,
// so that no single one decides. 0 for fewer than three.
double mean_sigma(std::vector<double> differences);

// Wilcoxon's signed-rank statistic (F. Wilcoxon, Biometrics Bulletin 1 (1945) 80), Σ of the ranks
// of the sizes of those above zero, as the normal deviate that is as probable. Up to 50 differences
// all choices of signs are counted: its normal approximation, (Σ − n (n + 1)/4) over
// √(n (n + 1) (2n + 1)/24), cannot exceed 3.5 with 16, of which one choice in 65,536 has no sign
// below zero (4.2). Zeros are left out; equal sizes share the mean of their ranks. 0 where nothing
// is left.
double signed_rank_sigma(const std::vector<double>& differences);

// Standard errors by which one explanation predicts segments better than another, from χ² of each
// segment: of the differences of their log scores, by their mean or, where they differ in size by
// orders, by their ranks, whichever is more significant.
double gain_sigma(const std::vector<double>& chi2_of_worse,
                  const std::vector<double>& chi2_of_better);

}  // namespace photorque::inference

// Whether differences lie above zero, whatever their distribution.
#pragma once

#include <vector>

namespace photorque::inference {

// Wilcoxon's signed-rank statistic (F. Wilcoxon, Biometrics Bulletin 1 (1945) 80) in its standard
// errors: Σ of the ranks of the sizes of those above zero, less its mean n (n + 1)/4, over
// √(n (n + 1) (2n + 1)/24). Of differences that lie about zero symmetrically it is standard normal,
// to a few per cent from n = 20 on. Zeros are left out; equal sizes share the mean of their ranks.
// 0 where nothing is left.
double signed_rank_sigma(const std::vector<double>& differences);

}  // namespace photorque::inference

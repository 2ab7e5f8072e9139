#include "diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>

#include "core/text/format.h"

namespace photorque {

std::string name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::consistent:
      return "consistent";
    case Verdict::missing_physics:
      return "missing_physics";
    case Verdict::unexplained:
      return "unexplained";
  }
  return "";
}

double explained_fraction(double chi2_per_sample_before, double chi2_per_sample_after,
                          int64_t samples) {
  const double before = chi2_per_sample_before - 1.0, after = chi2_per_sample_after - 1.0;
  if (std::isnan(before) || std::isnan(after) || std::isinf(after)) return 0.0;
  if (std::isinf(before)) return 1.0;
  const double noise = 5.0 * std::sqrt(2.0 / static_cast<double>(std::max<int64_t>(1, samples)));
  return before > noise ? std::clamp((before - after) / before, 0.0, 1.0) : 1.0;
}

std::string untested_names(const Holdout& holdout) {
  return printed(
      "the held-out data do not test the names: the nominal model predicts them as well "
      "(χ² per sample %.3g, with the names %.3g)",
      holdout.chi2_per_sample_before, holdout.chi2_per_sample_after);
}

}  // namespace photorque

#include "diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>

#include "core/text/format.h"

namespace photorque {

std::string name_of(Verdict verdict) {
  constexpr const char* names[] = {"consistent", "missing_physics", "unexplained"};
  return names[static_cast<size_t>(verdict)];
}

std::string in_words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

double explained_fraction(double chi2_per_sample_before, double chi2_per_sample_after,
                          int64_t samples) {
  const double before = chi2_per_sample_before - 1.0, after = chi2_per_sample_after - 1.0;
  if (std::isnan(before) || std::isnan(after) || std::isinf(after)) return 0.0;
  if (std::isinf(before)) return 1.0;
  const double noise = 5.0 * std::sqrt(2.0 / static_cast<double>(std::max<int64_t>(1, samples)));
  return before > noise ? std::clamp((before - after) / before, 0.0, 1.0) : 1.0;
}

double weighted_mean(double a, int64_t samples_a, double b, int64_t samples_b) {
  const auto m = static_cast<double>(samples_a), n = static_cast<double>(samples_b);
  return m + n > 0.0 ? (m * a + n * b) / (m + n) : 0.0;
}

void add_held_out(const Holdout& more, Holdout& all) {
  const auto mean = [&](double a, double b) {
    return weighted_mean(a, all.samples, b, more.samples);
  };
  all.chi2_per_sample_before = mean(all.chi2_per_sample_before, more.chi2_per_sample_before);
  all.chi2_per_sample_after = mean(all.chi2_per_sample_after, more.chi2_per_sample_after);
  all.samples += more.samples;
  const bool is_worse =
      more.predictive && (!all.predictive || more.predictive->sigma > all.predictive->sigma);
  if (is_worse) all.predictive = more.predictive;
}

std::string untested_names(const Holdout& holdout) {
  return printed(
      "the held-out data do not test the names: the nominal model predicts them as well "
      "(χ² per sample %.3g, with the names %.3g)",
      holdout.chi2_per_sample_before, holdout.chi2_per_sample_after);
}

}  // namespace photorque

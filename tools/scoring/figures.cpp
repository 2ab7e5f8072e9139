// Figures of pulls, held-out errors, stated probabilities and times.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/scoring/score.h"

namespace photorque {
namespace {

using Claims = std::vector<std::pair<double, bool>>;  // stated probability, and whether right

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

Claims claims_of_names(const std::vector<CaseScore>& scores) {
  Claims all;
  for (const CaseScore& s : scores) all.insert(all.end(), s.claims.begin(), s.claims.end());
  return all;
}
Claims claims_of_verdicts(const std::vector<CaseScore>& scores) {
  Claims all;
  for (const CaseScore& s : scores) {
    if (s.answered && std::isfinite(s.confidence)) all.emplace_back(s.confidence, s.right);
  }
  return all;
}

struct Bin {
  Fraction fraction;
  double stated = 0.0;  // sum
};
Bin bin_of(const Claims& claims, double from, double to) {
  Bin bin;
  for (const auto& [probability, right] : claims) {
    if (!(probability >= from && (probability < to || to == 1.0))) continue;
    ++bin.fraction.of;
    bin.fraction.hits += right ? 1 : 0;
    bin.stated += probability;
  }
  return bin;
}

// Mean distance between what is stated and what comes true, in ten equal bins, weighted by how many
// claims each holds (Naeini, Cooper and Hauskrecht, AAAI 2015).
double calibration_error(const Claims& claims) {
  double sum = 0.0;
  for (int i = 0; i < 10; ++i) {
    const Bin bin = bin_of(claims, i / 10.0, (i + 1) / 10.0);
    sum += std::abs(bin.stated - bin.fraction.hits);
  }
  return sum / static_cast<double>(claims.size());
}

Table calibration_table(Table table, const Claims& claims, const std::vector<double>& edges) {
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    const Bin bin = bin_of(claims, edges[i], edges[i + 1]);
    if (bin.fraction.of == 0) continue;
    const double n = bin.fraction.of;
    table.row()
        .set("from", edges[i])
        .set("to", edges[i + 1])
        .set("answers", n)
        .set("mean_stated", bin.stated / n)
        .set("share_right", bin.fraction.hits / n)
        .set("low_95", bin.fraction.low())
        .set("high_95", bin.fraction.high());
  }
  return table;
}

const std::vector<std::string> calibration_columns = {
    "from", "to", "answers", "mean_stated", "share_right", "low_95", "high_95"};

}  // namespace

Table proof_reliability(const std::vector<CaseScore>& scores) {
  return calibration_table(
      Table::of("proof_reliability", "Stated probability of a name, and how often it was right",
                calibration_columns),
      claims_of_names(scores), {0.0, 0.5, 0.8, 0.95, 0.99, 1.0});
}

Table proof_calibration(const std::vector<CaseScore>& scores) {
  return calibration_table(
      Table::of("proof_calibration",
                "Stated confidence of an answer, and how often verdict and names were right",
                calibration_columns),
      claims_of_verdicts(scores), {0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0});
}

std::vector<Quantity> proof_quantities(const std::vector<CaseScore>& scores) {
  std::vector<double> pulls, ratios, times;
  const auto slow = std::ranges::count_if(
      scores, [](const CaseScore& s) { return s.answered && s.processor_s > 60.0; });
  for (const CaseScore& s : scores) {
    if (s.right && is_visible(s)) pulls.insert(pulls.end(), s.pulls.begin(), s.pulls.end());
    if (s.right && is_visible(s) && s.holdout_chi2 > 0.0 && s.oracle_chi2 > 0.0) {
      ratios.push_back(std::sqrt(s.holdout_chi2 / s.oracle_chi2));
    }
    if (s.answered) times.push_back(s.processor_s);
  }
  std::vector<Quantity> quantities = {{"cases", {static_cast<double>(scores.size()), 0.0}}};
  const auto n = static_cast<double>(pulls.size());
  double squares = 0.0, within = 0.0, largest = 0.0;
  for (const double p : pulls) {
    squares += p * p;
    within += std::abs(p) <= 1.0 ? 1.0 : 0.0;
  }
  for (const double r : ratios) largest = std::max(largest, r);
  if (n > 1) {
    const double rms = std::sqrt(squares / n);
    quantities.push_back({"pulls", {n, 0.0}});
    quantities.push_back({"pulls_rms", {rms, rms / std::sqrt(2.0 * n)}});
    quantities.push_back(
        {"pulls_within_1_sigma", {within / n, std::sqrt(within * (n - within) / n) / n}});
    std::vector<double> sizes;
    for (const double p : pulls) sizes.push_back(std::abs(p));
    // Of a normal distribution, the median of |x| is 0.6745.
    quantities.push_back({"pulls_robust_sd", {median(sizes) / 0.6745, 0.0}});
  }
  if (!ratios.empty()) {
    quantities.push_back({"holdout_error_over_oracle_median", {median(ratios), 0.0}});
    quantities.push_back({"holdout_error_over_oracle_largest", {largest, 0.0}});
    quantities.push_back(
        {"holdout_within_10_percent_of_oracle",
         {static_cast<double>(std::ranges::count_if(ratios, [](double r) { return r <= 1.1; })) /
              static_cast<double>(ratios.size()),
          0.0}});
  }
  const auto claims = claims_of_names(scores), verdicts = claims_of_verdicts(scores);
  if (!verdicts.empty()) {
    quantities.push_back({"confidence_calibration_error", {calibration_error(verdicts), 0.0}});
  }
  if (!claims.empty()) {
    quantities.push_back({"name_calibration_error", {calibration_error(claims), 0.0}});
  }
  if (!times.empty()) {
    quantities.push_back({"processor_median_s", {median(times), 0.0}});
    quantities.push_back({"processor_largest_s", {*std::ranges::max_element(times), 0.0}});
    quantities.push_back({"processor_over_60_s", {static_cast<double>(slow), 0.0}});
  }
  return quantities;
}

}  // namespace photorque

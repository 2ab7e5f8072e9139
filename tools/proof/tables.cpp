#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "tools/proof/score.h"

namespace photorque {
namespace {

constexpr double visible = 30.0;  // gain of chi² from which a name is asked for
constexpr double hopeless = 6.0;  // and below which nothing can be said

template <class Belongs, class Hits>
Fraction fraction_of(const std::vector<CaseScore>& scores, const Belongs& belongs,
                     const Hits& hits) {
  Fraction fraction;
  for (const CaseScore& s : scores) {
    if (!belongs(s)) continue;
    ++fraction.of;
    fraction.hits += hits(s) ? 1 : 0;
  }
  return fraction;
}

bool is_outside(const CaseScore& s) {
  return s.true_verdict == "unexplained";
}
bool is_none(const CaseScore& s) {
  return s.true_kinds.empty();
}
bool is_inside(const CaseScore& s) {
  return !is_outside(s) && !is_none(s);
}
// Cases made elsewhere do not state their gain: all of them are meant to be seen.
bool is_visible(const CaseScore& s) {
  return is_inside(s) && s.true_verdict == "missing_physics" && !(s.chi2_gain <= visible);
}

// Half width for 95 %.
double wilson(const Fraction& fraction, double sign) {
  if (fraction.of == 0) return sign < 0 ? 0.0 : 1.0;
  constexpr double z = 1.959963984540054;
  const double n = fraction.of, p = fraction.hits / n, z2 = z * z / n;
  const double half = z * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n));
  return std::clamp((p + 0.5 * z2 + sign * half) / (1.0 + z2), 0.0, 1.0);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
  return text.empty() ? "-" : text;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

double Fraction::low() const {
  return wilson(*this, -1.0);
}
double Fraction::high() const {
  return wilson(*this, 1.0);
}

std::vector<ProofRow> proof_rows(const std::vector<CaseScore>& scores) {
  const auto all = [](const CaseScore&) { return true; };
  const auto right = [](const CaseScore& s) { return s.right; };
  const auto below = [](const CaseScore& s) { return is_inside(s) && s.chi2_gain < hopeless; };
  const auto single = [](const CaseScore& s) { return is_visible(s) && s.true_kinds.size() == 1; };
  const auto pair = [](const CaseScore& s) { return is_visible(s) && s.true_kinds.size() > 1; };
  const auto seen_unknown = [](const CaseScore& s) {
    return is_outside(s) && s.verdict == "unexplained";
  };
  std::vector<ProofRow> rows = {
      {"all cases: verdict and names right", fraction_of(scores, all, right), "≥ 95 %"},
      {"one effect that shows: name right", fraction_of(scores, single, right), "≥ 95 %"},
      {"one effect that shows: right within the group named",
       fraction_of(scores, single, [](const CaseScore& s) { return s.right_within_group; }), ""},
      {"two effects: both names right", fraction_of(scores, pair, right), ""},
      {"nothing missing: consistent", fraction_of(scores, is_none, right), "all"},
      {"below the limit: consistent, or the right name", fraction_of(scores, below, right), "all"},
      {"unknown law: unexplained, nothing wrong named", fraction_of(scores, is_outside, right),
       "all"},
      {"unknown law called unexplained: variable right",
       fraction_of(scores, seen_unknown, [](const CaseScore& s) { return s.dependence_right; }),
       ""},
      {"cases with a wrong name",
       fraction_of(scores, all, [](const CaseScore& s) { return s.wrong_name; }), "none"},
      {"cases without an answer",
       fraction_of(scores, all, [](const CaseScore& s) { return !s.answered; }), "none"},
  };
  std::erase_if(rows, [](const ProofRow& row) { return row.fraction.of == 0; });
  return rows;
}

Table proof_summary(const std::vector<CaseScore>& scores) {
  Table table = Table::of("proof", "What the diagnoses got right",
                          {"question", "aim", "hits", "of", "share", "low_95", "high_95"});
  for (const ProofRow& row : proof_rows(scores)) {
    const double of = row.fraction.of;
    table.row()
        .set("question", row.question)
        .set("aim", row.aim.empty() ? "-" : row.aim)
        .set("hits", row.fraction.hits)
        .set("of", of)
        .set("share", row.fraction.hits / of)
        .set("low_95", row.fraction.low())
        .set("high_95", row.fraction.high());
  }
  return table;
}

Table proof_by_kind(const std::vector<CaseScore>& scores) {
  struct Count {
    double shown = 0, right = 0, below = 0, below_right = 0, wrong_name = 0, unanswered = 0;
  };
  std::map<std::string, Count> counts;
  for (const CaseScore& s : scores) {
    std::string name = joined(s.true_kinds);
    if (s.true_kinds.size() > 1) name = "two effects";
    if (s.true_kinds.empty()) name = "nothing missing";
    if (is_outside(s)) name = "unknown: " + name;
    Count& count = counts[name];
    const bool shows = is_visible(s) || is_outside(s) || is_none(s);
    (shows ? count.shown : count.below) += 1;
    if (s.right) (shows ? count.right : count.below_right) += 1;
    count.wrong_name += s.wrong_name ? 1 : 0;
    count.unanswered += s.answered ? 0 : 1;
  }
  Table table = Table::of(
      "proof_by_kind", "By the injected effect",
      {"concealed", "shown", "right", "too_weak", "too_weak_right", "wrong_name", "unanswered"});
  for (const auto& [name, c] : counts) {
    table.row()
        .set("concealed", name)
        .set("shown", c.shown)
        .set("right", c.right)
        .set("too_weak", c.below)
        .set("too_weak_right", c.below_right)
        .set("wrong_name", c.wrong_name)
        .set("unanswered", c.unanswered);
  }
  return table;
}

Table proof_cases(const std::vector<CaseScore>& scores) {
  Table table = Table::of(
      "proof_cases", "Every case",
      {"case", "true_verdict", "concealed", "verdict", "named", "right", "right_within_group",
       "chi2_gain", "confidence", "holdout_chi2", "oracle_chi2", "pulls_rms", "wall_s"});
  for (const CaseScore& s : scores) {
    double squares = 0.0;
    for (const double pull : s.pulls) squares += pull * pull;
    const double rms = std::sqrt(squares / static_cast<double>(s.pulls.size()));
    table.row()
        .set("case", s.name)
        .set("true_verdict", s.true_verdict)
        .set("concealed", joined(s.true_kinds))
        .set("verdict", s.answered ? s.verdict : std::string("no answer"))
        .set("named", joined(s.kinds))
        .set("right", s.right ? 1.0 : 0.0)
        .set("right_within_group", s.right_within_group ? 1.0 : 0.0)
        .set("chi2_gain", s.chi2_gain)
        .set("confidence", s.confidence)
        .set("holdout_chi2", s.holdout_chi2)
        .set("oracle_chi2", s.oracle_chi2)
        .set("pulls_rms", rms)
        .set("wall_s", s.wall_s);
  }
  return table;
}

Table proof_reliability(const std::vector<CaseScore>& scores) {
  const std::vector<double> edges = {0.0, 0.5, 0.8, 0.95, 0.99, 1.0};
  Table table =
      Table::of("proof_reliability", "Stated probability of a name, and how often it was right",
                {"from", "to", "names", "mean_stated", "share_right", "low_95", "high_95"});
  for (size_t bin = 0; bin + 1 < edges.size(); ++bin) {
    Fraction fraction;
    double stated = 0.0;
    for (const CaseScore& s : scores) {
      for (const auto& [probability, right] : s.claims) {
        const bool last = bin + 2 == edges.size();
        if (!(probability >= edges[bin] && (probability < edges[bin + 1] || last))) continue;
        ++fraction.of;
        fraction.hits += right ? 1 : 0;
        stated += probability;
      }
    }
    if (fraction.of == 0) continue;
    const double n = fraction.of;
    table.row()
        .set("from", edges[bin])
        .set("to", edges[bin + 1])
        .set("names", n)
        .set("mean_stated", stated / n)
        .set("share_right", fraction.hits / n)
        .set("low_95", fraction.low())
        .set("high_95", fraction.high());
  }
  return table;
}

std::vector<Quantity> proof_quantities(const std::vector<CaseScore>& scores) {
  std::vector<double> pulls, ratios, times;
  for (const CaseScore& s : scores) {
    if (s.right && is_visible(s)) pulls.insert(pulls.end(), s.pulls.begin(), s.pulls.end());
    if (s.right && is_visible(s) && s.holdout_chi2 > 0.0 && s.oracle_chi2 > 0.0) {
      ratios.push_back(std::sqrt(s.holdout_chi2 / s.oracle_chi2));
    }
    if (s.answered) times.push_back(s.wall_s);
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
  if (!times.empty()) {
    quantities.push_back({"wall_median_s", {median(times), 0.0}});
    quantities.push_back({"wall_largest_s", {*std::ranges::max_element(times), 0.0}});
  }
  return quantities;
}

}  // namespace photorque

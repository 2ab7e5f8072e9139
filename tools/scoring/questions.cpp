// The headline counts.
#include <algorithm>
#include <cmath>

#include "tools/scoring/score.h"

namespace photorque {
namespace {

constexpr double visible = 30.0;   // gain of chi² from which a name is asked for
constexpr double hopeless = 6.0;   // and below which nothing can be said
constexpr double strong = 5e4;     // and from which on it is a strong effect
constexpr double max_sigma = 5.0;  // of the held-out residuals above what is predicted
constexpr double max_over_oracle = 1.1;

using Question = bool (*)(const CaseScore&);

Fraction fraction_of(const std::vector<CaseScore>& scores, Question belongs, Question hits) {
  Fraction fraction;
  for (const CaseScore& s : scores) {
    if (!belongs(s)) continue;
    ++fraction.of;
    fraction.hits += hits(s) ? 1 : 0;
  }
  return fraction;
}

// Half width for 95 %.
double wilson(const Fraction& fraction, double sign) {
  if (fraction.of == 0) return sign < 0 ? 0.0 : 1.0;
  constexpr double z = 1.959963984540054;
  const double n = fraction.of, p = fraction.hits / n, z2 = z * z / n;
  const double half = z * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n));
  return std::clamp((p + 0.5 * z2 + sign * half) / (1.0 + z2), 0.0, 1.0);
}

bool all(const CaseScore&) {
  return true;
}
bool right(const CaseScore& s) {
  return s.right;
}
template <size_t count>
bool shows_effects(const CaseScore& s) {
  return is_visible(s) && s.true_kinds.size() == count;
}
bool has_known_beside_unknown(const CaseScore& s) {
  return is_outside(s) && s.true_kinds.size() > 1;
}
bool is_unknown_alone(const CaseScore& s) {
  return is_outside(s) && s.true_kinds.size() == 1;
}
bool has_prediction(const CaseScore& s) {
  return names_missing_physics(s) && std::isfinite(s.predictive_sigma);
}
bool has_oracle(const CaseScore& s) {
  return names_missing_physics(s) && s.oracle_chi2 > 0.0;
}
bool is_well_known(const CaseScore& s) {
  constexpr double most_expected = 1.05;
  return s.expected_chi2 <= most_expected;
}
bool has_replay(const CaseScore& s) {
  return std::isfinite(s.replay_status);
}

// Of answers, whatever the truth was.
std::vector<ProofRow> rows_of_answers(const std::vector<CaseScore>& scores) {
  const auto answered = [](const CaseScore& s) { return s.answered; };
  return {
      {"cases with a wrong name",
       fraction_of(scores, all, [](const CaseScore& s) { return s.wrong_name; }), "≤ 1 %"},
      {"missing_physics that contradicts its own prediction by more than 5 σ",
       fraction_of(scores, has_prediction,
                   [](const CaseScore& s) { return s.predictive_sigma > max_sigma; }),
       "none"},
      {"missing_physics without a stated prediction",
       fraction_of(scores, names_missing_physics,
                   [](const CaseScore& s) { return !std::isfinite(s.predictive_sigma); }),
       "none"},
      {"missing_physics whose held-out χ² is within 10 % of the oracle's",
       fraction_of(
           scores, has_oracle,
           [](const CaseScore& s) { return s.holdout_chi2 <= max_over_oracle * s.oracle_chi2; }),
       "≥ 95 %"},
      {"the same, of those that expect the errors of their numbers to add at most 5 %",
       fraction_of(
           scores, [](const CaseScore& s) { return has_oracle(s) && is_well_known(s); },
           [](const CaseScore& s) { return s.holdout_chi2 <= max_over_oracle * s.oracle_chi2; }),
       "≥ 95 %"},
      {"answers with a number beyond physics",
       fraction_of(scores, answered, [](const CaseScore& s) { return !s.impossible.empty(); }),
       "none"},
      {"answers without a confidence",
       fraction_of(scores, answered,
                   [](const CaseScore& s) { return !std::isfinite(s.confidence); }),
       "none"},
      {"cases without an answer",
       fraction_of(scores, all, [](const CaseScore& s) { return !s.answered; }), "none"},
      {"exits other than 0",
       fraction_of(scores, all, [](const CaseScore& s) { return s.exit_status != 0; }), "none"},
      {"improved.toml that propagates",
       fraction_of(scores, has_replay, [](const CaseScore& s) { return s.replay_status == 0.0; }),
       "all"},
      {"improved.toml that repeats the recording as well as stated",
       fraction_of(scores, has_replay, replays_as_stated), "all"},
  };
}

}  // namespace

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

bool names_missing_physics(const CaseScore& s) {
  return s.answered && s.verdict == "missing_physics";
}
bool replays_as_stated(const CaseScore& s) {
  const double stated = std::isfinite(s.attitude_chi2) ? s.attitude_chi2 : s.fit_chi2;
  return s.replay_status == 0.0 && s.replay_chi2 <= 0.2 + 1.33 * std::max(1.0, stated);
}

double Fraction::low() const {
  return wilson(*this, -1.0);
}
double Fraction::high() const {
  return wilson(*this, 1.0);
}

std::vector<ProofRow> proof_rows(const std::vector<CaseScore>& scores) {
  const auto below = [](const CaseScore& s) { return is_inside(s) && s.chi2_gain < hopeless; };
  const auto in_group = [](const CaseScore& s) { return s.right_within_group; };
  std::vector<ProofRow> rows = {
      {"all cases: verdict and names right", fraction_of(scores, all, right), "≥ 95 %"},
      {"one effect that shows: name right", fraction_of(scores, shows_effects<1>, right), "≥ 95 %"},
      {"one effect that shows: right within the group named",
       fraction_of(scores, shows_effects<1>, in_group), ""},
      {"one strong effect (χ² gain above 50 000): name right",
       fraction_of(
           scores, [](const CaseScore& s) { return shows_effects<1>(s) && s.chi2_gain > strong; },
           right),
       "≥ 95 %"},
      {"one effect under correlated noise: name right",
       fraction_of(
           scores, [](const CaseScore& s) { return is_visible(s) && s.family == "noise_effect"; },
           right),
       "≥ 95 %"},
      {"two effects: both names right", fraction_of(scores, shows_effects<2>, right), "≥ 95 %"},
      {"three effects: all names right", fraction_of(scores, shows_effects<3>, right), "≥ 85 %"},
      {"nothing missing, noise as stated: consistent",
       fraction_of(
           scores, [](const CaseScore& s) { return is_none(s) && s.family != "noise_none"; },
           right),
       "all"},
      {"nothing missing, noise not as stated: consistent",
       fraction_of(
           scores, [](const CaseScore& s) { return s.family == "noise_none"; }, right),
       "all"},
      {"below the limit: consistent, or the right name", fraction_of(scores, below, right), "all"},
      {"unknown law: unexplained, nothing wrong named",
       fraction_of(scores, is_unknown_alone, right), "all"},
      {"unknown law called unexplained: variable right",
       fraction_of(
           scores,
           [](const CaseScore& s) { return is_unknown_alone(s) && s.verdict == "unexplained"; },
           [](const CaseScore& s) { return s.dependence_right; }),
       ""},
      {"known effect and unknown law: unexplained, nothing wrong named",
       fraction_of(scores, has_known_beside_unknown, right), "≥ 95 %"},
      {"known effect and unknown law: the known one named too",
       fraction_of(scores, has_known_beside_unknown,
                   [](const CaseScore& s) { return s.known_named; }),
       ""},
      {"platforms and motions of the second maker: verdict and names right",
       fraction_of(
           scores, [](const CaseScore& s) { return s.maker.starts_with("second"); }, right),
       "≥ 95 %"},
  };
  ProofRow index = {
      "effects rightly named: index of lamp, cell, string or diode right", {}, "≥ 98 %"};
  for (const CaseScore& s : scores) {
    index.fraction.of += s.indices;
    index.fraction.hits += s.indices_right;
  }
  rows.push_back(index);
  for (ProofRow& row : rows_of_answers(scores)) rows.push_back(std::move(row));
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

}  // namespace photorque

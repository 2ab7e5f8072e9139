// Scores of diagnoses against what was injected.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/product.h"

namespace photorque {

// What happened in one case.
struct CaseScore {
  std::string name, family;  // as in truth.json; family "case" where that names none
  std::string maker;         // of the motion: "first", "second: …"; empty: not stated
  std::string true_verdict, verdict;
  std::vector<std::string> true_kinds, kinds;
  double chi2_gain = 0.0;  // what the data can show of the injected effects; NaN: not stated
  bool answered = false;   // a diagnosis.json was written
  std::string failure;     // what the program said instead
  int exit_status = 0;     // of `diagnose`; −1: stopped
  bool verdict_right = false;
  // Verdict and set of names are among those that the truth accepts.
  bool right = false;
  // The same when every named effect may be swapped for one that it calls indistinguishable.
  bool right_within_group = false;
  bool false_alarm = false;       // something named or "unexplained" where nothing is missing
  bool wrong_name = false;        // an effect named that neither acts nor is accepted
  bool dependence_right = false;  // of an unknown law: the first variable named is the right one
  bool known_named = false;       // beside an unknown law: exactly the known effects were named
  // Of effects on one lamp, cell, string or diode whose name is right: how many, and of how many
  // the index is right too.
  int indices = 0, indices_right = 0;
  std::vector<std::string> impossible;  // named numbers beyond the bounds of physics
  double confidence = 0.0;              // NaN: not stated
  std::vector<std::pair<double, bool>>
      claims;                 // probability stated of each name, and whether right
  std::vector<double> pulls;  // (fitted − true) / sigma
  double holdout_chi2 = 0.0, oracle_chi2 = 0.0;  // per number, after; NaN: unknown
  // What diagnose itself expects of holdout_chi2, and how many standard errors it lies above.
  double predictive_chi2 = 0.0, predictive_sigma = 0.0;  // NaN: not stated
  // What it expects the errors of its parameters to leave of holdout_chi2. NaN: not stated.
  double expected_chi2 = 0.0;
  // Per number of the recording, after; the same of its attitudes alone, by the medians.
  double fit_chi2 = 0.0, attitude_chi2 = 0.0;  // NaN: not stated
  // improved.toml run by `propagate`: exit status, and deviation from the recorded attitudes per
  // number (replayed_chi2). NaN: not run.
  double replay_status = 0.0, replay_chi2 = 0.0;
  double processor_s = 0.0;
};

// Reads truth.json of `truth_folder`, and diagnosis.json of `diagnosis_folder` and, where there is
// one, of `oracle_folder`. InputError when truth.json cannot be understood; a diagnosis that cannot
// counts as no answer.
CaseScore score_case(const std::filesystem::path& truth_folder,
                     const std::filesystem::path& diagnosis_folder,
                     const std::filesystem::path& oracle_folder);

// Cases by what they ask. `is_visible`: an effect of the catalogue, or several, that the readings
// show (chi² gain of more than 30, or not stated).
bool is_outside(const CaseScore& s);
bool is_none(const CaseScore& s);
bool is_inside(const CaseScore& s);
bool is_visible(const CaseScore& s);
bool names_missing_physics(const CaseScore& s);
// Whether improved.toml propagates and its attitudes lie no further from the recorded ones than the
// diagnosis states of its fit, by a third and 0.2.
bool replays_as_stated(const CaseScore& s);

// k of n as a fraction with its interval of 95 % (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209).
struct Fraction {
  int hits = 0, of = 0;
  double low() const;
  double high() const;
};

// The headline counts: one row per question, "aim" in words.
struct ProofRow {
  std::string question;
  Fraction fraction;
  std::string aim;
};
std::vector<ProofRow> proof_rows(const std::vector<CaseScore>& scores);

// Rows by family, and by maker: how many, right with interval, wrong names, times.
Table proof_by_family(const std::vector<CaseScore>& scores);
// Rows by kind: how many, right, wrong names.
Table proof_by_kind(const std::vector<CaseScore>& scores);
// One row per case.
Table proof_cases(const std::vector<CaseScore>& scores);
// Stated probability, in five bins, beside the fraction that was right.
Table proof_reliability(const std::vector<CaseScore>& scores);
// Stated confidence of the verdict, in ten bins, beside the fraction that was right.
Table proof_calibration(const std::vector<CaseScore>& scores);
// The headline counts as a table, and figures of pulls, held-out error and time.
Table proof_summary(const std::vector<CaseScore>& scores);
std::vector<Quantity> proof_quantities(const std::vector<CaseScore>& scores);

}  // namespace photorque

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/scoring/score.h"

namespace photorque {
namespace {

constexpr const char* no_maker = "-";

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " + ") + name;
  return text.empty() ? "-" : text;
}

struct GroupCount {
  Fraction right;
  double wrong_name = 0;
  std::vector<double> times_s;
};

}  // namespace

Table proof_by_family(const std::vector<CaseScore>& scores) {
  std::map<std::string, GroupCount> groups;
  for (const CaseScore& s : scores) {
    std::vector<std::string> names = {"family " + s.family};
    if (!s.maker.empty()) names.push_back("maker " + s.maker.substr(0, s.maker.find(',')));
    for (const std::string& name : names) {
      GroupCount& group = groups[name];
      ++group.right.of;
      group.right.hits += s.right ? 1 : 0;
      group.wrong_name += s.wrong_name ? 1 : 0;
      group.times_s.push_back(s.processor_s);
    }
  }
  Table table = Table::of("proof_by_family", "By family and by maker",
                          {"group", "cases", "right", "share", "low_95", "high_95", "wrong_name",
                           "median_s", "largest_s"});
  for (auto& [name, group] : groups) {
    std::ranges::sort(group.times_s);
    const double of = group.right.of;
    table.row()
        .set("group", name)
        .set("cases", of)
        .set("right", group.right.hits)
        .set("share", group.right.hits / of)
        .set("low_95", group.right.low())
        .set("high_95", group.right.high())
        .set("wrong_name", group.wrong_name)
        .set("median_s", group.times_s[group.times_s.size() / 2])
        .set("largest_s", group.times_s.back());
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
    if (s.true_kinds.size() == 2) name = "two effects";
    if (s.true_kinds.size() == 3) name = "three effects";
    if (s.true_kinds.empty()) name = "nothing missing";
    if (is_outside(s))
      name = "unknown: " + (s.true_kinds.size() > 1 ? "beside a known effect" : name);
    if (s.family.starts_with("noise")) name += ", other noise";
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
      {"case",        "true_verdict",       "concealed",        "verdict",       "named",
       "right",       "right_within_group", "chi2_gain",        "confidence",    "holdout_chi2",
       "oracle_chi2", "predictive_chi2",    "predictive_sigma", "expected_chi2", "replay_chi2",
       "pulls_rms",   "impossible",         "exit_status",      "processor_s",   "family",
       "maker"});
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
        .set("predictive_chi2", s.predictive_chi2)
        .set("predictive_sigma", s.predictive_sigma)
        .set("expected_chi2", s.expected_chi2)
        .set("replay_chi2", s.replay_chi2)
        .set("pulls_rms", rms)
        .set("impossible", joined(s.impossible))
        .set("exit_status", s.exit_status)
        .set("processor_s", s.processor_s)
        .set("family", s.family)
        .set("maker", s.maker.empty() ? no_maker : s.maker);
  }
  return table;
}

}  // namespace photorque

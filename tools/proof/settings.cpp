#include "tools/proof/settings.h"

#include "core/errors.h"

namespace photorque {
namespace {

int count_of(const Settings& prove, const char* key, int otherwise) {
  constexpr int64_t most = 100000;
  return static_cast<int>(prove.integer_or(key, otherwise, 0, most));
}

}  // namespace

InjectedPlan read_plan(const Settings& s) {
  InjectedPlan plan;
  plan.seed = static_cast<uint64_t>(s.integer_or("seed", 1, 0, INT64_MAX));
  plan.per_kind = count_of(s, "per_kind", plan.per_kind);
  plan.none = count_of(s, "none", plan.none);
  plan.pairs = count_of(s, "pairs", plan.pairs);
  plan.outside = count_of(s, "outside", plan.outside);
  plan.triples = count_of(s, "triples", plan.triples);
  plan.known_unknown = count_of(s, "known_unknown", plan.known_unknown);
  plan.noise_none = count_of(s, "noise_none", plan.noise_none);
  plan.noise_effect = count_of(s, "noise_effect", plan.noise_effect);
  plan.strong_fraction = s.number_or("strong_share", plan.strong_fraction, Range::fraction());
  plan.second_fraction = s.number_or("second_maker_share", plan.second_fraction, Range::fraction());
  const Range seconds{20.0, 1e5, false, false}, rate{1.0, 1000.0, false, false};
  plan.duration_s = s.number_or("duration_s", plan.duration_s, seconds);
  plan.holdout_s = s.number_or("holdout_s", plan.holdout_s, seconds);
  if (s.has("rates_Hz")) plan.rates_Hz = s.numbers("rates_Hz", rate);
  if (plan.rates_Hz.empty()) throw s.error("rates_Hz", "[]", "at least one rate");
  plan.dirty_fraction = s.number_or("dirty_share", plan.dirty_fraction, Range::fraction());
  return plan;
}

}  // namespace photorque

#include "diagnosis/attitude/textbook_laws.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "diagnosis/attitude/domain.h"
#include "inference/trials.h"

namespace photorque {

std::optional<Trial> fit_textbook_laws(const Fit& nominal_fit, const Candidates& all,
                                       const RecordedData& data) {
  const AttitudeModel& model = nominal_fit.best.model;
  if (!model.platform.turns_about_one_axis() || model.platform.slides() ||
      !std::isfinite(nominal_fit.chi2)) {
    return std::nullopt;
  }
  const AttitudeDomain domain(all);
  inference::Members<Start> members;
  for (size_t c = 0; c < all.size(); ++c) {
    if (!all[c].is_linear() || all[c].empirical()) continue;
    const bool is_law = braking_power(all[c], model) || pulls_back(all[c], model) ||
                        all[c].effect.how.steady || all[c].start.stage == Stage::measurement;
    if (is_law && all[c].has_linear_strength()) members.push_back({{c, domain.start_of(c)}, {}});
  }
  if (members.empty()) return std::nullopt;
  const Trial nominal = nominal_trial(nominal_fit, all);
  inference::Effort growing = inference::patient(all.limits);
  growing.windows = {0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0};
  Trial found = nominal;
  // With rates alone a piece does not determine its initial angle; the whole does.
  const bool sees_angle = std::ranges::all_of(
      data.train, [](const Observation& seen) { return seen.sees_some_attitude(); });
  if (sees_angle) {
    const auto [pieces, parted] = inference::near_pieces(domain, nominal, data.train);
    found = domain.assemble(parted, members, pieces.runs, inference::patient(all.limits));
    // Short pieces determine the laws roughly: longer and longer ones lead on to the whole.
    for (const size_t count : std::views::reverse(all.limits.search.pieces)) {
      const std::vector<Observation> longer =
          count < pieces.pieces ? domain.cut(data.train, count) : std::vector<Observation>();
      if (longer.empty()) continue;
      const Trial next = domain.refit(found, longer, domain.seen_begins(found, longer),
                                      inference::patient(all.limits));
      if (std::isfinite(next.fit.chi2)) found = next;
    }
    found = domain.refit(found, data.train, domain.seen_begins(found, data.train), growing);
  } else {
    found = domain.assemble(nominal, members, data.train, growing);
  }
  if (!(found.fit.chi2 < nominal_fit.chi2)) return std::nullopt;
  return found;
}

}  // namespace photorque

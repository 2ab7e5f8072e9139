#include "diagnosis/attitude/domain.h"

#include "attitude/estimation/fit.h"
#include "core/parallel.h"
#include "diagnosis/attitude/effects/scan.h"
#include "diagnosis/attitude/holdout.h"

namespace photorque {
namespace {

static_assert(inference::Domain<AttitudeDomain>);

inference::CandidateTraits traits_of(const Candidate& c) {
  inference::CandidateTraits traits;
  traits.name = c.label;
  traits.is_empirical = c.empirical();
  traits.is_linear = c.is_linear();
  traits.is_fast = c.effect.how.fast;
  traits.is_limit_of_swinging = c.effect.how.inertia_change_kg_m2 != nullptr;
  traits.is_of_instrument = c.start.stage == Stage::measurement;
  // Several appendages with different frequencies and axes are distinguishable.
  traits.swings = c.effect.how.scan == Scan::mode;
  if (traits.swings) traits.most = 2;
  traits.has_strength = c.has_linear_strength();
  traits.parameters = c.start.parameters.size();
  return traits;
}

}  // namespace

AttitudeDomain::AttitudeDomain(const Candidates& all) : all_(all) {
  for (const Candidate& c : all.list) traits_.push_back(traits_of(c));
}

Trial AttitudeDomain::predict(const Trial& trial, const Runs& runs) const {
  Trial predicted = trial;
  predicted.fit = propagate_model(trial.fit, runs, all_.limits);
  return predicted;
}

std::vector<double> AttitudeDomain::gains(const Trial& at, const std::vector<size_t>& candidates,
                                          const Runs& runs) const {
  std::vector<ScoreGroup> groups;
  for (const size_t c : candidates) {
    groups.push_back({all_[c].is_linear() ? std::vector<Disturbance>{all_[c].start}
                                          : std::vector<Disturbance>{}});
  }
  std::vector<double> result;
  for (const Score& s : score(at.fit, runs, groups)) result.push_back(s.gain);
  return result;
}

std::vector<std::vector<Start>> AttitudeDomain::starts(const Trial& parent,
                                                       const std::vector<size_t>& candidates,
                                                       const Runs& runs, const Runs& averages,
                                                       int threads) const {
  const std::vector<double> lines_Hz = line_frequencies_Hz(parent.fit, runs, limits().scoring);
  std::vector<std::vector<Start>> result(candidates.size());
  parallel_for(candidates.size(), threads, [&](size_t i) {
    result[i] = starts_of(all_[candidates[i]], parent, runs, averages, lines_Hz, limits().scoring);
  });
  return result;
}

std::vector<Observation> AttitudeDomain::cut(const Runs& runs, size_t pieces) const {
  Runs result;
  for (const Observation& seen : runs) {
    for (size_t i = 0; i < pieces; ++i) {
      const size_t first = i * seen.blocks() / pieces, last = (i + 1) * seen.blocks() / pieces;
      if (first == last) continue;
      Observation piece = seen.part(first, last);
      piece.is_piece = true;
      if (piece.readings(0, piece.blocks()) >= limits().search.min_readings_of_piece) {
        result.push_back(std::move(piece));
      }
    }
  }
  return result;
}

}  // namespace photorque

// The motion as a domain of the search for missing effects (inference/domain.h).
#include "attitude/estimation/fit.h"
#include "core/parallel.h"
#include "diagnosis/attitude/effects/scan.h"
#include "diagnosis/attitude/recorded_data.h"

namespace photorque {

static_assert(inference::Domain<Candidates>);

Trial Candidates::predict(const Trial& trial, const Runs& runs) const {
  Trial predicted = trial;
  predicted.fit = propagate_model(trial.fit, runs, limits);
  return predicted;
}

std::vector<RunStart> Candidates::initial_conditions_of(const Trial& trial) const {
  return trial.fit.best.runs;
}

std::vector<RunStart> Candidates::initial_conditions_from_data(const Trial& trial,
                                                               const Runs& runs) const {
  return starts_from_data(trial.fit.best, runs);
}

Trial Candidates::with_initial_conditions(Trial trial, const std::vector<RunStart>& begins) const {
  trial.fit.best.runs = begins;
  return trial;
}

std::vector<double> Candidates::gains(const Trial& at, const std::vector<size_t>& candidates,
                                      const Runs& runs) const {
  std::vector<ScoreGroup> groups;
  for (const size_t c : candidates) {
    groups.push_back(
        {list[c].is_linear ? std::vector<Disturbance>{list[c].start} : std::vector<Disturbance>{}});
  }
  std::vector<double> result;
  for (const Score& s : score(at.fit, runs, groups)) result.push_back(s.gain);
  return result;
}

std::vector<std::vector<Start>> Candidates::starts(const Trial& parent,
                                                   const std::vector<size_t>& candidates,
                                                   const Runs& runs, const Runs& averages,
                                                   int threads) const {
  const std::vector<double> lines_Hz = line_frequencies_Hz(parent.fit, runs, limits.scoring);
  std::vector<std::vector<Start>> result(candidates.size());
  parallel_for(candidates.size(), threads, [&](size_t i) {
    result[i] = starts_of(list[candidates[i]], parent, runs, averages, lines_Hz, limits.scoring);
  });
  return result;
}

std::vector<Observation> Candidates::cut(const Runs& runs, size_t pieces) const {
  Runs result;
  for (const Observation& seen : runs) {
    for (size_t i = 0; i < pieces; ++i) {
      const size_t first = i * seen.blocks() / pieces, last = (i + 1) * seen.blocks() / pieces;
      if (first == last) continue;
      Observation piece = seen.part(first, last);
      piece.is_piece = true;
      if (piece.readings(0, piece.blocks()) >= limits.search.min_readings_of_piece) {
        result.push_back(std::move(piece));
      }
    }
  }
  return result;
}

std::vector<Observation> Candidates::average(const Trial& about, const Runs& runs,
                                             size_t blocks) const {
  return averaged_about(about.fit, runs, blocks);
}

double Candidates::excess_sigma(const Trial& trial, const Runs& runs) const {
  return photorque::excess_sigma(trial.fit, runs, limits);
}

}  // namespace photorque

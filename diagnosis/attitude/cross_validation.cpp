#include "diagnosis/attitude/answer.h"

#include <algorithm>
#include <cmath>

#include "attitude/estimation/fit.h"
#include "core/errors.h"
#include "core/parallel.h"

namespace photorque {
namespace {

constexpr size_t folds = 5;

// Removes the readings of blocks [first, last).
void leave_out(size_t first, size_t last, Observation& seen) {
  for (size_t i = first; i < last; ++i) {
    seen.attitude_rows[i] = 0.0;
    seen.gyro_rows[i].setZero();
    for (ScalarReadings& scalar : seen.scalar) {
      if (!scalar.rows.empty()) scalar.rows[i] = 0.0;
    }
  }
}

}  // namespace

CrossValidation::CrossValidation(const Candidates& candidates, std::vector<Observation> train,
                                 std::vector<Observation> held, size_t wanted, int threads)
    : all_(candidates), threads_(threads), runs_(std::move(train)), train_(runs_.size()) {
  std::move(held.begin(), held.end(), std::back_inserter(runs_));
  size_t all = 0;
  for (const Observation& seen : runs_) all += seen.blocks();
  for (size_t run = 0; run < runs_.size(); ++run) {
    const size_t blocks = runs_[run].blocks();
    const size_t pieces =
        runs_.size() >= wanted ? 1 : std::max<size_t>(1, (wanted * blocks + all / 2) / all);
    for (size_t piece = 0; piece < pieces; ++piece) {
      const Segment segment{run, piece * blocks / pieces, (piece + 1) * blocks / pieces};
      if (runs_[run].readings(segment.first, segment.last) > 0) segments_.push_back(segment);
    }
  }
}

std::vector<double> CrossValidation::chi2(const Trial& trial) const {
  std::vector<double> result(segments_.size(), inference::infinity);
  const std::vector<Observation> held{runs_.begin() + static_cast<std::ptrdiff_t>(train_),
                                      runs_.end()};
  const Trial on_held = all_.predict(trial, held);
  if (!std::isfinite(on_held.fit.chi2)) return result;
  std::vector<RunStart> begins = trial.fit.best.runs;
  begins.insert(begins.end(), on_held.fit.best.runs.begin(), on_held.fit.best.runs.end());
  parallel_for(folds, threads_, [&](size_t fold) {
    const std::vector<double> left_out = predicted(trial, begins, fold);
    for (size_t k = 0; k < left_out.size(); ++k) result[fold + k * folds] = left_out[k];
  });
  return result;
}

std::vector<double> CrossValidation::predicted(const Trial& trial,
                                               const std::vector<RunStart>& begins,
                                               size_t fold) const {
  // Runs that are left out as a whole, and the others.
  std::vector<Observation> whole, rest;
  std::vector<RunStart> begins_of_rest;
  std::vector<size_t> place(runs_.size());
  std::vector<bool> is_whole(runs_.size(), false);
  for (size_t i = fold; i < segments_.size(); i += folds) {
    const Segment& s = segments_[i];
    is_whole[s.run] = s.last - s.first == runs_[s.run].blocks();
  }
  for (size_t run = 0; run < runs_.size(); ++run) {
    std::vector<Observation>& these = is_whole[run] ? whole : rest;
    place[run] = these.size();
    these.push_back(runs_[run]);
    if (!is_whole[run]) begins_of_rest.push_back(begins[run]);
  }
  const std::vector<Observation> complete = rest;
  for (size_t i = fold; i < segments_.size(); i += folds) {
    const Segment& s = segments_[i];
    if (!is_whole[s.run]) leave_out(s.first, s.last, rest[place[s.run]]);
  }
  const inference::Effort effort{.max_iterations = all_.limits.fitting.brief_iterations};
  const Trial others = all_.refit(trial, rest, begins_of_rest, effort);
  if (!std::isfinite(others.fit.chi2)) return {};
  std::vector<double> result;
  try {
    std::vector<double> of_whole;
    if (!whole.empty()) {
      const Fit on_whole = all_.predict(others, whole).fit;
      if (!std::isfinite(on_whole.chi2)) return {};
      of_whole = on_whole.run_chi2;
    }
    const std::vector<Prediction> residuals = residuals_of(others.fit, complete);
    for (size_t i = fold; i < segments_.size(); i += folds) {
      const Segment& s = segments_[i];
      double sum = is_whole[s.run] ? of_whole[place[s.run]] : 0.0;
      for (size_t block = s.first; block < s.last && !is_whole[s.run]; ++block) {
        for (const double r : residuals[place[s.run]].residual[block]) {
          if (std::isfinite(r)) sum += r * r;
        }
      }
      result.push_back(sum);
    }
  } catch (const NumericalError&) {
    result.clear();
  }
  return result;
}

}  // namespace photorque

#include "diagnosis/light/segments.h"

#include <algorithm>

#include "core/parallel.h"
#include "inference/whiteness.h"

namespace photorque {
namespace {

constexpr size_t folds = 5;

// The segment of each row. Neighbouring rows of a scan have independent errors and go to different
// segments. The errors of neighbouring rows of a curve or of a run over time may be correlated.
// These rows are therefore assigned to segments in blocks.
std::vector<size_t> segments_of(const LightRun& run, size_t count) {
  constexpr size_t blocks_of_a_segment = 4;
  const bool is_scan = run.recording().kind == LightRecording::Kind::scan;
  const size_t block =
      is_scan ? 1 : std::max<size_t>(1, run.rows() / (count * blocks_of_a_segment));
  std::vector<size_t> segment(run.rows());
  for (size_t row = 0; row < segment.size(); ++row) segment[row] = row / block % count;
  return segment;
}

// χ² of every segment, each predicted by a fit to the rows of the other folds.
class Segments {
 public:
  Segments(const LightCandidates& all, const std::vector<FittedRun>& runs, int threads)
      : all_(all), runs_(runs), threads_(threads), count_(all.limits.discrepancy.segments) {
    for (const FittedRun& run : runs) segment_.push_back(segments_of(*run.run, count_));
    fitted_.resize(folds);
    parallel_for(folds, threads, [&](size_t fold) {
      for (size_t r = 0; r < runs.size(); ++r) {
        std::vector<size_t> rows;
        for (size_t row = 0; row < segment_[r].size(); ++row) {
          if (segment_[r][row] % folds != fold) rows.push_back(row);
        }
        fitted_[fold].push_back(part_of(runs[r], rows, all.nominal));
      }
    });
  }

  std::vector<double> chi2(const LightTrial& trial) const {
    std::vector<double> result(count_, 0.0);
    parallel_for(folds, threads_, [&](size_t fold) {
      const LightTrial others =
          fit_light(all_, trial, fitted_[fold], all_.limits.fitting.brief_iterations);
      for (size_t r = 0; r < runs_.size(); ++r) {
        const Eigen::VectorXd left = residuals_of(others, all_, runs_[r]);
        const size_t of_a_row = runs_[r].run->samples() / runs_[r].run->rows();
        for (size_t i = 0; i < runs_[r].run->samples(); ++i) {
          const size_t segment = segment_[r][i / of_a_row];
          const double off = left[static_cast<Eigen::Index>(i)];
          if (segment % folds == fold) result[segment] += off * off;
        }
      }
    });
    return result;
  }

 private:
  const LightCandidates& all_;
  const std::vector<FittedRun>& runs_;
  int threads_;
  size_t count_;
  std::vector<std::vector<size_t>> segment_;    // [run][row]: the segment of a row
  std::vector<std::vector<FittedRun>> fitted_;  // [fold][run]: the rows that are fitted
};

}  // namespace

std::optional<double> gain_over_segments(const LightTrial& trial, size_t which,
                                         const LightCandidates& all,
                                         const std::vector<FittedRun>& runs, int threads) {
  for (const FittedRun& run : runs) {
    if (run.run->rows() < 2 * all.limits.discrepancy.segments) return std::nullopt;
  }
  const Segments segments(all, runs, threads);
  return inference::gain_sigma(segments.chi2(without_candidate(trial, which)),
                               segments.chi2(trial));
}

}  // namespace photorque

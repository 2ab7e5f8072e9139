#include "diagnosis/light/findings.h"

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

}  // namespace

std::optional<double> gain_over_segments(const LightTrial& trial, size_t which,
                                         const LightCandidates& all,
                                         const std::vector<FittedRun>& runs, int threads) {
  for (const FittedRun& run : runs) {
    if (run.run->rows() < 2 * all.limits.discrepancy.segments) return std::nullopt;
  }
  const size_t count = all.limits.discrepancy.segments;
  std::vector<std::vector<size_t>> segment;  // [run][row]: the segment of a row
  for (const FittedRun& run : runs) segment.push_back(segments_of(*run.run, count));
  std::vector<std::vector<FittedRun>> fitted(folds);  // [fold][run]: the rows that are fitted
  parallel_for(folds, threads, [&](size_t fold) {
    for (size_t r = 0; r < runs.size(); ++r) {
      std::vector<size_t> rows;
      for (size_t row = 0; row < segment[r].size(); ++row) {
        if (segment[r][row] % folds != fold) rows.push_back(row);
      }
      fitted[fold].push_back(part_of(runs[r], rows, all.nominal));
    }
  });
  // χ² of every segment, each predicted by a fit to the rows of the other folds.
  const auto chi2 = [&](const LightTrial& explanation) {
    std::vector<double> result(count, 0.0);
    parallel_for(folds, threads, [&](size_t fold) {
      const LightTrial others =
          all.fit(explanation, fitted[fold], all.limits.fitting.brief_iterations);
      for (size_t r = 0; r < runs.size(); ++r) {
        const Eigen::VectorXd left = residuals_of(others, all, runs[r]);
        const size_t of_a_row = runs[r].run->samples() / runs[r].run->rows();
        for (size_t i = 0; i < runs[r].run->samples(); ++i) {
          const size_t in = segment[r][i / of_a_row];
          const double off = left[static_cast<Eigen::Index>(i)];
          if (in % folds == fold) result[in] += off * off;
        }
      }
    });
    return result;
  };
  return inference::gain_sigma(chi2(without_candidate(trial, which)), chi2(trial));
}

}  // namespace photorque

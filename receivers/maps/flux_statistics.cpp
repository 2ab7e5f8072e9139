#include "receivers/maps/flux_statistics.h"

#include <algorithm>
#include <cmath>

#include "receivers/jackknife.h"

namespace photorque {
namespace {

// Bins with enough surface for their irradiance to mean something.
std::vector<size_t> substantial_bins(const SurfaceGrid& grid) {
  std::vector<double> covered;
  for (const double area_m2 : grid.area_m2) {
    if (area_m2 > 0.0) covered.push_back(area_m2);
  }
  const auto middle = covered.begin() + static_cast<std::ptrdiff_t>(covered.size() / 2);
  std::nth_element(covered.begin(), middle, covered.end());
  std::vector<size_t> bins;
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    if (grid.area_m2[bin] >= 0.1 * *middle) bins.push_back(bin);
  }
  return bins;
}

// Variance over the surface / mean².
double squared_variation(const SurfaceGrid& grid, std::span<const double> power_W) {
  double total_W = 0.0, squares = 0.0;
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    if (grid.area_m2[bin] <= 0.0) continue;
    total_W += power_W[bin];
    squares += power_W[bin] * power_W[bin] / grid.area_m2[bin];
  }
  return squares * grid.total_area_m2() / (total_W * total_W) - 1.0;
}

Estimate square_root(const Estimate& square) {
  const double root = std::sqrt(std::max(0.0, square.value));
  // Below its own error the root is no longer linear in the square; it is of the size of √error.
  const double slope = std::max(root, std::sqrt(square.standard_error));
  return {root, slope > 0.0 ? square.standard_error / (2.0 * slope) : 0.0};
}

double relative_error_of(const std::vector<Estimate>& bins, std::span<const size_t> chosen,
                         double peak) {
  double squares = 0.0;
  int count = 0;
  for (const size_t bin : chosen) {
    if (bins[bin].value <= 0.1 * peak) continue;
    const double relative = bins[bin].standard_error / bins[bin].value;
    squares += relative * relative;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace

FluxStatistics flux_statistics(const FluxMapReceiver& receiver, const FluxMap& map,
                               const BinSums& sums) {
  const SurfaceGrid& grid = map.grid;
  const double area_m2 = grid.total_area_m2();
  const std::vector<size_t> chosen = substantial_bins(grid);
  const std::vector<Estimate>& bins = map.incident.per_bin_W_m2;
  const auto by_value = [&](size_t a, size_t b) { return bins[a].value < bins[b].value; };
  const auto [low, high] = std::minmax_element(chosen.begin(), chosen.end(), by_value);

  FluxStatistics statistics;
  const double mean_W_m2 = map.incident.power_W.value / area_m2;
  if (!(mean_W_m2 > 0.0)) return statistics;
  statistics.mean_W_m2 = {mean_W_m2, map.incident.power_W.standard_error / area_m2};
  statistics.min_W_m2 = bins[*low];
  statistics.max_W_m2 = bins[*high];
  statistics.uniformity.value = statistics.min_W_m2.value / mean_W_m2;
  statistics.uniformity.standard_error =
      std::hypot(statistics.min_W_m2.standard_error,
                 statistics.uniformity.value * statistics.mean_W_m2.standard_error) /
      mean_W_m2;
  statistics.variation = square_root(jackknife(sums, [&](std::span<const double> replicate) {
    return squared_variation(grid, receiver.incident_W(replicate));
  }));
  statistics.relative_error = relative_error_of(bins, chosen, statistics.max_W_m2.value);
  return statistics;
}

}  // namespace photorque

#include "receivers/flux_map.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/median.h"
#include "raytrace/receiver.h"
#include "receivers/kind.h"
#include "receivers/surface_grid.h"

namespace photorque {
namespace {

// Bins that contain enough surface for a meaningful irradiance.
std::vector<size_t> substantial_bins(const SurfaceGrid& grid) {
  std::vector<double> covered;
  for (const double area_m2 : grid.area_m2) {
    if (area_m2 > 0.0) covered.push_back(area_m2);
  }
  const double usual_m2 = upper_median(covered);
  std::vector<size_t> bins;
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    if (grid.area_m2[bin] >= 0.1 * usual_m2) bins.push_back(bin);
  }
  return bins;
}

// Variance over the surface, divided by the square of the mean.
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
  // If the square is below its error, the root is not linear in it. Its error is then of the order
  // of √error.
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

namespace {

// The two channels are neighbours in memory, so that one instruction adds both.
constexpr size_t incident = 0, absorbed = 1, channels = 2;

// Sum over the bands [first_band, last_band) of one channel.
double sum_bands(std::span<const double> bin, size_t channel, size_t first_band, size_t last_band) {
  double sum = 0.0;
  for (size_t band = first_band; band < last_band; ++band) sum += bin[band * channels + channel];
  return sum;
}

FluxLayer layer(const SurfaceGrid& grid, size_t bands, const BinSums& sums, size_t channel,
                size_t first_band, size_t last_band) {
  GridEstimates power_W = estimates_on(grid, sums, [&](std::span<const double> half, size_t bin) {
    return sum_bands(half.subspan(bin * bands * channels), channel, first_band, last_band);
  });
  FluxLayer result{power_W.total, std::move(power_W.per_bin)};
  for (size_t bin = 0; bin < grid.bins(); ++bin) {
    result.per_bin_W_m2[bin].value /= grid.area_m2[bin];
    result.per_bin_W_m2[bin].standard_error /= grid.area_m2[bin];
  }
  return result;
}

// "700-760nm"; "below_700nm" and "above_760nm" for the open bands at either end.
std::string band_label(const Bands& bands, size_t band) {
  constexpr double no_upper_edge_m = 1.0;
  const auto nm = [](double edge_m) { return std::to_string(std::lround(edge_m * 1e9)); };
  const double low_m = bands.edges_m[band], high_m = bands.edges_m[band + 1];
  if (low_m <= 0.0) return "below_" + nm(high_m) + "nm";
  if (high_m >= no_upper_edge_m) return "above_" + nm(low_m) + "nm";
  return nm(low_m) + "-" + nm(high_m) + "nm";
}

// Weighted by area, the mean of the map is the mean over the surface. Bins at an edge contain
// little surface.
Map density_map(const SurfaceGrid& grid, const FluxLayer& layer, const std::string& name,
                const std::string& title) {
  Map map = grid_map(grid, layer.per_bin_W_m2, name, title, "W/m²");
  map.weight = grid.area_m2;
  return map;
}

void add_layers(Product& product, const FluxMap& map, const std::string& name, const FluxLayer& in,
                const FluxLayer& kept) {
  product.quantities.push_back({"power_on_" + name + "_W", in.power_W});
  product.quantities.push_back({"power_absorbed_by_" + name + "_W", kept.power_W});
  product.maps.push_back(density_map(map.grid, in, "irradiance_" + name, "Irradiance on " + name));
  product.maps.push_back(
      density_map(map.grid, kept, "absorbed_" + name, "Power absorbed by " + name));
}

void add_statistics(Product& product, const FluxStatistics& statistics, const std::string& name) {
  const auto add = [&](const std::string& quantity, Estimate value) {
    product.quantities.push_back({quantity, value});
  };
  add("irradiance_mean_" + name + "_W_m2", statistics.mean_W_m2);
  add("irradiance_min_" + name + "_W_m2", statistics.min_W_m2);
  add("irradiance_max_" + name + "_W_m2", statistics.max_W_m2);
  add("uniformity_" + name, statistics.uniformity);
  add("variation_" + name, statistics.variation);
  add("relative_error_" + name, {statistics.relative_error, 0.0});
}

}  // namespace

FluxMapReceiver::FluxMapReceiver(std::string name, const Scene& scene, SurfaceGrid grid)
    : name_(std::move(name)), grid_(std::move(grid)), bands_(scene.bands), binner_(scene, grid_) {}

size_t FluxMapReceiver::bins() const {
  return 2 * grid_.bins() * static_cast<size_t>(bands_.count()) * channels;
}

size_t FluxMapReceiver::entry(size_t bin, size_t band) const {
  return (bin * static_cast<size_t>(bands_.count()) + band) * channels;
}

void FluxMapReceiver::score(const Hits& hits, std::span<double> sums) const {
  BinnedHits binned;
  binner_.bin(hits, binned);
  const auto bands = static_cast<size_t>(bands_.count());
  const size_t offset = hits.depth == 0 ? 0 : direct_entries();
  for (size_t band = 0; band < bands; ++band) {
    const double* in = hits.incident_W[band].data();
    const double* kept = hits.absorbed_W[band].data();
    double* base = sums.data() + offset + band * channels;
    for_each_binned(binned, [=](size_t hit, size_t index) {
      Eigen::Map<Vec2>(base + index * bands * channels) += Vec2(in[hit], kept[hit]);
    });
  }
}

FluxMap FluxMapReceiver::flux_map(const BinSums& sums) const {
  const auto count = static_cast<size_t>(bands_.count());
  const auto make = [&](size_t channel, size_t first, size_t last) {
    return layer(grid_, count, sums, channel, first, last);
  };
  FluxMap map{grid_, bands_, make(incident, 0, count), make(absorbed, 0, count), {}, {}};
  for (size_t band = 0; band < count; ++band) {
    map.incident_by_band.push_back(make(incident, band, band + 1));
    map.absorbed_by_band.push_back(make(absorbed, band, band + 1));
  }
  return map;
}

std::vector<double> FluxMapReceiver::incident_W(std::span<const double> bins) const {
  const auto bands = static_cast<size_t>(bands_.count());
  std::vector<double> power_W;
  for (size_t first = 0; first < direct_entries(); first += bands * channels) {
    power_W.push_back(sum_bands(bins.subspan(first), incident, 0, bands) +
                      sum_bands(bins.subspan(direct_entries() + first), incident, 0, bands));
  }
  return power_W;
}

Product FluxMapReceiver::product(const BinSums& sums) const {
  const FluxMap map = flux_map(sums);
  Product product;
  add_layers(product, map, name_, map.incident, map.absorbed);
  add_statistics(product, flux_statistics(*this, map, sums), name_);
  product.quantities.push_back({"area_" + name_ + "_m2", {grid_.total_area_m2(), 0.0}});
  if (bands_.count() == 1) return product;
  for (size_t band = 0; band < map.incident_by_band.size(); ++band) {
    add_layers(product, map, name_ + "_" + band_label(bands_, band), map.incident_by_band[band],
               map.absorbed_by_band[band]);
  }
  return product;
}

namespace kinds::flux_map {

ReceiverKind kind() {
  return {"flux_map", "Incident and absorbed power per bin of a surface",
          [](const Settings& settings, const Scene& scene) -> MadeReceiver {
            const ReceiverTarget target = read_target(settings, scene);
            const auto map = std::make_shared<const FluxMapReceiver>(
                target.name, scene, read_surface_grid(settings, scene, target, Side::front));
            return {.receiver = map, .flux_map = map};
          },
          joined({target_keys(), surface_grid_keys(Side::front)})};
}

}  // namespace kinds::flux_map

}  // namespace photorque

#include "tools/runs/direct_light.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace photorque {
namespace {

// Incident power of direct light in all bands, per bin of one replicate.
double direct_W(const FluxMapReceiver& map, std::span<const double> sums, size_t bin) {
  double power_W = 0.0;
  for (size_t band = 0; band < static_cast<size_t>(map.bands().count()); ++band) {
    power_W += sums[map.entry(bin, band)];
  }
  return power_W;
}

Estimate direct_total_W(const FluxMapReceiver& map, const BinSums& sums) {
  return sums.estimate([&](std::span<const double> all) {
    double power_W = 0.0;
    for (size_t bin = 0; bin < map.grid().bins(); ++bin) power_W += direct_W(map, all, bin);
    return power_W;
  });
}

Estimate direct_bin_W(const FluxMapReceiver& map, const BinSums& sums, size_t bin) {
  std::vector<double> values;
  for (int r = 0; r < sums.replicates; ++r) values.push_back(direct_W(map, sums.of(r), bin));
  const double bound_W = sums.bound.empty() ? 0.0 : direct_W(map, sums.bound, bin);
  return with_bound(estimate_from_replicates(values), bound_W);
}

DirectLight compare(const FluxMapReceiver& map, const Gathered& gathered, const BinSums& rays) {
  constexpr double well_lit = 0.3;  // relative error of the rays' bin at most
  DirectLight light;
  light.name = map.name();
  light.gathered_W = direct_total_W(map, gathered.direct);
  light.rays_W = direct_total_W(map, rays);
  const double sigma = std::hypot(light.gathered_W.standard_error, light.rays_W.standard_error);
  const double difference = light.gathered_W.value - light.rays_W.value;
  light.difference_sigma = difference / (sigma + 1e-300);
  int bins = 0;
  for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
    const Estimate ray = direct_bin_W(map, rays, bin);
    if (!(ray.value > 0.0) || ray.standard_error > well_lit * ray.value) continue;
    const Estimate own = direct_bin_W(map, gathered.direct, bin);
    const double error = std::hypot(ray.standard_error, own.standard_error);
    if (error > 0.0) light.mean_square += std::pow((own.value - ray.value) / error, 2);
    ++bins;
  }
  if (bins > 0) light.mean_square /= bins;
  light.open_pairs = gathered.open_pairs;
  light.shaded_pairs = gathered.shaded_pairs;
  light.shadow_rays = gathered.shadow_rays;
  return light;
}

void replace_direct(const FluxMapReceiver& map, const Gathered& gathered, BinSums& sums) {
  for (int r = 0; r < sums.replicates; ++r) {
    const auto direct = gathered.direct.of(r);
    std::copy(direct.begin(), direct.end(),
              sums.sums.begin() + static_cast<std::ptrdiff_t>(static_cast<size_t>(r) * map.bins()));
  }
  sums.bound = gathered.direct.bound;
  sums.bound.resize(map.bins(), 0.0);  // what bounces comes by rays
}

std::string cost_notice(const FluxMapReceiver& map, size_t pairs, uint64_t rays) {
  char text[256];
  std::snprintf(text, sizeof text,
                " by rays alone: to gather it over %.2g pairs of a bin and a lamp would take about "
                "%.2g s of one thread, the rays take %.2g s; trace.direct = \"gather\" does so all "
                "the same",
                static_cast<double>(pairs), gathering_cost_s(pairs), tracing_cost_s(rays));
  return "direct light on " + map.name() + text;
}

}  // namespace

DirectRoute gather_into(const Experiment& experiment, const TraceableScene& scene,
                        const RigidTransform& lab_from_body, const TraceOptions& options,
                        TraceResult& result) {
  const TraceEffort& effort = experiment.file.effort;
  const bool weigh_cost =
      effort.direct == TraceEffort::Direct::automatic && !effort.target_error.has_value();
  DirectRoute route;
  if (effort.direct == TraceEffort::Direct::rays) return route;
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    const FluxMapReceiver* map = experiment.receivers[i].flux_map.get();
    if (map == nullptr || !can_gather(experiment.scene, map->grid(), experiment.beams)) continue;
    const size_t pairs = map->grid().bins() * experiment.beams.size();
    if (weigh_cost && !gathering_pays(pairs, result.rays)) {
      route.notices.push_back(cost_notice(*map, pairs, result.rays));
      continue;
    }
    const Gathered gathered = gather_direct(scene, lab_from_body, experiment.beams, *map,
                                            {.replicates = options.replicates,
                                             .seed = options.seed,
                                             .threads = options.threads,
                                             .target_error = effort.target_error.value_or(0.0)});
    route.gathered.push_back(compare(*map, gathered, result.sums[i]));
    route.gathered.back().receiver = i;
    replace_direct(*map, gathered, result.sums[i]);
  }
  return route;
}

double worst_bin_error(const Experiment& experiment, const TraceResult& result) {
  constexpr double floor = 0.1;
  double worst = 0.0;
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    const FluxMapReceiver* map = experiment.receivers[i].flux_map.get();
    if (map == nullptr) continue;
    const std::vector<Estimate> bins = map->flux_map(result.sums[i]).incident.per_bin_W_m2;
    double peak = 0.0;
    for (const Estimate& bin : bins) peak = bin.value > peak ? bin.value : peak;
    for (const Estimate& bin : bins) {
      if (bin.value > floor * peak) worst = std::max(worst, bin.standard_error / bin.value);
    }
  }
  return worst;
}

}  // namespace photorque

#include "tools/runs/direct_light.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/text/format.h"
#include "receivers/gather/bodies/wrench.h"

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

// Rays are in single precision: sums that cancel have an error of this fraction of the power that
// they carry.
constexpr double ray_rounding = 1e-7;

// `ray_W`: mean power of one ray. `counting_W`: see counting_error_W().
DirectLight compare(const FluxMapReceiver& map, const Gathered& gathered, const BinSums& rays,
                    double ray_W, double counting_W, double sent_W) {
  constexpr double few = 100.0;  // below this number of rays their scatter does not give the error
  constexpr double well_lit = 0.3;  // largest relative error of a bin by rays
  DirectLight light;
  light.name = map.name();
  light.gathered_W = direct_total_W(map, gathered.direct);
  light.rays_W = direct_total_W(map, rays);
  const double expected = light.gathered_W.value / ray_W;
  const double chance_W = expected < few ? std::sqrt(std::max(expected, 0.0)) * ray_W : 0.0;
  const double sigma = std::hypot(light.gathered_W.standard_error, light.rays_W.standard_error,
                                  std::max(chance_W, counting_W));
  const double difference = light.gathered_W.value - light.rays_W.value;
  light.difference_sigma = difference / (sigma + ray_rounding * sent_W);
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

// Replaces the direct entries, which are the first of a receiver's bins.
void replace_direct(const Gathered& gathered, BinSums& sums) {
  for (int r = 0; r < sums.replicates; ++r) {
    const auto direct = gathered.direct.of(r);
    std::copy(direct.begin(), direct.end(),
              sums.sums.begin() + static_cast<std::ptrdiff_t>(static_cast<size_t>(r) * sums.bins));
  }
  sums.bound = gathered.direct.bound;
  sums.bound.resize(sums.bins, 0.0);  // bounces come from rays
}

std::array<Estimate, 3> total_N_m(const TorqueMapReceiver& map, const BinSums& sums) {
  std::array<Estimate, 3> total;
  for (size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> values(static_cast<size_t>(sums.replicates), 0.0);
    double bounds = 0.0;
    for (size_t entry = axis; entry < map.direct_entries(); entry += 3) {
      for (size_t r = 0; r < values.size(); ++r) {
        values[r] += sums.of(static_cast<int>(r))[entry];
      }
      bounds += sums.bound_of(entry);
    }
    total[axis] = with_bound(estimate_from_replicates(values), bounds);
  }
  return total;
}

// `scale_N_m`: torque of all the light at the largest arm. `counting_N_m`: counting_error_W() as a
// torque at this arm.
DirectTorque compare(const TorqueMapReceiver& map, const Gathered& gathered, const BinSums& rays,
                     double scale_N_m, double counting_N_m) {
  DirectTorque torque{map.name()};
  const auto all_own = total_N_m(map, gathered.direct), all_by_rays = total_N_m(map, rays);
  for (size_t axis = 0; axis < 3; ++axis) {
    const Estimate &own = all_own[axis], &by_rays = all_by_rays[axis];
    const double sigma = std::hypot(own.standard_error, by_rays.standard_error, counting_N_m) +
                         ray_rounding * scale_N_m;
    torque.worst_sigma = std::max(torque.worst_sigma, std::abs(own.value - by_rays.value) / sigma);
  }
  return torque;
}

// `scale_N`: force of all the light; `arm_m`: the largest arm.
DirectTorque compare(const WrenchReceiver& receiver, const Gathered& gathered, const BinSums& rays,
                     double scale_N, double counting_N, double arm_m) {
  BinSums own = rays;
  replace_direct(gathered, own);
  DirectTorque wrench{receiver.name()};
  const WrenchEstimate all_own = receiver.direct(own), all_by_rays = receiver.direct(rays);
  const auto values = [](const WrenchEstimate& e) {
    Eigen::Array<double, 6, 1> all;
    all << e.mean.force_N.array(), e.mean.torque_N_m.array();
    return all;
  };
  const auto mine = values(all_own), theirs = values(all_by_rays);
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double scale = k < 3 ? scale_N : scale_N * arm_m;
    const double counting = counting_N * scale / scale_N;
    const double sigma =
        std::sqrt(all_own.covariance(k, k) + all_by_rays.covariance(k, k) + counting * counting) +
        ray_rounding * scale;
    wrench.worst_sigma = std::max(wrench.worst_sigma, std::abs(mine[k] - theirs[k]) / sigma);
  }
  return wrench;
}

std::string cost_notice(const std::string& what, size_t pairs, uint64_t rays) {
  return what +
         printed(
             " by rays alone: to gather it over %.2g pairs of a bin and a lamp would take about "
             "%.2g s of one thread, the rays take %.2g s; trace.direct = \"gather\" does so all "
             "the same",
             static_cast<double>(pairs), gathering_cost_s(pairs), tracing_cost_s(rays));
}

// Data shared by all maps and bodies of one run.
struct Wanted {
  const Experiment& experiment;
  const TraceableScene& scene;
  const RigidTransform& lab_from_body;
  GatherOptions options;
  bool weigh_cost;
  uint64_t rays;
  double sent_W;
  double ray_W;
  DirectRoute& route;

  double counting_W;

  double force_N() const { return sent_W / speed_of_light_m_s; }
  double counting_N() const { return counting_W / speed_of_light_m_s; }

  // Whether quadrature takes less time than rays; otherwise adds a notice.
  bool pays(const std::string& what, size_t pairs) const {
    if (!weigh_cost || gathering_pays(pairs, rays)) return true;
    route.notices.push_back(cost_notice(what, pairs, rays));
    return false;
  }
};

void gather_torques(const Wanted& wanted, const TorqueMapReceiver& map, BinSums& sums) {
  if (map.force() != TorqueMapReceiver::Force::momentum) return;
  const std::vector<Beam>& beams = wanted.experiment.beams;
  if (!can_gather_torque(wanted.experiment.scene, map.grid(), beams)) return;
  constexpr size_t dearer = 8;  // cost relative to irradiance, which uses tables
  const size_t pairs = dearer * map.grid().bins() * beams.size();
  if (!wanted.pays("torque of direct light on " + map.name(), pairs)) return;
  const Gathered gathered =
      gather_torque(wanted.scene, wanted.lab_from_body, beams, map, wanted.options);
  wanted.route.torques.push_back(compare(map, gathered, sums,
                                         wanted.force_N() * wanted.experiment.scene.radius_m(),
                                         wanted.counting_N() * wanted.experiment.scene.radius_m()));
  replace_direct(gathered, sums);
}

void gather_light(const Wanted& wanted, const FluxMapReceiver& map, size_t place, BinSums& sums) {
  const std::vector<Beam>& beams = wanted.experiment.beams;
  if (!can_gather(wanted.experiment.scene, map.grid(), beams)) return;
  if (!wanted.pays("direct light on " + map.name(), map.grid().bins() * beams.size())) return;
  const Gathered gathered =
      gather_direct(wanted.scene, wanted.lab_from_body, beams, map, wanted.options);
  wanted.route.gathered.push_back(
      compare(map, gathered, sums, wanted.ray_W, wanted.counting_W, wanted.sent_W));
  wanted.route.gathered.back().receiver = place;
  replace_direct(gathered, sums);
}

void gather_wrench(const Wanted& wanted, const WrenchGather& bodies, const WrenchReceiver& receiver,
                   BinSums& sums) {
  // Sunlight has closed forms. A near lamp needs a quadrature over every lit facet, which takes
  // tenths of a second.
  const bool sunlight = std::ranges::all_of(wanted.experiment.beams, [](const Beam& beam) {
    return beam.aperture && std::isinf(beam.aperture->radius_m);
  });
  if (wanted.experiment.file.effort.direct != TraceEffort::Direct::gather && !sunlight) return;
  if (!wanted.pays("force and torque of direct light on " + receiver.name(), bodies.pairs())) {
    return;
  }
  const Gathered gathered = bodies.wrench(wanted.lab_from_body, receiver, wanted.options);
  wanted.route.wrenches.push_back(
      compare(receiver, gathered, sums, wanted.force_N(), wanted.counting_N(),
              wanted.experiment.scene.radius_m() + receiver.about_body_m().norm()));
  replace_direct(gathered, sums);
}

}  // namespace

DirectRoute gather_into(const Experiment& experiment, const TraceableScene& scene,
                        const WrenchGather* bodies, const RigidTransform& lab_from_body,
                        const TraceOptions& options, TraceResult& result) {
  const TraceEffort& effort = experiment.file.effort;
  DirectRoute route;
  if (effort.direct == TraceEffort::Direct::rays) return route;
  const Wanted wanted{experiment,
                      scene,
                      lab_from_body,
                      {.replicates = options.replicates,
                       .seed = options.seed,
                       .body_points = 1 << 12,
                       .threads = options.threads,
                       .target_error = effort.target_error.value_or(0.0)},
                      effort.direct == TraceEffort::Direct::automatic && !effort.target_error,
                      result.rays,
                      result.sent_W,
                      result.sent_W / static_cast<double>(result.rays),
                      route,
                      counting_error_W(result, options.replicates)};
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    const NamedReceiver& receiver = experiment.receivers[i];
    BinSums& sums = result.sums[i];
    if (receiver.torque_map) gather_torques(wanted, *receiver.torque_map, sums);
    if (receiver.flux_map) gather_light(wanted, *receiver.flux_map, i, sums);
    if (receiver.wrench && bodies != nullptr)
      gather_wrench(wanted, *bodies, *receiver.wrench, sums);
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

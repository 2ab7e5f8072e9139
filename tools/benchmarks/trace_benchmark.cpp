// Speed of the forward tracer without bounces, compared with a bare Embree loop over the same
// sorted rays; and speed of maps by gathering.
//
// Case A: a disc of 0.4 m, pillbox of 1.5 deg, over a 0.5 m square of 100 × 100 bins with a box
// between. Case B: 50 LEDs of 3 deg over a plate of 20,000 triangles with posts.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/constants.h"
#include "core/parallel.h"
#include "raytrace/tracing/find_hits.h"
#include "raytrace/tracing/shadow.h"
#include "receivers/flux_map.h"
#include "receivers/gather/gather.h"
#include "scenes/experiment/experiment.h"
#include "tools/benchmarks/benchmark_scene.h"

namespace photorque {
namespace {

Mesh plate(double side_m, int cells, double z_m) {
  return sheet(side_m, cells, [z_m](double, double) { return z_m; });
}

Mesh box(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_m.emplace_back((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(),
                                 (i & 4) ? high.z() : low.z());
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

struct Case {
  Scene scene;
  std::vector<Beam> beams;
};

Case case_a() {
  Case a;
  a.scene.surfaces.push_back(grey_surface("black", 0, 0));
  add_part(a.scene, plate(0.5, 1, 0.0), "receiver");
  add_part(a.scene, box(Vec3(0, -0.02, 0.5), Vec3(0.1, 0.08, 0.55)), "box");
  a.beams = make_beams("led", {{"power_W", {1.0}},
                               {"aperture_diameter_m", {0.4}},
                               {"profile", {"pillbox"}},
                               {"half_angle_deg", {1.5}},
                               {"pillbox_measure", {"angle"}},
                               {"wavelength_nm", {730.0}},
                               {"position_m", vector_node(Vec3(0, 0, 1.5))},
                               {"aim_m", vector_node(Vec3::Zero())}});
  return a;
}

Case case_b() {
  Case b;
  b.scene.surfaces.push_back(grey_surface("black", 0, 0));
  add_part(b.scene, plate(0.5, 99, 0.0), "receiver");
  for (int k = 0; k < 16; ++k) {
    const double angle = 2 * pi * k / 16, x = 0.2 * std::cos(angle), y = 0.2 * std::sin(angle);
    add_part(b.scene, box(Vec3(x - 0.01, y - 0.01, 0.0), Vec3(x + 0.01, y + 0.01, 0.08)),
             "post_" + std::to_string(k));
  }
  for (int k = 0; k < 50; ++k) {
    add_led(b.beams, Vec3(0.06 * (k % 10) - 0.27, 0.1 * (k / 10) - 0.2, 1.5), 0.045);
  }
  return b;
}

FluxMapReceiver flux_map(const Scene& scene) {
  SurfaceGridOptions options;
  const auto instances = scene.instances_of("receiver");
  return {"receiver", scene, make_surface_grid(scene, instances, options)};
}

constexpr uint64_t forward_rays = 1ull << 24;

void forward(benchmark::State& state, const Case& which) {
  const TraceableScene scene(which.scene, false);
  const FluxMapReceiver map = flux_map(which.scene);
  const Receiver* const receivers[] = {&map};
  TraceOptions options;
  options.rays = forward_rays;
  options.threads = static_cast<int>(state.range(0));
  uint64_t rays = 0;
  for (auto _ : state) rays += trace(scene, {}, which.beams, receivers, options).rays;
  state.counters["Mrays/s"] =
      benchmark::Counter(static_cast<double>(rays) / 1e6, benchmark::Counter::kIsRate);
}

// A mirror of 10 m × 10 m that faces the zenith, 500 m below a receiver of 8 m × 8 m that faces
// down. With the Sun in the zenith, 1000 W/m² · 100 m² meet the mirror, and 64 kW meet the
// transparent back of the receiver.
Case one_mirror() {
  Case one;
  one.scene.surfaces.push_back(grey_surface("mirror", 1.0, 0.0));
  add_part(one.scene, plate(10.0, 1, 0.0), "mirror");
  one.scene.surfaces.push_back(grey_surface("nothing", 0, 0, 1.0));
  one.scene.surfaces.push_back(grey_surface("black", 0, 0));
  Mesh receiver = plate(8.0, 1, 500.0);
  for (auto& triangle : receiver.triangles) std::swap(triangle[1], triangle[2]);
  add_part(one.scene, std::move(receiver), "receiver");
  one.scene.instances.back().front_surface = 2;
  one.scene.instances.back().back_surface = 1;
  one.beams =
      make_beams("sun", {{"direction", vector_node(Vec3(0, 0, -1))}, {"irradiance_W_m2", {1000.0}}},
                 {.scene_radius_m = one.scene.radius_m(), .notice = {}});
  return one;
}

// Sunlight on one mirror in a large scene: rays that meet the scene, and the error of the power
// that the receiver gets from the mirror (64 kW except for the Sun's width).
void sunlight(benchmark::State& state, const Case& which) {
  const TraceableScene scene(which.scene);
  const FluxMapReceiver map = flux_map(which.scene);
  const Receiver* const receivers[] = {&map};
  TraceOptions options;
  options.rays = 1ull << state.range(1);
  options.threads = static_cast<int>(state.range(0));
  std::atomic<uint64_t> first_hits = 0;
  options.observe = [&](const HitOrigin&, const Hits& hits) {
    if (hits.depth == 0) first_hits += static_cast<uint64_t>(hits.count);
  };
  uint64_t rays = 0;
  Estimate received;
  for (auto _ : state) {
    const TraceResult result = trace(scene, {}, which.beams, receivers, options);
    rays += result.rays;
    received = result.power_balance.absorbed_by_instance_W[1];
  }
  state.counters["useful_%"] = 100.0 * static_cast<double>(first_hits) / static_cast<double>(rays);
  state.counters["useful_Mrays/s"] =
      benchmark::Counter(static_cast<double>(first_hits) / 1e6, benchmark::Counter::kIsRate);
  state.counters["received_kW"] = 1e-3 * received.value;
  state.counters["error_kW"] = 1e-3 * received.standard_error;
}

// Rays of one batch per beam, in the order of their landing cells.
std::vector<std::vector<Ray>> batches_of(const Case& which, const TraceableScene& scene) {
  std::vector<std::vector<Ray>> batches(std::min<size_t>(which.beams.size(), 8));
  LaunchBuffer launched;
  // Number of rays of one replicate of one beam in `forward`.
  const int log2_rays = std::countr_zero(std::bit_ceil(forward_rays / 16 / which.beams.size()));
  for (size_t b = 0; b < batches.size(); ++b) {
    const Beam& beam = which.beams[b * which.beams.size() / batches.size()];
    const LaunchPlan plan =
        plan_launch(*beam.emitter, beam.lab_from_emitter, scene.data(), log2_rays);
    launch(*beam.emitter, plan, {1, b, 0}, 0, launched);
    for (const uint32_t i : launched.order) batches[b].push_back(launched.rays[i]);
  }
  return batches;
}

// Embree alone on existing rays.
void bare_embree(benchmark::State& state, const Case& which) {
  const TraceableScene scene(which.scene, false);
  const auto batches = batches_of(which, scene);
  const int threads = static_cast<int>(state.range(0));
  constexpr size_t repeats = 64;
  uint64_t rays = 0;
  for (auto _ : state) {
    parallel_for(repeats * batches.size(), threads, [&](size_t item) {
      const auto buffer = std::make_unique<HitBuffer>(1);
      const std::span<const Ray> batch = batches[item % batches.size()];
      const RayList all{batch, {}};
      for (size_t begin = 0; begin < all.size(); begin += Hits::capacity) {
        find_hits(scene.data(), all.part(begin, Hits::capacity), Coherence::coherent, *buffer);
        benchmark::DoNotOptimize(buffer->hits.instance[0]);
      }
    });
    for (const std::vector<Ray>& batch : batches) rays += repeats * batch.size();
  }
  state.counters["Mrays/s"] =
      benchmark::Counter(static_cast<double>(rays) / 1e6, benchmark::Counter::kIsRate);
}

// Root mean square of the relative standard error over the bins above a tenth of the peak.
double rms_error(const FluxMapReceiver& map, const BinSums& direct) {
  std::vector<Estimate> bins;
  double peak = 0.0;
  for (size_t bin = 0; bin < map.grid().bins(); ++bin) {
    bins.push_back(direct.estimate(map.entry(bin, 0)));
    peak = std::max(peak, bins.back().value);
  }
  double squares = 0.0;
  int lit = 0;
  for (const Estimate& bin : bins) {
    if (bin.value < 0.1 * peak) continue;
    squares += bin.standard_error * bin.standard_error / (bin.value * bin.value);
    ++lit;
  }
  return std::sqrt(squares / lit);
}

// Map of direct light by gathering, from beams to errors of bins.
void gather(benchmark::State& state, const TraceableScene& scene, const FluxMapReceiver& map,
            const RigidTransform& lab_from_body, std::span<const Beam> beams) {
  GatherOptions options;
  options.threads = static_cast<int>(state.range(0));
  options.points = static_cast<int>(state.range(1));
  Gathered gathered;
  for (auto _ : state) gathered = gather_direct(scene, lab_from_body, beams, map, options);
  state.counters["rms_error_%"] = 100.0 * rms_error(map, gathered.direct);
  state.counters["shadow_rays"] = static_cast<double>(gathered.shadow_rays);
  state.counters["shaded_pairs"] = static_cast<double>(gathered.shaded_pairs);
}

void gather(benchmark::State& state, const Case& which) {
  const TraceableScene scene(which.scene, false);
  gather(state, scene, flux_map(which.scene), {}, which.beams);
}

// Shadow rays from points of 1 mm patches of the plate to points of a disc above, one batch per
// patch, as in gathering.
void shadow_rays(benchmark::State& state, const Case& which, double disc_radius_m) {
  const TraceableScene scene(which.scene, false);
  constexpr size_t patches = 2048, rays = shadow_batch;
  std::vector<ShadowRay> all;
  const double ray_offset_m = shadow_ray_offset_m(scene);
  for (size_t i = 0; i < patches * rays; ++i) {
    const auto golden = [](size_t n, double step) { return std::fmod(0.5 + step * n, 1.0); };
    const size_t patch = i / rays;
    const Vec3 from(0.498 * (golden(patch, 0.7548776662) - 0.5) + 1e-3 * golden(i, 0.8191725134),
                    0.498 * (golden(patch, 0.5698402910) - 0.5) + 1e-3 * golden(i, 0.6710436067),
                    ray_offset_m);
    const double radius_m = disc_radius_m * std::sqrt(golden(i, 0.5497004779));
    const double turn = 2.0 * pi * golden(i, 0.4503);
    const Vec3 to(radius_m * std::cos(turn), radius_m * std::sin(turn), 1.5);
    const double length_m = (to - from).norm();
    const Eigen::Vector3f along = ((to - from) / length_m).cast<float>();
    all.push_back(
        {{static_cast<float>(from.x()), static_cast<float>(from.y()), static_cast<float>(from.z())},
         {along.x(), along.y(), along.z()},
         static_cast<float>(length_m)});
  }
  const int threads = static_cast<int>(state.range(0));
  std::vector<uint8_t> lit(all.size());
  for (auto _ : state) {
    parallel_for(patches, threads, [&](size_t patch) {
      find_shadows(scene, std::span(all).subspan(patch * rays, rays),
                   std::span(lit).subspan(patch * rays, rays));
    });
  }
  state.counters["Mrays/s"] = benchmark::Counter(
      1e-6 * static_cast<double>(all.size() * state.iterations()), benchmark::Counter::kIsRate);
  state.counters["lit_%"] =
      100.0 * std::accumulate(lit.begin(), lit.end(), 0.0) / static_cast<double>(lit.size());
}

void stasis_30_deg_gather(benchmark::State& state) {
  const Experiment stasis = resolve_experiment(
      read_experiment_file(std::string(PHOTORQUE_SOURCE_DIR) + "/scenes/stasis/nominal.toml"));
  const TraceableScene scene(stasis.scene);
  for (const NamedReceiver& named : stasis.receivers) {
    if (!named.flux_map) continue;
    gather(state, scene, *named.flux_map, lab_from_body_at(30 * degree_rad, 0.0), stasis.beams);
    return;
  }
}

template <class Run>
benchmark::internal::Benchmark* add(const char* name, const Run& run) {
  return benchmark::RegisterBenchmark(name, run)->UseRealTime()->Unit(benchmark::kMillisecond);
}

void add_all() {
  using State = benchmark::State;
  // Arguments: threads, binary logarithm of the number of rays.
  add("one_mirror_sun", [](State& s) { sunlight(s, one_mirror()); })->Args({1, 18})->Args({1, 22});
  // Arguments: threads, points per replicate in bins that may be shaded.
  add("case_a_gather", [](State& s) { gather(s, case_a()); })->Args({1, 16})->Args({2, 16});
  add("case_b_gather", [](State& s) { gather(s, case_b()); })->Args({1, 1})->Args({2, 1});
  add("stasis_30_deg_gather", stasis_30_deg_gather)->Args({1, 16})->Args({2, 16});
  // Argument: threads.
  const auto add_by_threads = [](const char* name, const auto& run) {
    add(name, run)->Arg(1)->Arg(2);
  };
  add_by_threads("case_a_shadow_rays", [](State& s) { shadow_rays(s, case_a(), 0.2); });
  add_by_threads("case_b_shadow_rays", [](State& s) { shadow_rays(s, case_b(), 0.0225); });
  add_by_threads("case_a_forward", [](State& s) { forward(s, case_a()); });
  add_by_threads("case_a_bare_embree", [](State& s) { bare_embree(s, case_a()); });
  add_by_threads("case_b_forward", [](State& s) { forward(s, case_b()); });
  add_by_threads("case_b_bare_embree", [](State& s) { bare_embree(s, case_b()); });
}

}  // namespace
}  // namespace photorque

int main(int argc, char** argv) {
  photorque::add_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}

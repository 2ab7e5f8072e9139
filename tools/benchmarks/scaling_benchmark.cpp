// Computing time over the number of triangles and of emitters.
//
//   scaling_benchmark [largest number of triangles, 1e7]
//
// Measures user CPU time of the whole process, which depends little on other programs on the
// machine, with two threads.
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "receivers/gather/gather.h"
#include "tools/benchmarks/benchmark_scene.h"

namespace photorque {
namespace {

constexpr int threads = 2;
constexpr double field_m = 0.5;

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * usage.ru_utime.tv_usec;
}

template <typename Work>
double cpu_s_of(const Work& work) {
  const double before = cpu_s();
  work();
  return cpu_s() - before;
}

// `count` LEDs of 3 deg on a square grid over the field, looking down.
std::vector<Beam> lamps(int count) {
  const int across = static_cast<int>(std::ceil(std::sqrt(count)));
  std::vector<Beam> beams;
  for (int k = 0; k < count; ++k) {
    const Vec3 at(field_m * ((k % across + 0.5) / across - 0.5),
                  field_m * ((k / across + 0.5) / across - 0.5), 1.5);
    add_led(beams, at, 0.045 / across);
  }
  return beams;
}

// A corrugated sheet of `cells`² squares, partly mirroring and partly matt, so that rays bounce.
Scene corrugated(int cells) {
  Scene scene;
  scene.surfaces.push_back(grey_surface("foil", 0.4, 0.2));
  const auto wave_m = [](double x, double y) { return 0.02 * std::sin(40 * x) * std::cos(30 * y); };
  add_part(scene, sheet(field_m, cells, wave_m), "sheet");
  return scene;
}

// A flat receiver, and a grid of squares above it that shades it.
Scene shaded_plate() {
  Scene scene;
  scene.surfaces.push_back(grey_surface("black", 0, 0));
  const auto square = [](const Vec3& centre, double side_m) {
    const Vec3 u(0.5 * side_m, 0, 0), v(0, 0.5 * side_m, 0);
    return Mesh{{centre - u - v, centre + u - v, centre + u + v, centre - u + v},
                {{0, 1, 2}, {0, 2, 3}},
                {}};
  };
  add_part(scene, square(Vec3::Zero(), field_m), "receiver");
  for (int k = 0; k < 16; ++k) {
    add_part(scene, square(Vec3(0.12 * (k % 4) - 0.18, 0.12 * (k / 4) - 0.18, 0.1), 0.02), "shade");
  }
  return scene;
}

void over_triangles(double largest) {
  constexpr uint64_t rays = 1 << 21;
  const std::vector<Beam> beams = lamps(4);
  std::printf("triangles,build_s,trace_s,segments_per_ray\n");
  for (double wanted = 1e3; wanted <= 1.01 * largest; wanted *= 10.0) {
    Scene scene = corrugated(static_cast<int>(std::lround(std::sqrt(0.5 * wanted))));
    const size_t triangles = scene.meshes[0].triangles.size();
    std::optional<TraceableScene> traceable;
    const double build_s = cpu_s_of([&] { traceable.emplace(std::move(scene)); });
    TraceOptions options;
    options.rays = rays;
    options.threads = threads;
    TraceResult result;
    const double trace_s = cpu_s_of([&] { result = trace(*traceable, {}, beams, {}, options); });
    std::printf("%zu,%.4g,%.4g,%.3f\n", triangles, build_s, trace_s,
                static_cast<double>(result.segments) / static_cast<double>(result.rays));
    std::fflush(stdout);
  }
}

void over_emitters() {
  Scene scene = shaded_plate();
  const FluxMapReceiver map("receiver", scene,
                            make_surface_grid(scene, scene.instances_of("receiver"), {}));
  const TraceableScene traceable(std::move(scene));
  const Receiver* const receivers[] = {&map};
  std::printf("emitters,forward_16M_rays_s,forward_4096_rays_each_s,gather_s\n");
  for (const int count : {1, 10, 100, 1000, 10000}) {
    const std::vector<Beam> beams = lamps(count);
    TraceOptions options;
    options.threads = threads;
    options.rays = 1 << 24;
    uint64_t rays = 0;
    const double all_s =
        cpu_s_of([&] { rays = trace(traceable, {}, beams, receivers, options).rays; });
    const double same_rays_s =
        all_s * static_cast<double>(options.rays) / static_cast<double>(rays);
    options.rays = 4096 * static_cast<uint64_t>(count);
    const double rays_each_s = cpu_s_of([&] { trace(traceable, {}, beams, receivers, options); });
    GatherOptions gathering;
    gathering.threads = threads;
    gathering.points = 1;
    const double gather_s = cpu_s_of([&] { gather_direct(traceable, {}, beams, map, gathering); });
    std::printf("%d,%.4g,%.4g,%.4g\n", count, same_rays_s, rays_each_s, gather_s);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace photorque

int main(int count, char** arguments) {
  photorque::over_triangles(count > 1 ? std::atof(arguments[1]) : 1e7);
  photorque::over_emitters();
}

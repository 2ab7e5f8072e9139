// Laws of every scene: balances, independence of threads, one way for all surfaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "core/errors.h"
#include "raytrace/surfaces/bsdf.h"
#include "tests/raytrace/test_scenes.h"

namespace photorque {
namespace {

using fixtures::add;

// A bit of everything: mirrors, matt and translucent sheets, a box in between.
Scene busy_scene() {
  Scene scene;
  add(scene, fixtures::rectangle(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)),
      grey_surface("matt", 0.1, 0.6), "floor");
  add(scene, fixtures::rectangle(Vec3(0.5, 0, 0.5), Vec3(0, 1, 0), Vec3(0, 0, 1)),
      grey_surface("mirror", 0.9, 0.05), "wall");
  add(scene, fixtures::rectangle(Vec3(0, 0, 0.8), Vec3(0.6, 0, 0.1), Vec3(0, 0.6, 0)),
      grey_surface("film", 0.2, 0.1, 0.5), "film");
  add(scene, fixtures::box(Vec3(-0.2, -0.1, 0.2), Vec3(0.1, 0.2, 0.4)),
      grey_surface("paint", 0.0, 0.3), "box");
  return scene;
}

Beam wide_cone(double height_m) {
  const auto emitter = std::make_shared<fixtures::PillboxDisc>(2.5, 0.1, 20 * degree_rad);
  return fixtures::beam(emitter, Vec3(0.1, -0.2, height_m), Vec3(-0.05, 0.1, -1));
}

TEST(PowerBalance, ClosesForEveryReplicate) {
  const TraceableScene scene(busy_scene());
  const Beam beam = wide_cone(2.0);
  for (const int depth : {1, 2, 5, 64}) {
    const PowerBalance power_balance =
        trace(scene, {}, std::span(&beam, 1), {},
              {.rays = 1 << 17, .max_depth = depth, .cutoff = depth == 5 ? 1e-3 : 1e-9})
            .power_balance;
    EXPECT_LE(power_balance.closure, 1e-12);
    EXPECT_NEAR(power_balance.absorbed_W.value + power_balance.escaped_W.value +
                    power_balance.truncated_W.value,
                2.5, 1e-11);
    double by_instance = 0.0;
    for (const Estimate& part : power_balance.absorbed_by_instance_W) by_instance += part.value;
    EXPECT_NEAR(by_instance, power_balance.absorbed_W.value, 1e-12);
    if (depth == 1) {  // one interaction only: much is cut off
      EXPECT_GT(power_balance.truncated_W.value, 0.1);
    }
    if (depth == 64) {
      EXPECT_LT(power_balance.truncated_W.value, 1e-6);
    }
  }
}

TEST(PowerBalance, SurfacesAndRaysAgreeOnForceAndTorque) {
  const TraceableScene scene(busy_scene());
  const Beam beam = wide_cone(2.0);
  const fixtures::TotalWrench wrench;
  const Receiver* const receivers[] = {&wrench};
  const TraceResult result = trace(scene, {}, std::span(&beam, 1), receivers, {.rays = 1 << 20});
  for (size_t k = 0; k < 6; ++k) {
    const Estimate surfaces = result.sums[0].estimate(k);
    const Estimate rays =
        k < 3 ? result.power_balance.force_N[k] : result.power_balance.torque_N_m[k - 3];
    const double error = std::hypot(surfaces.standard_error, rays.standard_error);
    EXPECT_LT(std::abs(surfaces.value - rays.value), 4 * error) << k;
    EXPECT_LT(error, 1e-3 * 2.5 / speed_of_light_m_s);
  }
}

// Scores, and notes which threads did. The first ones wait until `wanted` have come: a test of
// threads that ran on one thread would prove nothing.
class ThreadCounter final : public Receiver {
 public:
  explicit ThreadCounter(size_t wanted) : wanted_(wanted) {}
  size_t bins() const override { return 1; }
  void score(const Hits& hits, std::span<double> sums) const override {
    for (int i = 0; i < hits.count; ++i) sums[0] += hits.incident_W[0][i] * hits.position_m[0][i];
    std::unique_lock lock(mutex_);
    threads_.insert(std::this_thread::get_id());
    arrived_.notify_all();
    const bool all = arrived_.wait_for(lock, std::chrono::seconds(missing_ ? 0 : 30),
                                       [this] { return threads_.size() >= wanted_; });
    missing_ = missing_ || !all;
  }
  Product product(const BinSums&) const override { return {}; }
  size_t count() const { return threads_.size(); }

 private:
  size_t wanted_;
  mutable std::mutex mutex_;
  mutable std::condition_variable arrived_;
  mutable std::set<std::thread::id> threads_;
  mutable bool missing_ = false;  // waited without success
};

TEST(Threads, SameBitsAtOneTwoAndSeven) {
  const TraceableScene scene(busy_scene());
  const std::vector<Beam> beams = {wide_cone(2.0), wide_cone(1.5)};
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 7, 7}) {
    const fixtures::TotalWrench wrench;
    const ThreadCounter counter(static_cast<size_t>(threads));
    const Receiver* const receivers[] = {&wrench, &counter};
    const TraceResult result = trace(scene, lab_from_body_at(0.3, 0.2), beams, receivers,
                                     {.rays = 1 << 20, .threads = threads});
    std::vector<double> all = result.sums[0].sums;
    all.insert(all.end(), result.sums[1].sums.begin(), result.sums[1].sums.end());
    all.push_back(result.power_balance.escaped_W.value);
    results.push_back(all);
    EXPECT_EQ(counter.count(), static_cast<size_t>(threads));
  }
  for (size_t i = 1; i < results.size(); ++i) EXPECT_EQ(results[i], results[0]);
}

// A plain surface and one with a BSDF that adds nothing take the same way, bit for bit.
TEST(Interaction, ABsdfThatAddsNothingChangesNoBit) {
  const auto traced = [](Scene scene) {
    const TraceableScene traceable(std::move(scene));
    const Beam beam = wide_cone(2.0);
    const fixtures::TotalWrench wrench;
    const Receiver* const receivers[] = {&wrench};
    const TraceResult result =
        trace(traceable, {}, std::span(&beam, 1), receivers, {.rays = 1 << 16});
    std::vector<double> all = result.sums[0].sums;
    all.push_back(result.power_balance.absorbed_W.value);
    all.push_back(result.power_balance.escaped_W.value);
    for (const Estimate& torque : result.power_balance.torque_N_m) all.push_back(torque.value);
    return all;
  };
  Scene scene = busy_scene();
  const std::vector<double> plain = traced(scene);
  const auto nothing = std::make_shared<const Bsdf>();
  for (OpticalSurface& surface : scene.surfaces) surface.bsdf = nothing;
  EXPECT_EQ(traced(scene), plain);
  // Something changes them: heat that leaves the front alone.
  Bsdf heat;
  heat.reemitted = 0.5;
  heat.front_emission = 1.0;
  for (OpticalSurface& surface : scene.surfaces) {
    surface.bsdf = std::make_shared<const Bsdf>(heat);
  }
  EXPECT_NE(traced(scene), plain);
}

TEST(Seed, ChangesTheBitsAndNotTheMeaning) {
  const TraceableScene scene(busy_scene());
  const Beam beam = wide_cone(2.0);
  TraceOptions options{.rays = 1 << 17};
  const Estimate a = trace(scene, {}, std::span(&beam, 1), {}, options).power_balance.absorbed_W;
  options.seed = 2;
  const Estimate b = trace(scene, {}, std::span(&beam, 1), {}, options).power_balance.absorbed_W;
  EXPECT_NE(a.value, b.value);
  EXPECT_LT(std::abs(a.value - b.value), 4 * std::hypot(a.standard_error, b.standard_error));
}

TEST(LowDiscrepancy, BeatsPseudoRandomErrorTenfold) {
  // A plate that catches a fraction p of the beam: pseudo-random counting would err by
  // sqrt(p (1 − p)/n).
  Scene plate;
  add(plate, fixtures::rectangle(Vec3(0.123, 0, 0), Vec3(0.5, 0.1, 0), Vec3(-0.07, 0.6, 0)),
      grey_surface("black", 0, 0), "plate");
  const TraceableScene scene(std::move(plate));
  const Beam beam = fixtures::beam(std::make_shared<fixtures::ParallelBeam>(1.0, 1.0),
                                   Vec3(0, 0, 3), Vec3(0, 0, -1));
  const TraceResult result = trace(scene, {}, std::span(&beam, 1), {}, {.rays = 1 << 20});
  const double p = 0.307;
  EXPECT_LT(result.power_balance.absorbed_W.standard_error,
            0.1 * std::sqrt(p * (1 - p) / static_cast<double>(result.rays)));
}

TEST(Bands, EachBandSeesItsOwnSurfaceAndTheSumIsConserved) {
  Scene scene;
  scene.bands.edges_m = {400e-9, 600e-9, 800e-9};
  OpticalSurface filter;  // reflects the short band, absorbs the long one
  filter.specular = {0.75, 0.0};
  filter.absorbed = {0.25, 1.0};
  add(scene, fixtures::rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), filter, "filter");
  const TraceableScene traceable(std::move(scene));
  Beam beam = fixtures::beam(std::make_shared<fixtures::ParallelBeam>(3.0, 1.0), Vec3(0, 0, 3),
                             Vec3(0, 0, -1));
  beam.spectrum = {Spectrum::Shape::gaussian, 600e-9, 20e-9, 0.0};  // half of it in each band
  const PowerBalance power_balance =
      trace(traceable, {}, std::span(&beam, 1), {}, {.rays = 1 << 14}).power_balance;
  EXPECT_NEAR(power_balance.absorbed_W.value, 1.5 * 0.25 + 1.5, 1e-12);
  EXPECT_NEAR(power_balance.escaped_W.value, 1.5 * 0.75, 1e-12);
  EXPECT_LE(power_balance.closure, 1e-12);
}

TEST(Transmission, GoesStraightOnThroughBothSides) {
  Scene scene;
  add(scene, fixtures::rectangle(Vec3(0, 0, 1), Vec3(2, 0, 0), Vec3(0, 2, 0)),
      grey_surface("half", 0, 0, 0.5), "upper");
  add(scene, fixtures::rectangle(Vec3(0, 0, 0.5), Vec3(2, 0, 0), Vec3(0, -2, 0)),
      grey_surface("half", 0, 0, 0.5), "flipped");
  const uint32_t floor = add(scene, fixtures::rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)),
                             grey_surface("black", 0, 0), "floor");
  const TraceableScene traceable(std::move(scene));
  const Beam beam = fixtures::beam(std::make_shared<fixtures::ParallelBeam>(1.0, 1.0),
                                   Vec3(0, 0, 3), Vec3(0, 0, -1));
  const PowerBalance power_balance =
      trace(traceable, {}, std::span(&beam, 1), {}, {.rays = 1 << 14}).power_balance;
  EXPECT_NEAR(power_balance.absorbed_by_instance_W[floor].value, 0.25, 1e-12);
}

// A source at 1e9 m must hit what it is aimed at: it is brought near in double precision.
TEST(FarSource, KeepsItsAim) {
  const TraceableScene traceable(
      fixtures::scene_of_part(fixtures::rectangle(Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0)),
                              grey_surface("black", 0, 0), "plate"));
  const Vec3 d = Vec3(1, 2, -3).normalized();
  const Beam beam = fixtures::beam(std::make_shared<fixtures::ParallelBeam>(1.0, 0.1), -1e9 * d, d);
  const fixtures::TotalWrench wrench;
  const Receiver* const receivers[] = {&wrench};
  const TraceResult result =
      trace(traceable, {}, std::span(&beam, 1), receivers, {.rays = 1 << 16});
  EXPECT_NEAR(result.power_balance.absorbed_W.value, 1.0, 1e-12);
  // Centred on the origin: no torque, to what a double resolves at 1e9 m (1e-7 m).
  for (size_t k = 3; k < 6; ++k) {
    EXPECT_LT(std::abs(result.sums[0].estimate(k).value) * speed_of_light_m_s, 5e-7);
  }
}

TEST(MirroredInstance, KeepsItsFrontOutside) {
  Scene scene;
  const uint32_t id = add(scene, fixtures::box(Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.5, 0.5)),
                          grey_surface("black", 0, 0), "box");
  scene.instances[id].body_from_mesh = Affine(Eigen::Scaling(-1.0, 2.0, 1.0));
  scene.surfaces.push_back(grey_surface("mirror", 1, 0));
  scene.instances[id].back_surface = 1;  // would show
  const TraceableScene traceable(std::move(scene));
  const Beam beam = fixtures::beam(std::make_shared<fixtures::ParallelBeam>(1.0, 0.4),
                                   Vec3(0, 0, 3), Vec3(0, 0, -1));
  EXPECT_NEAR(trace(traceable, {}, std::span(&beam, 1), {}, {.rays = 1 << 14})
                  .power_balance.absorbed_W.value,
              1.0, 1e-12);
}

TEST(Options, OutOfRangeAreRefusedInOneLine) {
  const TraceableScene scene(busy_scene());
  const Beam beam = wide_cone(2.0);
  TraceOptions few;
  few.replicates = 4;
  EXPECT_THROW(trace(scene, {}, std::span(&beam, 1), {}, few), InputError);
  EXPECT_THROW(trace(scene, {}, {}, {}, {}), InputError);
  Scene broken = busy_scene();
  broken.instances[0].mesh = 99;
  EXPECT_THROW(TraceableScene{broken}, InputError);
}

}  // namespace
}  // namespace photorque

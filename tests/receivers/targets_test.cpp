// Sunlight that is sent only where it can meet the scene gives what sunlight on the whole disc
// gives.
#include <gtest/gtest.h>

#include "raytrace/emitter.h"
#include "raytrace/tracing/targets.h"
#include "receivers/flux_map.h"
#include "tests/receivers/gather_lamps.h"

namespace photorque {
namespace {

// A Sun that the tracer does not know as parallel light.
class WholeDisc final : public Emitter {
 public:
  explicit WholeDisc(std::shared_ptr<const Emitter> sun) : sun_(std::move(sun)) {}
  double power_W() const override { return sun_->power_W(); }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    sun_->emit(samples, rays);
  }
  double relative_intensity(double angle_rad) const override {
    return sun_->relative_intensity(angle_rad);
  }

 private:
  std::shared_ptr<const Emitter> sun_;
};

struct Found {
  std::vector<Estimate> absorbed_W;  // by instance
  std::array<Estimate, 3> force_N;
  Estimate escaped_W, map_W;
  double emitted_W = 0.0, closure = 0.0;
  double useful = 0.0;  // fraction of the rays that meet the scene
};

Found trace_sun(const Scene& scene, const Beam& sun, const RigidTransform& lab_from_body,
                uint64_t rays) {
  const FluxMapReceiver map("receiver", scene,
                            make_surface_grid(scene, scene.instances_of("receiver"), {}));
  const TraceableScene traceable(scene);
  const Receiver* const receivers[] = {&map};
  TraceOptions options{.rays = rays};
  std::atomic<uint64_t> first_hits = 0;
  options.observe = [&](const HitOrigin&, const Hits& hits) {
    if (hits.depth == 0) first_hits += static_cast<uint64_t>(hits.count);
  };
  const TraceResult result =
      trace(traceable, lab_from_body, std::span(&sun, 1), receivers, options);
  const PowerBalance& balance = result.power_balance;
  return {balance.absorbed_by_instance_W,
          balance.force_N,
          balance.escaped_W,
          map.flux_map(result.sums[0]).incident.power_W,
          balance.emitted_W,
          balance.closure,
          static_cast<double>(first_hits) / static_cast<double>(result.rays)};
}

// A mirror, a tilted plate and a small ball far from each other.
Scene spread_out() {
  Scene scene;
  fixtures::add(scene, fixtures::rectangle(Vec3(3, 1, -2), Vec3(0.3, 0, 0), Vec3(0, 0.2, 0.1)),
                grey_surface("mirror", 0.9, 0.0), "mirror");
  fixtures::add(scene, fixtures::rectangle(Vec3(-2, 2, 3), Vec3(0.4, 0, 0.3), Vec3(0, 0.5, 0)),
                grey_surface("grey", 0.2, 0.3), "receiver");
  Mesh ball = fixtures::sphere(0.2, 24);
  for (Vec3& at_m : ball.vertices_m) at_m += Vec3(-1, -4, 0);
  fixtures::add(scene, std::move(ball), grey_surface("matt", 0.0, 0.8), "ball");
  return scene;
}

void expect_same(const Estimate& a, const Estimate& b, double scale, const std::string& what) {
  EXPECT_NEAR(a.value, b.value, 4 * std::hypot(a.standard_error, b.standard_error) + 1e-9 * scale)
      << what;
}

TEST(Targets, GiveTheTotalsOfTheWholeDisc) {
  const Scene scene = spread_out();
  const double radius_m = scene.radius_m();
  const RigidTransform turned{Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized())),
                              Vec3::Zero()};
  const std::pair<const char*, SettingsNode::Table> suns[] = {
      {"parallel", {{"angular_radius_deg", {0.0}}}},
      {"disc", {{"angular_radius_deg", {0.27}}}},
      {"wide", {{"angular_radius_deg", {12.0}}}},
      {"gaussian", {{"sun_shape", {"gaussian"}}, {"sun_shape_sigma_mrad", {20.0}}}},
      {"buie", {{"sun_shape", {"buie"}}, {"circumsolar_ratio", {0.3}}}}};
  for (const auto& [name, keys] : suns) {
    const Beam sun = fixtures::source("sun", keys, Vec3::Zero(), Vec3(0.3, -0.2, -1), radius_m);
    Beam whole = sun;
    whole.emitter = std::make_shared<WholeDisc>(sun.emitter);
    const Found sent = trace_sun(scene, sun, turned, 1 << 18);
    const Found all = trace_sun(scene, whole, turned, 1 << 22);
    EXPECT_GT(sent.useful, 5 * all.useful) << name;
    EXPECT_EQ(sent.emitted_W, all.emitted_W) << name;
    EXPECT_LE(sent.closure, 1e-12) << name;
    for (size_t i = 0; i < sent.absorbed_W.size(); ++i) {
      expect_same(sent.absorbed_W[i], all.absorbed_W[i], sent.emitted_W,
                  name + std::string(" part ") + std::to_string(i));
    }
    expect_same(sent.escaped_W, all.escaped_W, sent.emitted_W, name);
    expect_same(sent.map_W, all.map_W, sent.emitted_W, name);
    for (size_t k = 0; k < 3; ++k) {
      expect_same(sent.force_N[k], all.force_N[k], sent.emitted_W / speed_of_light_m_s, name);
    }
  }
}

// A plate of 0.5 m² normal to parallel light takes up E A, whatever else is in the scene, and the
// stated errors hold it: 24 seeds, at most one in a thousand beyond 3.5 of 15 degrees of freedom.
TEST(Targets, ErrorsHoldTheClosedForm) {
  Scene scene;
  const auto black = grey_surface("black", 0, 0);
  fixtures::add(scene, fixtures::rectangle(Vec3(10, 0, 0), Vec3(1, 0, 0), Vec3(0, 0.5, 0)), black,
                "receiver");
  fixtures::add(scene, fixtures::rectangle(Vec3(-30, 20, 5), Vec3(1, 0, 0), Vec3(0, 1, 0)), black,
                "other");
  const Beam sun =
      fixtures::source("sun", {{"angular_radius_deg", {0.5}}, {"irradiance_W_m2", {1000.0}}},
                       Vec3::Zero(), Vec3(0, 0, -1), scene.radius_m());
  const TraceableScene traceable(scene);
  double squares = 0.0;
  constexpr int seeds = 24;
  for (int seed = 1; seed <= seeds; ++seed) {
    const TraceResult result = trace(traceable, {}, std::span(&sun, 1), {},
                                     {.rays = 1 << 16, .seed = static_cast<uint64_t>(seed)});
    const Estimate absorbed = result.power_balance.absorbed_by_instance_W[0];
    EXPECT_NEAR(absorbed.value, 500.0, 4.5 * absorbed.standard_error) << seed;
    EXPECT_LT(absorbed.standard_error, 1.0);
    squares += std::pow((absorbed.value - 500.0) / absorbed.standard_error, 2) / seeds;
  }
  EXPECT_LT(squares, 2.5);  // of t with 15 degrees of freedom: 15/13 on the mean
  EXPECT_GT(squares, 0.3);
}

// A body that fills the disc, and light that is not known to be parallel.
TEST(Targets, AreNoneWhereNothingIsSaved) {
  Scene scene;
  fixtures::add(scene, fixtures::sphere(1.0, 48), grey_surface("black", 0, 0), "ball");
  const Beam sun = fixtures::source("sun", {}, Vec3::Zero(), Vec3(0, 0, -1), scene.radius_m());
  const TraceableScene traceable(scene);
  const auto targets = Targets::of(*sun.emitter, sun.lab_from_emitter, traceable.data(), 1 << 20);
  EXPECT_FALSE(targets);
  EXPECT_FALSE(
      Targets::of(WholeDisc(sun.emitter), sun.lab_from_emitter, traceable.data(), 1 << 20));
}

}  // namespace
}  // namespace photorque

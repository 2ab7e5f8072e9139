// Torque of direct light gathered from the surface's side.
#include "receivers/gather/gather.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "tests/receivers/random_lamps.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::rectangle;

TorqueMapReceiver torque_map_of(const Scene& scene, int bins, const Vec3& about_m) {
  SurfaceGridOptions options;
  options.side = Side::both;
  options.width = options.height = bins;
  return {"receiver", scene, make_surface_grid(scene, scene.instances_of("receiver"), options),
          about_m};
}

Vec3 total_of(const TorqueMap& map) {
  return {map.total_N_m[0].value, map.total_N_m[1].value, map.total_N_m[2].value};
}

// As if nothing bounced.
TorqueMap direct_of(const TorqueMapReceiver& map, Gathered gathered) {
  BinSums sums = std::move(gathered.direct);
  std::vector<double> padded;
  for (int r = 0; r < sums.replicates; ++r) {
    const auto direct = sums.of(r);
    padded.insert(padded.end(), direct.begin(), direct.end());
    padded.resize(map.bins() * static_cast<size_t>(r + 1), 0.0);
  }
  sums.bins = map.bins();
  sums.sums = std::move(padded);
  sums.bound.resize(map.bins(), 0.0);
  return map.torque_map(sums);
}

// F = P A cos θ [(1 − ρs) d − 2 (ρs cos θ + ρd/3) n] on a flat plate whose normal n looks against
// the light's travel d.
// Source: J. R. Wertz (ed.), Spacecraft Attitude Determination and Control (1978), eq. 17-37.
TEST(GatherTorque, SunOnEitherSideOfAGreyPlateIsTheTextbooksForce) {
  for (const double tilt_deg : {0.0, 35.0, 70.0, 110.0, 160.0}) {
    Scene scene;
    const Vec3 centre_m(0.3, -0.2, 0.1);
    add(scene, rectangle(centre_m, Vec3(1.0, 0, 0), Vec3(0, 0.5, 0)), grey_surface("s", 0.3, 0.25),
        "receiver");
    const TraceableScene traceable(scene);
    const Vec3 about_m(0.05, 0.4, -0.3);
    const TorqueMapReceiver map = torque_map_of(scene, 12, about_m);
    const Beam sun =
        fixtures::source("sun", {{"irradiance_W_m2", {1361.0}}, {"angular_radius_deg", {0.0}}});
    const RigidTransform attitude = lab_from_body_at(tilt_deg * degree_rad, 0.6);
    const TorqueMap found =
        direct_of(map, gather_torque(traceable, attitude, std::span(&sun, 1), map, {}));
    const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
    const Vec3 normal = travel.z() < 0.0 ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
    const double cosine = -travel.dot(normal);
    const Vec3 force_N = 1361.0 / speed_of_light_m_s * 0.5 * cosine *
                         (0.7 * travel - 2.0 * (0.3 * cosine + 0.25 / 3.0) * normal);
    const Vec3 expected = (centre_m - about_m).cross(force_N);
    EXPECT_LT((total_of(found) - expected).norm(), 1e-9 * expected.norm()) << tilt_deg;
  }
}

// A black plate that all light falls on takes up the momentum of the beam, which is that of its
// axis times the mean cosine, wherever its bins cut the beam's edge.
TEST(GatherTorque, ABlackPlateTakesUpTheMomentumOfTheWholeBeam) {
  fixtures::RandomLamps random_lamps(18);
  int done = 0, precise = 0;
  for (int i = 0; i < 40; ++i) {
    const fixtures::Draw d = random_lamps.draw();
    const auto scene = fixtures::wide_plate(d, 1.0);
    if (!scene) continue;
    const TraceableScene traceable(*scene);
    const Vec3 about_m = d.centre_m + d.height_m * Vec3(0.5, -0.2, 0.1);
    const TorqueMapReceiver map = torque_map_of(*scene, random_lamps.integer(2, 12), about_m);
    const Gathered gathered = gather_torque(traceable, {}, std::span(&d.beam, 1), map,
                                            {.replicates = 2, .points = 1, .threads = 1});
    EXPECT_EQ(gathered.shaded_pairs, 0u);
    const TorqueMap found = direct_of(map, gathered);
    const DiscLight light(*d.beam.emitter, *d.beam.aperture);
    const Vec3 momentum_N = light.angles().mean_cosine() / speed_of_light_m_s * Vec3::UnitZ();
    const Vec3 expected = -about_m.cross(momentum_N);
    const double stated_N_m = found.total_N_m[0].standard_error;
    EXPECT_LT((total_of(found) - expected).norm(), 1e-6 * expected.norm() + stated_N_m)
        << i << ": " << d.description;
    precise += stated_N_m < 1e-4 * expected.norm() ? 1 : 0;
    ++done;
  }
  EXPECT_GT(done, 25);
  EXPECT_GE(precise, done - 3);  // not where a beam far narrower than its bin is hard to find
}

// Rays are another route, also where something shades and the surface mirrors and scatters.
TEST(GatherTorque, AgreesWithRaysBinByBin) {
  const TraceableScene scene(fixtures::shaded_square());
  const TorqueMapReceiver map = torque_map_of(scene.scene(), 20, {0.1, 0.0, -0.2});
  const std::vector<Beam> beams = {fixtures::pillbox_disc("angle"),
                                   fixtures::gaussian_led(0.05, 9.0, {0.3, 0, 1.4}, {-0.2, 0, -1})};
  const RigidTransform attitude = lab_from_body_at(10 * degree_rad, 0.4);
  const Gathered gathered = gather_torque(scene, attitude, beams, map, {});
  const Receiver* const receivers[] = {&map};
  const TraceResult traced = trace(scene, attitude, beams, receivers, {.rays = 1 << 22});
  EXPECT_GT(gathered.shaded_pairs, 20u);
  double squares = 0.0;
  int compared = 0;
  for (size_t entry = 0; entry < map.direct_entries(); ++entry) {
    const Estimate rays = traced.sums[0].estimate(entry), own = gathered.direct.estimate(entry);
    if (!(rays.standard_error < 0.1 * std::abs(rays.value))) continue;
    squares += std::pow(rays.value - own.value, 2) /
               (std::pow(rays.standard_error, 2) + std::pow(own.standard_error, 2));
    ++compared;
  }
  EXPECT_GT(compared, 300);
  EXPECT_NEAR(squares / compared, 1.15, 0.3);
}

}  // namespace
}  // namespace photorque

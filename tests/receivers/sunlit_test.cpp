// Force and torque of sunlight with all that bounces, by quadrature over lit pieces.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <regex>
#include <sstream>

#include "core/constants.h"
#include "receivers/gather/bodies/sunlit_body.h"
#include "receivers/wrench/wrench.h"
#include "tests/outside.h"
#include "tests/receivers/gather_lamps.h"
#include "tests/receivers/receiver_scenes.h"
#include "tests/receivers/sunlight.h"

namespace photorque {
namespace {

using fixtures::add;
using fixtures::irradiance_W_m2;
using fixtures::pressure_Pa;
using fixtures::rectangle;
using fixtures::sun;
using fixtures::textbook_N;

SunlitWrench sunlit(const TraceableScene& scene, const RigidTransform& attitude) {
  const Beam beam = sun(0.0);
  SunlitEffort effort;
  effort.scattered.rays = 1 << 20;
  const auto body = SunlitBody::make(scene, std::span(&beam, 1), Vec3::Zero(), effort);
  return body->wrench(attitude, 1e-6 * pressure_Pa);
}

void expect_near(const WrenchSum& found, const Vec3& force_N, const Vec3& torque_N_m,
                 double relative) {
  EXPECT_LT((found.head<3>().matrix() - force_N).norm(), relative * force_N.norm());
  constexpr double lever_m = 1.0;
  EXPECT_LT((found.tail<3>().matrix() - torque_N_m).norm(), relative * lever_m * force_N.norm());
}

// Shadows are cut out along their edges: exact, where rays would leave 2e-4.
TEST(Sunlit, AShadowTakesItsRectangleOutOfThePlateBelow) {
  Scene scene;
  add(scene, rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), grey_surface("s", 0.2, 0.3),
      "below");
  // Its underside and the plate exchange no light: both throw it where nothing is.
  add(scene, rectangle(Vec3(0.1, 0.2, 0.5), Vec3(0.6, 0, 0), Vec3(0, 0.4, 0)),
      grey_surface("b", 0.0, 0.0), "above");
  const TraceableScene traceable(scene);
  for (const double tilt_deg : {5.0, 25.0, 40.0}) {
    const RigidTransform attitude = lab_from_body_at(tilt_deg * degree_rad, 0.5);
    const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
    const Vec3 shadow_m = Vec3(0.1, 0.2, 0.5) + 0.5 / -travel.z() * travel;
    const Vec3 per_area_N = textbook_N(1.0, 0.2, 0.3, travel, Vec3::UnitZ());
    const Vec3 black_N = textbook_N(0.24, 0.0, 0.0, travel, Vec3::UnitZ());
    const WrenchSum found = sunlit(traceable, attitude).direct;
    expect_near(found, (4.0 - 0.24) * per_area_N + black_N,
                -0.24 * shadow_m.cross(per_area_N) + Vec3(0.1, 0.2, 0.5).cross(black_N), 1e-9);
  }
}

// A wall that cuts through a plate shades a strip beside the line where they meet, whether or not a
// row of its corners lies in the plate.
TEST(Sunlit, AWallThroughAPlateShadesAStripBesideIt) {
  for (const std::vector<double>& rows_m :
       {std::vector<double>{-0.4, 0.4}, std::vector<double>{-0.4, 0.0, 0.4}}) {
    Scene scene;
    add(scene, rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), grey_surface("b", 0.0, 0.0),
        "plate");
    Mesh wall;
    for (const double z : rows_m) {
      wall.vertices_m.emplace_back(0.0, -0.5, z);
      wall.vertices_m.emplace_back(0.0, 0.5, z);
    }
    for (uint32_t i = 0; i + 1 < rows_m.size(); ++i) {
      wall.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
      wall.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
    }
    add(scene, std::move(wall), grey_surface("b", 0.0, 0.0), "wall");
    const TraceableScene traceable(scene);
    const RigidTransform attitude = lab_from_body_at(35.0 * degree_rad, 0.0);
    const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
    ASSERT_NEAR(travel.y(), 0.0, 1e-12);
    // Only the part of the wall above the plate is lit. It shades a strip below, which is further
    // along the same rays.
    const Vec3 all_N = pressure_Pa * -travel.z() * 4.0 * travel;
    expect_near(sunlit(traceable, attitude).direct, all_N, Vec3::Zero(), 1e-9);
  }
}

// Torques that cancel by symmetry are no reason to look ever closer.
TEST(Sunlit, ABodyWithoutTorqueIsDoneAsFast) {
  Scene scene;
  add(scene, rectangle(Vec3(0, 0, 0.3), Vec3(1, 0, 0), Vec3(0, 1, 0)),
      grey_surface("m", 0.6, 0.0, 0.3), "one");
  add(scene, rectangle(Vec3(0, 0, -0.3), Vec3(1, 0, 0), Vec3(0, 1, 0)),
      grey_surface("m", 0.6, 0.0, 0.3), "other");
  const TraceableScene traceable(scene);
  const Beam beam = sun(0.0);
  const auto body = SunlitBody::make(traceable, std::span(&beam, 1), Vec3::Zero());
  const SunlitWrench found = body->wrench(lab_from_body_at(0.3, 0.2), 0.0);
  EXPECT_LT(found.rays, 30'000'000u);
}

// A mirror under 45 deg throws the beam onto a black wall: momentum arrives once, turned aside.
TEST(Sunlit, AMirrorThrowsTheBeamOntoAWall) {
  Scene scene;
  const double half_m = 0.2;
  add(scene, rectangle(Vec3::Zero(), Vec3(2 * half_m, 0, 2 * half_m), Vec3(0, 2 * half_m, 0)),
      grey_surface("m", 1.0, 0.0), "mirror");
  // Taller than the beam and out of the light that comes from above.
  add(scene, rectangle(Vec3(-0.7, 0, 0), Vec3(0, 0, 1.2), Vec3(0, 1.0, 0)),
      grey_surface("b", 0.0, 0.0), "wall");
  const TraceableScene traceable(scene);
  const SunlitWrench found = sunlit(traceable, {});
  const double beam_N = pressure_Pa * 4.0 * half_m * half_m;
  // The mirror looks towards (−1, 0, 1): light from above goes on along −x.
  const Vec3 mirror_N = beam_N * (-Vec3::UnitZ() + Vec3::UnitX());
  EXPECT_LT((found.direct.head<3>().matrix() - mirror_N).norm(), 1e-9 * beam_N);
  const Vec3 all_N = -beam_N * Vec3::UnitZ();
  EXPECT_LT((found.total().head<3>().matrix() - all_N).norm(), 1e-6 * beam_N);
  // The beam meets the wall at the height that it left the mirror at, 0 on the mean.
  EXPECT_LT(found.total().tail<3>().matrix().norm(), 1e-5 * beam_N * half_m);
}

// A small white square scatters by Lambert's law; a black disc above it, radius R at height h,
// takes up ⅔ (1 − cos³ α) of its power over c along the normal, tan α = R/h.
TEST(Sunlit, ADiscTakesUpItsShareOfScatteredLight) {
  Scene scene;
  const double side_m = 0.002, height_m = 0.3, radius_m = 0.25;
  add(scene, rectangle(Vec3::Zero(), Vec3(side_m, 0, 0), Vec3(0, side_m, 0)),
      grey_surface("w", 0.0, 1.0), "white");
  Mesh disc = fixtures::polygon(256);
  for (Vec3& vertex : disc.vertices_m) {
    vertex = Vec3(radius_m * vertex.x(), radius_m * vertex.y(), height_m);
  }
  add(scene, std::move(disc), grey_surface("b", 0.0, 0.0), "disc");
  const TraceableScene traceable(scene);
  // From so far to the side that the disc does not shade the square.
  const double tilt_rad = 60.0 * degree_rad;
  const SunlitWrench found = sunlit(traceable, lab_from_body_at(tilt_rad, 0.3));
  const double momentum_N = pressure_Pa * side_m * side_m * std::cos(tilt_rad);
  const double alpha = std::atan(radius_m / height_m);
  const double expected_N = 2.0 / 3.0 * (1.0 - std::pow(std::cos(alpha), 3)) * momentum_N;
  const double one_N = found.bounced[2], other_N = found.bounced[8];
  // 16384 rays from each of its two triangles for each half; of one, 0.41 ± 0.36 stays.
  EXPECT_NEAR(0.5 * (one_N + other_N), expected_N, 4.0 * 0.36 / std::sqrt(65536.0) * momentum_N);
  EXPECT_NE(one_N, other_N);
}

// Light passes a thin sheet and is stopped by the plate below it.
TEST(Sunlit, AThinSheetPassesItsShareOn) {
  Scene scene;
  add(scene, rectangle(Vec3(0, 0, 0.4), Vec3(0.5, 0, 0), Vec3(0, 0.5, 0)),
      grey_surface("sheet", 0.0, 0.0, 0.6), "sheet");
  add(scene, rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), grey_surface("b", 0.0, 0.0),
      "plate");
  const TraceableScene traceable(scene);
  const RigidTransform attitude = lab_from_body_at(0.4, 1.1);
  const Vec3 travel = attitude.inverse().direction(-Vec3::UnitZ());
  const Vec3 per_area_N = pressure_Pa * -travel.z() * travel;
  const Vec3 sheet_m(0, 0, 0.4), shadow_m = sheet_m + 0.4 / -travel.z() * travel;
  const Vec3 missing_N = 0.25 * 0.4 * per_area_N;
  expect_near(sunlit(traceable, attitude).total(), 4.0 * per_area_N,
              sheet_m.cross(missing_N) - shadow_m.cross(missing_N), 1e-6);
}

// A scene of boxes and sheets of all kinds of plain surfaces, in each other's way.
Scene drawn_scene(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto surface = [&] {
    const double specular = uniform(0.0, 0.5), diffuse = uniform(0.0, 0.5);
    return grey_surface("s", specular, diffuse);
  };
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    const Vec3 half_m{uniform(0.1, 0.4), uniform(0.1, 0.4), uniform(0.02, 0.4)};
    const Vec3 centre_m{uniform(-0.6, 0.6), uniform(-0.6, 0.6), uniform(-0.6, 0.6)};
    Mesh box = fixtures::box(-half_m, half_m);
    const Quat turned = Quat{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const Mat3 rotation = turned.normalized().toRotationMatrix();
    for (Vec3& vertex : box.vertices_m) vertex = centre_m + rotation * vertex;
    box.encloses = true;
    add(scene, std::move(box), surface(), "box" + std::to_string(i));
  }
  for (int i = 0; i < 3; ++i) {
    const auto side = [&] { return Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; };
    const Vec3 along = side();
    const Vec3 across = along.cross(side());
    add(scene, rectangle(0.7 * side(), along, across), surface(), "sheet" + std::to_string(i));
  }
  // The test's sun lights a ball of 1 m.
  const double shrink = 0.99 / scene.radius_m();
  for (Mesh& mesh : scene.meshes) {
    for (Vec3& vertex : mesh.vertices_m) vertex *= shrink;
  }
  return scene;
}

// The mean square, over directions, of the differences of direct and bounced wrenches from rays in
// their standard errors.
Eigen::Array2d against_rays(const TraceableScene& known, const TraceableScene& traced,
                            std::mt19937& random, int directions) {
  std::vector<uint32_t> all(known.scene().instances.size());
  for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const WrenchReceiver receiver("body", known.scene(), all);
  const Receiver* const receivers[] = {&receiver};
  const Beam beam = sun(0.2665);
  SunlitEffort effort;
  effort.scattered.rays = 1 << 20;
  const auto body = SunlitBody::make(known, std::span(&beam, 1), Vec3::Zero(), effort);
  const auto uniform = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  for (int i = 0; i < directions; ++i) {
    const RigidTransform attitude{Quat{uniform(), uniform(), uniform(), uniform()}.normalized(),
                                  Vec3::Zero()};
    const TraceResult result = trace(traced, attitude, std::span(&beam, 1), receivers,
                                     {.rays = 1 << 18, .replicates = 64});
    const SunlitWrench own = body->wrench(attitude, 1e-9);
    const WrenchSum bounced = 0.5 * (own.bounced.head<6>() + own.bounced.tail<6>());
    const WrenchSum scattered = 0.5 * (own.bounced.head<6>() - own.bounced.tail<6>());
    const auto add = [&](const WrenchEstimate& rays, const WrenchSum& found, bool is_bounced) {
      for (Eigen::Index k = 0; k < 6; ++k) {
        const double value = k < 3 ? rays.mean.force_N[k] : rays.mean.torque_N_m[k - 3];
        const double own_square = is_bounced ? std::pow(scattered[k], 2) : 0.0;
        squares[is_bounced ? 1 : 0] += std::pow(found[k] - value, 2) /
                                       (rays.covariance(k, k) + own_square) / (6.0 * directions);
      }
    };
    add(receiver.direct(result.sums[0]), own.direct, false);
    BinSums later = result.sums[0];
    for (int r = 0; r < later.replicates; ++r) {
      const auto first = later.sums.begin() + r * static_cast<std::ptrdiff_t>(later.bins);
      std::fill_n(first, receiver.direct_entries(), 0.0);
    }
    add(receiver.total(later), bounced, true);
  }
  return squares;
}

// Rays are another route, and agree within their errors. 6 components of 6 directions, hardly
// correlated beyond one direction: the mean square of normal differences is 1 ± 0.3 or so.
TEST(Sunlit, AgreesWithRays) {
  std::mt19937 random(7);
  for (int i = 0; i < 2; ++i) {
    const TraceableScene scene(drawn_scene(random));
    const Eigen::Array2d squares = against_rays(scene, scene, random, 6);
    EXPECT_LT(squares[0], 2.2) << i;
    EXPECT_LT(squares[1], 2.2) << i;
  }
}

// The comparison notices a third more light from one box.
TEST(Sunlit, ComparisonWithRaysNoticesAThird) {
  std::mt19937 random(7);
  Scene scene = drawn_scene(random);
  Scene other = scene;
  OpticalSurface& one = other.surfaces[other.instances[0].front_surface];
  for (int band = 0; band < scene.bands.count(); ++band) {
    const auto b = static_cast<size_t>(band);
    const double more = 0.33 * (one.diffuse[b] + one.specular[b]);
    one.diffuse[b] += more;
    one.absorbed[b] -= more;
  }
  const TraceableScene known(std::move(scene)), traced(std::move(other));
  EXPECT_GT(against_rays(known, traced, random, 6).maxCoeff(), 5.0);
}

// The vectors of a lookup of Basilisk, all of one kind after another.
std::vector<Vec3> vectors_in(const std::string& text) {
  static const std::regex value("<value_[123]>([^<]*)</value_[123]>");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), value), end; it != end; ++it) {
    numbers.push_back(std::stod((*it)[1]));
  }
  std::vector<Vec3> vectors;
  for (size_t i = 0; i + 2 < numbers.size(); i += 3) {
    vectors.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
  return vectors;
}

// A cube of 2 m in 200 directions of sunlight at 1 au, from another program's table. The file does
// not name the optics: its first force is 5.600 m² at the pressure of 1372.5398 W/m², and the 51st
// leaves a specular fraction of 0.2 and a diffuse one of 0.3.
TEST(Sunlit, AgreesWithTheLookupOfACube) {
  PHOTORQUE_NEEDS_THIRD_PARTY("reference/basilisk_cube_lookup.xml");
  std::ifstream in(outside::third_party("reference/basilisk_cube_lookup.xml"));
  std::stringstream text;
  text << in.rdbuf();
  const std::vector<Vec3> all = vectors_in(text.str());
  ASSERT_EQ(all.size(), 600u);  // directions to the Sun, forces, torques
  Scene scene;
  Mesh cube = fixtures::box(Vec3(-1, -1, -1), Vec3(1, 1, 1));
  cube.encloses = true;
  add(scene, std::move(cube), grey_surface("s", 0.2, 0.3), "cube");
  const TraceableScene traceable(scene);
  const double scale = 1372.5398 / irradiance_W_m2;
  for (size_t i = 0; i < 200; ++i) {
    const RigidTransform attitude{Quat::FromTwoVectors(all[i], Vec3::UnitZ()), Vec3::Zero()};
    const WrenchSum found = scale * sunlit(traceable, attitude).total();
    // The table itself scatters by 1e-12 N and N m about zero where symmetry asks for it; its
    // largest force is 4e-5 N.
    EXPECT_LT((found.head<3>().matrix() - all[200 + i]).norm(), 2e-11) << i;
    EXPECT_LT((found.tail<3>().matrix() - all[400 + i]).norm(), 5e-12) << i;
  }
}

// Scenes that the quadrature does not cover use rays.
TEST(Sunlit, IsForPlainSurfacesInTheLightOfOneSun) {
  Scene scene;
  add(scene, rectangle(Vec3::Zero(), Vec3(2, 0, 0), Vec3(0, 2, 0)), grey_surface("b", 0.5, 0.0),
      "plate");
  const std::vector<Beam> one = {sun(0.2665)}, two = {sun(0.2665), sun(0.2665)};
  const std::vector<Beam> lamp = {fixtures::gaussian_led(0.05, 9.0, {0, 0, 1.4}, {0, 0, -1})};
  const TraceableScene plain(scene);
  EXPECT_TRUE(SunlitBody::make(plain, one, Vec3::Zero()));
  EXPECT_FALSE(SunlitBody::make(plain, two, Vec3::Zero()));
  EXPECT_FALSE(SunlitBody::make(plain, lamp, Vec3::Zero()));
  scene.surfaces[0].bsdf = std::make_shared<Bsdf>();
  const TraceableScene rough(scene);
  EXPECT_FALSE(SunlitBody::make(rough, one, Vec3::Zero()));
}

}  // namespace
}  // namespace photorque

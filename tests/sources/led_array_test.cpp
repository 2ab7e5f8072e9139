#include "core/constants.h"
#include "sampling.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using test::changed;
using test::make_beams;
using test::vector_node;

const Vec3 centre_m(0.1, -0.2, 1.5);

SettingsNode::Table array_of(const std::string& layout, SettingsNode::Table more) {
  return changed({{"layout", {layout}},
                  {"position_m", vector_node(0.1, -0.2, 1.5)},
                  {"direction", vector_node(0, 0, -1)},
                  {"power_W", {1.5}},
                  {"aperture_diameter_m", {0.01}},
                  {"profile", {"gaussian"}},
                  {"fwhm_deg", {3.0}},
                  {"wavelength_nm", {730.0}}},
                 std::move(more));
}

std::vector<Vec3> positions_of(const std::vector<Beam>& beams) {
  std::vector<Vec3> all;
  for (const Beam& beam : beams) all.push_back(beam.lab_from_emitter.translation_m);
  return all;
}

Vec3 axis_of(const Beam& beam) {
  return beam.lab_from_emitter.direction(Vec3::UnitZ());
}

Vec3 mean_of(const std::vector<Vec3>& all) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : all) sum += v;
  return sum / static_cast<double>(all.size());
}

// Number of neighbours of each point at the distance `pitch_m`; fails if one is nearer.
std::vector<int> neighbours(const std::vector<Vec3>& points, double pitch_m) {
  std::vector<int> count(points.size(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      const double distance_m = (points[i] - points[j]).norm();
      EXPECT_GT(distance_m, pitch_m * (1.0 - 1e-12));
      if (distance_m < pitch_m * (1.0 + 1e-12)) ++count[i];
    }
  }
  return count;
}

TEST(LedArray, GridHasRowsAndColumnsAboutItsCentre) {
  const auto beams = make_beams(
      "led_array", array_of("grid", {{"count", {SettingsNode::Array{{int64_t{5}}, {int64_t{3}}}}},
                                     {"pitch_m", {0.03}}}));
  const auto at_m = positions_of(beams);
  ASSERT_EQ(at_m.size(), 15u);
  EXPECT_TRUE(mean_of(at_m).isApprox(centre_m, 1e-12));
  EXPECT_TRUE((at_m[1] - at_m[0]).isApprox(Vec3(0.03, 0, 0), 1e-12));  // x first
  EXPECT_NEAR((at_m[5] - at_m[0]).norm(), 0.03, 1e-12);
  const auto count = neighbours(at_m, 0.03);
  EXPECT_EQ(std::count(count.begin(), count.end(), 4), 3);  // inner
  EXPECT_EQ(std::count(count.begin(), count.end(), 2), 4);  // corners
  EXPECT_EQ(beams[7].name, "led_array[7]");
}

TEST(LedArray, GridMayHaveTwoPitches) {
  const auto at_m = positions_of(make_beams(
      "led_array", array_of("grid", {{"count", {SettingsNode::Array{{int64_t{2}}, {int64_t{2}}}}},
                                     {"pitch_mm", {SettingsNode::Array{{30.0}, {50.0}}}}})));
  EXPECT_NEAR((at_m[1] - at_m[0]).norm(), 0.03, 1e-12);
  EXPECT_NEAR((at_m[2] - at_m[0]).norm(), 0.05, 1e-12);
}

TEST(LedArray, RingIsEvenAndRound) {
  const auto at_m = positions_of(make_beams(
      "led_array", array_of("ring", {{"count", {int64_t{12}}}, {"ring_radius_m", {0.2}}})));
  ASSERT_EQ(at_m.size(), 12u);
  EXPECT_TRUE(mean_of(at_m).isApprox(centre_m, 1e-12));
  for (const Vec3& p : at_m) EXPECT_NEAR((p - centre_m).norm(), 0.2, 1e-12);
  // Chord of 30 deg: 2 r sin 15°.
  for (const int n : neighbours(at_m, 0.4 * std::sin(15 * degree_rad))) EXPECT_EQ(n, 2);
}

TEST(LedArray, HexagonIsClosePacked) {
  for (const auto& [count, inner, corners] :
       {std::tuple{7, 1, 6}, {19, 7, 6}, {37, 19, 6}, {61, 37, 6}}) {
    const auto at_m = positions_of(make_beams(
        "led_array", array_of("hexagonal", {{"count", {int64_t{count}}}, {"pitch_m", {0.03}}})));
    ASSERT_EQ(at_m.size(), static_cast<size_t>(count));
    EXPECT_TRUE(mean_of(at_m).isApprox(centre_m, 1e-12));
    const auto near = neighbours(at_m, 0.03);
    EXPECT_EQ(std::count(near.begin(), near.end(), 6), inner);
    EXPECT_EQ(std::count(near.begin(), near.end(), 3), corners);
  }
  const auto fifty = positions_of(make_beams(
      "led_array", array_of("hexagonal", {{"count", {int64_t{50}}}, {"pitch_m", {0.03}}})));
  EXPECT_EQ(fifty.size(), 50u);
  EXPECT_LT((mean_of(fifty) - centre_m).norm(), 0.03);
}

TEST(LedArray, PositionsAreTakenAsGiven) {
  auto table = array_of(
      "positions",
      {{"positions_m", {SettingsNode::Array{vector_node(0, 0, 1), vector_node(0.5, 0, 2)}}},
       {"aim_m", vector_node(0.25, 0, 0)}});
  table.erase("position_m");
  table.erase("direction");
  const auto beams = make_beams("led_array", table);
  ASSERT_EQ(beams.size(), 2u);
  EXPECT_TRUE(beams[1].lab_from_emitter.translation_m.isApprox(Vec3(0.5, 0, 2)));
  // Parallel: from the centre (0.25, 0, 1.5) to the aim.
  for (const Beam& beam : beams) EXPECT_TRUE(axis_of(beam).isApprox(-Vec3::UnitZ(), 1e-12));
}

TEST(LedArray, ParallelBeamsAreParallelAndTheirPlaneIsNormalToThem) {
  const Vec3 direction = Vec3(0.3, -0.2, -1.0).normalized();
  const auto beams =
      make_beams("led_array", array_of("hexagonal", {{"count", {int64_t{19}}},
                                                     {"pitch_m", {0.03}},
                                                     {"direction", vector_node(0.3, -0.2, -1.0)}}));
  for (const Beam& beam : beams) {
    EXPECT_TRUE(axis_of(beam).isApprox(direction, 1e-12));
    EXPECT_NEAR((beam.lab_from_emitter.translation_m - centre_m).dot(direction), 0.0, 1e-12);
  }
}

TEST(LedArray, ConvergingBeamsMeetAtTheAim) {
  const Vec3 aim_m(0.05, 0.1, 0.2);
  for (const bool own_plane : {false, true}) {
    auto table = array_of("ring", {{"count", {int64_t{8}}},
                                   {"ring_radius_m", {0.3}},
                                   {"aim", {"converging"}},
                                   {"aim_m", vector_node(0.05, 0.1, 0.2)}});
    if (!own_plane) table.erase("direction");
    const Vec3 normal = own_plane ? Vec3(-Vec3::UnitZ()) : (aim_m - centre_m).normalized();
    for (const Beam& beam : make_beams("led_array", table)) {
      const Vec3 to_aim_m = aim_m - beam.lab_from_emitter.translation_m;
      EXPECT_LT(to_aim_m.cross(axis_of(beam)).norm(), 1e-12);
      EXPECT_GT(to_aim_m.dot(axis_of(beam)), 0.0);
      EXPECT_NEAR((beam.lab_from_emitter.translation_m - centre_m).dot(normal), 0.0, 1e-12);
    }
  }
}

// In any direction: a tenth of a degree off moves no LED by more than that times its distance.
TEST(LedArray, APanelThatIsALittleOffDoesNotTurnAboutItsAxis) {
  const auto at = [](const Vec3& direction) {
    return make_beams(
        "led_array",
        array_of("grid",
                 {{"count", {SettingsNode::Array{{int64_t{5}}, {int64_t{3}}}}},
                  {"pitch_m", {0.03}},
                  {"direction", vector_node(direction.x(), direction.y(), direction.z())}}));
  };
  for (const double vertical : {-1.0, 1.0}) {
    const auto straight = at({0.0, 0.0, vertical});
    for (int azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += 15) {
      const double a = azimuth_deg * degree_rad, off = 0.1 * degree_rad;
      const auto turned = at({off * std::cos(a), off * std::sin(a), vertical});
      for (size_t i = 0; i < straight.size(); ++i) {
        const Vec3 moved_m =
            turned[i].lab_from_emitter.translation_m - straight[i].lab_from_emitter.translation_m;
        EXPECT_LE(moved_m.norm(), 1.01 * off * 0.07) << azimuth_deg;
      }
    }
  }
}

TEST(LedArray, FocusTurnsWithThePanel) {
  const Vec3 direction = Vec3(0.1, -0.2, -1.0).normalized();
  auto table = array_of("ring", {{"count", {int64_t{8}}},
                                 {"ring_radius_m", {0.3}},
                                 {"aim", {"converging"}},
                                 {"focus_m", {2.5}},
                                 {"direction", vector_node(0.1, -0.2, -1.0)}});
  for (const Beam& beam : make_beams("led_array", table)) {
    const Vec3 to_focus_m = centre_m + 2.5 * direction - beam.lab_from_emitter.translation_m;
    EXPECT_LT(to_focus_m.cross(axis_of(beam)).norm(), 1e-12);
    EXPECT_NEAR(to_focus_m.norm(), std::hypot(2.5, 0.3), 1e-12);
  }
}

TEST(LedArray, TotalPowerIsSharedEqually) {
  auto table = array_of(
      "ring", {{"count", {int64_t{8}}}, {"ring_radius_m", {0.3}}, {"total_power_W", {90.0}}});
  table.erase("power_W");
  for (const Beam& beam : make_beams("led_array", table)) {
    EXPECT_DOUBLE_EQ(beam.emitter->power_W(), 90.0 / 8.0);
  }
}

// Against the moments of the normal distribution, within five of their standard errors.
TEST(LedArray, LedsDifferByTheStatedSpread) {
  constexpr int64_t count = 10000;
  constexpr double power_spread = 0.04, aim_deg = 0.5;
  auto table = array_of("hexagonal", {{"count", {count}},
                                      {"pitch_m", {0.03}},
                                      {"total_power_W", {1e4}},
                                      {"power_spread", {power_spread}},
                                      {"aim_spread_deg", {aim_deg}}});
  table.erase("power_W");
  const auto beams = make_beams("led_array", table);
  double sum = 0.0, squares = 0.0, across = 0.0, exitance = 0.0;
  for (const Beam& beam : beams) {
    const double off = beam.emitter->power_W() - 1.0;
    sum += off;
    squares += off * off;
    exitance += beam.aperture->exitance_W_m2 * pi * std::pow(beam.aperture->radius_m, 2);
    const double angle = std::acos(std::min(1.0, axis_of(beam).dot(-Vec3::UnitZ())));
    across += angle * angle / 2.0;
  }
  const double n = static_cast<double>(count);
  EXPECT_NEAR(sum / n, 0.0, 5.0 * power_spread / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), power_spread, 5.0 * power_spread / std::sqrt(2.0 * n));
  EXPECT_NEAR(std::sqrt(across / n), aim_deg * degree_rad,
              5.0 * aim_deg * degree_rad / std::sqrt(4.0 * n));
  EXPECT_NEAR(exitance, n + sum, 1e-6);  // direct light is gathered from the same powers
  // Equal LEDs on another panel; other LEDs by another seed.
  table["pitch_m"] = {0.05};
  EXPECT_EQ(make_beams("led_array", table)[77].emitter->power_W(), beams[77].emitter->power_W());
  table["spread_seed"] = {int64_t{2}};
  EXPECT_NE(make_beams("led_array", table)[77].emitter->power_W(), beams[77].emitter->power_W());
  table["spread_seed"] = {int64_t{0}};
  EXPECT_EQ(make_beams("led_array", table)[77].emitter->power_W(), 1.0);
}

TEST(LedArray, ReportsTheMistake) {
  const SettingsNode::Table ring = {{"count", {int64_t{8}}}, {"ring_radius_m", {0.3}}};
  const auto refuses = [](SettingsNode::Table table, const std::string& words) {
    EXPECT_THAT(refusal_of([&] { make_beams("led_array", std::move(table)); }),
                testing::HasSubstr(words));
  };
  refuses(changed(array_of("ring", ring), {{"total_power_W", {9.0}}}), "also power_W");
  refuses(changed(array_of("ring", ring), {}, {"power_W"}), "power_W: found nothing");
  refuses(changed(array_of("ring", ring), {{"count", {int64_t{0}}}}), "count: found 0");
  refuses(changed(array_of("ring", ring), {}, {"ring_radius_m"}), "ring_radius_m: found nothing");
  refuses(changed(array_of("ring", ring), {{"aim", {"converging"}}}), "aim_m: found nothing");
  refuses(changed(array_of("ring", ring), {{"aim_m", vector_node(0, 0, 0)}}), "also aim_m");
  refuses(array_of("square", ring), "one of \"grid\"");
  refuses(
      array_of("grid", {{"count", {SettingsNode::Array{{2.5}, {int64_t{3}}}}}, {"pitch_m", {0.1}}}),
      "two whole numbers");
  refuses(array_of("grid", {{"count", {SettingsNode::Array{{int64_t{3}}}}}, {"pitch_m", {0.1}}}),
          "two whole numbers");
  refuses(array_of("grid", {{"count", {SettingsNode::Array{{int64_t{3000}}, {int64_t{3000}}}}},
                            {"pitch_m", {0.1}}}),
          "at most 100000");
  refuses(array_of("positions", {{"positions_m", {SettingsNode::Array{}}}}), "positions_m");
  refuses(changed(array_of("ring", ring), {{"pitch_m", {0.3}}}), "pitch_m");
  // One LED of the array stands on the point that all are aimed at.
  refuses(changed(array_of("ring", ring),
                  {{"aim", {"converging"}}, {"aim_m", vector_node(0.4, -0.2, 1.5)}}),
          "position of the source itself");
}

}  // namespace
}  // namespace photorque

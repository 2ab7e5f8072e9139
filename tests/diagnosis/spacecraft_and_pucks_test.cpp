// Machines off the bearing: one angle of a spacecraft that the Sun presses on, and a body that
// slides on a table. Recordings by closed forms and by a small independent integration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "attitude/propagation/run.h"
#include "core/constants.h"
#include "diagnosis/attitude/diagnose.h"
#include "diagnosis/guess/guess.h"
#include "tests/diagnosis/machine_bench.h"
#include "tests/files.h"
#include "tests/noise.h"

namespace photorque {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const char* const puck_toml =
    "[platform]\ntopology = \"planar\"\n[sensors.position]\nnoise_m = 3e-4\n";

// Down a slope under viscous drag: v → −g s/c exponentially, each axis alone.
Recording puck(double slope_x, double slope_y, double drag_1_s, uint64_t seed) {
  Noise noise(seed, 3e-4);
  Channel x{"x_m", {}}, y{"y_m", {}};
  const auto way = [&](double t, double v, double slope) {
    const double a = -standard_gravity_m_s2 * slope;
    if (drag_1_s == 0.0) return v * t + 0.5 * a * t * t;
    const double last = a / drag_1_s;
    return last * t + (v - last) * (1.0 - std::exp(-drag_1_s * t)) / drag_1_s;
  };
  for (int i = 0; i < 800; ++i) {
    const double t = 0.05 * i;
    x.values.push_back(way(t, 0.3, slope_x) + noise());
    y.values.push_back(way(t, 0.1, slope_y) + noise());
  }
  return recording_of(0.05, {x, y});
}

TEST(Pucks, TheSlopeOfTheTableAndTheDragAreFound) {
  const Diagnosis d = diagnose(machine(puck_toml), {{"puck.csv", puck(1e-3, -2e-3, 0.04, 1)}}, {});
  EXPECT_EQ(d.verdict, Verdict::missing_physics);
  ASSERT_THAT(kinds_of(d), UnorderedElementsAre("table_slope", "sliding_drag"));
  const FittedParameter& slope = parameter(d, "table_slope", "slope_rad");
  EXPECT_NEAR(slope.value[0], 1e-3, 5.0 * slope.sigma[0]);
  EXPECT_NEAR(slope.value[1], -2e-3, 5.0 * slope.sigma[1]);
  EXPECT_LT(slope.sigma[0], 2e-5);
  const FittedParameter& drag = parameter(d, "sliding_drag", "coefficient_kg_s");
  EXPECT_NEAR(drag.value[0], 0.04, 5.0 * drag.sigma[0]);
}

TEST(Pucks, FreelyTheyAreConsistent) {
  const Diagnosis d = diagnose(machine(puck_toml), {{"puck.csv", puck(0, 0, 0, 2)}}, {});
  EXPECT_EQ(d.verdict, Verdict::consistent);
  EXPECT_THAT(kinds_of(d), IsEmpty());
}

// Straight on and slower and slower by μ g: a slope or a spring would do as well, and neither is
// said. The path carries a wave that no law has, ten times the noise, as a real table does.
TEST(Pucks, ASlideToRestIsBrakedByFriction) {
  Noise noise(7, 3e-4);
  Channel x{"x_m", {}}, y{"y_m", {}};
  constexpr double coefficient = 0.19, start_m_s = 1.5, interval_s = 0.005;
  for (int i = 0; i < 150; ++i) {
    const double t = interval_s * i;
    const double way = start_m_s * t - 0.5 * coefficient * standard_gravity_m_s2 * t * t +
                       3e-3 * std::sin(25.0 * t);
    x.values.push_back(0.8 * way + noise());
    y.values.push_back(0.6 * way + noise());
  }
  const Diagnosis d = diagnosed(machine(puck_toml), interval_s, {x, y});
  ASSERT_THAT(kinds_of(d), ElementsAre("sliding_friction"));
  EXPECT_EQ(d.verdict, Verdict::unexplained);  // the wave is left
  EXPECT_NEAR(parameter(d, "sliding_friction", "coefficient").value[0], coefficient, 0.02);
}

// A wall that it bounces off is a new initial state, no force.
TEST(Pucks, AWallIsNoForce) {
  Recording free = puck(0, 0, 0, 3);
  for (double& x : free.channels[0].values) {
    if (x > 6.0) x = 12.0 - x;
  }
  const Diagnosis d = diagnose(machine(puck_toml), {{"puck.csv", free}}, {});
  EXPECT_EQ(d.verdict, Verdict::consistent);
}

// A platform that thrusters hold in its place, PD control, while it turns evenly: the commanded
// force answers the place, and the effects show in the command alone. Between commands the
// acceleration is constant but for the force that turns along, which is taken at the middle.
Recording held_in_place(double gain, const Vec2& lab_m_s2, const Vec2& body_m_s2, uint64_t seed) {
  constexpr double mass_kg = 12.0, turn_rad_s = 0.055, step_s = 0.1;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 3e-5), of_angle(0.0, 1.5e-4);
  std::array<Channel, 5> all{
      {{"x_m", {}}, {"y_m", {}}, {"angle_rad", {}}, {"command_x_N", {}}, {"command_y_N", {}}}};
  Vec2 place_m(0.004, -0.003), velocity_m_s(2e-4, 1e-4);
  for (int i = 0; i < 1200; ++i) {
    const Vec2 seen_m = place_m + Vec2(noise(random), noise(random));
    const Vec2 command_N = -mass_kg * (0.02 * seen_m + 0.15 * velocity_m_s);
    all[0].values.push_back(seen_m.x());
    all[1].values.push_back(seen_m.y());
    all[2].values.push_back(turn_rad_s * step_s * i + of_angle(random));
    all[3].values.push_back(command_N.x());
    all[4].values.push_back(command_N.y());
    const double heading = turn_rad_s * step_s * (i + 0.5);
    const Vec2 along(std::cos(heading), std::sin(heading)), across(-along.y(), along.x());
    const Vec2 a =
        gain * command_N / mass_kg + lab_m_s2 + body_m_s2.x() * along + body_m_s2.y() * across;
    place_m += step_s * velocity_m_s + 0.5 * step_s * step_s * a;
    velocity_m_s += step_s * a;
  }
  return recording_of(step_s, {all.begin(), all.end()});
}

TEST(Pucks, ForcesUnderFeedbackAreFoundOverStretches) {
  const Vec2 lab_m_s2(4e-4, 1.5e-4), body_m_s2(1.5e-4, -1e-4);
  constexpr double gain = 0.8;
  const std::vector<NamedRecording> runs = {
      {"held.csv", held_in_place(gain, lab_m_s2, body_m_s2, 6)}};
  const NominalModel platform = machine(R"([platform]
topology = "planar"
mass_kg = 12
inertia_kg_m2 = 0.2
[sensors.position]
noise_m = 3e-5
[sensors.angle]
noise_arcsec = 31
)");
  const Diagnosis d = diagnose(platform, runs, {});
  ASSERT_THAT(kinds_of(d), UnorderedElementsAre("actuator_gain", "table_slope", "body_force"))
      << d.sentence;
  EXPECT_THAT(d.warnings, testing::Contains(HasSubstr("16 segments")));
  EXPECT_NEAR(parameter(d, "actuator_gain", "gain_error").value[0], gain - 1.0, 0.05);
  for (size_t k = 0; k < 2; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(parameter(d, "table_slope", "slope_rad").value[k],
                -lab_m_s2[at] / standard_gravity_m_s2, 2e-6);
    EXPECT_NEAR(parameter(d, "body_force", "force_N").value[k], 12.0 * body_m_s2[at], 2e-4);
  }
}

TEST(Pucks, AreGuessedByTheirColumns) {
  std::ostringstream file;
  file << "time (s),x (mm),y (mm)\n";
  const Recording seen = puck(1e-3, 0, 0, 4);
  for (size_t i = 0; i < seen.rows(); ++i) {
    file << seen.time_s[i] << ',' << 1e3 * seen.channels[0].values[i] << ','
         << 1e3 * seen.channels[1].values[i] << '\n';
  }
  const auto path = test_file("puck.csv", file.str());
  const std::string toml = guess_experiment({path}, path.parent_path());
  EXPECT_THAT(toml, HasSubstr("topology = \"planar\""));
  EXPECT_THAT(toml, HasSubstr("x_mm = \"x (mm)\""));
  EXPECT_THAT(toml, HasSubstr("[sensors.position]"));
}

const char* const spacecraft_toml = R"([platform]
topology = "one_axis"
axis = "x"
[environment.sun]
date = "2015-04-27"
pointing = { axis = "x", right_ascension_deg = 130, declination_deg = 17 }
[sensors.angle]
noise_arcsec = 0.1
)";

// A roll between firings under a torque per unit of inertia [rad/s²] that changes so slowly that it
// is constant over a segment, and shakes by a white torque besides; an initial state for each.
template <typename Torque>
Recording roll(const Torque& torque, double shaking, uint64_t seed) {
  Noise normal(seed);
  Channel angle{"roll_rad", {}}, thruster{"thruster", {}};
  constexpr double step_s = 1800.0;
  double roll_rad = 0.0, rate = 0.0;
  for (int i = 0; i < 2400; ++i) {
    const bool fires = i % 20 == 0;
    if (fires) rate = -roll_rad / 36000.0 + 2e-9 * normal();
    angle.values.push_back(roll_rad + 0.1 * arcsecond_rad * normal());
    thruster.values.push_back(fires ? 1.0 : 0.0);
    const double a = torque(step_s * (i + 0.5), roll_rad + 0.5 * rate * step_s);
    roll_rad += rate * step_s + 0.5 * a * step_s * step_s;
    rate += a * step_s + shaking * std::sqrt(step_s) * normal();
  }
  return recording_of(step_s, {angle, thruster});
}

// p s × a about x, of the same Sun: what the law is, tests/attitude holds against closed forms.
double pressed(const Environment& environment, const Vec3& a_m3, double time_s, double roll_rad) {
  const Vec3 sun = environment.sun->at(time_s)[0];
  const double p = 1361.0 / 299792458.0 / sun.squaredNorm();
  const Quat body_from_lab(Eigen::AngleAxisd(-roll_rad, Vec3::UnitX()));
  return p * (body_from_lab * sun.normalized()).cross(a_m3).x();
}

TEST(Spacecraft, ThePressureOfTheSunIsNamedAndMeasured) {
  const NominalModel model = machine(spacecraft_toml);
  const Vec3 a_m3(0.0, 2e-7, 3e-8);
  const Recording seen = roll(
      [&](double t, double at) { return pressed(model.model.environment, a_m3, t, at); }, 0.0, 5);
  const Diagnosis d = diagnose(model, {{"roll.csv", seen}}, {});
  ASSERT_THAT(kinds_of(d), ElementsAre("radiation_pressure"));
  const FittedParameter& a = parameter(d, "radiation_pressure", "area_moment_m3");
  EXPECT_EQ(a.value[0], 0.0);  // along the axis it exerts nothing
  for (size_t k = 1; k < 3; ++k) {
    EXPECT_NEAR(a.value[k], a_m3[static_cast<Eigen::Index>(k)], 5.0 * a.sigma[k]);
    EXPECT_LT(a.sigma[k], 2e-8);
  }
}

}  // namespace
}  // namespace photorque

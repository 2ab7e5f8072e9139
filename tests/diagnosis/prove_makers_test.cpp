// Platforms and motions of both makers of `prove`, and where their simulation needs shorter steps.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tools/proof/files.h"
#include "tools/proof/strength.h"

namespace photorque {
namespace {

InjectedPlan quiet_plan(double second_fraction) {
  InjectedPlan plan;
  plan.per_kind = plan.pairs = plan.outside = 0;
  plan.none = 40;
  plan.second_fraction = second_fraction;
  return plan;
}

TEST(ProveMakers, SecondTakesItsShareAndKeepsToPhysicalMotions) {
  const InjectedPlan plan = quiet_plan(0.25);
  int second = 0;
  for (size_t i = 0; i < case_count(plan); ++i) {
    const InjectedCase c = draw_case(plan, i);
    second += c.maker.starts_with("second") ? 1 : 0;
    EXPECT_TRUE(injected::stays_physical(c)) << c.maker;
  }
  EXPECT_EQ(second, 10);
}

TEST(ProveMakers, SecondMovesAsTheFirstNeverDoes) {
  const InjectedPlan plan = quiet_plan(1.0);
  std::set<std::string> motions;
  double fastest_rad_s = 0.0, lightest_kg = 1e9, heaviest_kg = 0.0, shortest_s = 1e9;
  bool without_gyro = false, without_commands = false;
  for (size_t i = 0; i < case_count(plan); ++i) {
    const InjectedCase c = draw_case(plan, i);
    motions.insert(c.maker.substr(0, c.maker.find(',')));
    fastest_rad_s = std::max(fastest_rad_s, injected::length(c.runs[0].start.rate_rad_s));
    lightest_kg = std::min(lightest_kg, c.world.mass_kg);
    heaviest_kg = std::max(heaviest_kg, c.world.mass_kg);
    shortest_s = std::min(shortest_s, c.runs[0].duration_s);
    without_gyro = without_gyro || !c.sensors.has_gyro;
    without_commands = without_commands || !c.sensors.has_commands;
    const std::string text = injected_experiment(c, false);
    EXPECT_EQ(text.find("[sensors.gyro]") == std::string::npos, !c.sensors.has_gyro);
  }
  EXPECT_EQ(motions.size(), 4u);
  EXPECT_GT(fastest_rad_s, 1.0);
  EXPECT_LT(lightest_kg, 3.0);
  EXPECT_GT(heaviest_kg, 30.0);
  EXPECT_EQ(shortest_s, 60.0);
  EXPECT_TRUE(without_gyro);
  EXPECT_TRUE(without_commands);
}

// Every effect of a triple shows beyond the other two.
TEST(ProveMakers, TriplesShowThreeDifferentEffects) {
  InjectedPlan plan = quiet_plan(0.0);
  plan.none = 0;
  plan.triples = 2;
  plan.duration_s = 150.0;
  for (size_t i = 0; i < case_count(plan); ++i) {
    const InjectedCase c = draw_case(plan, i);
    std::set<std::string> kinds;
    for (const InjectedEffect& effect : c.world.effects) kinds.insert(effect.kind);
    EXPECT_EQ(kinds.size(), 3u);
    EXPECT_EQ(c.verdict, "missing_physics");
    EXPECT_GE(c.chi2_gain, 200.0);
  }
}

// A body that dry friction brings to rest: ω falls by τ/I, and the angle ends at ω₀² I/(2 τ). Steps
// of a tenth of a second pass over the instant where it stops.
TEST(ProveMakers, DryFrictionStopsABodyWhereTheWorkIsDone) {
  InjectedWorld world;
  world.mass_kg = 5.0;
  world.gravity_m_s2 = 0.0;
  for (size_t k = 0; k < 3; ++k) world.inertia_kg_m2[k][k] = 0.1;
  world.effects = {{"dry_friction", {{"torque_N_m", {1e-3}}}}};
  InjectedStart start;
  start.rate_rad_s = {0, 0, 0.1};
  const auto end = injected_motion(world, {}, start, 0.0, {30.0}, 0.1, 1e-9).back();
  EXPECT_NEAR(injected::turn_of(end.attitude)[2], 0.1 * 0.1 * 0.1 / (2.0 * 1e-3), 1e-6);
  EXPECT_LT(injected::length(end.rate_rad_s), 1e-6);
}

}  // namespace
}  // namespace photorque

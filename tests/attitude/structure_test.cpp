// Lithium in batteries, and moving masses: the functions behind the disturbances.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/disturbances/mass/battery.h"
#include "attitude/disturbances/mass/moving_masses.h"
#include "core/constants.h"
#include "tests/attitude/settings_bench.h"

namespace photorque {
namespace {

TEST(Battery, LithiumFollowsFaraday) {
  EXPECT_NEAR(lithium_kg_C * 3600 * 1e3, 0.2589, 5e-5);  // g/Ah
  EXPECT_NEAR(lithium_as_published_kg_C * 3600 * 1e3, 0.3, 1e-12);
}

TEST(Battery, OpposedCellsCancel) {
  const std::vector<BatteryCell> cells = {{{0.03, 0, 0}, 0.5}, {{-0.03, 0, 0}, 0.5}};
  EXPECT_EQ(com_shift_m_C(cells, 7.0).norm(), 0.0);
}

// Usual parts, 1.8 deg, 2 mm and 0.25 kg on 7 kg, which give the paper's printed results.
MovingMass usual_mass() {
  return {.direction_body = Vec3::UnitX(),
          .mass_kg = 0.25,
          .lead_m = 2e-3,
          .step_angle_rad = 1.8 * degree_rad};
}

// A full turn of the screw moves the mass by its lead.
TEST(MovingMasses, TurnOfTheScrewIsOneLead) {
  MovingMass mass = usual_mass();
  EXPECT_NEAR(mass.pitch_m() * 200, 2e-3, 1e-18);
  mass.microsteps = 16;
  EXPECT_NEAR(mass.pitch_m() * 200 * 16, 2e-3, 1e-18);
  EXPECT_NEAR(mass.com_step_m(7.0).x() * 200 * 16, 2e-3 * 0.25 / 7.0, 1e-18);
}

TEST(MovingMasses, BalanceToHalfAStepAlongEachAxis) {
  const std::vector<MovingMass> masses = eight_masses(usual_mass());
  const double resolution_m = com_resolution_m(usual_mass(), 7.0);
  for (int i = 0; i < 50; ++i) {
    const Vec3 offset_m(1e-5 * std::sin(1.0 + i), 2e-5 * std::cos(2.3 * i),
                        -6e-5 * std::sin(0.7 * i));
    const BalanceCommand command = balancing_steps(offset_m, masses, 7.0);
    EXPECT_LE(command.left_over_m.cwiseAbs().maxCoeff(), resolution_m * (1 + 1e-9));
    Vec3 moved_m = offset_m;
    for (size_t k = 0; k < masses.size(); ++k) {
      moved_m += static_cast<double>(command.steps[k]) * masses[k].com_step_m(7.0);
    }
    EXPECT_LT((moved_m - command.left_over_m).norm(), 1e-15);
  }
}

TEST(MovingMasses, UnreachableDirectionsAreLeftOver) {
  const BalanceCommand command = balancing_steps({1e-5, 2e-5, 0}, {usual_mass()}, 7.0);
  EXPECT_LT(std::abs(command.left_over_m.x()), com_resolution_m(usual_mass(), 7.0));
  EXPECT_EQ(command.left_over_m.y(), 2e-5);
}

TEST(MovingMasses, SettingsNameAnySet) {
  const Settings usual = settings_of("moving_mass_kg = 0.25, lead_mm = 2");
  EXPECT_EQ(read_moving_masses(usual).size(), 8u);
  const Settings three = settings_of(
      "moving_mass_kg = 0.4, lead_m = 1e-3, step_angle_deg = 0.9, "
      "directions = [[2, 0, 0], [0, 1, 1], [0, 0, 1]]");
  const std::vector<MovingMass> masses = read_moving_masses(three);
  ASSERT_EQ(masses.size(), 3u);
  EXPECT_NEAR(masses[1].direction_body.norm(), 1.0, 1e-15);
  EXPECT_NEAR(masses[0].pitch_m(), 1e-3 / 400, 1e-18);
}

}  // namespace
}  // namespace photorque

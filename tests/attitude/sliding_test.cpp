// A platform that slides on a table: closed forms of the forces.
#include <gtest/gtest.h>

#include <cmath>

#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "scenes/experiment/toml.h"
#include "tests/attitude/settings_bench.h"

namespace photorque {
namespace {

PropagationRun run_of(const std::string& toml) {
  return read_propagation(Settings(parse_toml(toml, "puck.toml")));
}

const std::string puck = R"([platform]
topology = "planar"
mass_kg = 2
[propagate]
duration_s = 5
output_rate_Hz = 2
initial_position_m = [0.1, -0.2]
initial_velocity_m_s = [0.3, 0.4]
tolerance = 1e-11
)";

struct Place {
  double x, y;
};

Place end_of_run(const std::string& toml) {
  const Recording recording = propagate(run_of(toml)).recording;
  return {recording.find("x_m")->values.back(), recording.find("y_m")->values.back()};
}

Place end_of(const std::string& disturbance) {
  return end_of_run(puck + "[[disturbance]]\n" + disturbance);
}

// The end position of a run with a force that is commanded from one second on.
Place end_of_commanded(const std::string& command, const std::string& disturbance) {
  const std::string acting = disturbance.empty() ? "" : "[[disturbance]]\n" + disturbance;
  return end_of_run(puck + "[[propagate.command]]\ntime_s = 1\n" + command + acting);
}

TEST(Sliding, FreelyItGoesStraight) {
  const PropagationResult result = propagate(run_of(puck));
  EXPECT_NEAR(result.recording.find("x_m")->values.back(), 0.1 + 0.3 * 5, 1e-12);
  EXPECT_NEAR(result.recording.find("y_m")->values.back(), -0.2 + 0.4 * 5, 1e-12);
  EXPECT_EQ(result.recording.find("velocity_x_m_s"), nullptr);
}

// A force that is commanded in lab axes gives a constant acceleration from its time on.
TEST(Sliding, ForceCommandedInTheLaboratoryAcceleratesIt) {
  const Place end = end_of_commanded("force_N = [0.4, -0.2]\n", "");
  EXPECT_NEAR(end.x, 0.1 + 0.3 * 5 + 0.5 * 0.4 / 2.0 * 16, 1e-10);
  EXPECT_NEAR(end.y, -0.2 + 0.4 * 5 - 0.5 * 0.2 / 2.0 * 16, 1e-10);
}

// The acceleration f/m rotates with a platform at the constant rate ω: two integrations of (cos ω
// t, sin ω t) from rest at t = 0 give (1 − cos ω t, ω t − sin ω t)/ω².
TEST(Sliding, ForceFixedInTheBodyTurnsWithIt) {
  const double turn_rad = 0.5 * 5, a_m_s2 = 0.6 / 2.0;
  const double along = a_m_s2 * (1.0 - std::cos(turn_rad)) / 0.25;
  const double across = a_m_s2 * (turn_rad - std::sin(turn_rad)) / 0.25;
  const std::string turning = "initial_rate_rad_s = [0, 0, 0.5]\n";
  const std::string acting = "[[disturbance]]\nkind = \"body_force\"\nforce_N = [0.6, 0]\n";
  const std::string commanded = "[[propagate.command]]\ntime_s = 0\nforce_body_N = [0.6, 0]\n";
  for (const std::string& force : {acting, commanded}) {
    const Place end = end_of_run(puck + turning + force);
    EXPECT_NEAR(end.x, 0.1 + 0.3 * 5 + along, 1e-8);
    EXPECT_NEAR(end.y, -0.2 + 0.4 * 5 + across, 1e-8);
  }
}

TEST(Sliding, ThrustersThatGiveLessAccelerateLess) {
  const std::string command = "force_N = [0.4, -0.2]\n";
  const Place gain = end_of_commanded(command, "kind = \"actuator_gain\"\ngain_error = -0.25\n");
  EXPECT_NEAR(gain.x, 0.1 + 0.3 * 5 + 0.5 * 0.75 * 0.4 / 2.0 * 16, 1e-10);
  const Place axes =
      end_of_commanded(command, "kind = \"actuator_gain\"\ngain_error = [-0.25, 0.5, 7]\n");
  EXPECT_NEAR(axes.x, gain.x, 1e-10);
  EXPECT_NEAR(axes.y, -0.2 + 0.4 * 5 - 0.5 * 1.5 * 0.2 / 2.0 * 16, 1e-10);
  const Place saturated =
      end_of_commanded(command, "kind = \"thrust_saturation\"\nloss_at_one_newton = 2.5\n");
  EXPECT_NEAR(saturated.x, 0.1 + 0.3 * 5 + 0.5 * 0.2 / 2.0 * 16, 1e-8);
  EXPECT_NEAR(saturated.y, -0.2 + 0.4 * 5 - 0.5 * (0.2 / 1.5) / 2.0 * 16, 1e-8);
  const Place heavier = end_of_commanded(command, "kind = \"mass_error\"\ndelta_kg = 2\n");
  EXPECT_NEAR(heavier.x, 0.1 + 0.3 * 5 + 0.5 * 0.4 / 4.0 * 16, 1e-10);
}

// From (0.1, −0.2) m at (0.3, 0.4) m/s, 0.5 m/s in all, with 2 kg during 5 s.
TEST(Sliding, EveryForceMovesItByItsClosedForm) {
  // Viscous drag, v = v₀ exp(−c t/m); form drag, v = v₀/(1 + k v₀ t/m); dry friction stops the
  // platform after v₀²/(2 μ g) for any mass, and then it only creeps. A spring swings it about f/k
  // with ω² = k/m.
  const double viscous = (1.0 - std::exp(-0.25 * 5)) / 0.25,
               form = std::log(1.0 + 0.4 * 0.5 * 5) / 0.4, dry = 0.25 / (2.0 * 0.02 * g);
  const double w = 0.5, c = std::cos(w * 5), s = std::sin(w * 5) / w;
  struct Case {
    const char* disturbance;
    Place end;
    double tolerance_m;
  };
  for (const Case& one :
       {Case{"kind = \"table_slope\"\nslope_mrad = [2, -1]\n",
             {0.1 + 0.3 * 5 - 0.5 * g * 2e-3 * 25, -0.2 + 0.4 * 5 + 0.5 * g * 1e-3 * 25},
             1e-10},
        Case{"kind = \"sliding_drag\"\ncoefficient_kg_s = 0.5\n",
             {0.1 + 0.3 * viscous, -0.2 + 0.4 * viscous},
             1e-10},
        Case{"kind = \"sliding_air_drag\"\ncoefficient_kg_m = 0.8\n",
             {0.1 + 0.6 * form, -0.2 + 0.8 * form},
             1e-9},
        Case{"kind = \"sliding_friction\"\ncoefficient = 0.02\n",
             {0.1 + 0.6 * dry, -0.2 + 0.8 * dry},
             1e-4},
        Case{"kind = \"sliding_spring\"\nstiffness_N_per_m = 0.5\npull_N = [0.1, 0]\n",
             {0.2 + (0.1 - 0.2) * c + 0.3 * s, -0.2 * c + 0.4 * s},
             1e-9}}) {
    const Place end = end_of(one.disturbance);
    EXPECT_NEAR(end.x, one.end.x, one.tolerance_m) << one.disturbance;
    EXPECT_NEAR(end.y, one.end.y, one.tolerance_m) << one.disturbance;
  }
}

// A drag on the rotation reduces only the rotation.
TEST(Sliding, TurnsMeanwhile) {
  const PropagationRun run =
      run_of(puck + "initial_rate_rad_s = [0, 0, 0.2]\n[[disturbance]]\nkind = \"bearing_drag\"\n" +
             "coefficient_N_m_s = 0.3\n");
  const PropagationResult result = propagate(run);
  EXPECT_NEAR(result.states.back().rate_body_rad_s.z(), 0.2 * std::exp(-0.3 * 5), 1e-9);
  EXPECT_NEAR(result.recording.find("x_m")->values.back(), 1.6, 1e-10);
}

TEST(Sliding, ReportsTheMistake) {
  EXPECT_THROW(run_of(puck + "initial_charge_Ah = 0\n[[disturbance]]\nkind = \"table_slope\"\n"
                             "slope_rad = [1, 2, 3]\n"),
               InputError);
  EXPECT_THROW(run_of("[platform]\ntopology = \"planar\"\naxis = \"x\"\n"), InputError);
  // A force of a command has two components.
  EXPECT_THROW(end_of_commanded("force_N = [0.4]\n", ""), InputError);
  EXPECT_THROW(end_of_commanded("force_body_N = [0.4, 0, 0]\n", ""), InputError);
}

}  // namespace
}  // namespace photorque

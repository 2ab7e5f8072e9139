// Drag in free-molecular flow as a user meets it: a table of torque-map, and propagate with it.
#include <cmath>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using testing::HasSubstr;
using testing::Not;

class DragCommands : public CommandTest {
 protected:
  // A plate of 0.4 m, 0.1 m above the centre of rotation, in a gas so cold that its molecules stay
  // together and leave no momentum when they come off.
  std::string write_gas() const {
    write_plate();
    return write("gas.toml", R"([scene]
file = "plate.gltf"
[torque_map]
azimuth_step_deg = 45
elevation_step_deg = 45
[torque_map.molecular_flow]
speed_m_s = 7500
temperature_K = 1e-6
molar_mass_g_mol = 16
wall_temperature_K = 1e-6
)");
  }
};

// T = ½ρv² C_D A L with C_D = 2, the plate's area across the wind and the arm of its middle. The
// atmosphere turns with the orbit.
// Source: J. R. Wertz, W. J. Larson, Space Mission Analysis and Design, 3rd ed. (1999), table
// 10-10, aerodynamic torque.
TEST_F(DragCommands, APlateInOrbitHasTheTorqueOfTheTextbook) {
  succeed("torque-map " + write_gas() + " --out " + at("map"));
  EXPECT_THAT(file_text(at("map/gas.spo")), HasSubstr("Area"));
  const std::string orbit = write("orbit.toml", R"([platform]
topology = "free"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
[[disturbance]]
kind = "orbit"
altitude_m = 400e3
inclination_deg = 0
[[disturbance]]
kind = "aerodynamic_drag"
table = "map/wrench_table_body.csv"
density_kg_m3 = 1e-11
[propagate]
duration_s = 1
initial_attitude = [0.92387953251, -0.38268343237, 0, 0]
)");
  succeed("propagate " + orbit + " --out " + at("o"));
  const double radius_m = 6771.2e3;
  const double wind_m_s = std::sqrt(3.986004418e14 / radius_m) - 7.292115e-5 * radius_m;
  const double force_N = 0.5 * 1e-11 * wind_m_s * wind_m_s * 2.0 * 0.16 * std::sqrt(0.5);
  const double torque_N_m = force_N * 0.1 * std::sqrt(0.5);
  const double found =
      csv_table(at("o/time_history.csv")).at("torque_aerodynamic_drag_x_N_m").at(0);
  EXPECT_NEAR(found, torque_N_m, 1e-4 * torque_N_m);
  EXPECT_NEAR(torque_N_m, 4.12e-6, 0.01e-6);
  // The orbit is needed.
  EXPECT_THAT(refused("propagate " + orbit + " --set 'disturbance[0]={kind=\"gravity_gradient\"}'"),
              HasSubstr("found \"aerodynamic_drag\" of a platform on the ground"));
}

// The torque is proportional to |sin 2e| at the elevation e, with a kink at e = 0 that wide steps
// round off.
TEST_F(DragCommands, ATableWithTooFewDirectionsRaisesAWarning) {
  const std::string map = "torque-map " + write_gas() + " --out " + at("map");
  EXPECT_THAT(succeed(map).out, HasSubstr("WARNING: the table: the directions are too far apart"));
  const std::string fine =
      succeed(map + " --set torque_map.azimuth_step_deg=5 --set torque_map.elevation_step_deg=5")
          .out;
  EXPECT_THAT(fine, HasSubstr("error of interpolation between the nodes: 0.00"));
  EXPECT_THAT(fine, Not(HasSubstr("WARNING")));
}

TEST_F(DragCommands, AGasFlowIsRefusedWhereThereIsLight) {
  const std::string gas = write_gas();
  EXPECT_THAT(refused("trace " + gas), HasSubstr("source: found a gas flow"));
  EXPECT_THAT(refused("torque-map " + gas + " --page"), HasSubstr("a map of a gas flow"));
  EXPECT_THAT(refused("torque-map " + gas + " --set 'source=[{kind=\"sun\"}]'"),
              HasSubstr("a source beside torque_map.molecular_flow"));
  EXPECT_THAT(
      refused("torque-map " + gas + " --set 'torque_map.molecular_flow.part=[{node=\"no_wing\"}]'"),
      HasSubstr("no_wing"));
}

}  // namespace
}  // namespace photorque

// `propagate` with light: against closed forms of a plate in sunlight, and tables against tracing.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "core/constants.h"
#include "core/transform.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double height_m = 0.1, edge_m = 0.4;  // of the plate over the centre of rotation

constexpr const char* sun = R"([[source]]
kind = "sun"
irradiance_W_m2 = 1000
angular_radius_deg = 0.27
direction = [0.6, 0, -0.8]
)";
// From above.
constexpr const char* even_sun = R"([[source]]
kind = "sun"
irradiance_W_m2 = 1000
angular_radius_deg = 0.27
direction = [0, 0, -1]
)";
// A lamp to one side.
constexpr const char* lamp = R"([[source]]
kind = "led"
name = "side"
power_W = 50
aperture_diameter_m = 0.05
profile = "gaussian"
fwhm_deg = 20
wavelength_nm = 730
position_m = [0.6, 0, 0.8]
aim_m = [0, 0, 0.1]
)";
constexpr const char* rest = R"([[receiver]]
node = "plate"
bins = [8, 8]
[array]
cells = [2, 2]
[platform]
topology = "tabletop"
mass_kg = 5
inertia_kg_m2 = [[0.08, 0, 0], [0, 0.08, 0], [0, 0, 0.15]]
tilt_limit_deg = 25
battery_capacity_Ah = 0.02
battery_voltage_V = 10
[[disturbance]]
kind = "static_unbalance"
offset_m = [0, 0, -1e-4]
[propagate]
duration_s = 40
output_rate_Hz = 2
initial_tilt_deg = 4
initial_heading_deg = 25
initial_rate_rad_s = [0.02, -0.01, 0.15]
tolerance = 1e-9
[light]
cache = ""
rays = 131072
)";

class CoupledCommand : public CommandTest {
 protected:
  std::string experiment(const std::string& source, const std::string& more = "") {
    write_plate(edge_m, height_m);
    return write("e.toml", "[scene]\nfile = \"plate.gltf\"\n" + source + rest + more);
  }

  std::map<std::string, double> events(const std::string& folder) const {
    std::map<std::string, double> all;
    for (const auto& row : csv_rows(at(folder + "/events.csv"))) {
      all.emplace(row[0], std::atof(row[1].c_str()));
    }
    return all;
  }
};

Vec3 row_of(std::map<std::string, std::vector<double>>& columns, const std::string& stem, size_t i,
            const std::string& unit) {
  return {columns.at(stem + "_x" + unit)[i], columns.at(stem + "_y" + unit)[i],
          columns.at(stem + "_z" + unit)[i]};
}

// Torques of light in a history against r × F of a black plate, which takes up E A cos/c along the
// light at its middle. `cosine`: of the angle of incidence, for the direction of the light in body
// axes and the time.
struct TorqueComparison {
  double largest = 0.0, worst = 0.0;
};
TorqueComparison compare_torques(
    std::map<std::string, std::vector<double>>& history,
    const std::function<double(const Vec3& light_body, double time_s)>& cosine) {
  TorqueComparison all;
  for (size_t i = 0; i < history.at("t_s").size(); ++i) {
    const Quat q(history.at("q_w")[i], history.at("q_x")[i], history.at("q_y")[i],
                 history.at("q_z")[i]);
    const Vec3 light = q.conjugate() * Vec3(0.6, 0, -0.8);
    const Vec3 force =
        1000.0 * edge_m * edge_m * cosine(light, history.at("t_s")[i]) / speed_of_light_m_s * light;
    const Vec3 torque = Vec3(0, 0, height_m).cross(force);
    const Vec3 found = row_of(history, "torque_radiation_pressure", i, "_N_m");
    all.largest = std::max(all.largest, torque.norm());
    all.worst = std::max(all.worst, (found - torque).norm());
  }
  return all;
}

// At every attitude and yaw.
TEST_F(CoupledCommand, TorqueOfAPlateInSlantingSunlight) {
  succeed("propagate " + experiment(sun) + " --out " + at("o"));
  auto history = csv_table(at("o/time_history.csv"));
  const TorqueComparison torques = compare_torques(
      history, [](const Vec3& light_body, double) { return std::abs(light_body.z()); });
  EXPECT_GT(torques.largest, 2e-8);
  EXPECT_LE(torques.worst, 0.01 * torques.largest);
  EXPECT_GT(csv_table(at("o/power.csv")).at("light_on_cells_W").size(), 30u);
  EXPECT_LE(figure("energy_closure", "o"), 1e-9);
}

// A plate on a joint about body y through its middle: r × F with the cosine of the turned plate,
// which follows the Sun, or a schedule that the light was traced for at some angles only. Turned
// edge-on to the light the plate's torque has a corner, which 100 attitudes do not resolve.
TEST_F(CoupledCommand, ATableThatMissesItsToleranceIsAWarning) {
  const auto warned = [&](const std::string& further) {
    const Outcome got =
        succeed("propagate " + experiment(sun) + " --set platform.tilt_limit_deg=120 " + further +
                " --out " + at("o"));
    const std::string reported = summary("o").at("warnings").dump();
    EXPECT_EQ(got.out.find("warning: ") != std::string::npos, reported != "[]") << got.out;
    return reported;
  };
  EXPECT_THAT(warned("--set light.tolerance=1e-6 --set light.max_traces=100"),
              HasSubstr("exceed light.tolerance = 1e-06 of the largest: torque by up to "));
  EXPECT_EQ(warned("--set light.tolerance=0.05"), "[]");
}

TEST_F(CoupledCommand, APlateOnAJointTakesTheLightOfItsAngle) {
  const std::string joint =
      "[[joint]]\nnode = \"plate\"\naxis = [0, 1, 0]\npoint_m = [0, 0, 0.1]\n";
  const std::string follows = joint + "towards_sun = [0, 0, 1]\n";
  const std::string scheduled = joint +
                                "positions = 7\n[[joint.at]]\ntime_s = 0\nangle_deg = -30\n"
                                "[[joint.at]]\ntime_s = 30\nangle_deg = 30\n";
  for (const bool follow : {true, false}) {
    // Within these tilts no angle of the schedule turns the plate edge-on.
    succeed("propagate " + experiment(sun, follow ? follows : scheduled) +
            " --set platform.tilt_limit_deg=8 --set light.tolerance=4e-3 --out " + at("o"));
    auto history = csv_table(at("o/time_history.csv"));
    const TorqueComparison torques =
        compare_torques(history, [&](const Vec3& light_body, double time_s) {
          const double angle = (-30.0 + 2.0 * std::min(30.0, time_s)) * degree_rad;
          return follow ? std::hypot(light_body.x(), light_body.z())
                        : -Vec3(std::sin(angle), 0, std::cos(angle)).dot(light_body);
        });
    EXPECT_GT(torques.largest, 2e-8);
    EXPECT_LE(torques.worst, 0.012 * torques.largest) << (follow ? "follows" : "scheduled");
    EXPECT_LE(figure("energy_closure", "o"), 1e-9);
    // No more than all light that a plate square to the Sun takes; when it follows, the cosine of
    // 0.6 across the joint, turned by the yaw, and of a few degrees of tilt.
    const auto cells = csv_table(at("o/power.csv")).at("light_on_cells_W");
    const double most_W = 1000.0 * edge_m * edge_m;
    EXPECT_LE(std::ranges::max(cells), 1.002 * most_W);
    const double least_W = follow ? 0.74 * most_W : 0.0;
    EXPECT_GT(std::ranges::min(cells), least_W);
  }
  refused("propagate " + experiment(sun, follows + follows) + " --out " + at("two"));
}

// A table that forgot the yaw would give the same body torque after a quarter turn.
TEST_F(CoupledCommand, TableAndTraceAgreeUnderALampToOneSide) {
  const std::string file = experiment(lamp);
  const Outcome tabled = succeed("propagate " + file + " --verbose --out " + at("table"));
  EXPECT_THAT(tabled.out, HasSubstr("depends on the yaw"));
  succeed("propagate " + file + " --set 'light.mode=\"trace\"' --out " + at("trace"));
  auto a = csv_table(at("table/time_history.csv")), b = csv_table(at("trace/time_history.csv"));
  ASSERT_EQ(a.at("t_s").size(), b.at("t_s").size());
  double largest = 0.0, apart = 0.0, turned = 0.0, heading_range = 0.0;
  for (size_t i = 0; i < a.at("t_s").size(); ++i) {
    const Vec3 one = row_of(a, "torque_radiation_pressure", i, "_N_m");
    const Vec3 other = row_of(b, "torque_radiation_pressure", i, "_N_m");
    largest = std::max(largest, one.norm());
    // The continuation has two traces behind it after two seconds.
    if (a.at("t_s")[i] >= 3.0) apart = std::max(apart, (one - other).norm());
    turned = std::max(turned, std::abs(a.at("q_z")[i] - b.at("q_z")[i]));
    heading_range = std::max(heading_range, std::abs(a.at("q_z")[i] - a.at("q_z")[0]));
  }
  EXPECT_GT(heading_range, 0.9);  // through half a turn and more
  EXPECT_LE(apart, 0.03 * largest);
  EXPECT_LE(turned, 1e-6);
  const double one_W = figure("mean_array_power_W", "table");
  const double other_W = figure("mean_array_power_W", "trace");
  EXPECT_GT(one_W, 0.5);
  EXPECT_NEAR(one_W / other_W, 1.0, 2e-3);
}

// A level platform at rest under an even Sun: constant power, so that every event has its instant.
TEST_F(CoupledCommand, EventsComeAtTheirInstants) {
  const std::string day = R"([array.day]
load_W = 6
converter_efficiency = 0.9
charge_efficiency = 0.8
discharge_efficiency = 0.9
battery_charge = 0.5
[[light.switch]]
time_s = 100.25
on = false
[[light.switch]]
time_s = 300.5
on = true
)";
  succeed("propagate " + experiment(even_sun, day) +
          " --set propagate.initial_tilt_deg=0 --set propagate.initial_rate_rad_s=[0,0,0]"
          " --set propagate.duration_s=400 --set array.temperature_K=298.15 --out " +
          at("o"));
  auto power = csv_table(at("o/power.csv"));
  const double array_W = power.at("best_power_W")[0];
  const double surplus_W = 0.9 * array_W - 6.0, capacity_J = 0.02 * 3600 * 10;
  ASSERT_GT(surplus_W, 10.0);
  const auto all = events("o");
  EXPECT_NEAR(all.at("battery_full"), 0.5 * capacity_J / (0.8 * surplus_W), 1e-3);
  EXPECT_NEAR(all.at("sun_off"), 100.25, 1e-9);
  EXPECT_NEAR(all.at("light_lost"), 100.25, 1e-9);
  EXPECT_NEAR(all.at("battery_not_full"), 100.25, 1e-9);
  EXPECT_NEAR(all.at("battery_empty"), 100.25 + capacity_J * 0.9 / 6.0, 1e-6);
  EXPECT_NEAR(all.at("light_returns"), 300.5, 1e-9);
  EXPECT_NEAR(all.at("battery_not_empty"), 300.5, 1e-9);
  EXPECT_LE(figure("energy_closure", "o"), 1e-9);
  EXPECT_NEAR(figure("load_unserved_J", "o"), 6.0 * (300.5 - 100.25 - capacity_J * 0.9 / 6.0),
              1e-6);
}

// A level plate at rest under an even Sun: the run ends in the steady state of `power`, in still
// air and in orbit's surroundings alike.
TEST_F(CoupledCommand, CellsEndInTheSteadyStateOfPower) {
  const std::string file = experiment(even_sun, "[array.thermal]\ncapacity_J_m2_K = 200\n");
  for (const std::string around :
       {"", " --set array.thermal.convection_W_m2_K=0 --set array.thermal.surroundings_K=3"}) {
    succeed("power " + file + around + " --out " + at("p"));
    const Outcome moving =
        succeed("propagate " + file + around +
                " --set propagate.initial_tilt_deg=0 --set propagate.initial_rate_rad_s=[0,0,0]"
                " --set propagate.duration_s=400 --out " +
                at("o"));
    const double steady_K = figure("cell_temperature_K", "p");
    EXPECT_GT(steady_K, 295.0);
    EXPECT_NEAR(figure("cell_temperature_K", "o"), steady_K, 0.02);
    const double steady_W = figure("array_power_W", "p");
    EXPECT_NEAR(csv_table(at("o/power.csv")).at("array_power_W").back(), steady_W, 1e-3 * steady_W);
    EXPECT_THAT(moving.out, HasSubstr("cells at the end"));
  }
}

// Whatever the platform and its start: a run in light ends at its time, or at the platform's own
// stop, never at the edge of a table.
TEST_F(CoupledCommand, NoRunEndsAtTheEdgeOfATable) {
  std::mt19937_64 random(20261127);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::filesystem::rename(experiment(sun), at("sunny.toml"));
  const std::string lit = experiment(lamp);
  size_t wider = 0;
  constexpr int runs = 8;
  for (int i = 0; i < runs; ++i) {
    const bool has_stop = i % 3 == 0;
    const double stop_deg = has_stop ? between(8.0, 40.0) : 90.0;
    const std::vector<std::pair<std::string, double>> numbers = {
        {"platform.mass_kg", between(1.0, 10.0)},
        {"platform.tilt_limit_deg", stop_deg},
        {"propagate.initial_tilt_deg", between(0.5, 7.0)},
        {"propagate.initial_heading_deg", between(0.0, 360.0)},
        {"propagate.tolerance", std::pow(10.0, between(-9.0, -4.0))},
        {"propagate.duration_s", 120.0},
        {"propagate.output_rate_Hz", 0.5},
        {"light.step_s", between(0.2, 20.0)},
        {"light.tolerance", 0.05},
        {"light.rays", 256.0},
        {"light.max_traces", 100.0}};
    std::string words = "propagate " + (i % 2 == 0 ? lit : at("sunny.toml"));
    for (const auto& [key, value] : numbers) {
      char text[40];
      std::snprintf(text, sizeof text, "%.9g", value);
      words += " --set " + key + "=" + text;
    }
    words += " --set 'propagate.initial_rate_rad_s=[" + std::to_string(between(-0.03, 0.03)) + "," +
             std::to_string(between(-0.03, 0.03)) + "," + std::to_string(between(-0.2, 0.2)) + "]'";
    // Top-heavy under the lamp: it falls over, through every table.
    if (i % 2 == 0) words += " --set 'disturbance[0].offset_m=[0,0,1e-4]'";
    if (i % 4 == 0) words += " --set light.max_tilt_deg=" + std::to_string(between(1.0, 20.0));
    const Outcome got = succeed(words + " --out " + at("o"));
    wider += got.out.find("repeated with a wider table") != std::string::npos ? 1 : 0;
    const double end_s = csv_table(at("o/time_history.csv")).at("t_s").back();
    if (end_s > 119.0) continue;
    ASSERT_TRUE(std::filesystem::exists(at("o/events.csv"))) << words;
    EXPECT_THAT(file_text(at("o/events.csv")), HasSubstr("tilt_stop")) << words;
  }
  EXPECT_GE(wider, 2u);  // so that the edge was met
}

TEST_F(CoupledCommand, ATableIsKeptByTheContentOfItsInputs) {
  const std::string file = experiment(sun);
  const std::string cached = " --set light.cache=kept --set propagate.duration_s=2 --out ";
  const Outcome first = succeed("propagate " + file + cached + at("a"));
  EXPECT_THAT(first.out, HasSubstr("attitudes traced in"));
  // Neither the platform nor the load changes the light; the same numbers come back.
  const Outcome again = run("propagate " + file + cached + at("b"));
  EXPECT_THAT(again.out, HasSubstr("stored by an earlier run"));
  EXPECT_EQ(files("a").at("time_history.csv"), files("b").at("time_history.csv"));
  const Outcome heavier = run("propagate " + file + cached + at("c") + " --set platform.mass_kg=6");
  EXPECT_THAT(heavier.out, HasSubstr("stored by an earlier run"));
  const Outcome brighter =
      run("propagate " + file + cached + at("d") + " --set source[0].irradiance_W_m2=900");
  EXPECT_THAT(brighter.out, HasSubstr("attitudes traced in"));
  // Another scene under the same name.
  std::string text = file_text(at("plate.gltf"));
  write("plate.gltf", text.replace(text.find("\"black\""), 7, "\"matte\""));
  EXPECT_THAT(run("propagate " + file + cached + at("e")).out, HasSubstr("attitudes traced in"));
}

TEST_F(CoupledCommand, WrongInputIsOneLine) {
  const std::string file = experiment(sun);
  const std::pair<std::string, std::string> cases[] = {
      {"'light.mode=\"tables\"'", "light.mode"},
      {"light.tolerance=2", "light.tolerance: found 2"},
      {"light.speed=2", "light.speed"},
      {"'light.switch=[{time_s=3,on=false,source=\"moon\"}]'",
       "light.switch.source: found \"moon\""},
      {"'disturbance=[{kind=\"power_balance\",load_W=3}]'", "disturbance[0].kind"},
  };
  for (const auto& [set, expected] : cases) {
    EXPECT_THAT(refused("propagate " + file + " --set " + set + " --out " + at("o")),
                HasSubstr(expected))
        << set;
  }
}

}  // namespace
}  // namespace photorque

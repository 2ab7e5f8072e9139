// The commands budget, propagate and balance as a user meets them.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/outside.h"
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const fs::path source = PHOTORQUE_SOURCE_DIR;

class AttitudeCommands : public CommandTest {};

constexpr const char* pendulum = R"([platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
[[disturbance]]
kind = "static_unbalance"
offset_m = [2e-6, -1e-6, -3e-5]
[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = 1.5e-5
[sensors.camera]
noise_arcsec = [37, 37, 12]
[sensors.gyro]
noise_rad_s = 2e-4
[propagate]
duration_s = 400
initial_tilt_deg = 6
initial_rate_rad_s = [0.01, -0.005, 0.08]
[balance]
moving_mass_kg = 0.25
lead_mm = 2
)";

// A satellite at rest above a place on the equator, from ten seconds after the first state of its
// orbit on: by the epoch of the attitude.
TEST_F(AttitudeCommands, PropagatesInAnOrbitFromMessages) {
  for (const char* name : {"states.oem", "attitude.apm"}) {
    fs::copy_file(source / "tests/data/keys" / name, at(name));
  }
  const std::string experiment = write("sat.toml", R"([platform]
topology = "free"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
[[disturbance]]
kind = "orbit"
ephemeris = "states.oem"
[[disturbance]]
kind = "gravity_gradient"
[propagate]
duration_s = 60
initial_apm = "attitude.apm"
)");
  succeed("propagate " + experiment + " --out " + at("o"));
  const auto all = files("o");
  EXPECT_THAT(all.at("attitude.aem"), HasSubstr("START_TIME      = 2026-01-01T00:00:10"));
  EXPECT_THAT(all.at("time_history.csv"), HasSubstr("\n0,0.8,0.6,0,0,"));
  EXPECT_THAT(all.at("summary.json"), HasSubstr("states.oem"));
  const auto refusal = [&](const std::string& setting) {
    return refused("propagate " + experiment + " --set " + setting);
  };
  EXPECT_THAT(refusal("propagate.duration_s=400"),
              HasSubstr("an end 110 s after the ephemeris, expected a run between "
                        "2026-01-01T00:00:00.000000 and 2026-01-01T00:05:00.000000 UTC"));
  EXPECT_THAT(refusal("propagate.epoch=\\\"2026-01-01T00:04:30\\\""), HasSubstr("an end 30 s"));
  EXPECT_THAT(refusal("propagate.initial_time_s=-20"), HasSubstr("a start 10 s before"));
  EXPECT_THAT(refusal("propagate.initial_apm=states.oem"), HasSubstr("CCSDS_APM_VERS"));
  EXPECT_THAT(refusal("disturbance[0].ephemeris=absent.oem"), HasSubstr("absent.oem"));
  // Stated keys take precedence, and a budget stands in the same orbit.
  const Outcome stated = run("propagate " + experiment +
                             " --set propagate.initial_attitude=[1,0,0,0] --out " + at("p"));
  EXPECT_THAT(files("p").at("time_history.csv"), HasSubstr("\n0,1,0,0,0,")) << stated.err;
  succeed("budget " + experiment + " --out " + at("b"));
}

TEST_F(AttitudeCommands, PropagateWritesTheFilesOfTheContract) {
  succeed("propagate " + attitude_file + " --set propagate.duration_s=30 --out " + at("o"));
  const auto all = files("o");
  for (const char* name :
       {"summary.json", "time_history.csv", "recording.csv", "attitude.aem", "run.h5", "tilt.png",
        "yaw.png", "rates.png", "torques.png", "torque_fractions.png",
        "torque_static_unbalance.png", "torque_radiation_pressure.png"}) {
    EXPECT_TRUE(all.contains(name)) << name;
  }
  EXPECT_FALSE(all.contains("tilt.svg"));
  EXPECT_THAT(all.at("recording.csv"), HasSubstr("\nt_s,q_w,q_x,q_y,q_z,gyro_x_rad_s"));
  EXPECT_THAT(all.at("attitude.aem"), HasSubstr("CCSDS_AEM_VERS = 1.0"));
  EXPECT_THAT(all.at("recording.csv"), HasSubstr("light_torque.csv:"));
}

// A recording that propagate made, given to balance, gives back the offset that made it; the steps
// leave at most about one step along each axis.
TEST_F(AttitudeCommands, BalanceFindsTheOffsetThatMadeTheRecording) {
  const std::string experiment = write("p.toml", pendulum);
  succeed("propagate " + experiment + " --out " + at("p"));
  const Outcome got =
      succeed("balance " + experiment + " --recording " + at("p") +
              "/recording.csv --set disturbance[0].offset_m=[0,0,0] --json --out " + at("b"));
  const json summary = json::parse(got.out);
  const std::map<std::string, double> truth = {
      {"offset_x_m", 2e-6}, {"offset_y_m", -1e-6}, {"offset_z_m", -3e-5}};
  for (const auto& [name, offset_m] : truth) {
    const double sigma_m = summary.at(name).at("standard_error").get<double>();
    EXPECT_NEAR(value(summary, name), offset_m, 4.5 * sigma_m) << name;
    EXPECT_LT(sigma_m, 2e-8) << name;
  }
  EXPECT_NEAR(value(summary, "chi2_per_sample"), 1.0, 0.05);
  // Half a step of 200 on 2 mm with 0.25 kg of 8 kg.
  EXPECT_NEAR(value(summary, "resolution_m"), 0.5 * 1e-5 * 0.25 / 8.0, 1e-12);
  EXPECT_LT(value(summary, "left_by_steps_m"), 2 * std::sqrt(3.0) * 1.5625e-7);
  EXPECT_TRUE(files("b").contains("balance_residuals.png"));
}

TEST_F(AttitudeCommands, BudgetRanksAndComparesWithThePaper) {
  const Outcome got =
      succeed("budget " + attitude_file + " --verbose --format svg --out " + at("o"));
  const size_t unbalance = got.out.find("static_unbalance"), light = got.out.find("radiation_pr");
  EXPECT_LT(unbalance, light);
  EXPECT_THAT(got.out, HasSubstr("com_resolution_m"));
  EXPECT_THAT(got.out, HasSubstr("array_power_at_30_deg_W"));
  EXPECT_THAT(got.out, HasSubstr("Faraday's constant"));
  const auto all = files("o");
  for (const char* name : {"budget.csv", "paper_figures.csv", "elastic_torque_by_tilt.png",
                           "elastic_torque_by_tilt.svg", "torque_by_tilt.png"}) {
    EXPECT_TRUE(all.contains(name)) << name;
  }
}

// The paper's figures are those of one platform.
TEST_F(AttitudeCommands, BudgetOfAnotherPlatformIsNotComparedWithThePaper) {
  const std::string orbit = (source / "scenes/spacecraft/orbit.toml").string();
  const Outcome got = succeed("budget " + orbit + " --out " + at("o"));
  EXPECT_THAT(got.out, HasSubstr("Disturbance torques, largest first"));
  EXPECT_THAT(got.out, testing::Not(HasSubstr("paper")));
  const auto all = files("o");
  EXPECT_TRUE(all.contains("budget.csv"));
  EXPECT_FALSE(all.contains("paper_figures.csv"));
  EXPECT_THAT(all.at("budget.csv"), testing::Not(HasSubstr("paper")));
}

// The planet's light has the Sun of the orbit in every command, and the orbit itself no torque.
TEST_F(AttitudeCommands, BudgetRanksTheLightOfThePlanet) {
  // The torque z × s of light from the direction s.
  std::string table = "azimuth_deg,elevation_deg,torque_x_N_m,torque_y_N_m,torque_z_N_m\n";
  for (int azimuth = -180; azimuth <= 180; azimuth += 30) {
    for (int elevation = -90; elevation <= 90; elevation += 30) {
      const double degree = std::numbers::pi / 180.0, a = azimuth * degree, e = elevation * degree;
      table += std::to_string(azimuth) + "," + std::to_string(elevation) + "," +
               std::to_string(-std::cos(e) * std::sin(a)) + "," +
               std::to_string(std::cos(e) * std::cos(a)) + ",0\n";
    }
  }
  write("table.csv", table);
  const std::string experiment =
      write("orbit.toml",
            "[platform]\ntopology = \"free\"\nmass_kg = 50\n"
            "inertia_kg_m2 = [[4, 0, 0], [0, 3, 0], [0, 0, 2]]\n"
            "[[disturbance]]\nkind = \"orbit\"\naltitude_m = 600e3\ninclination_deg = 97.8\n"
            "date_year = 2026\nsun_direction = [0.3, 0.9, 0.3]\n"
            "[[disturbance]]\nkind = \"planet_light\"\ntable = \"table.csv\"\n");
  for (const std::string& command :
       {std::string("check "), "budget --format svg --out " + at("o") + " "}) {
    succeed(command + experiment);
  }
  const auto all = files("o");
  EXPECT_THAT(all.at("budget.csv"), HasSubstr("\nplanet_light,"));
  EXPECT_THAT(all.at("torque_by_tilt.svg"), HasSubstr(">planet_light<"));
  EXPECT_THAT(all.at("torque_by_tilt.svg"), testing::Not(HasSubstr(">orbit<")));
}

// tests/attitude/run_test.cpp has more.
TEST_F(AttitudeCommands, WrongInputIsOneLineAndExitTwo) {
  struct Case {
    const char *from, *to, *message;
  };
  const std::vector<Case> cases = {
      {"[sensors.camera]", "[sensor.camera]", "expected a known key, perhaps \"sensors\""},
      {"noise_arcsec", "noise_parsec", "sensors.camera.noise_parsec"},
      {"offset_m = [2e-6", "offset_m = [nan", "disturbance[0].offset_m: found nan"},
      {"duration_s = 400", "duration_s = 1e12", "propagate.duration_s: found 1e+12"},
      {"duration_s = 400", "epoch = \"yesterday\"", "propagate.epoch: found \"yesterday\""},
  };
  for (const Case& c : cases) {
    std::string text = pendulum;
    text.replace(text.find(c.from), std::string(c.from).size(), c.to);
    EXPECT_THAT(refused("propagate " + write("p.toml", text) + " --out " + at("o")),
                HasSubstr(c.message));
    EXPECT_FALSE(fs::exists(at("o"))) << c.to;
  }
  const std::string experiment = write("p.toml", pendulum);
  EXPECT_EQ(run("balance " + experiment).status, 2);
  EXPECT_EQ(run("balance " + experiment + " --recording /no/such.csv").status, 2);
  EXPECT_EQ(run("propagate " + experiment + " --set propagate.commands=no_such.csv").status, 2);
  write("c.csv", "t_s,command_x_N_m\n0,0\n2,1e-4\n1,0\n");
  EXPECT_THAT(refused("propagate " + experiment + " --set propagate.commands=c.csv"),
              HasSubstr("c.csv:4: t_s"));
}

// Recordings that another program made, in another language, with another integrator: with the
// injected effect of each case put into the experiment, the whole trajectory fits to its noise.
TEST_F(AttitudeCommands, RecordingsOfAnotherSimulatorFitToTheirNoise) {
  const fs::path cases = photorque::outside::reference_data("cases");
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(cases)) {
    if (!fs::exists(entry.path() / "truth.json")) continue;
    const json truth = json::parse(file_text(entry.path() / "truth.json"));
    if (truth.at("verdict") == "unexplained") continue;
    std::string text = file_text(entry.path() / "experiment.toml");
    for (const json& effect : truth.at("effects")) {
      text += "\n[[disturbance]]\n";
      for (const auto& [key, number] : effect.items()) {
        const std::string name = key == "attitude_latency_s" ? "latency_s" : key;
        text += name + " = " + number.dump() + "\n";
      }
    }
    text += "[balance]\nmoving_mass_kg = 0.25\nlead_mm = 2\n";
    const Outcome got =
        succeed("balance " + write("case.toml", text) + " --recording " +
                (entry.path() / "run1.csv.gz").string() + " --json --out " + at("o"));
    // Some 28,000 numbers: the standard error of chi² per sample is √(2/28000) = 0.0085.
    EXPECT_NEAR(value(json::parse(got.out), "chi2_per_sample"), 1.0, 5 * 0.0085) << entry.path();
    ++compared;
  }
  EXPECT_GE(compared, 11);
}

// Neither an unread key nor a torque that is the same at every tilt but for rounding.
TEST_F(AttitudeCommands, ABudgetEndsAndReadsItsKeys) {
  const std::string platform =
      "[platform]\ntopology = \"tabletop\"\nmass_kg = 7\ninertia_kg_m2 = [[0.09, 0, 0], [0, "
      "0.09, 0], [0, 0, 0.17]]\n[[disturbance]]\nkind = \"turbine_torque\"\ntorque_N_m = 1e-6\n";
  succeed("budget " + write("b.toml", platform) + " --out " + at("o"));
  for (const char* key : {"budget.tlit_deg=10", "budget.light.foo=1"}) {
    EXPECT_THAT(refused("budget " + attitude_file + " --set " + key + " --out " + at("m")),
                HasSubstr("an unknown key"))
        << key;
  }
}

}  // namespace
}  // namespace photorque

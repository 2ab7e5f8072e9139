// Files of `diagnose` work where they lie, and its recordings are of one kind.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;

// A table of which every row ends in the same cells more.
std::string with_columns(const std::string& table, const std::string& names,
                         const std::string& cells) {
  std::istringstream rows(table);
  std::string row, wider;
  bool is_header = true;
  while (std::getline(rows, row)) {
    if (row.starts_with('#')) continue;
    wider += row + (std::exchange(is_header, false) ? names : cells) + "\n";
  }
  return wider;
}

class DiagnoseCommand : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    write("sun.csv", "t_s,sun_x,sun_y,sun_z\n0,1,0,0\n50,1,0.1,0\n100,1,0.2,0\n");
    // A file with the name of a node is no reason to call the node by a path.
    write("panel", "");
    experiment_ = write("lab.toml", R"([platform]
topology = "free"
mass_kg = 10
inertia_kg_m2 = [[0.5, 0, 0], [0, 0.6, 0], [0, 0, 0.7]]
[environment.sun]
table = 'sun.csv' # beside this file
[sensors.camera]
noise_arcsec = [30, 30, 30]
[sensors.gyro]
noise_rad_s = 2e-4
[propagate]
duration_s = 30
initial_rate_rad_s = [0.01, 0.02, 0.05]
)");
    succeed("propagate " + experiment_ + " --quiet -o " + at("propagated"));
    recording_ = at("propagated/recording.csv");
  }

  std::string experiment_, recording_;
};

TEST_F(DiagnoseCommand, ImprovedExperimentsFindTheirFiles) {
  succeed("diagnose " + experiment_ + " --recording " + recording_ + " --quiet --out " +
          at("deep/down/answer"));
  EXPECT_THAT(file_text(at("deep/down/answer/improved.toml")), HasSubstr("../../../sun.csv"));
  succeed("propagate " + at("deep/down/answer/improved.toml") + " --quiet --out " + at("again"));
}

TEST_F(DiagnoseCommand, ImprovedExperimentsHaveTheChangesOfTheCommandLine) {
  succeed("diagnose " + experiment_ + " --recording " + recording_ +
          " --set platform.mass_kg=12 --set environment.gravity_m_s2=0 --quiet "
          "--out " +
          at("answer"));
  const std::string improved = file_text(at("answer/improved.toml"));
  EXPECT_THAT(improved, HasSubstr("mass_kg = 12"));
  EXPECT_THAT(improved, HasSubstr("gravity_m_s2 = 0"));
  succeed("propagate " + at("answer/improved.toml") + " --quiet --out " + at("again"));
}

TEST_F(DiagnoseCommand, FiguresAreWrittenInTheFormatsThatAreAskedFor) {
  const std::string command = "diagnose " + experiment_ + " --recording " + recording_ +
                              " --quiet --style paper --out " + at("answer");
  succeed(command);
  EXPECT_FALSE(std::filesystem::exists(at("answer/gyro_z_rad_s.svg")));
  succeed(command + " --format svg,pdf");
  EXPECT_TRUE(std::filesystem::exists(at("answer/diagnosis.json")));
  EXPECT_THAT(file_text(at("answer/gyro_z_rad_s.svg")), HasSubstr("nominal model"));
  EXPECT_THAT(file_text(at("answer/gyro_z_rad_s.pdf")), HasSubstr("%PDF-"));
  EXPECT_THAT(refused(command + " --format jpg"), HasSubstr("found \"jpg\", expected"));
}

// A voltage and a current beside the motion do not make the recording one of light.
TEST_F(DiagnoseCommand, ALogWithVoltageAndCurrentIsOfMotion) {
  const std::string log =
      write("log.csv", with_columns(file_text(recording_), ",voltage_V,current_A", ",12,0.5"));
  succeed("diagnose " + experiment_ + " --recording " + log + " --quiet --out " + at("log"));
  EXPECT_THAT(file_text(at("log/diagnosis.json")), HasSubstr("gyro_z_rad_s"));
}

TEST_F(DiagnoseCommand, RecordingsOfTwoKindsAreListedByName) {
  const std::string curve = write("curve.csv", "voltage_V,current_A\n0,1\n0.3,0.9\n0.5,0\n");
  for (const std::string& both : {"--recording " + recording_ + " --recording " + curve,
                                  "--recording " + recording_ + " --holdout " + curve}) {
    EXPECT_THAT(refused("diagnose " + experiment_ + " " + both + " --quiet --out " + at("answer")),
                HasSubstr("curve.csv: found column names of light"));
  }
  EXPECT_THAT(refused("diagnose " + experiment_ + " --recording " + recording_ + " " + curve +
                      " --out " + at("answer")),
              HasSubstr("repeat --recording before each of several"));
}

// A plate that turns under a lamp straight above it, on a platform that nothing else acts on: what
// `propagate` recorded of its motion, beside the maximum that `power` gives at every attitude.
TEST_F(DiagnoseCommand, AScenePlatformAndARunOfTheArrayAreOneAnswer) {
  write("plate.obj",
        "o array\nv -0.05 -0.05 0\nv 0.05 -0.05 0\nv 0.05 0.05 0\nv -0.05 0.05 0\nf 1 2 3 4\n");
  const std::string lab = write("both.toml", R"([scene]
file = "plate.obj"
unit = "m"
[[source]]
kind = "led_array"
layout = "grid"
count = [1, 1]
pitch_m = [0.1, 0.1]
position_m = [0, 0, 1]
direction = [0, 0, -1]
power_W = 5
aperture_diameter_m = 0.02
profile = "gaussian"
fwhm_deg = 10
wavelength_nm = 730
[[receiver]]
kind = "flux_map"
node = "array"
facing = [0, 0, 1]
[trace]
rays = 200000
[array]
receiver = "array"
cells = [1, 1]
gap_m = 0
margin_m = 0
strings = 1
bypass_every = 1
bypass = "ideal"
[array.bypass_diode]
drop_V = 0.5
[array.quantum_efficiency]
wavelength_nm = [600, 860]
efficiency = [0.9, 0.9]
[array.cell_parameters]
reference_area_m2 = 0.01
reference_temperature_K = 298.15
saturation_1_A = 1e-11
saturation_2_A = 0
ideality_1 = 1
series_ohm = 0.01
shunt_ohm = 100
breakdown_fraction = 0
gap_eV = 1.121
gap_slope_per_K = -0.0002677
photocurrent_slope_per_K = 0.0004
[platform]
topology = "tabletop"
mass_kg = 7
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
[environment]
gravity_m_s2 = 9.80665
[[disturbance]]
kind = "static_unbalance"
offset_m = { value = [0, 0, -1e-5], sigma = [1e-7, 1e-7, 1e-7] }
[sensors.camera]
noise_arcsec = [30, 30, 30]
[sensors.gyro]
noise_rad_s = 2e-4
[sensors.array]
voltage_noise_V = 0.002
current_noise_A = 0.01
[light]
mode = "off"
[propagate]
duration_s = 30
initial_rate_rad_s = [0, 0, 0.05]
)");
  succeed("power " + lab + " --quiet --out " + at("power"));
  succeed("propagate " + lab + " --quiet --out " + at("propagated"));
  const auto power = nlohmann::json::parse(file_text(at("power/summary.json")));
  const auto figure = [&](const char* name) { return power[name]["value"].dump(); };
  const std::string both = write(
      "run.csv",
      with_columns(file_text(at("propagated/recording.csv")), ",array_voltage_V,array_current_A",
                   "," + figure("array_voltage_V") + "," + figure("array_current_A")));
  succeed("diagnose " + lab + " --recording " + both + " --quiet --out " + at("answer"));
  const auto json = nlohmann::json::parse(file_text(at("answer/diagnosis.json")));
  EXPECT_EQ(json["verdict"], "consistent") << json["sentence"];
  ASSERT_EQ(json["domains"].size(), 2u);
  EXPECT_EQ(json["domains"][0]["of"], "motion");
  EXPECT_EQ(json["domains"][1]["of"], "light");
  EXPECT_THAT(file_text(at("answer/report.html")), HasSubstr("array_voltage_V"));
  succeed("check " + at("answer/improved.toml"));
  // No light among the recordings, no light held out.
  EXPECT_THAT(refused("diagnose " + lab + " --recording " + at("propagated/recording.csv") +
                      " --holdout " + both + " --quiet --out " + at("answer")),
              HasSubstr("run.csv: found column names of light"));
}

TEST_F(DiagnoseCommand, AnExperimentWithoutACommandIsReported) {
  EXPECT_THAT(refused(experiment_), HasSubstr("expected a command before it"));
}

}  // namespace
}  // namespace photorque

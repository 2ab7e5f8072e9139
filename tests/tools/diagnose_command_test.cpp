// What `diagnose` writes works where it lies, and what it is given is of one kind.
#include <gmock/gmock.h>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;

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
    const Outcome flown = run("propagate " + experiment_ + " --quiet -o " + at("flown"));
    ASSERT_EQ(flown.status, 0) << flown.err;
    recording_ = at("flown/recording.csv");
  }

  std::string experiment_, recording_;
};

TEST_F(DiagnoseCommand, WhatItImprovesFindsItsFilesFromItsFolder) {
  const Outcome found = run("diagnose " + experiment_ + " --recording " + recording_ +
                            " --quiet --out " + at("deep/down/answer"));
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(file_text(at("deep/down/answer/improved.toml")), HasSubstr("../../../sun.csv"));
  const Outcome again =
      run("propagate " + at("deep/down/answer/improved.toml") + " --quiet --out " + at("again"));
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(DiagnoseCommand, WhatItImprovesHasTheChangesOfTheCommandLine) {
  const Outcome found = run("diagnose " + experiment_ + " --recording " + recording_ +
                            " --set platform.mass_kg=12 --set environment.gravity_m_s2=0 --quiet "
                            "--out " +
                            at("answer"));
  ASSERT_EQ(found.status, 0) << found.err;
  const std::string improved = file_text(at("answer/improved.toml"));
  EXPECT_THAT(improved, HasSubstr("mass_kg = 12"));
  EXPECT_THAT(improved, HasSubstr("gravity_m_s2 = 0"));
  const Outcome again =
      run("propagate " + at("answer/improved.toml") + " --quiet --out " + at("again"));
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(DiagnoseCommand, RecordingsOfTwoKindsAreToldByName) {
  const std::string curve = write("curve.csv", "voltage_V,current_A\n0,1\n0.3,0.9\n0.5,0\n");
  for (const std::string& both : {"--recording " + recording_ + " --recording " + curve,
                                  "--recording " + recording_ + " --holdout " + curve}) {
    const Outcome found =
        run("diagnose " + experiment_ + " " + both + " --quiet --out " + at("answer"));
    EXPECT_EQ(found.status, 2);
    EXPECT_THAT(found.err, HasSubstr("curve.csv: found a recording of light"));
  }
  const Outcome list = run("diagnose " + experiment_ + " --recording " + recording_ + " " + curve +
                           " --out " + at("answer"));
  EXPECT_EQ(list.status, 2);
  EXPECT_THAT(list.err, HasSubstr("repeat --recording before each of several"));
}

TEST_F(DiagnoseCommand, AnExperimentWithoutACommandIsToldSo) {
  const Outcome alone = run(experiment_);
  EXPECT_EQ(alone.status, 2);
  EXPECT_THAT(alone.err, HasSubstr("expected a command before it"));
}

}  // namespace
}  // namespace photorque

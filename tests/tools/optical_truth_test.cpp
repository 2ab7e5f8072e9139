// Scenes on which a wrong number, or a false alarm, once stood without a word.
#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class OpticalTruth : public CommandTest {
 protected:
  // A black plate of 1 m² in the sun, with more keys.
  std::string plate(const std::string& direction, const std::string& more,
                    const std::string& faces = "f 1 2 3 4\n", const std::string& at = "") const {
    write("plate.obj", "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\no plate\n" + faces);
    return write("plate.toml",
                 "[scene]\nfile = \"plate.obj\"\nunit = \"m\"\n" + at +
                     "[[material]]\nname = \"plate\"\nabsorptance = 1\n[[source]]\nkind = \"sun\"\n"
                     "direction = " +
                     direction + "\nirradiance_W_m2 = 1000\nangular_radius_deg = 0\n" + more);
  }
};

TEST_F(OpticalTruth, EdgeOnLightRaisesNoWarning) {
  const Outcome traced =
      succeed("trace " + plate("[1, 0, 0]", "[trace]\nrays = 65536\n") + " --out " + at("o"));
  succeed("check " + at("plate.toml"));
  EXPECT_THAT(traced.out + traced.err, Not(HasSubstr("WARNING")));
}

// Sobol points meet the plate equally often in all replicates, each off by a fraction of a ray.
TEST_F(OpticalTruth, CountsThatAgreeByChanceRaiseNoWarning) {
  for (const char* rays : {"32768", "65536"}) {
    const Outcome traced =
        succeed("trace " + plate("[0, 0, -1]", std::string("[trace]\nrays = ") + rays) + " --out " +
                at("o"));
    EXPECT_THAT(traced.out + traced.err, Not(HasSubstr("WARNING"))) << rays;
  }
}

// The largest force is that of 1 m², and the torque is zero in every direction.
TEST_F(OpticalTruth, ASheetDrawnFromBothSidesCountsOnceAndRaisesNoWarning) {
  const std::string file =
      plate("[0, 0, -1]", "[torque_map]\nazimuth_step_deg = 90\nelevation_step_deg = 30\n",
            "f 1 2 3 4\nf 4 3 2 1\n");
  succeed("check " + file);
  const Outcome map = succeed("torque-map " + file + " --out " + at("o"));
  EXPECT_THAT(map.out, HasSubstr("largest force    3.3356×10⁻⁶ N, divided by the pressure 1 m2"));
  EXPECT_THAT(map.out, HasSubstr("coincide back to back"));
  EXPECT_THAT(map.out + map.err, Not(HasSubstr("WARNING")));
}

TEST_F(OpticalTruth, ShippedScenesRaiseNoWarning) {
  int traced = 0;
  const fs::path scenes = fs::path(PHOTORQUE_SOURCE_DIR) / "scenes";
  for (const auto& file : fs::recursive_directory_iterator(scenes)) {
    if (file.path().extension() != ".toml") continue;
    if (file_text(file.path()).find("[[source]]") == std::string::npos) continue;
    const Outcome got =
        succeed("trace " + file.path().string() + " --out " + at("o") + " --set trace.rays=65536");
    EXPECT_THAT(got.out + got.err, Not(HasSubstr("WARNING"))) << file.path();
    ++traced;
  }
  EXPECT_GE(traced, 11);
}

TEST_F(OpticalTruth, TorqueMapOverTiltsNeedsNoReceiver) {
  succeed("torque-map " +
          plate("[0, 0, -1]", "[torque_map]\ntilt_deg = [0, 30]\nheading_deg = [0]\n") + " --out " +
          at("o"));
}

// A black plate of 1 mm² whose corners are written 10 km from the origin takes up 1000 W/m² and has
// its force there; the torque is 10 km times the force.
TEST_F(OpticalTruth, SunlightOnAMillimetreTenKilometresAwayIsRight) {
  const std::string file =
      write("far.toml",
            "[scene]\nfile = \"far.obj\"\nunit = \"m\"\n[[material]]\nname = \"far\"\n"
            "absorptance = 1\n[[source]]\nkind = \"sun\"\ndirection = [0, 0, -1]\n"
            "irradiance_W_m2 = 1000\nangular_radius_deg = 0\n"
            "[[receiver]]\nnode = \"plate\"\nbins = [2, 2]\n"
            "[torque_map]\nazimuth_step_deg = 10\nelevation_step_deg = 10\n");
  write("far.obj",
        "v 10000 0 0\nv 10000.001 0 0\nv 10000.001 0.001 0\nv 10000 0.001 0\no plate\nf 1 2 3 4\n");
  succeed("check " + file);
  const Outcome traced = succeed("trace " + file + " --out " + at("o"));
  EXPECT_THAT(traced.out + traced.err, Not(HasSubstr("WARNING")));
  EXPECT_NEAR(figure("power_on_plate_W", "o"), 1e-3, 1e-9);
  const double force_N = 1e-3 / speed_of_light_m_s;
  EXPECT_NEAR(figure("force_z_body_body_N", "o"), -force_N, 1e-6 * force_N);
  EXPECT_NEAR(figure("torque_y_body_body_N_m", "o"), 10000.0005 * force_N, 1e-6 * 1e4 * force_N);
  const Outcome map = succeed("torque-map " + file + " --out " + at("m"));
  EXPECT_THAT(map.out, HasSubstr("divided by the pressure 1.0000×10⁻⁶ m2"));
  EXPECT_THAT(map.out + map.err, Not(HasSubstr("WARNING")));
}

// The Sun sends 1000 W/m² · 40,000 m² in 4096 rays. None of them meets a plate of 1 cm², which then
// receives at most 3/4096 of the power, by the rule of three.
// Source: J. A. Hanley and A. Lippman-Hand, JAMA 249 (1983) 1743.
TEST_F(OpticalTruth, AReceiverThatNoRayMetHasALimit) {
  write("far.obj",
        "v -100 -100 0\nv 100 -100 0\nv 100 100 0\nv -100 100 0\no field\nf 1 2 3 4\n"
        "v 0.3 0.3 1\nv 0.31 0.3 1\nv 0.31 0.31 1\nv 0.3 0.31 1\no small\nf 5 6 7 8\n");
  const std::string file = write(
      "far.toml",
      "[scene]\nfile = \"far.obj\"\nunit = \"m\"\n[[source]]\nkind = \"sun\"\ndirection = [0, 0, "
      "-1]\nirradiance_W_m2 = 1000\nangular_radius_deg = 0\n[[receiver]]\nnode = \"small\"\nbins "
      "= [1, 1]\n[trace]\nrays = 4096\ndirect = \"rays\"\n");
  const Outcome traced = succeed("trace " + file + " --out " + at("o"));
  EXPECT_THAT(traced.out, HasSubstr("no ray met it: at most about 29300 W"));
}

// A plate of 1 m² in a closed chamber that a lamp lights from the inside.
TEST_F(OpticalTruth, AChamberAroundALampRaisesNoWarning) {
  std::string corners, faces = "o chamber\n";
  for (int i = 0; i < 8; ++i) {
    corners += std::string("v ") + (i & 1 ? "2 " : "-2 ") + (i & 2 ? "2 " : "-2 ") +
               (i & 4 ? "3\n" : "-1\n");
  }
  for (const char* face :
       {"5 7 8 6", "9 10 12 11", "5 6 10 9", "7 11 12 8", "5 9 11 7", "6 8 12 10"}) {
    faces += "f " + std::string(face) + "\n";
  }
  write("chamber.obj", "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\n" + corners +
                           "o plate\nf 1 2 3 4\n" + faces);
  const std::string file = write(
      "chamber.toml",
      "[scene]\nfile = \"chamber.obj\"\nunit = \"m\"\n[[source]]\nkind = \"led\"\npower_W = 1\n"
      "position_m = [0, 0, 2]\ndirection = [0, 0, -1]\naperture_diameter_m = 0.1\nprofile = "
      "\"pillbox\"\npillbox_measure = \"solid_angle\"\nhalf_angle_deg = 30\nwavelength_nm = "
      "500\n[trace]\nrays = 65536\n");
  const Outcome traced = succeed("trace " + file + " --out " + at("o"));
  EXPECT_THAT(traced.out + traced.err, Not(HasSubstr("WARNING")));
  EXPECT_THAT(traced.out + traced.err, Not(HasSubstr("inside of closed parts")));
  succeed("check " + file);
}

TEST_F(OpticalTruth, PartsBelowTheResolutionOfRaysAreRefused) {
  const std::string far = "v 10000 0 0\nv 10000.001 0 0\nv 10000 0.001 0\no chip\nf 5 6 7\n";
  const std::string file = plate("[0, 0, -1]", "", "f 1 2 3 4\n" + far);
  EXPECT_THAT(refused("trace " + file + " --out " + at("o")), HasSubstr("\"chip\""));
}

}  // namespace
}  // namespace photorque

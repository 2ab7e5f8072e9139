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

TEST_F(OpticalTruth, TorqueMapOverTiltsNeedsNoReceiver) {
  succeed("torque-map " +
          plate("[0, 0, -1]", "[torque_map]\ntilt_deg = [0, 30]\nheading_deg = [0]\n") + " --out " +
          at("o"));
}

TEST_F(OpticalTruth, SunlightOnAFarSceneIsRefused) {
  const std::string file =
      plate("[0, 0, -1]", "", "f 1 2 3 4\n", "centre_of_rotation_m = [10000, 0, 0]\n");
  EXPECT_THAT(refused("trace " + file + " --out " + at("o")), HasSubstr("from the body's origin"));
}

TEST_F(OpticalTruth, PartsBelowTheResolutionOfRaysAreRefused) {
  const std::string far = "v 10000 0 0\nv 10000.001 0 0\nv 10000 0.001 0\no chip\nf 5 6 7\n";
  const std::string file = plate("[0, 0, -1]", "", "f 1 2 3 4\n" + far);
  EXPECT_THAT(refused("trace " + file + " --out " + at("o")), HasSubstr("\"chip\""));
}

}  // namespace
}  // namespace photorque

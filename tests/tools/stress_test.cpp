// Numbers far from those of a laboratory: sizes, distances, rates and temperatures. Each is right,
// or one line says why there is none.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Stress : public CommandTest {
 protected:
  // A square of this side that the Sun stands above.
  Outcome lit_square(double side_m, const std::string& further = "") const {
    std::ostringstream model;
    model.precision(17);
    for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      model << "v " << x * side_m << " " << y * side_m << " 0\n";
    }
    write("square.obj", model.str() + "usemtl black\nf 1 2 3 4\n" + further);
    return run(
        "trace " +
        write("e.toml",
              "[scene]\nfile = \"square.obj\"\nunit = \"m\"\n[[material]]\nname = \"black\"\n"
              "absorptance = 1\n[[source]]\nkind = \"sun\"\ndirection = [0, 0, -1]\n"
              "irradiance_W_m2 = 1361\n[[receiver]]\nkind = \"wrench\"\n"
              "[trace]\nrays = 65536\n") +
        " --out " + at("o"));
  }
  // The last row of a free body's history, which turns about its z axis.
  std::vector<double> turned(const std::string& rate_rad_s, const std::string& duration_s) const {
    succeed(
        "propagate " +
        write("p.toml",
              "[platform]\ntopology = \"free\"\nmass_kg = 1\n"
              "inertia_kg_m2 = [[1, 0, 0], [0, 1, 0], [0, 0, 1.5]]\n[propagate]\nduration_s = " +
                  duration_s + "\ninitial_rate_rad_s = [0, 0, " + rate_rad_s +
                  "]\noutput_rate_Hz = 1\n") +
        " --out " + at("o"));
    return last_row(at("o/time_history.csv"));
  }
};

// Irradiance times area, whatever the size. The Sun's disc takes 5e-6 of the cosine.
TEST_F(Stress, SquaresOfAMicrometreAndOfTenThousandKilometres) {
  for (const double side_m : {1e-6, 1.0, 1e7}) {
    const Outcome got = lit_square(side_m);
    ASSERT_EQ(got.status, 0) << got.err;
    const json absorbed = summary("o").at("absorbed_W");
    const double expected_W = 1361.0 * side_m * side_m;
    EXPECT_NEAR(absorbed.at("value").get<double>() / expected_W, 1.0,
                5.0 * absorbed.at("standard_error").get<double>() / expected_W + 1e-5)
        << side_m;
  }
}

TEST_F(Stress, TrianglesWithoutAreaAndNeedlesChangeNothing) {
  ASSERT_EQ(lit_square(1.0).status, 0);
  const json alone = summary("o").at("absorbed_W");
  const Outcome got =
      lit_square(1.0,
                 "v 0 0 0\nv 0 0 0\nv 0.2 0 0\nv 0.4 0 0\nf 5 6 7\nf 5 7 8\n"
                 "v -0.4 0.1 -0.1\nv 0.4 0.1 -0.1\nv 0 0.100000001 -0.1\nf 9 10 11\n");
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("without area left out"));
  const double tolerance_W = 3.0 * alone.at("standard_error").get<double>() + 1e-6;
  EXPECT_NEAR(summary("o").at("absorbed_W").at("value").get<double>(),
              alone.at("value").get<double>(), tolerance_W);
}

// Half the angle turned, in the quaternion.
TEST_F(Stress, RatesFromANanoradianToAThousandRadiansASecond) {
  const std::vector<double> fast = turned("1e3", "1");
  EXPECT_NEAR(fast.at(1), std::cos(500.0), 1e-9);
  EXPECT_NEAR(fast.at(4), std::sin(500.0), 1e-9);
  const std::vector<double> slow = turned("1e-9", "100");
  EXPECT_NEAR(slow.at(4), 5e-8, 1e-15);
}

TEST_F(Stress, CellsTooColdForADiodeAreReported) {
  EXPECT_THAT(refused("power " + nominal_file +
                      " --set array.temperature_K=1 "
                      "--set trace.rays=4096 --out " +
                      at("o")),
              HasSubstr("found 1, expected a number in [100, 1000] K"));
}

// Inputs of an attacker with the documents alone that were accepted silently or gave unintended
// messages.
class Attack : public CommandTest {
 protected:
  const fs::path lab_ = source_folder + "/docs/tutorials";
  std::string bench() const { return (lab_ / "bench.toml").string(); }
  std::string recorded(const std::string& name) const {
    return " --recording " + (lab_ / name).string();
  }
  // The experiment with more at its end.
  std::string bench_with(const std::string& more) const {
    std::string text = file_text(bench());
    text.replace(text.find("plate.gltf"), 10, (lab_ / "plate.gltf").string());
    return write("bench.toml", text + more) + " --allow-outside";
  }
  void expect_refused(const std::string& arguments, const std::string& part) const {
    expect_refusal(arguments + " --quiet --out " + at("o"), part);
  }
};

TEST_F(Attack, OneReadingIsNoRecording) {
  const std::string one = write("one.csv", "u_m,v_m,irradiance_W_m2\n0,0,700\n");
  expect_refused("diagnose " + bench() + " --recording " + one,
                 "one.csv: found 1 usable reading, expected at least 8 to fit");
}

TEST_F(Attack, NoiseWhoseSquareIsNothingIsRefused) {
  expect_refused("diagnose " + bench() + recorded("monday_iv.csv.gz") +
                     " --set sensors.array.voltage_noise_V=1e-300",
                 "expected 0 or a size of at least 1e-100 in SI units");
}

TEST_F(Attack, NumbersOfEffectsAreReportedWithTheirRange) {
  expect_refused("power " + bench_with("[[effect]]\nkind = \"led_derated\"\nindex = 3\n"
                                       "factor = 2.5\n"),
                 "effect[0].factor: found 2.50000, expected a number of led_derated: from 0 to 1");
  expect_refused("power " + bench_with("[[effect]]\nkind = \"attitude_bias\"\n"
                                       "bias_deg = [0, 40]\n"),
                 "expected a number of attitude_bias: from -17.2 to 17.2");
}

// Derivatives went by a beam of 180.4 deg.
TEST_F(Attack, WidthsBesideTheEndOfTheirRangeAreDiagnosed) {
  succeed("diagnose " + bench() + recorded("monday_iv.csv.gz") +
          " --set source[0].fwhm_deg=179.9 --quiet --out " + at("o"));
}

TEST_F(Attack, LightThatMissesTheCellsIsReported) {
  succeed("power " + bench() +
          " --set source[0].wavelength_nm=1500 --set trace.rays=4096 --quiet --out " + at("o"));
  EXPECT_THAT(file_text(at("o/summary.json")),
              HasSubstr("100 % of the light at 1500 nm lies outside of 600.0 to 860.0 nm"));
}

TEST_F(Attack, ATorqueMapReportsThatItOmitsTheAttitudeBias) {
  const Outcome got = succeed("torque-map " +
                              bench_with("[[effect]]\nkind = \"attitude_bias\"\nbias_deg = [0, 4]\n"
                                         "[torque_map]\ntilt_deg = [0]\nheading_deg = [0]\n") +
                              " --set trace.rays=4096 --out " + at("o"));
  EXPECT_THAT(got.out, HasSubstr("attitude_bias acts at [attitude]"));
}

TEST_F(Attack, RatesThatNoPlatformHasAreNoFailureOfTheComputation) {
  std::string rows = "t_s,q_w,q_x,q_y,q_z,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";
  for (int i = 0; i < 60; ++i) rows += std::to_string(0.1 * i) + ",1,0,0,0,1e300,0,0\n";
  expect_refused("balance " + attitude_file + " --recording " + write("fast.csv", rows),
                 "rates below 1e6 rad/s");
}

}  // namespace
}  // namespace photorque

// The temperature of the cells in `power` and `sweep`, as a user meets it.
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/tools/command_test.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::string lit_stasis = nominal_file + " --set trace.rays=65536 ";

class WarmArrayCommand : public CommandTest {
 protected:
  json power(const std::string& set) {
    const Outcome got = succeed("power " + lit_stasis + set + " --out " + at("out"));
    out_ = got.out;
    return summary();
  }
  std::string out_;
};

// One face with constant convection: h A (T − T_air) = α L − P.
TEST_F(WarmArrayCommand, PowerIsThatOfCellsInTheSteadyState) {
  const json steady = power(
      "--set "
      "'array.thermal={convection_W_m2_K=12,emissivity=0,faces=1,air_K=300,absorptance=0.9}'");
  EXPECT_THAT(out_, HasSubstr("steady state: the front in air of 300 K with 12 W/m²K"));
  const double kelvin = value(steady, "cell_temperature_K");
  const double absorbed_W = 0.9 * value(steady, "power_on_cells_W");
  const double left_W = absorbed_W - value(steady, "array_power_W");
  EXPECT_NEAR(kelvin, 300.0 + left_W / (12.0 * value(steady, "area_of_cells_m2")), 1e-4);
  EXPECT_EQ(value(steady, "cell_temperature_is_stated"), 0.0);
  const auto stated = [&](double at_K) {
    return power("--set array.temperature_K=" + std::to_string(at_K));
  };
  const json same = stated(kelvin);
  EXPECT_THAT(out_, HasSubstr("as stated"));
  EXPECT_EQ(value(same, "cell_temperature_is_stated"), 1.0);
  EXPECT_NEAR(value(same, "array_power_W"), value(steady, "array_power_W"), 1e-6);
  const double slope_W_K = 0.5 * (value(stated(kelvin + 1.0), "array_power_W") -
                                  value(stated(kelvin - 1.0), "array_power_W"));
  EXPECT_LT(slope_W_K, -0.05);
  EXPECT_NEAR(value(steady, "array_power_slope_W_K"), slope_W_K, 1e-3 * -slope_W_K);
}

TEST_F(WarmArrayCommand, SurroundingsAreThoseOfTheExperiment) {
  power("--set environment.air_temperature_K=301");
  EXPECT_THAT(out_, HasSubstr("steady state: both faces in still air of 301 K, emissivity 0.84\n"));
  power("--set 'disturbance=[{kind=\"orbit\"}]'");
  EXPECT_THAT(out_, HasSubstr("both faces in a vacuum, emissivity 0.84 to 2.73 K"));
  EXPECT_THAT(file_text(at("out/cell_temperature.csv")), HasSubstr("both faces in a vacuum"));
}

TEST_F(WarmArrayCommand, CellsAboveTheirRatedTemperatureAreAWarning) {
  EXPECT_EQ(power("").at("warnings").dump(), "[]");
  const json hot = power("--set array.thermal.faces=1 --set array.rated_temperature_K=320");
  EXPECT_THAT(hot.at("warnings").dump(), HasSubstr("above array.rated_temperature_K, 320"));
  EXPECT_THAT(out_, HasSubstr("WARNING: cells of "));
  EXPECT_NEAR(value(hot, "cell_temperature_above_rated_K"),
              value(hot, "cell_temperature_K") - 320.0, 1e-9);
}

TEST_F(WarmArrayCommand, PowerStatesSpectrumAndSlope) {
  const json lit = power("");
  EXPECT_THAT(out_, HasSubstr("Solar array at its maximum power point, light at "));
  EXPECT_THAT(out_, testing::ContainsRegex("electric power .*, -0\\.[0-9]+ W/K"));
}

TEST_F(WarmArrayCommand, TorqueMapsStateTheTemperatureOfTheirPower) {
  const Outcome got = succeed("torque-map " + lit_stasis +
                              "--set torque_map.rays=16384 --set torque_map.tilt_deg=[0,20] "
                              "--set torque_map.heading_deg=[0] --out " +
                              at("map"));
  EXPECT_THAT(got.out, HasSubstr("electric_W of the table: cells of "));
  EXPECT_THAT(got.out, HasSubstr("steady state: both faces in still air"));
  EXPECT_THAT(file_text(at("map/power_over_attitude.csv")), HasSubstr(",cell_temperature_K"));
}

// Cells of 16 % or more on a surface that absorbs a tenth of their light.
TEST_F(WarmArrayCommand, MorePowerThanTheSurfaceAbsorbsIsAWarning) {
  write("plate.obj", "o plate\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl m\nf 1 2 3 4\n");
  const auto warnings = [&](const std::string& material) {
    write("plate.toml",
          "[scene]\nfile = \"plate.obj\"\nunit = \"m\"\n[[material]]\nname = \"m\"\n" + material +
              "[[source]]\nkind = \"sun\"\ndirection = [0, 0, -1]\nangular_radius_deg = 0\n"
              "spectrum = \"AM1.5G\"\n[[receiver]]\nkind = \"flux_map\"\nnode = \"plate\"\n"
              "bins = [4, 4]\n[trace]\nrays = 16384\n[array]\ncells = [4, 4]\n");
    out_ = succeed("power " + at("plate.toml") + " --out " + at("out")).out;
    return summary().at("warnings").dump();
  };
  EXPECT_EQ(warnings("absorptance = 1\n"), "[]");
  EXPECT_THAT(out_, HasSubstr("maximum power point, sunlight AM1.5G"));
  EXPECT_THAT(warnings("absorptance = 0.1\nspecular = 0.9\n"),
              HasSubstr("their material absorbs only 10 %"));
}

// Cells that hardly cool: beyond some light they give less. With cells of 25 °C more light is more.
TEST_F(WarmArrayCommand, SweepsJudgeCellsAtTheirTemperature) {
  const std::string plan =
      "--set "
      "'sweep={verb=\"power\",maximise=\"array_power_W\",axis=[{key=\"source[0].total_power_W\","
      "values=[10,20,40,80]}]}' --set 'array.thermal={faces=1,convection_W_m2_K=1,emissivity=0}' ";
  const Outcome warm = succeed("sweep " + lit_stasis + plan + " --out " + at("warm"));
  EXPECT_THAT(warm.out, testing::Not(HasSubstr("source[0].total_power_W=80")));
  EXPECT_THAT(warm.out, HasSubstr("  cell_temperature_K  "));
  EXPECT_GT(figure("best_cell_temperature_K", "warm"), 320.0);
  const Outcome cold = succeed("sweep " + lit_stasis + plan +
                               "--set array.temperature_K=298.15 --out " + at("cold"));
  EXPECT_THAT(cold.out, HasSubstr("source[0].total_power_W=80"));
}

TEST_F(WarmArrayCommand, WrongPlatesAreOneLine) {
  for (const auto& [set, part] : std::vector<std::pair<std::string, std::string>>{
           {"array.thermal.absorptance=0.1", "array.thermal.absorptance: found 0.1"},
           {"'array.thermal={emissivity=0,convection_W_m2_K=0}'", "array.thermal.emissivity"},
           {"array.thermal.air_K=0", "array.thermal.air_K: found 0"},
           {"array.thermal.faces=3", "array.thermal.faces: found 3"},
           {"array.temperature_C=25", "temperature_K"}}) {
    EXPECT_THAT(refused("power " + lit_stasis + "--set " + set + " --out " + at("out")),
                HasSubstr(part))
        << set;
    EXPECT_FALSE(fs::exists(at("out"))) << set;
  }
}

}  // namespace
}  // namespace photorque

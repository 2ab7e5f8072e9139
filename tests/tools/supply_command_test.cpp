// `supply`: the trade as a user meets it, and the laws that stand in it alone.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "tests/tools/command_test.h"
#include "tools/supply/trade.h"

namespace photorque {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* fed_platform = R"([platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.19]]
tilt_limit_deg = 30
battery_voltage_V = 10
[environment]
magnetic_field_T = [0, 2e-5, -4e-5]
[supply_trade]
load_W = 20
duration_h = 10
tilts = 4
[supply_trade.battery]
specific_energy_Wh_kg = { value = 100, sigma = 10 }
usable_fraction = 1.0
electrodes_m = { value = 1e-3, sigma = 1e-4 }
[[supply_trade.microwave]]
frequency_GHz = 5.8
rectifier_efficiency = 0.8
transmitter_efficiency = { value = 0.5, sigma = 0.05 }
)";

class SupplyCommand : public CommandTest {
 protected:
  json summary(const std::string& more = "") {
    const Outcome got = succeed("supply " + write("s.toml", fed_platform) + " " + more +
                                " --json --out " + at("o"));
    return json::parse(got.out);
  }
};

double of(const json& summary, const std::string& name, const std::string& what = "value") {
  return summary.at(name).at(what).get<double>();
}

// 20 W for 10 h are 200 Wh, 2 kg at 100 Wh/kg, with a tenth of error; 20 Ah of 10 V, whose lithium,
// 0.2589 g/Ah, migrates by 1 mm along x and leans the platform by that times g.
TEST_F(SupplyCommand, BatteryFollowsFromEnergyAndLithium) {
  const json all = summary();
  EXPECT_NEAR(of(all, "battery_mass_kg"), 2.0, 1e-12);
  EXPECT_NEAR(of(all, "battery_mass_kg", "standard_error"), 0.5 * (200 / 90.0 - 200 / 110.0),
              1e-12);
  const double lithium_kg = 6.94e-3 / 96485.33212 * 3600.0 * 20.0;
  EXPECT_NEAR(of(all, "battery_torque_N_m"), lithium_kg * 1e-3 * 9.80665, 1e-12);
  EXPECT_NEAR(of(all, "battery_torque_N_m", "standard_error"), 0.1 * lithium_kg * 1e-3 * 9.80665,
              1e-12);
  // ½ T t²/I per watt.
  EXPECT_NEAR(of(all, "battery_angle_deg_per_W"),
              0.5 * of(all, "battery_torque_N_m") * 36000.0 * 36000.0 / 0.1 / 20.0 / degree_rad,
              1e-6);
}

TEST_F(SupplyCommand, SuppliesDeliverTheLoadAtZeroTiltAndLessWhenTilted) {
  const json all = summary();
  for (const char* way : {"battery", "cable", "microwave_5_8_GHz", "induction"}) {
    EXPECT_NEAR(of(all, std::string(way) + "_delivered_level_W"), 20.0, 1e-9) << way;
  }
  EXPECT_LT(of(all, "microwave_5_8_GHz_delivered_tilted_W"), 16.0);
  EXPECT_GT(of(all, "microwave_5_8_GHz_source_W"), 20.0 / 0.8 / 0.5);
  EXPECT_NEAR(of(all, "microwave_5_8_GHz_source_W", "standard_error") /
                  of(all, "microwave_5_8_GHz_source_W"),
              0.1, 0.002);
  // A cable pulls back; the pressure of the beam tilts further, by h sin θ P/c at the most.
  EXPECT_LT(of(all, "cable_torque_N_m"), 0.0);
  EXPECT_GT(of(all, "microwave_5_8_GHz_torque_N_m"), 0.0);
  EXPECT_LT(of(all, "microwave_5_8_GHz_torque_N_m"), 0.0238 * 0.5 * 26.0 / 299792458.0);
  // Coils in resonance do not turn each other on average; out of it they do, as far as it is known.
  EXPECT_NEAR(of(all, "induction_torque_N_m"), 0.0, 1e-15);
  EXPECT_GT(of(all, "induction_torque_N_m", "standard_error"), 1e-9);
  EXPECT_GT(of(all, "induction_alternating_N_m"), 1e-7);
  EXPECT_EQ(of(summary("--set supply_trade.induction.detuning=0"), "induction_torque_N_m",
               "standard_error"),
            0.0);
}

// The light of a way is that of `power`, whose figures pass through the converter and the lamps'
// efficiency.
TEST_F(SupplyCommand, LightIsThatOfPower) {
  const std::string beam = "[[supply_trade.beam]]\nname = \"LED beaming\"\nexperiment = \"" +
                           nominal_file +
                           "\"\nrays = 65536\nlamp_efficiency = 0.5\nconverter_efficiency = 0.9\n";
  const Outcome fed = succeed("supply " + write("s.toml", fed_platform + beam) +
                              " --set supply_trade.tilts=2 --json --out " + at("o"));
  const json all = json::parse(fed.out);
  for (const auto& [tilt, name] : std::vector<std::pair<std::string, std::string>>{
           {"0", "delivered_level_W"}, {"30", "delivered_tilted_W"}}) {
    const Outcome lit = succeed("power " + nominal_file +
                                " --set trace.rays=65536 --set attitude.tilt_deg=" + tilt +
                                " --json --out " + at("p"));
    EXPECT_NEAR(of(all, "LED_beaming_" + name), 0.9 * of(json::parse(lit.out), "array_power_W"),
                1e-9);
  }
  EXPECT_NEAR(of(all, "LED_beaming_source_W"), 88.0 / 0.5, 1e-9);
}

TEST_F(SupplyCommand, WritesTablesAndPictures) {
  const Outcome got =
      succeed("supply " + write("s.toml", fed_platform) + " --verbose --out " + at("o"));
  EXPECT_THAT(got.out, HasSubstr("25 W x 24 h is 600 Wh; 360 Wh is 15 W x 24 h"));
  const auto all = files("o");
  for (const char* name :
       {"summary.json", "supply.csv", "supply_by_tilt.csv", "supply_figures.csv",
        "paper_supply.csv", "supply_over_tilt.png", "battery_torque_by_charge.png"}) {
    EXPECT_TRUE(all.contains(name)) << name;
  }
}

TEST_F(SupplyCommand, WrongInputIsOneLineAndExitTwo) {
  const std::string experiment = write("s.toml", fed_platform);
  for (const auto& [key, message] : std::vector<std::pair<std::string, std::string>>{
           {"supply_trade.load_W=0", "supply_trade.load_W"},
           {"supply_trade.tilt_max_deg=90", "supply_trade.tilt_max_deg"},
           {"supply_trade.batery.usable_fraction=1", "perhaps \"battery\""},
           {"supply_trade.cable.voltage_V=0.1", "V for this load through this cable"},
           {"supply_trade.induction.receiver.outer_radius_m=0.01", "more than inner_radius_m"},
           {"supply_trade.induction.transmitter_height_m=-0.05", "room for the receiver to tilt"},
           {"supply_trade.battery.usable_fraction=1.5", "usable_fraction"}}) {
    EXPECT_THAT(refused("supply " + experiment + " --set " + key + " --out " + at("o")),
                HasSubstr(message))
        << key;
  }
}

// Photons above the gap in a blackbody's hemisphere by the midpoint rule over Planck's law, and the
// most power of q V (J_L − J_0 (exp(qV/kT) − 1)) by trying a million voltages.
TEST(RadiativeLimit, IsTheBestOfTheDiodeEquation) {
  constexpr double gap_J = 1.424 * elementary_charge_C, kT_J = boltzmann_J_K * 298.15;
  double photons = 0.0;
  constexpr int steps = 200000;
  const double dE_J = 60.0 * kT_J / steps;
  for (int i = 0; i < steps; ++i) {
    const double E_J = gap_J + (i + 0.5) * dE_J;
    photons += E_J * E_J / std::expm1(E_J / kT_J) * dE_J;
  }
  photons *= 2.0 * pi / (std::pow(planck_J_s, 3) * std::pow(speed_of_light_m_s, 2));
  const double photon_J = planck_J_s * speed_of_light_m_s / 858e-9;
  const double light = 11.4e4 / photon_J;
  double best = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    const double V = 1.5 * i / 1e6;
    best = std::max(best, V * elementary_charge_C *
                              (light - photons * std::expm1(V * elementary_charge_C / kT_J)));
  }
  EXPECT_NEAR(radiative_limit(858e-9, 11.4e4, gap_J, 298.15), best / 11.4e4, 1e-9);
  EXPECT_EQ(radiative_limit(900e-9, 11.4e4, gap_J, 298.15), 0.0);
}

}  // namespace
}  // namespace photorque

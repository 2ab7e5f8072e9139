// Current-voltage curves as meters write them: the experiment that a guess makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/text/format.h"
#include "diagnosis/guess/guess.h"
#include "diagnosis/light/module/diagnose.h"
#include "scenes/experiment/toml.h"
#include "tests/files.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(GuessedCurve, HasHeadersInManyWords) {
  const auto curve = [&](const std::string& header, double scale) {
    std::string text = header + "\n";
    const bool is_numbered = std::ranges::count(header, ';') > 1;
    for (int i = 0; i <= 40; ++i) {
      const double volt = 0.015 * i;
      const double ampere = scale * (1.0 - std::exp((volt - 0.6) / 0.03));
      text += (is_numbered ? std::to_string(i) + ";" : "") + std::to_string(volt) + ";" +
              std::to_string(ampere) + "\n";
    }
    return guess_experiment({test_file("curve.csv", text)}, testing::TempDir());
  };
  for (const char* header :
       {"U/V;I/A", "U / V;I / A", "No.;U;I", "Nr.;Spannung (V);Strom (A)",
        "Panel Voltage;Panel Current", "U_mod [V];I_mod [A]", "Voltage (in V);Current [in A]",
        "Voltage (in volts);I (in amps)", "Power in mW;Voltage (V);Current (A)",
        "power_W;Voltage (V);Current (A)", "Widerstand in kOhm;Spannung in V;Strom in A", "W;U;I",
        "R (Ω);Spannung in V;Strom in A", "Source;Voltage;Current",
        "lux;Panel_V (V);Panel_I (A)"}) {
    EXPECT_THAT(curve(header, 2.0), AllOf(HasSubstr("[module]"), Not(HasSubstr("density"))))
        << header;
  }
  EXPECT_THAT(curve("V;J (mA/cm2)", 20.0),
              AllOf(HasSubstr("the current of 1 cm²"), Not(HasSubstr("columns"))));
  EXPECT_THAT(curve("Sample no;V;J (mA/cm2)", 20.0), HasSubstr("current_mA_cm2 = \"J (mA/cm2)\""));
  EXPECT_THAT(curve("V;J", 0.02), HasSubstr("the current of 1 cm²"));
  EXPECT_THAT(refusal_of([&] { curve("U;K", 1.0); }), HasSubstr("one voltage and one current"));
}

// 36 cells of 0.65 V whose meter stays at −0.01 A, or at 0, beyond open circuit, and whose current
// may be counted into the module: what a guess accepts, a diagnosis reads.
TEST(GuessedCurve, MayEndInWhatAMeterMade) {
  for (const auto& [sign, beyond_A] : {std::pair{1.0, -0.01}, {1.0, 0.0}, {-1.0, 0.0}}) {
    std::string text = "V,I\n";
    for (int i = 0; i <= 52; ++i) {
      const double volt = 0.5 * i, ampere = 5.0 * (1.0 - std::exp((volt - 23.4) / 1.08));
      text += std::to_string(volt) + "," +
              std::to_string(volt < 23.4 ? sign * ampere : sign * beyond_A) + "\n";
    }
    const fs::path file = test_file("meter.csv", text);
    const std::string guessed = guess_experiment({file}, testing::TempDir());
    EXPECT_THAT(guessed, HasSubstr("cells_in_series = 36\n")) << sign << ", " << beyond_A;
    const Settings root(parse_toml(guessed, "guess.toml"));
    const ModuleDesign design = read_module(root, testing::TempDir());
    EXPECT_EQ(diagnose_module(design, {read_light_recording(file, {})}, {}).verdict,
              Verdict::consistent)
        << sign << ", " << beyond_A;
  }
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { guess_experiment({test_file("few.csv", text)}, testing::TempDir()); });
  };
  EXPECT_THAT(refusal("V,I\n0,5\n5,4.5\n10,NaN\n20,0\n"),
              AllOf(HasSubstr("3 usable points in 4 rows"), HasSubstr("at least 12 points")));
  // A resistor of 2 ohm, and a tracker that goes about one point of a module.
  std::string resistor = "V,I\n", log = resistor;
  for (int i = 0; i < 40; ++i) {
    resistor += printed("%d,%.1f\n", i, 0.5 * i);
    log += printed("%.3f,%.3f\n", 17.0 + std::sin(2.1 * i), 3.0 + 2.5 * std::sin(0.9 * i));
  }
  EXPECT_THAT(refusal(resistor), HasSubstr("a curve that no diode fits"));
  EXPECT_THAT(refusal(log), HasSubstr("not a log over time"));
}

// A wrong unit, and a dark curve beside the one in light. The proposed names are accepted.
TEST(GuessedCurve, IsNamedByTheCommandOfARefusal) {
  std::string typo = "V(I), I(A)\n", lit = ",S1_V_D,S1_J_D,S1_V_L,S1_J_L\n";
  for (int i = 0; i <= 30; ++i) {
    const double volts = 0.02 * i, amperes = 0.03 - 1e-11 * std::exp(volts / 0.0275);
    typo += printed("%.2f,%.6f\n", volts, amperes);
    lit += printed("%d,%.2f,%.6f,%.2f,%.6f\n", i, volts, amperes - 0.03, volts, amperes);
  }
  const auto guess = [](const fs::path& file, const std::vector<std::string>& header) {
    return guess_experiment({file}, testing::TempDir(), {.header = header});
  };
  const fs::path first = test_file("typo.csv", typo), second = test_file("lit.csv", lit);
  EXPECT_THAT(refusal_of([&] { guess(first, {}); }),
              AllOf(HasSubstr("the unit \"i\""), HasSubstr("--columns voltage_V,current_A (")));
  EXPECT_THAT(guess(first, {"voltage_V", "current_A"}), HasSubstr("[module]"));
  EXPECT_THAT(refusal_of([&] { guess(second, {}); }),
              HasSubstr("--columns column_1,column_2,column_3,voltage_V,current_A ("));
  EXPECT_THAT(guess(second, {"column_1", "column_2", "column_3", "voltage_V", "current_A"}),
              HasSubstr("[module]"));
}

// Curves of one diode with n = 1.3. The numbers of cells: STM6-40/36 at 51 °C and STP6-120/36 at
// 55 °C (36 cells), PWP201 at 45 °C (36), SpectraVolt 100M36S (36), a roof of 16 modules of 72
// cells.
TEST(GuessedCurve, HasANumberOfCellsThatIsMade) {
  const auto guess_of = [](double open_V, const std::string& above) {
    std::string text = above + "Voltage (V),Current (A)\n";
    for (int i = 0; i <= 40; ++i) {
      // The last reading before the zero is at 39/40.5 of the open-circuit voltage.
      const double volt = open_V * i / 40.5 * (i == 40 ? 1.02 : 1.0);
      text += printed("%.5f,%.5f\n", volt, 5.0 * -std::expm1(20.0 * (volt / open_V - 1.0)));
    }
    return guess_experiment({test_file("cells.csv", text)}, testing::TempDir());
  };
  const auto cells = [&](int count) { return "cells_in_series = " + std::to_string(count) + "\n"; };
  EXPECT_THAT(guess_of(21.02, "# T = 51 C\n"), HasSubstr(cells(36)));
  EXPECT_THAT(guess_of(19.2, "# T = 55 C\n"), HasSubstr(cells(36)));
  EXPECT_THAT(guess_of(16.78, ""), HasSubstr(cells(36)));
  EXPECT_THAT(guess_of(20.2, ""), HasSubstr(cells(36)));
  EXPECT_THAT(guess_of(22.4, ""), HasSubstr(cells(36)));
  EXPECT_THAT(guess_of(39.0, ""), HasSubstr(cells(60)));
  EXPECT_THAT(guess_of(0.573, ""), AllOf(HasSubstr(cells(1)), HasSubstr("give 0.57")));
  EXPECT_THAT(guess_of(780.0, ""),
              AllOf(HasSubstr("modules of 72 in a string"), HasSubstr("at 0.6"),
                    Not(HasSubstr("Silicon in sunlight"))));
  // Perovskite and organic cells.
  EXPECT_THAT(guess_of(1.2, ""), AllOf(HasSubstr(cells(1)), HasSubstr("Silicon in sunlight")));
  EXPECT_THAT(guess_of(0.2, ""), HasSubstr("Silicon in sunlight"));
}

// Conditions in the lines above a header: curves of ctib/BuildingSystems, and a PV-KLA tester,
// whose text is Latin-1 and has tables of other numbers above the curve.
TEST(GuessedCurve, HasTheConditionsOfItsFile) {
  std::string rows;
  for (int i = 0; i <= 40; ++i) {
    rows +=
        printed("%.4f\t%.4f\t590\n", 0.0146 * i, 4.69 * -std::expm1((0.0146 * i - 0.578) / 0.04));
  }
  const std::string file = guess_experiment(
      {test_file("kla.txt",
                 "PVK 5.11\r\n[Parameter]\r\nPmpp in W\tVmpp in V\tG in W/m\xb2\tT in \xb0"
                 "C\r\n"
                 "2.03\t0.47\t589.5\t22.9\r\n[Curve Data]\r\nV in V\tI in A\tG in W/m\xb2\r\n" +
                     rows)},
      testing::TempDir());
  EXPECT_THAT(file, AllOf(HasSubstr("cells_in_series = 1\n"), HasSubstr("states 590")));
  EXPECT_THAT(guess_experiment({test_file("warm.txt", "# T = 50 C\nV\tI\tG (W/m2)\n" + rows)},
                               testing::TempDir()),
              AllOf(HasSubstr("temperature_K = 323.15"), HasSubstr("temperature_sigma_K = 5\n")));
}

}  // namespace
}  // namespace photorque

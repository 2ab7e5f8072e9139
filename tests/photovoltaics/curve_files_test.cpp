// Curves as meters write them: tails, wild readings, files of instruments.
#include "photovoltaics/fit/curve_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/numerics/random.h"
#include "core/text/format.h"
#include "ivcurves.h"
#include "photovoltaics/fit/conditions.h"
#include "photovoltaics/fit/fit.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

// A cell of I_L 8 A, I_0 1e-9 A, n 1.1, R_s 5 mΩ, R_sh 50 Ω from its equation, each reading rounded
// to 0.1 mA; beyond open circuit the current is `clipped_A`.
IvSweep clipped_curve(double clipped_A, int beyond) {
  ivcurves::Truth truth{8.0, 1e-9, 5e-3, 50.0, 1.1, 1};
  const CellCurve cell(truth.parameters());
  IvSweep sweep;
  for (int i = 0; i < 64 + beyond; ++i) {
    const double v = 0.01 * i, exact_A = cell.current_A(8.0, v);
    const double noise =
        std::sqrt(12.0) * (unit_interval(hash_words(5, static_cast<uint64_t>(i))) - 0.5);
    sweep.voltage_V.push_back(v);
    sweep.current_A.push_back(exact_A > 0.0 ? std::round(1e4 * exact_A * (1.0 + 5e-4 * noise)) / 1e4
                                            : clipped_A);
  }
  return sweep;
}

TEST(PhotovoltaicFit, ATailThatTheMeterMadeIsLeftOut) {
  for (const double clipped_A : {0.0, -0.01, 0.02}) {
    for (const int beyond : {3, 8, 40}) {
      IvSweep sweep = clipped_curve(clipped_A, beyond);
      const size_t made = static_cast<size_t>(std::ranges::count(sweep.current_A, clipped_A));
      const CurveCleaning cleaning = clean_curve(sweep);
      EXPECT_EQ(cleaning.clipped, made) << clipped_A << " A, " << beyond;
      EXPECT_EQ(cleaning.spikes, 0u);
      EXPECT_NEAR(cleaning.clipped_A, clipped_A, 1e-12);
      const SweepFit fit = fit_sweeps(std::array{sweep}, {});
      EXPECT_NEAR(fit.diode.scale_V.value / 0.025693, 1.1, 0.02);
      EXPECT_NEAR(fit.diode.photocurrent_A.value, 8.0, 0.01);
    }
  }
}

// The module of the other tests' equation, 9 A, n 1.1, R_s 0.3 Ω, R_sh 300 Ω of 60 cells, in steps
// of 0.25 V to 45 V, read by a meter with a range from `low_A` to `high_A` in steps of `step_A`.
IvSweep in_range(double low_A, double high_A, double step_A) {
  ivcurves::Truth truth{9.0, 5e-10, 0.3, 300.0, 1.1, 60};
  const CellCurve module(truth.parameters());
  IvSweep sweep;
  for (int i = 0; i <= 180; ++i) {
    const double noise =
        std::sqrt(12.0) * (unit_interval(hash_words(7, static_cast<uint64_t>(i))) - 0.5);
    const double exact_A = module.current_A(9.0, 0.25 * i) * (1.0 + 5e-4 * noise);
    sweep.voltage_V.push_back(0.25 * i);
    sweep.current_A.push_back(std::clamp(step_A * std::round(exact_A / step_A), low_A, high_A));
  }
  return sweep;
}

TEST(PhotovoltaicFit, ReadingsAtEitherEndOfTheRangeAreLeftOut) {
  constexpr double scale_V = 1.1 * 60 * 0.0256926;
  for (const double low_A : {-0.02, -0.1, -0.5, -1.0, -4.0}) {
    IvSweep sweep = in_range(low_A, 20.0, 1e-4);
    const size_t made = static_cast<size_t>(std::ranges::count(sweep.current_A, low_A));
    EXPECT_EQ(clean_curve(sweep).clipped, made) << low_A;
    EXPECT_EQ(take_range_limit(sweep).readings, 0u) << low_A;
    const SweepFit fit = fit_sweeps(std::array{sweep}, {});
    EXPECT_NEAR(fit.diode.scale_V.value / scale_V, 1.0, 0.015) << low_A;
    EXPECT_LT(fit.diode.scale_V.standard_error, 0.01 * scale_V) << low_A;
  }
  for (const double high_A : {8.5, 8.9}) {
    IvSweep sweep = in_range(-20.0, high_A, 1e-4);
    const size_t made = static_cast<size_t>(std::ranges::count(sweep.current_A, high_A));
    EXPECT_EQ(clean_curve(sweep).clipped, 0u);
    const RangeLimit limit = take_range_limit(sweep);
    EXPECT_EQ(limit.readings, made) << high_A;
    EXPECT_EQ(limit.current_A, high_A);
    const Estimate scale = fit_sweeps(std::array{sweep}, {}).diode.scale_V;
    EXPECT_NEAR(scale.value, scale_V, 3.0 * scale.standard_error) << high_A;
    EXPECT_LT(scale.standard_error, 0.1 * scale_V) << high_A;
  }
}

// Coarse steps make plateaus of equal readings too; the curve leaves those step by step.
TEST(PhotovoltaicFit, APlateauOfRoundedReadingsStays) {
  for (const double step_A : {0.001, 0.01, 0.05, 0.1}) {
    IvSweep sweep = in_range(-20.0, 20.0, step_A);
    EXPECT_EQ(take_range_limit(sweep).readings, 0u) << step_A;
    EXPECT_EQ(clean_curve(sweep).clipped, 0u) << step_A;
  }
}

// The last readings of a curve measured by hand over loads (10 and 15 kΩ at 435 and 445 mV).
TEST(PhotovoltaicFit, TwoSmallCurrentsAtTheEndStay) {
  IvSweep sweep{
      {0.185, 0.281, 0.322, 0.345, 0.365, 0.387, 0.402, 0.42, 0.435, 0.445},
      {1.85e-3, 1.28e-3, 0.99e-3, 0.73e-3, 0.53e-3, 0.38e-3, 0.18e-3, 0.09e-3, 0.04e-3, 0.03e-3}};
  EXPECT_EQ(clean_curve(sweep).clipped, 0u);
  EXPECT_EQ(sweep.voltage_V.size(), 10u);
}

// The offset of a meter at 0 V is no photocurrent.
TEST(PhotovoltaicFit, ADarkCurveIsNotReversed) {
  IvSweep dark;
  for (int i = 0; i <= 60; ++i) {
    dark.voltage_V.push_back(0.01 * i);
    dark.current_A.push_back(-4e-9 + 1e-10 * std::expm1(dark.voltage_V.back() / 0.026));
  }
  EXPECT_FALSE(reverse_negative(dark));
}

TEST(PhotovoltaicFit, CurvesOneBelowTheOtherAreSeparated) {
  std::string text = "Source,Voltage,Current\n";
  for (const double open_V : {780.0, 770.0, 790.0}) {
    for (int i = 0; i <= 20; ++i) {
      const double volt = open_V * i / 20.0;
      text += printed("%s,%.2f,%.4f\n", i == 0 ? "S.csv" : "", volt,
                      9.0 * -std::expm1((volt - open_V) / 40.0));
    }
  }
  const auto curves = curves_in(text, "strings.csv");
  ASSERT_EQ(curves.size(), 3u);
  EXPECT_TRUE(curves[1].is_stacked);
  EXPECT_EQ(curves[1].sweep.voltage_V.size(), 21u);
  EXPECT_NEAR(curves[1].sweep.voltage_V.back(), 770.0, 1e-9);
  // Forward and back, a last reading at 0 V, and readings in any order are one curve.
  std::vector<double> both_ways, shuffled;
  for (int i = 0; i <= 20; ++i) both_ways.push_back(i);
  for (int i = 20; i >= 0; --i) both_ways.push_back(i);
  for (int i = 0; i < 41; ++i) shuffled.push_back((17 * i) % 41);
  EXPECT_EQ(starts_of_curves(both_ways).size(), 1u);
  EXPECT_EQ(starts_of_curves(shuffled).size(), 1u);
  EXPECT_EQ(starts_of_curves({0, 1, 2, 3, 4, 5, 6, 7, 0}).size(), 1u);
}

TEST(PhotovoltaicFit, DeadReadingsBelowAFlowingCurrentAreLeftOut) {
  IvSweep sweep = clipped_curve(0.0, 3);
  for (const size_t i : {0u, 1u, 2u, 30u, 31u}) sweep.current_A[i] = 0.0;
  const CurveCleaning cleaning = clean_curve(sweep);
  EXPECT_EQ(cleaning.dead, 5u);
  EXPECT_EQ(cleaning.spikes, 0u);
  EXPECT_EQ(cleaning.kept.size(), sweep.voltage_V.size());
  EXPECT_EQ(cleaning.kept.front(), 3u);
  EXPECT_NEAR(fit_sweeps(std::array{sweep}, {}).diode.photocurrent_A.value, 8.0, 0.01);
  // A curve that is not cleaned: the refusal names the reading.
  IvSweep dead = clipped_curve(0.0, 3);
  dead.current_A[0] = 0.0;
  EXPECT_THAT(refusal_of([&] { fit_sweeps(std::array{dead}, {}); }),
              testing::HasSubstr("0 A at 0 V"));
}

TEST(PhotovoltaicFit, CurvesThatGoOnBeyondTheirEndsStayWhole) {
  ivcurves::Truth truth{8.0, 1e-9, 5e-3, 50.0, 1.1, 1};
  const CellCurve cell(truth.parameters());
  for (const double step_V : {0.001, 0.01, 0.04}) {
    IvSweep sweep;
    for (double v = -0.2; v < 0.7; v += step_V) {
      sweep.voltage_V.push_back(v);
      sweep.current_A.push_back(cell.current_A(8.0, v));
    }
    const size_t points = sweep.voltage_V.size();
    const CurveCleaning cleaning = clean_curve(sweep);
    EXPECT_EQ(cleaning.clipped + cleaning.spikes, 0u) << step_V;
    EXPECT_EQ(sweep.voltage_V.size(), points);
  }
}

TEST(PhotovoltaicFit, SingleOutliersAreOmitted) {
  IvSweep sweep = clipped_curve(0.0, 0);
  sweep.current_A[20] = 0.0;   // a contact that opened
  sweep.current_A[55] += 0.2;  // on the falling part
  IvSweep cleaned = sweep;
  EXPECT_EQ(clean_curve(cleaned).spikes, 1u);
  const SweepFit fit = fit_sweeps(std::array{cleaned}, {});
  ASSERT_EQ(fit.outliers.size(), 1u);
  EXPECT_NEAR(fit.outliers[0].voltage_V, 0.55, 1e-9);
  EXPECT_NEAR(fit.diode.scale_V.value / 0.025693, 1.1, 0.02);
  // Without the first step the fit finds both.
  EXPECT_EQ(fit_sweeps(std::array{sweep}, {}).outliers.size(), 2u);
}

TEST(PhotovoltaicFit, FilesOfInstrumentsAreRead) {
  struct Written {
    const char* text;
    std::optional<double> irradiance_W_m2 = {}, temperature_K = {};
  };
  for (const Written& w : std::initializer_list<Written>{
           {"voltage_V,current_A\n0.1,0.5\n0.2,0.4\n"},
           {"\xEF\xBB\xBF\"V\",\"I\"\r\n0.1,0.5\r\n0.2,0.4\r\n"},
           {"Voltage (V);Current (mA)\n0,1;500\n0,2;400\n"},
           {"# by hand\nVolts\tAmps\n0.1\t0.5\n0.2\t0.4\n"},
           {"Module 17, 25 March\nIsc: 0.5\nCurrent [mA], Voltage [mV]\n500, 100\n400, 200\n"},
           {"V I\n 0.1   0.5\n 0.2   0.4\n"},
           {"voltage,current\nV,mA\n0.1,500\n0.2,400\n"},
           {"Time;U / V;I / A\n08:00;0.1;0.5\n08:01;0.2;0.4\n"},
           {"Spannung [V];Strom [mA]\n0,1;500\n0,2;400\n"},
           {"Tensión (V)\tCorriente (A)\n0,1\t0,5\n0,2\t0,4\n"},
           {"tension courant\n0,1 0,5\n0,2 0,4\n"},
           {"电压(V),电流(A)\n0.1,0.5\n0.2,0.4\n"},
           {"Spannung in V;Strom in mA;Einstrahlung in W/m2;Zelltemperatur in °C\n"
            "0,1;500;900;24\n0,2;400;1100;26\n",
            1000.0, 298.15},
           // KickStart, the buffer and the SCPI fields of Keithley's source-measure units, whose
           // current is counted into the device.
           {"KickStart Export\nModel,2460\n\nRun Index,Point,SMU-1 Voltage (V),SMU-1 Current (A),"
            "SMU-1 Time (s)\n1,1,1.0E-01,5.0E-01,0.1\n1,2,2.0E-01,4.0E-01,0.2\n"},
           {"Model,2450\n\nIndex,Reading,Unit,Source Value,Source Unit\n1,+5.0E-01,A,+1.0E-01,V\n"
            "2,+4.0E-01,A,+2.0E-01,V\n"},
           {"Index,Reading,Unit,Value,Unit\n1,100,mV,0.5,A\n2,200,mV,0.4,A\n"},
           {"VOLT,CURR,RES,TIME,STAT\n+1.0E-01,+5.0E-01,+9.91E+37,+0.0E+00,+2.1E+04\n"
            "+2.0E-01,+4.0E-01,+9.91E+37,+1.0E-01,+2.1E+04\n"},
           {"AnodeI,AnodeV,CathodeI\n0.5,0.1,-0.5\n0.4,0.2,-0.4\n"},
           // PVPM, Daystar, ESTI, HT, and lines above and below the readings.
           {"PVPM 1000C40\r\nUoc = 0,60 V\r\nEeff = 1000 W/m²\r\nTmod = 25,0 °C\r\n\r\n"
            "Nr\tU in V\tI in A\tP in W\r\n1\t0,1\t0,5\t0,05\r\n2\t0,2\t0,4\t0,08\r\n",
            1000.0, 298.15},
           {"\"Daystar, Inc.\",\"IVPC 3.11\"\n\"Irradiance (W/m^2)\",1000\n\"Cell Temp (C)\",25\n"
            "\"Volts\",\"Amps\",\"Watts\"\n0.1,0.5,0.05\n0.2,0.4,0.08\n",
            1000.0, 298.15},
           {"Device: AB123\n# Irradiance [W/m2]: 1000\nT_DUT [°C]: 25\n"
            "V_meas [V]\tI_meas [A]\tV_corr [V]\tI_corr [A]\n0.1\t0.5\t9\t9\n0.2\t0.4\t9\t9\n",
            1000.0, 298.15},
           {"Temperature coefficient: 0.05 %/K\nV (V),I (A),Vopc (V),Iopc (A)\n0.1,0.5,9,9\n"
            "0.2,0.4,9,9\n"},
           {"Vmod;Imod;\n0,1 V;500 mA;\n0,2 V;400 mA;\nIsc;0,5\nEnd of data\n"},
           {"Voltage (V) Current (mA)\n0.1 500\n0.2 400\n"},
           {"V [V],J [mA/cm^2]\n0.1,500\n0.2,400\n"},
           {"Vset,Vmeas,Imeas\n9,0.1,0.5\n9,0.2,0.4\n"},
           {"Vset,Imeas\n0.1,0.5\n0.2,0.4\n"},
           {"VA,IA\n0.1,0.5\n0.2,0.4\n"},
           // Names of unknown words with a known unit.
           {"Index,Potential applied (V),WE(1).Current (mA)\n1,0.1,500\n2,0.2,400\n"},
           {"time/s,Ewe/V,<I>/mA\n1,0.1,500\n2,0.2,400\n"},
           {"Bias voltage (V),Photocurrent (mA),Dark Current (mA)\n0.1,500,1\n0.2,400,2\n"},
           {"Voc (V),V_FW (mV),Error (A),Current\n9,100,9,0.5\n9,200,9,0.4\n"},
           {"E (V),J_FW (mA cm-2)\n0.1,500\n0.2,400\n"},
           {"U_in_V,J_in_mA_cm2\n0.1,500\n0.2,400\n"},
           {"V (V),J (mA*cm^-2)\n0.1,500\n0.2,400\n"},
           {"Voltage(in V),Current(in mA)\n0.1,500\n0.2,400\n"},
           {"Voltage [in volts];Current [in amps]\n0,1;0,5\n0,2;0,4\n"},
           // A current density without a unit, and dark columns beside those in light.
           {"Voltage,J\n0.1,500\n0.2,400\n"},
           {"Vdark,Jdark,Vlight,Jlight\n9,9,0.1,0.5\n9,9,0.2,0.4\n"},
           {"V_oc (V),Volts,Amps\n9,0.1,0.5\n9,0.2,0.4\n"},
           // A header that was added by hand above rows with other separators.
           {"voltage_V,current_A\n0.1\t0.5\t25\n0.2\t0.4\t25\n"},
           {"voltage_V,current_A\n0,1;0,5\n0,2;0,4\n"},
           {"Voltage (V),Current (A),Monitor (V)\n0.1,0.5,9\n0.2,0.4,9\n"},
           {"Potential (V),J (mA cm⁻²)\n0.1,500\n0.2,400\n"},
           {"2/25/2021 5:04 PM\nVoltage\tCurrent1\n0.1\t0.5\n0.2\t0.4\n"},
           {"voltage_mV,current_mA\n100,500\n150,NaN\n200,400\n250,9.91E37\n"},
           {"voltage_V,current_A,irradiance_W_m2,Temperature "
            "(C)\n0.1,0.5,900,24\n0.2,0.4,1100,26\n",
            1000.0, 298.15}}) {
    const auto curves = curves_in(w.text, "curve.csv");
    ASSERT_EQ(curves.size(), 1u) << w.text;
    const IvSweep& sweep = curves[0].sweep;
    ASSERT_EQ(sweep.voltage_V.size(), 2u) << w.text;
    EXPECT_NEAR(sweep.voltage_V[0], 0.1, 1e-15) << w.text;
    EXPECT_NEAR(sweep.voltage_V[1], 0.2, 1e-15) << w.text;
    EXPECT_NEAR(sweep.current_A[0], 0.5, 1e-15) << w.text;
    EXPECT_NEAR(sweep.current_A[1], 0.4, 1e-15) << w.text;
    EXPECT_EQ(curves[0].irradiance_W_m2.has_value(), w.irradiance_W_m2.has_value());
    if (w.irradiance_W_m2) {
      EXPECT_NEAR(*curves[0].irradiance_W_m2, *w.irradiance_W_m2, 1e-9);
      EXPECT_NEAR(curves[0].temperature_K.value_or(0.0), *w.temperature_K, 1e-9);
    }
  }
  // Names of the file's own.
  const CurveColumns columns = {{"voltage_mV", "ch1"}, {"current_A", "ch2"}};
  const auto named = curves_in("ch2;ch1\n0,5;100\n0,4;200\n", "x", columns);
  EXPECT_NEAR(named[0].sweep.voltage_V[1], 0.2, 1e-15);
  EXPECT_TRUE(is_curve_header("ch2;ch1", columns));
  EXPECT_FALSE(is_curve_header("ch2;ch1"));
  // Curves have only their own readings.
  EXPECT_TRUE(is_curve_header("Index;Spannung [V];Strom [A];Leistung [W];Zeit"));
  EXPECT_FALSE(is_curve_header("t,angle,voltage,current"));
  // The current counted into the device.
  const auto into = curves_in("V,I\n0,-0.5\n0.3,-0.4\n0.6,0.1\n", "x");
  EXPECT_TRUE(into[0].is_reversed);
  EXPECT_NEAR(into[0].sweep.current_A[0], 0.5, 1e-15);
  EXPECT_FALSE(curves_in("V,I\n0,0.5\n0.3,0.4\n0.6,-0.1\n", "x")[0].is_reversed);
  EXPECT_EQ(curves_in("V,I,sweep\n0,1,3\n0,2,4\n1,1,3\n", "x").size(), 2u);
  const auto message = [](const char* text) -> std::string {
    return refusal_of([&] { curves_in(text, "curve.csv"); });
  };
  EXPECT_THAT(message("0.1,0.5\n0.2,0.4\n"), testing::HasSubstr("a header that names a voltage"));
  EXPECT_THAT(message("V,I (mA/sr)\n0.1,35\n"), testing::HasSubstr("the unit ma/sr"));
  // A row without a voltage among the readings is a mistake, not their end.
  EXPECT_THAT(message("V,I\n0.1,0.5\nO.2,0.4\n0.3,0.3\n"), testing::HasSubstr("curve.csv:3"));
  EXPECT_TRUE(curves_in("V,J (mA/cm2)\n0.1,35\n", "x")[0].is_density);
  EXPECT_FALSE(is_curve_header("t,motor voltage,motor current,omega"));
  EXPECT_THAT(message("V,I,V,I\n0.1,0.5,0.1,0.4\n"),
              testing::HasSubstr("second column of this quantity"));
  // Several currents beside one voltage are several curves, several voltages are ambiguous.
  const auto scans =
      curves_in("Voltage (V),Forward (mA),Reverse (A)\n0.1,500,0.4\n0.2,400,0.3\n", "x");
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_NEAR(scans[0].sweep.current_A[1], 0.4, 1e-15);
  EXPECT_NEAR(scans[1].sweep.current_A[0], 0.4, 1e-15);
  EXPECT_NEAR(scans[1].sweep.voltage_V[1], 0.2, 1e-15);
  EXPECT_THAT(
      message("Bias (V),Probe (V),I\n0.1,0.1,0.5\n"),
      testing::HasSubstr("found \"Bias (V)\", \"Probe (V)\", expected one voltage: rename"));
  EXPECT_THAT(message("sweep,V,Front (A),Rear (A)\n1,0.1,0.1,0.5\n"),
              testing::HasSubstr("found \"Front (A)\", \"Rear (A)\", expected one current"));
  EXPECT_THAT(message("Voc (V),Isc (A)\n0.6,8\n"), testing::HasSubstr("a header that names"));
  EXPECT_TRUE(is_curve_header("Voltage (V),Forward (mA),Reverse (mA)"));
  EXPECT_FALSE(is_curve_header("t,motor voltage (V),motor current (A)"));
  EXPECT_TRUE(is_curve_header("Index,Reading,Unit,Source Value,Source Unit"));
  EXPECT_TRUE(is_curve_header("Vdark,Jdark,Vlight,Jlight"));
  for (const char* points : {"V_oc (V),I_sc (A)\n0.6,8\n", "V_mp_V,I_mp_A\n0.5,7\n"}) {
    EXPECT_THAT(message(points), testing::HasSubstr("a header that names a voltage"));
  }
  EXPECT_THAT(message("Vdark,Jdark\n0.1,0.5\n"), testing::HasSubstr("of a device in light"));
  EXPECT_EQ(curves_in("% T=39.8\nV,I\n0.1,0.5\n", "x")[0].without_unit, "T=39.8");
  EXPECT_THAT(message("V,I\n0.1,a\n"), testing::HasSubstr("curve.csv:2"));
  EXPECT_THAT(message("V,I,temperature\n0.1,0.5,25\n"), testing::HasSubstr("K or °C"));
}

// A module of 60 cells, 9 A, n 1.05, R_s 0.3 Ω, R_sh 200 Ω; its curve under light that changes by
// `light`, and with charge stored in the junction for `stored` readings: the diode's current at a
// diode voltage that lags by τ dV_d/dt.
struct Module {
  ivcurves::Truth truth{9.0, 5e-10, 0.3, 200.0, 1.05, 60};
  CellCurve cell = CellCurve(truth.parameters());

  template <typename Light>
  IvSweep sweep(const Light& light) const {
    IvSweep s;
    const double open_V = cell.open_circuit_V(9.0);
    for (int i = 0; i < 100; ++i) {
      const double v = open_V * i / 99.0;
      const double noise = unit_interval(hash_words(7, static_cast<uint64_t>(i))) - 0.5;
      s.voltage_V.push_back(v);
      s.current_A.push_back(cell.current_A(9.0 * light(i), v) * (1.0 + 1e-3 * noise));
    }
    return s;
  }
};

TEST(PhotovoltaicFit, ReadingsUnderOtherLightAreLeftOut) {
  const Module module;
  const auto dip = [](int i) { return i < 8 ? 0.98 : 1.0; };
  const auto cloud = [](int i) { return 1.0 - 0.04 * std::exp(-std::pow((i - 15) / 5.0, 2)); };
  const auto flash = [](int i) { return 1.0 + 0.03 * std::exp(-std::pow((i - 25) / 4.0, 2)); };
  const auto check = [&](IvSweep sweep, size_t fewest) {
    const UnsteadyLight found = take_unsteady_light(sweep, 1e-3);
    EXPECT_GE(found.readings, fewest);
    EXPECT_LT(found.readings, 25u);
    const SweepFit fit = fit_sweeps(std::array{sweep}, {});
    EXPECT_NEAR(fit.diode.scale_V.value, module.truth.scale_V(), 0.02 * module.truth.scale_V());
    EXPECT_NEAR(fit.diode.photocurrent_A.value, 9.0, 0.01);
    EXPECT_NEAR(fit.diode.series_ohm.value, 0.3, 0.01);
  };
  check(module.sweep(dip), 8);
  check(module.sweep(cloud), 10);
  check(module.sweep(flash), 8);
  // Steady light, and a step down as of a shadow on a substring, lose nothing.
  IvSweep steady = module.sweep([](int) { return 1.0; });
  EXPECT_EQ(take_unsteady_light(steady, 1e-3).readings, 0u);
  IvSweep step = module.sweep([](int i) { return i < 30 ? 1.05 : 1.0; });
  EXPECT_EQ(take_unsteady_light(step, 1e-3).readings, 0u);
  // With the irradiance of each reading all are used.
  IvSweep measured = module.sweep(cloud);
  for (int i = 0; i < 100; ++i) measured.light.push_back(cloud(i));
  const SweepFit fit = fit_sweeps(std::array{measured}, {});
  EXPECT_TRUE(fit.uses_light);
  EXPECT_EQ(fit.points, 100u);
  EXPECT_NEAR(fit.diode.photocurrent_A.value, 9.0, 0.01);
  EXPECT_NEAR(fit.diode.shunt_ohm.value, 200.0, 8.0);
  // A fall in proportion to the voltage has the curve of a leak, and no larger scatter.
  for (const double fall : {0.01, 0.03, 0.1}) {
    const auto falling = [=](int i) { return 1.0 - fall * (i / 99.0 - 0.5); };
    IvSweep monitored = module.sweep(falling);
    for (int i = 0; i < 100; ++i) monitored.light.push_back(falling(i));
    const SweepFit lit = fit_sweeps(std::array{monitored}, {});
    EXPECT_TRUE(lit.uses_light) << fall;
    EXPECT_NEAR(lit.diode.shunt_ohm.value, 200.0, 8.0) << fall;
    EXPECT_NEAR(lit.diode.photocurrent_A.value, 9.0, 0.01) << fall;
  }
  // A sensor that scatters while the light is steady is not.
  IvSweep scattered = module.sweep([](int) { return 1.0; });
  for (uint64_t i = 0; i < 100; ++i) {
    scattered.light.push_back(1.0 + 0.01 * (unit_interval(hash_words(8, i)) - 0.5));
  }
  EXPECT_FALSE(fit_sweeps(std::array{scattered}, {}).uses_light);
}

// The stored charge makes the diode's current that of a voltage τ dV_d/dt higher: to first order in
// τ this is the diffusion capacitance. The curve is made by that shift, bisected for the current.
TEST(PhotovoltaicFit, HysteresisGivesTheStoredCharge) {
  const Module module;
  const double open_V = module.cell.open_circuit_V(9.0), a = module.truth.scale_V();
  for (const double readings : {0.05, 0.3}) {
    std::string text = "t (ms),V,I\n";
    for (int i = 0; i < 200; ++i) {
      const bool rising = i < 100;
      const double v = open_V * (rising ? i : 199 - i) / 99.0;
      const double rate_V = (rising ? 1.0 : -1.0) * open_V / 99.0;  // per reading
      double low = -20.0, high = 10.0;
      for (int k = 0; k < 80; ++k) {
        const double current = 0.5 * (low + high), d = v + 0.3 * current;
        const double g = 5e-10 * std::exp(d / a) / a;
        const double moved = d + readings * rate_V / (1.0 + 0.3 * (g + 1.0 / 200.0));
        const double left = 9.0 - 5e-10 * std::expm1(moved / a) - d / 200.0 - current;
        (left > 0.0 ? low : high) = current;
      }
      char line[80];
      std::snprintf(line, sizeof line, "%.1f,%.6f,%.6f\n", 0.2 * i, v, low);
      text += line;
    }
    const IvSweep sweep = curves_in(text, "x")[0].sweep;
    EXPECT_TRUE(sweep.is_timed);
    const SweepFit fit = fit_sweeps(std::array{sweep}, {});
    ASSERT_TRUE(fit.storage.has_value());
    EXPECT_TRUE(fit.storage->is_timed);
    EXPECT_NEAR(fit.storage->time.value, readings * 2e-4, 0.1 * readings * 2e-4);
    EXPECT_NEAR(fit.diode.scale_V.value, a, 0.02 * a);
    EXPECT_NEAR(fit.diode.series_ohm.value, 0.3, 0.01);
    // The rising half alone gives another open-circuit voltage, and no storage.
    IvSweep half = sweep;
    for (std::vector<double>* column : {&half.voltage_V, &half.current_A, &half.rate_V_s}) {
      column->resize(100);
    }
    EXPECT_FALSE(fit_sweeps(std::array{half}, {}).storage.has_value());
  }
}

}  // namespace
}  // namespace photorque

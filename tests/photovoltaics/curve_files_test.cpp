// Curves as meters write them: tails, wild readings, files of instruments.
#include "photovoltaics/fit/curve_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/numerics/random.h"
#include "ivcurves.h"
#include "photovoltaics/fit/conditions.h"
#include "photovoltaics/fit/fit.h"

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

TEST(PhotovoltaicFit, SingleWildReadingsAreLeftOut) {
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
    std::optional<double> irradiance_W_m2, temperature_K;
  };
  for (const Written& w : std::initializer_list<Written>{
           {"voltage_V,current_A\n0.1,0.5\n0.2,0.4\n", {}, {}},
           {"\xEF\xBB\xBF\"V\",\"I\"\r\n0.1,0.5\r\n0.2,0.4\r\n", {}, {}},
           {"Voltage (V);Current (mA)\n0,1;500\n0,2;400\n", {}, {}},
           {"# by hand\nVolts\tAmps\n0.1\t0.5\n0.2\t0.4\n", {}, {}},
           {"Module 17, 25 March\nIsc: 0.5\nCurrent [mA], Voltage [mV]\n500, 100\n400, 200\n",
            {},
            {}},
           {"V I\n 0.1   0.5\n 0.2   0.4\n", {}, {}},
           {"voltage,current\nV,mA\n0.1,500\n0.2,400\n", {}, {}},
           {"Time;U / V;I / A\n08:00;0.1;0.5\n08:01;0.2;0.4\n", {}, {}},
           {"Spannung [V];Strom [mA]\n0,1;500\n0,2;400\n", {}, {}},
           {"Tensión (V)\tCorriente (A)\n0,1\t0,5\n0,2\t0,4\n", {}, {}},
           {"tension courant\n0,1 0,5\n0,2 0,4\n", {}, {}},
           {"电压(V),电流(A)\n0.1,0.5\n0.2,0.4\n", {}, {}},
           {"Spannung in V;Strom in mA;Einstrahlung in W/m2;Zelltemperatur in °C\n"
            "0,1;500;900;24\n0,2;400;1100;26\n",
            1000.0, 298.15},
           {"voltage_mV,current_mA\n100,500\n150,NaN\n200,400\n250,9.91E37\n", {}, {}},
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
    try {
      curves_in(text, "curve.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(message("0.1,0.5\n0.2,0.4\n").find("a header that names a voltage"), std::string::npos);
  EXPECT_NE(message("V,I (mA/cm2)\n0.1,35\n").find("the unit ma/cm2"), std::string::npos);
  EXPECT_NE(message("V,I,V,I\n0.1,0.5,0.1,0.4\n").find("second such column"), std::string::npos);
  EXPECT_NE(message("V,I\n0.1,a\n").find("curve.csv:2"), std::string::npos);
  EXPECT_NE(message("V,I,temperature\n0.1,0.5,25\n").find("K or °C"), std::string::npos);
}

}  // namespace
}  // namespace photorque

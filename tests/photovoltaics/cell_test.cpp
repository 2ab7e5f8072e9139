// One cell: closed forms, published high-precision curves, random parameters.
#include "photovoltaics/cell/cell.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bisection.h"
#include "core/constants.h"
#include "core/errors.h"
#include "core/numerics/random.h"
#include "core/parallel.h"
#include "ivcurves.h"
#include "photovoltaics/cell/model.h"
#include "photovoltaics/cell/table.h"
#include "reference.h"

namespace photorque {
namespace {

CellParameters ideal() {
  CellParameters p;
  p.saturation_1_A = 1e-10;
  p.shunt_ohm = 1e15;
  return p;
}

TEST(PhotovoltaicCell, IdealCellMatchesClosedForms) {
  const CellCurve cell(ideal());
  const double vt = cell.thermal_V(), light_A = 3.0;
  EXPECT_NEAR(cell.open_circuit_V(light_A), vt * std::log1p(light_A / 1e-10), 1e-15);
  EXPECT_EQ(cell.short_circuit_A(light_A), light_A);
  // At the maximum (1 + x) eˣ = 1 + I_L/I₀.
  const CellOperatingPoint best = cell.maximum_power(light_A);
  const double x = best.voltage_V / vt;
  EXPECT_NEAR(x + std::log1p(x), std::log1p(light_A / 1e-10), 1e-13);
}

TEST(PhotovoltaicCell, ResistiveLimitGivesAQuarterOfTheProduct) {
  // With a series resistance that dwarfs the junction's, the cell is a source of V_oc behind it.
  CellParameters p = ideal();
  p.series_ohm = 1e6;
  const CellOperatingPoint best = CellCurve(p).maximum_power(3.0);
  const double open_V = CellCurve(p).open_circuit_V(3.0);
  EXPECT_NEAR(best.power_W(), 0.25 * open_V * open_V / 1e6, 1e-5 * best.power_W());
}

// The voltage put back into the dark current, and derivatives of the dark current itself, at
// temperatures and shunts far apart.
TEST(PhotovoltaicCell, OneDiodeByTheOmegaFunctionSolvesItsEquation) {
  for (const double temperature_K : {120.0, 298.15, 420.0}) {
    for (const double shunt_ohm : {2.0, 180.0, 1e9}) {
      CellParameters p;
      p.saturation_1_A = 1e-11 * std::exp(0.15 * (temperature_K - 298.15));
      p.ideality_1 = 1.2;
      p.shunt_ohm = shunt_ohm;
      p.temperature_K = temperature_K;
      const CellCurve exact(p);
      const OneDiode cell(exact);
      for (double dark_A = -0.5; dark_A < 2.0; dark_A += 0.0137) {
        const DiodeVoltage at = cell.at(dark_A), solved = solved_diode_voltage(exact, dark_A);
        const DarkCurrent d = exact.dark(at.value_V);
        const double scale_V = 1.2 * exact.thermal_V();
        EXPECT_NEAR(d.value_A, dark_A, 1e-11 * (d.slope_S * scale_V + std::abs(dark_A)));
        EXPECT_NEAR(at.slope_ohm * d.slope_S, 1.0, 1e-9);
        EXPECT_NEAR(at.curvature_V_A2, -d.curvature_A_V2 * std::pow(at.slope_ohm, 3),
                    1e-9 * scale_V * std::pow(at.slope_ohm * d.slope_S / scale_V, 2) *
                        std::pow(at.slope_ohm, 2));
        EXPECT_NEAR(
            at.third_V_A3, solved.third_V_A3,
            1e-8 * (std::abs(solved.third_V_A3) + std::pow(at.slope_ohm, 3) / (scale_V * scale_V)));
      }
    }
  }
}

// The fixed point of the function: y + e^y = 1 at y = 0; and Ω = −y(0), with Ω e^Ω = 1.
TEST(PhotovoltaicCell, OmegaFunctionHasItsKnownValues) {
  EXPECT_NEAR(wright_log_omega(1.0), 0.0, 1e-13);
  EXPECT_NEAR(wright_log_omega(0.0), -0.56714329040978387300, 1e-13);
  EXPECT_NEAR(wright_log_omega(1.0 + std::exp(1.0)), 1.0, 1e-13);
  EXPECT_NEAR(wright_log_omega(1e7 + std::log(1e7)), std::log(1e7), 1e-13 * 17.0);
  EXPECT_EQ(wright_log_omega(-100.0), -100.0);
}

TEST(PhotovoltaicCell, DerivativesMatchDifferences) {
  const CellCurve cell(reference::cell());
  for (double v = -5.2; v < 0.75; v += 0.05) {
    const double h = 1e-5;
    const DarkCurrent low = cell.dark(v - h), at = cell.dark(v), high = cell.dark(v + h);
    EXPECT_NEAR((high.value_A - low.value_A) / (2 * h), at.slope_S, 1e-6 * at.slope_S) << v;
    EXPECT_NEAR((high.slope_S - low.slope_S) / (2 * h), at.curvature_A_V2,
                1e-5 * (std::abs(at.curvature_A_V2) + at.slope_S))
        << v;
  }
}

TEST(PhotovoltaicCell, MatchesBisectionInExtendedPrecision) {
  const CellParameters p = reference::cell();
  const CellCurve cell(p);
  for (double current_A = -10.0; current_A < 30.0; current_A += 0.613) {
    const double expected = static_cast<double>(bisection::cell_V(p, 6.0L, current_A));
    EXPECT_NEAR(cell.voltage_V(6.0, current_A), expected, 1e-14 * std::max(1.0, std::abs(expected)))
        << current_A;
  }
}

// cwhanse/ivcurves: curves computed with 40 digits (residuals below 1e-16 A).
TEST(PhotovoltaicCell, ReproducesThePublishedHighPrecisionCurves) {
  PHOTORQUE_NEEDS_THIRD_PARTY("reference/ivcurves");
  const std::vector<ivcurves::Curve> curves = ivcurves::read("case1");
  EXPECT_EQ(curves.size(), 32u);
  double worst = 0.0;
  const auto compare = [&](double found, double expected, double scale) {
    worst = std::max(worst, std::abs(found - expected) / scale);
  };
  for (const ivcurves::Curve& c : curves) {
    const CellCurve cell(c.truth.parameters());
    const double light_A = c.truth.photocurrent_A;
    ASSERT_EQ(c.voltage_V.size(), 100u);
    for (size_t i = 0; i < 100; ++i) {
      compare(cell.current_A(light_A, c.voltage_V[i]), c.current_A[i], c.short_circuit_A);
      compare(cell.voltage_V(light_A, c.current_A[i]), c.voltage_V[i], c.open_circuit_V);
    }
    const CellOperatingPoint best = cell.maximum_power(light_A);
    compare(cell.short_circuit_A(light_A), c.short_circuit_A, c.short_circuit_A);
    compare(cell.open_circuit_V(light_A), c.open_circuit_V, c.open_circuit_V);
    compare(best.power_W(), c.maximum_W, c.maximum_W);
    compare(best.voltage_V, c.maximum_V, c.maximum_V);
    compare(best.current_A, c.maximum_A, c.maximum_A);
    compare(cell.current_A(light_A, 0.5 * c.open_circuit_V), c.half_A, c.short_circuit_A);
  }
  EXPECT_LE(worst, 1e-12);
}

// --- random parameters --------------------------------------------------------------------------

struct RandomCell {
  CellParameters parameters;
  double photocurrent_A;
};

RandomCell random_cell(uint64_t seed, uint64_t index) {
  const auto between = [&](uint64_t dimension, double low, double high) {
    return low + (high - low) * unit_interval(hash_words(seed, index, dimension));
  };
  const auto decades = [&](uint64_t dimension, double low, double high) {
    return std::pow(10.0, between(dimension, low, high));
  };
  CellParameters p;
  p.temperature_K = between(0, 50.0, 600.0);
  p.saturation_1_A = decades(1, -25.0, -4.0);
  p.ideality_1 = between(2, 0.5, 2.5);
  p.saturation_2_A = between(3, 0.0, 1.0) < 0.5 ? 0.0 : decades(4, -15.0, -3.0);
  p.ideality_2 = between(5, 1.0, 5.0);
  p.series_ohm = between(6, 0.0, 1.0) < 0.2 ? 0.0 : decades(7, -5.0, 1.0);
  p.shunt_ohm = decades(8, -1.0, 9.0);
  p.breakdown_fraction = between(9, 0.0, 1.0) < 0.3 ? 0.0 : decades(10, -5.0, 0.0);
  p.breakdown_V = -decades(11, 0.0, 2.0);
  p.breakdown_exponent = between(12, 1.0, 12.0);
  return {p, decades(13, -9.0, 2.0)};
}

// Kirchhoff's current law at a point of the curve, in units of the rounding of its largest terms.
double kirchhoff_error(const CellCurve& cell, double photocurrent_A, double diode_V,
                       double current_A) {
  const DarkCurrent d = cell.dark(diode_V);
  const double rounding_V =
      std::abs(diode_V) + 2 * std::abs(current_A * cell.parameters().series_ohm);
  const double scale =
      std::abs(photocurrent_A) + std::abs(current_A) + std::abs(d.value_A) + d.slope_S * rounding_V;
  return std::abs(photocurrent_A - d.value_A - current_A) /
         (scale * std::numeric_limits<double>::epsilon());
}

#ifdef NDEBUG
constexpr size_t random_sets = 1000000;
#else
constexpr size_t random_sets = 20000;  // without optimisation
#endif

TEST(PhotovoltaicCell, MillionRandomCellsAreSolvedWithoutFailure) {
  constexpr size_t block = 1000;
  std::atomic<int> failures = 0;
  parallel_for(random_sets / block, 0, [&](size_t b) {
    for (size_t i = b * block; i < (b + 1) * block; ++i) {
      const auto [p, light_A] = random_cell(11, i);
      const CellCurve cell(p);
      const CellOperatingPoint best = cell.maximum_power(light_A);
      const double reverse_A = light_A * 1.5;
      const double reverse_V = cell.voltage_V(light_A, reverse_A);
      const double half_A = cell.current_A(light_A, 0.5 * best.voltage_V);
      const double half_diode_V = 0.5 * best.voltage_V + half_A * p.series_ohm;
      const double reverse_diode_V = cell.diode_voltage_V(light_A - reverse_A);
      const bool good = kirchhoff_error(cell, light_A, best.diode_V, best.current_A) < 64 &&
                        kirchhoff_error(cell, light_A, reverse_diode_V, reverse_A) < 64 &&
                        kirchhoff_error(cell, light_A, half_diode_V, half_A) < 64 &&
                        best.voltage_V > 0 && best.current_A > 0 && reverse_V < 0 &&
                        best.power_W() >= 0.5 * best.voltage_V * half_A * (1 - 1e-12);
      if (!good && failures.fetch_add(1) < 5) {
        ADD_FAILURE() << "set " << i << ": best " << best.voltage_V << " V, reverse " << reverse_V;
      }
    }
  });
  EXPECT_EQ(failures, 0);
}

TEST(PhotovoltaicCell, MaximumIsOneOnRandomCells) {
  for (uint64_t i = 0; i < 2000; ++i) {
    const auto [p, light_A] = random_cell(12, i);
    const CellCurve cell(p);
    const CellOperatingPoint best = cell.maximum_power(light_A);
    const double open_V = cell.open_circuit_V(light_A);
    for (int k = 1; k < 40; ++k) {
      const double v = open_V * k / 40.0;
      ASSERT_LE(v * cell.current_A(light_A, v), best.power_W() * (1 + 1e-12)) << i;
    }
  }
}

TEST(PhotovoltaicTable, IsExactOverItsRangeAndBeyond) {
  for (uint64_t i = 0; i < 30; ++i) {
    const auto [p, light_A] = random_cell(14, i);
    const CellCurve cell(p);
    const DiodeVoltageTable table(cell, light_A);
    for (uint64_t k = 0; k < 300; ++k) {
      const double sign = k % 2 ? 1.0 : -1.0;
      const double j =
          sign * light_A * std::pow(10.0, 1.0 - 9.0 * unit_interval(hash_words(15, i, k)));
      const double exact = cell.diode_voltage_V(j);
      const DiodeVoltage v = table.at(j);
      const double allowed = 4e-12 * p.ideality_1 * cell.thermal_V() + 1e-14 * std::abs(exact);
      EXPECT_NEAR(v.value_V, exact, allowed) << "cell " << i << " current " << j;
      EXPECT_NEAR(v.slope_ohm * cell.dark(exact).slope_S, 1.0, 1e-7) << "cell " << i << " " << j;
    }
  }
}

// PVsyst's at 800 W/m² and in the dark: the values of pvlib's test_calcparams_pvsyst (R_sh_ref 300
// Ω, R_sh_0 1000 Ω, R_sh_exp 5.5). Breakdown keeps its current.
TEST(PhotovoltaicCell, ShuntInLightIsThatOfTheNamedModels) {
  CellParameters p;
  p.shunt_ohm = 300.0;
  p.breakdown_fraction = 2e-3;
  EXPECT_EQ(in_light(p, 3.0).shunt_ohm, 300.0);
  p.shunt_light_A = 6.0;
  EXPECT_NEAR(in_light(p, 1.5).shunt_ohm, 1200.0, 1e-9);
  EXPECT_NEAR(in_light(p, 12.0).shunt_ohm, 150.0, 1e-9);
  EXPECT_NEAR(in_light(p, 1.5).breakdown_fraction / in_light(p, 1.5).shunt_ohm, 2e-3 / 300.0,
              1e-15);
  EXPECT_GT(in_light(p, 0.0).shunt_ohm, 1e5);
  EXPECT_TRUE(std::isfinite(in_light(p, 0.0).shunt_ohm));
  p.shunt_dark_ohm = 1000.0;
  EXPECT_NEAR(in_light(p, 0.8 * 6.0).shunt_ohm, 305.757, 5e-4);
  EXPECT_NEAR(in_light(p, 0.0).shunt_ohm, 1000.0, 1e-9);
  EXPECT_NEAR(in_light(p, 6.0).shunt_ohm, 300.0, 1e-9);
}

// tests/data/de_soto.py: De Soto's model by its equations in Python, as pvlib has it.
TEST(PhotovoltaicCell, ModuleInOtherConditionsIsDeSotos) {
  CellModel module;
  module.reference.saturation_1_A = 8.196e-10;
  module.reference.ideality_1 = 2.6373 / (boltzmann_J_K * 298.15 / elementary_charge_C);
  module.reference.series_ohm = 1.065;
  module.reference.shunt_ohm = 381.68;
  module.reference.shunt_light_A = 5.114;
  module.gap_eV = 1.121;
  module.gap_slope_1_K = -0.0002677;
  module.photocurrent_slope_1_K = 0.004539 / 5.114;
  const auto rows = csv_rows(reference::file("de_soto"));
  for (size_t r = 1; r < rows.size(); ++r) {
    const auto cell_of_row = [&](size_t column) { return std::stod(rows[r].at(column)); };
    const double irradiance_W_m2 = cell_of_row(0), kelvin = cell_of_row(1),
                 short_A = cell_of_row(2), open_V = cell_of_row(3), maximum_W = cell_of_row(4);
    const double light_A = 5.114 * irradiance_W_m2 / 1000.0 * photocurrent_factor(module, kelvin);
    const CellCurve cell(in_light(parameters_at(module, 1.0, kelvin), light_A));
    EXPECT_NEAR(cell.short_circuit_A(light_A), short_A, 1e-8 * short_A) << r;
    EXPECT_NEAR(cell.open_circuit_V(light_A), open_V, 1e-8 * open_V) << r;
    EXPECT_NEAR(cell.maximum_power(light_A).power_W(), maximum_W, 1e-8 * maximum_W) << r;
  }
  EXPECT_EQ(rows.size(), 21u);
}

TEST(PhotovoltaicCell, ParametersOutOfRangeAreNamed) {
  CellParameters p;
  p.shunt_ohm = -1.0;
  EXPECT_THROW(CellCurve{p}, InputError);
  p = {};
  p.breakdown_fraction = 8.0;
  EXPECT_THROW(CellCurve{p}, InputError);
  p = {};
  p.saturation_1_A = 0.0;
  EXPECT_THROW(CellCurve{p}, InputError);
}

}  // namespace
}  // namespace photorque

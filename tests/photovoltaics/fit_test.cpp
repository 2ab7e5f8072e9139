// Fitted parameters against those that made the curves, and predictions against measurements.
#include "photovoltaics/fit/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/numerics/median.h"
#include "core/numerics/random.h"
#include "core/text/parse.h"
#include "ivcurves.h"
#include "photovoltaics/fit/conditions.h"
#include "photovoltaics/fit/curve_text.h"
#include "tests/files.h"

namespace photorque {
namespace {

// Where a ray from the origin meets a curve: V(t)/I(t) of the ray's ratio, by bisection in V.
double ray_V(const CellCurve& cell, double light_A, double ohm) {
  double low = 0.0, high = cell.open_circuit_V(light_A);
  for (int i = 0; i < 80; ++i) {
    const double v = 0.5 * (low + high);
    (v < ohm * cell.current_A(light_A, v) ? low : high) = v;
  }
  return 0.5 * (low + high);
}

// The measure of the ivcurves benchmark: ten points along the fitted curve, each compared with
// where its ray from the origin meets the true curve. The benchmark counts 1 for the open circuit
// of most curves whatever was fitted; that one is left out here and V_oc itself compared instead.
double score(const SingleDiode& fit, const ivcurves::Truth& truth) {
  const CellCurve fitted(fit.parameters(298.15)), exact(truth.parameters());
  const double light_A = fit.photocurrent_A.value, open_V = fitted.open_circuit_V(light_A);
  double sum =
      std::abs(fitted.short_circuit_A(light_A) / exact.short_circuit_A(truth.photocurrent_A) -
               1.0) +
      std::abs(open_V / exact.open_circuit_V(truth.photocurrent_A) - 1.0);
  for (int k = 1; k < 9; ++k) {
    const double v = open_V * k / 9.0, i = fitted.current_A(light_A, v);
    const double exact_V = ray_V(exact, truth.photocurrent_A, v / i), exact_A = exact_V * i / v;
    sum += std::hypot(v / exact_V - 1.0, i / exact_A - 1.0);
  }
  return sum;
}

TEST(PhotovoltaicFit, ExactCurvesGiveTheirParametersBack) {
  PHOTORQUE_NEEDS_THIRD_PARTY("reference/ivcurves");
  const auto curves = ivcurves::read("case1");
  double sum = 0.0;
  for (const ivcurves::Curve& c : curves) {
    const SweepFit fit = fit_sweeps(std::array{IvSweep{c.voltage_V, c.current_A}}, {});
    EXPECT_NEAR(fit.diode.photocurrent_A.value / c.truth.photocurrent_A, 1.0, 1e-11);
    EXPECT_NEAR(fit.diode.saturation_A.value / c.truth.saturation_A, 1.0, 1e-9);
    EXPECT_NEAR(fit.diode.scale_V.value / c.truth.scale_V(), 1.0, 1e-10);
    EXPECT_NEAR(fit.diode.series_ohm.value / c.truth.series_ohm, 1.0, 1e-9);
    EXPECT_NEAR(fit.diode.shunt_ohm.value / c.truth.shunt_ohm, 1.0, 1e-9);
    sum += score(fit.diode, c.truth);
  }
  EXPECT_LE(sum, 1e-10);
}

// Sum of the relative errors of all parameters from 50 noisy repeats (the benchmark's score).
double noisy_score(const std::string& name) {
  const auto curves = ivcurves::read(name);
  std::vector<IvSweep> sweeps;
  for (const auto& c : curves) sweeps.push_back({c.voltage_V, c.current_A});
  // As the benchmark describes its sweeps: even steps, then noise that is uniform ±0.05 % in
  // voltage and 0.1 % in current with a correlation exp(−k/60).
  const EvenSweeps even = with_even_steps(sweeps, {1e-3, 5e-4 / std::sqrt(3.0), 60.0});
  const SingleDiode d = fit_sweeps(even.sweeps, even.noise).diode;
  const ivcurves::Truth& t = curves[0].truth;
  return std::abs(d.photocurrent_A.value / t.photocurrent_A - 1.0) +
         std::abs(d.saturation_A.value / t.saturation_A - 1.0) +
         std::abs(d.scale_V.value / t.scale_V() - 1.0) +
         std::abs(d.series_ohm.value / t.series_ohm - 1.0) +
         std::abs(d.shunt_ohm.value / t.shunt_ohm - 1.0);
}

TEST(PhotovoltaicFit, FiftyNoisyRepeatsGiveTheirParametersBack) {
  PHOTORQUE_NEEDS_THIRD_PARTY("reference/ivcurves");
  for (const auto& [name, most] : {std::pair{"case3a", 0.1}, std::pair{"case3c", 0.05}}) {
    EXPECT_LT(noisy_score(name), most) << name;
  }
}

TEST(PhotovoltaicFit, StandardErrorsAreTheScatterOfFits) {
  constexpr uint64_t runs = 60;
  ivcurves::Truth truth{2.0, 1e-9, 0.2, 200.0, 1.2, 20};
  const CellCurve cell(truth.parameters());
  const double open_V = cell.open_circuit_V(2.0);
  double squares = 0.0, predicted_gain = 0.0;
  for (uint64_t run = 0; run < runs; ++run) {
    IvSweep sweep;
    for (uint64_t i = 0; i < 60; ++i) {
      const double v = open_V * static_cast<double>(i) / 60.0;
      const auto noise = [&](uint64_t d) {  // variance 1
        return std::sqrt(12.0) * (unit_interval(hash_words(3, run, i, d)) - 0.5);
      };
      sweep.voltage_V.push_back(v * (1.0 + 5e-4 * noise(0)));
      sweep.current_A.push_back(cell.current_A(2.0, v) * (1.0 + 1e-3 * noise(1)));
    }
    const Estimate fitted = fit_sweeps(std::array{sweep}, {}).diode.series_ohm;
    squares += (fitted.value - 0.2) * (fitted.value - 0.2) / runs;
    predicted_gain += fitted.standard_error * fitted.standard_error / runs;
  }
  // A variance from 60 runs is uncertain by 18 %.
  EXPECT_NEAR(squares / predicted_gain, 1.0, 0.55);
}

// A curve without series resistance is explicit: I = I_L − I₀ (e^{V/a} − 1) − G V. Noise from
// uniform numbers of variance 1, if there is a draw.
IvSweep explicit_curve(double leak_S, std::optional<uint64_t> draw) {
  IvSweep sweep;
  for (uint64_t i = 0; i <= 60; ++i) {
    const double v = 0.011 * static_cast<double>(i);
    const double exact = 2.0 - 2e-10 * std::expm1(v / 0.0285) - leak_S * v;
    const double noise =
        draw ? std::sqrt(12.0) * (unit_interval(hash_words(17, *draw, i)) - 0.5) : 0.0;
    sweep.voltage_V.push_back(v);
    sweep.current_A.push_back(exact * (1.0 + 1e-3 * noise));
  }
  return sweep;
}

// A lower limit of 95 % lies below the truth in 95 of 100 draws, and a leak that shows is a number.
// 40 draws: with 95 % fewer than 34 have a chance of 3e-3 (binomial), and 40 of 40 is well possible
// because where the leak shows there is a number with an error instead.
TEST(PhotovoltaicFit, AShuntThatTheDataDoNotDetermineHasALowerLimit) {
  constexpr double leak_S = 1.0 / 1500.0;  // less than the noise shows, 1e-3 of 2 A over 0.5 V
  int limits = 0, right = 0;
  for (uint64_t draw = 0; draw < 40; ++draw) {
    const SweepFit fit = fit_sweeps(std::array{explicit_curve(leak_S, draw)}, {1e-3, 1e-7, 0.0});
    if (!fit.diode.shunt_above_ohm) {
      ++right;
      continue;
    }
    ++limits;
    right += *fit.diode.shunt_above_ohm < 1.0 / leak_S ? 1 : 0;
    EXPECT_GT(*fit.diode.shunt_above_ohm, 20.0);
  }
  EXPECT_GE(limits, 20);
  EXPECT_GE(right, 34);
  const SweepFit leaks = fit_sweeps(std::array{explicit_curve(0.1, 1)}, {1e-3, 1e-7, 0.0});
  EXPECT_FALSE(leaks.diode.shunt_above_ohm);
  EXPECT_NEAR(leaks.diode.shunt_ohm.value, 10.0, 4.0 * leaks.diode.shunt_ohm.standard_error);
  EXPECT_LT(leaks.diode.shunt_ohm.standard_error, 2.0);
  // It has no series resistance: the 95 % limit lies above none, and 1 mA at 2 A shows milliohms.
  ASSERT_TRUE(leaks.diode.series_below_ohm);
  EXPECT_LT(*leaks.diode.series_below_ohm, 5e-3);
}

TEST(PhotovoltaicFit, ABoundThatIsReachedIsNamed) {
  // Current that rises with the voltage, as of a negative leak.
  const SweepFit fit = fit_sweeps(std::array{explicit_curve(-2e-3, std::nullopt)}, {});
  ASSERT_FALSE(fit.bounds.empty());
  EXPECT_EQ(fit.bounds.back().key, "shunt_ohm");
  EXPECT_EQ(fit.bounds.back().meaning, "the fit has no leak");
  EXPECT_GT(fit.bounds.back().value, 1e7);
  EXPECT_TRUE(fit.diode.shunt_above_ohm);
}

const ivcurves::Truth rated_truth{8.0, 5e-10, 0.3, 400.0, 1.1, 60};

std::vector<RatedPoint> rated_points() {
  const CellCurve cell(rated_truth.parameters());
  std::vector<RatedPoint> points;
  for (const double sun : {1.0, 0.2}) {
    const double light_A = cell.photocurrent_A(8.0 * sun);
    const CellOperatingPoint best = cell.maximum_power(light_A);
    points.push_back({1000.0 * sun, 298.15, 8.0 * sun, cell.open_circuit_V(light_A), best.current_A,
                      best.voltage_V});
  }
  return points;
}

std::array<Estimate, 5> fitted_figures(const RatedFit& fit) {
  const SingleDiode& d = fit.diode;
  return {d.photocurrent_A, d.scale_V, d.series_ohm, d.shunt_ohm,
          Estimate{fit.model.gap_eV, fit.gap_error_eV}};
}

// The standard errors are the scatter of many fits, each of figures rounded at random.
TEST(PhotovoltaicFit, DatasheetErrorsAreTheScatterOfRoundedFigures) {
  constexpr int draws = 60;
  const std::vector<RatedPoint> exact = rated_points();
  const RatedTolerance tolerance{1e-3, 1e-2, 0.0};
  const double guess_V = 60 * 1.2 * 0.0257;
  const auto predicted_gain = fitted_figures(fit_rated_points(exact, {}, guess_V, tolerance));
  std::array<double, predicted_gain.size()> sum{}, squares{};
  for (uint64_t draw = 0; draw < draws; ++draw) {
    std::vector<RatedPoint> rounded = exact;
    for (uint64_t p = 0; p < rounded.size(); ++p) {
      const auto move = [&](double& figure, double step, uint64_t which) {
        figure += step * (unit_interval(hash_words(11, draw, p, which)) - 0.5);
      };
      move(rounded[p].short_circuit_A, tolerance.step_A, 0);
      move(rounded[p].maximum_A, tolerance.step_A, 1);
      move(rounded[p].open_circuit_V, tolerance.step_V, 2);
      move(rounded[p].maximum_V, tolerance.step_V, 3);
    }
    const auto found = fitted_figures(fit_rated_points(rounded, {}, guess_V));
    for (size_t k = 0; k < found.size(); ++k) {
      sum[k] += found[k].value - predicted_gain[k].value;
      squares[k] += std::pow(found[k].value - predicted_gain[k].value, 2);
    }
  }
  for (size_t k = 0; k < predicted_gain.size(); ++k) {
    const double scatter = std::sqrt((squares[k] - sum[k] * sum[k] / draws) / (draws - 1));
    // A scatter of 60 is known to 9 %.
    EXPECT_NEAR(predicted_gain[k].standard_error / scatter, 1.0, 0.35) << k;
    EXPECT_GT(predicted_gain[k].standard_error, 0.0) << k;
  }
}

TEST(PhotovoltaicFit, FiguresDetermineTheirRounding) {
  const std::array points = {RatedPoint{1000, 298.15, 5.116, 22.05, 4.66, 17.6},
                             RatedPoint{200, 298.15, 1.03, 20.0, 0.94, 17.0}};
  const RatedTolerance steps = written_steps(points);
  EXPECT_NEAR(steps.step_A, 1e-3, 1e-18);
  EXPECT_NEAR(steps.step_V, 1e-2, 1e-17);
}

TEST(PhotovoltaicFit, DatasheetFiguresOfAKnownModuleGiveItBack) {
  const ivcurves::Truth& truth = rated_truth;
  const std::vector<RatedPoint> points = rated_points();
  const RatedFit fit = fit_rated_points(points, {5e-4, -3e-3}, 60 * 1.3 * 0.0257);
  EXPECT_LT(fit.rms, 1e-9);
  EXPECT_NEAR(fit.diode.scale_V.value / truth.scale_V(), 1.0, 1e-5);
  EXPECT_NEAR(fit.diode.series_ohm.value / 0.3, 1.0, 1e-4);
  EXPECT_NEAR(fit.diode.shunt_ohm.value / 400.0, 1.0, 1e-3);
  // The slopes that were asked for are the model's.
  const RatedPoint warm = fit.predict(1000.0, 308.15);
  EXPECT_NEAR((warm.open_circuit_V / points[0].open_circuit_V - 1.0) / 10.0, -3e-3, 1e-9);
  EXPECT_NEAR((warm.short_circuit_A / points[0].short_circuit_A - 1.0) / 10.0, 5e-4, 1e-7);
}

// --- NREL mPERT: 20 modules over irradiance and temperature ---------------------------------

struct MeasuredModule {
  std::string name, technology;
  double cells = 0, current_slope_1_K = 0, voltage_slope_1_K = 0;
  std::vector<RatedPoint> points;
};

MeasuredModule read_module(const std::filesystem::path& file) {
  MeasuredModule module;
  module.name = file.stem().string();
  std::ifstream in(file);
  bool data = false;
  for (std::string line; std::getline(in, line);) {
    const auto read = [&](const std::string& key, double& number, double unit) {
      const size_t at = line.find(key);
      if (at != std::string::npos) number = unit * std::stod(line.substr(at + key.size()));
    };
    read("alpha_sc: ", module.current_slope_1_K, 0.01);
    read("beta_oc: ", module.voltage_slope_1_K, 0.01);
    read("Cells_in_Series: ", module.cells, 1.0);
    const std::vector<std::string_view> c = cells_of(line);
    if (data && c.size() >= 9 && !c[8].empty()) {
      const auto number = [&](size_t i) { return *number_in(c[i]); };
      module.points.push_back(
          {number(3), number(2) + 273.15, number(4), number(5), number(6), number(7)});
    }
    data = data || line.starts_with("seqno,date");
  }
  return module;
}

const RatedPoint* at(const MeasuredModule& module, double irradiance, double celsius) {
  for (const RatedPoint& p : module.points) {
    if (p.irradiance_W_m2 == irradiance && std::abs(p.temperature_K - 273.15 - celsius) < 0.1)
      return &p;
  }
  return nullptr;
}

TEST(PhotovoltaicFit, TwoPointsPredictTheRestOfEveryMeasuredModule) {
  PHOTORQUE_NEEDS_THIRD_PARTY("measured/nrel_mpert/modules");
  const auto folder = outside::third_party("measured/nrel_mpert/modules");
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(folder)) files.push_back(file.path());
  std::ranges::sort(files);
  std::vector<double> all, by_best_law;
  for (const auto& file : files) {
    const MeasuredModule module = read_module(file);
    const RatedPoint *bright = at(module, 1000, 25), *dim = at(module, 200, 25);
    ASSERT_TRUE(bright != nullptr && dim != nullptr) << module.name;
    const auto rms_of = [&](const RatedFit& fit) {
      double squares = 0.0, count = 0.0;
      for (const RatedPoint& p : module.points) {
        if (&p == bright || &p == dim) continue;
        const RatedPoint predicted = fit.predict(p.irradiance_W_m2, p.temperature_K);
        const double ratio =
            predicted.maximum_A * predicted.maximum_V / (p.maximum_A * p.maximum_V);
        squares += (ratio - 1.0) * (ratio - 1.0);
        count += 1.0;
      }
      return std::sqrt(squares / count);
    };
    const auto fit_by = [&](std::optional<ShuntLaw> law) {
      return fit_rated_points(
          std::array{*bright, *dim}, {module.current_slope_1_K, module.voltage_slope_1_K},
          module.cells > 0 ? 1.2 * 0.0257 * module.cells : bright->open_circuit_V / 20.0, {}, law);
    };
    all.push_back(rms_of(fit_by(ShuntLaw::constant)));
    by_best_law.push_back(rms_of(fit_by(std::nullopt)));
    // The law that is taken is never the worse one for the conditions that were left out.
    EXPECT_LE(by_best_law.back(), all.back()) << module.name;
    if (module.name.starts_with("aSi")) {
      EXPECT_LT(by_best_law.back(), 0.075) << module.name;
    }
  }
  EXPECT_EQ(all.size(), 20u);
  // The measurements themselves are good to 2.8 % (their authors).
  EXPECT_LT(upper_median(all), 0.028);
}

IvSweep third_party_sweep(const std::string& path) {
  const auto rows = csv_rows(outside::third_party(path));
  IvSweep sweep;
  for (size_t r = 1; r < rows.size(); ++r) {
    sweep.voltage_V.push_back(std::stod(rows[r].at(0)));
    sweep.current_A.push_back(std::stod(rows[r].at(1)));
  }
  return sweep;
}

// The plateaus of the measured curve: 1.727 to 1.732 A below 9 V, 1.667 to 1.688 A beyond 11 V.
// Such flat ones leave room for a string that is all leak, so steep that every error is the
// voltage's.
TEST(PhotovoltaicFit, FaintStepsAreNoLeak) {
  PHOTORQUE_NEEDS_THIRD_PARTY("measured/ddiv/IV_step2.csv");
  const ShadedFit fit = fit_shaded_string(third_party_sweep("measured/ddiv/IV_step2.csv"), 3, {});
  EXPECT_NEAR(fit.photocurrents_A[0].value, 1.73, 0.01);
  EXPECT_NEAR(fit.photocurrents_A[1].value, 1.68, 0.015);
  EXPECT_NEAR(fit.photocurrents_A[2].value, 1.67, 0.01);
  EXPECT_LT(fit.rms_A, 0.01);
}

TEST(PhotovoltaicFit, PartlyShadedStringHasBothMeasuredPeaks) {
  PHOTORQUE_NEEDS_THIRD_PARTY("measured/ddiv/IV_step3.csv");
  const IvSweep sweep = third_party_sweep("measured/ddiv/IV_step3.csv");
  const ShadedFit fit = fit_shaded_string(sweep, 3, {});
  const std::vector<ArrayPoint> maxima = fit.curve(298.15).maxima();
  // The largest powers among the measured points: 39.8 W at 19.93 V, 42.8 W at 33.07 V. The points
  // are 1.7 V apart there, so that a maximum may lie between two of them.
  const auto has = [&](double power_W, double voltage_V) {
    return std::ranges::any_of(maxima, [&](const ArrayPoint& p) {
      return std::abs(p.power_W() / power_W - 1.0) < 0.02 &&
             std::abs(p.voltage_V - voltage_V) < 1.0;
    });
  };
  EXPECT_TRUE(has(39.8, 19.93));
  EXPECT_TRUE(has(42.8, 33.07));
  EXPECT_LT(fit.rms_A, 0.01 * 2.085);
}

// --- A shunt that follows the light ------------------------------------------------------------

// Figures of a module with R_sh = 100 Ω · 1000/G, n 1.1, R_s 0.3 Ω and I_0 5e-9 A, from its
// equation with another program; maxima 235.641, 118.200, 46.027 and 22.282 W.
TEST(PhotovoltaicFit, AShuntInverseToTheLightIsFound) {
  const std::vector<RatedPoint> points = {{1000, 298.15, 8.9731, 36.068, 8.1782, 28.813},
                                          {500, 298.15, 4.4933, 34.895, 4.1057, 28.789},
                                          {200, 298.15, 1.7989, 33.344, 1.6450, 27.981},
                                          {100, 298.15, 0.8997, 32.171, 0.8224, 27.093}};
  const RatedFit fit =
      fit_rated_points(points, {}, 60 * 1.2 * 0.0257, written_steps(points), std::nullopt);
  EXPECT_EQ(fit.shunt_law, ShuntLaw::inverse);
  EXPECT_NEAR(fit.diode.series_ohm.value, 0.3, 0.003);
  EXPECT_NEAR(fit.diode.shunt_ohm.value, 100.0, 1.0);
  EXPECT_GT(fit.other_rms, 100.0 * fit.rms);
  EXPECT_LT(fit.rms_over_known, 3.0);
  const double maxima_W[] = {235.641, 118.200, 46.027, 22.282};
  for (size_t i = 0; i < points.size(); ++i) {
    const RatedPoint p = fit.predict(points[i].irradiance_W_m2, 298.15);
    EXPECT_NEAR(p.maximum_A * p.maximum_V / maxima_W[i], 1.0, 1e-3);
  }
  // A constant one misses the figures by far more than their rounding.
  EXPECT_GT(fit_rated_points(points, {}, 60 * 1.2 * 0.0257, written_steps(points)).rms_over_known,
            100.0);
}

// The exact curve of a cell, from short to open circuit.
CurveAt exact_curve(const CellCurve& cell, double light_A) {
  CurveAt one;
  one.temperature_K = cell.parameters().temperature_K;
  const double open_V = cell.open_circuit_V(light_A);
  for (int i = 0; i <= 50; ++i) {
    one.sweep.voltage_V.push_back(open_V * i / 50.0);
    one.sweep.current_A.push_back(cell.current_A(light_A, one.sweep.voltage_V.back()));
  }
  return one;
}

// Two lights and two temperatures from the equations: photocurrents, gap and shunt come back.
TEST(PhotovoltaicFit, CurvesUnderSeveralConditionsShareOneSetOfParameters) {
  CellModel truth;
  truth.reference = ivcurves::Truth{8.0, 5e-9, 0.3, 150.0, 1.2, 60}.parameters();
  truth.gap_eV = 1.15;
  truth.gap_slope_1_K = -0.0002677;
  for (const bool inverse : {false, true}) {
    std::vector<CurveAt> curves;
    for (const auto& [light_A, warmer_K] :
         {std::pair{8.0, 0.0}, {4.0, 10.0}, {1.0, -15.0}, {8.2, 30.0}}) {
      CellParameters p = parameters_at(truth, 1.0, truth.reference.temperature_K + warmer_K);
      if (inverse) p.shunt_ohm *= 8.0 / light_A;
      curves.push_back(exact_curve(CellCurve(p), light_A));
    }
    const ConditionsFit fit = fit_conditions(curves, {});
    EXPECT_EQ(fit.shunt_law, inverse ? ShuntLaw::inverse : ShuntLaw::constant);
    EXPECT_NEAR(fit.model.gap_eV, 1.15, 1e-5);
    EXPECT_NEAR(fit.diode.series_ohm.value, 0.3, 1e-5);
    EXPECT_NEAR(fit.diode.shunt_ohm.value, 150.0, 1e-2);
    EXPECT_NEAR(fit.curves[2].photocurrent_A.value, 1.0, 1e-6);
    EXPECT_LT(fit.rms, 1e-7);
  }
}

// Curves of two diodes and a constant shunt, which neither law of one diode describes: the law that
// is taken predicts the curves between, which no fit has seen, at least as well as the other.
TEST(PhotovoltaicFit, TheShuntLawIsChosenByCurvesThatAreLeftOut) {
  CellParameters truth = ivcurves::Truth{8.0, 5e-10, 0.3, 120.0, 1.0, 60}.parameters();
  truth.saturation_2_A = 2e-5;
  truth.ideality_2 = 2.0 * truth.ideality_1;
  const CellCurve cell(truth);
  std::vector<CurveAt> seen, kept;
  for (const double light_A : {8.0, 5.0, 2.5, 1.2, 0.6}) seen.push_back(exact_curve(cell, light_A));
  for (const double light_A : {6.5, 3.5, 1.7, 0.8}) kept.push_back(exact_curve(cell, light_A));
  const auto off = [&](std::optional<ShuntLaw> law) {
    const ConditionsFit fit = fit_conditions(seen, {}, law);
    double squares = 0.0;
    for (const CurveAt& one : kept) {
      const double isc = one.sweep.current_A.front();
      double best = 1e300;
      for (double light_A = 0.999 * isc; light_A < 1.02 * isc; light_A += 1e-4 * isc) {
        const CellCurve fitted(in_light(fit.model.reference, light_A));
        double sum = 0.0;
        for (size_t i = 0; i < one.sweep.voltage_V.size(); ++i) {
          const double r =
              fitted.current_A(light_A, one.sweep.voltage_V[i]) - one.sweep.current_A[i];
          sum += r * r / (isc * isc);
        }
        best = std::min(best, sum);
      }
      squares += best;
    }
    return squares;
  };
  const double constant = off(ShuntLaw::constant), inverse = off(ShuntLaw::inverse);
  EXPECT_LE(off(std::nullopt), 1.02 * std::min(constant, inverse));
}

TEST(PhotovoltaicFit, WrongDataAreRefused) {
  EXPECT_THROW(fit_sweeps({}, {}), InputError);
  EXPECT_THROW(fit_sweeps(std::array{IvSweep{{0, 1}, {1, 0}}}, {}), InputError);
  // Eight times the same reading fits every cell.
  const IvSweep same{std::vector<double>(8, 0.3), std::vector<double>(8, 5.0)};
  EXPECT_THROW(fit_sweeps(std::array{same}, {}), InputError);
  const IvSweep dark{{0, 1, 2, 3, 4, 5, 6}, {0, -1, -2, -3, -4, -5, -6}};
  EXPECT_THROW(fit_sweeps(std::array{dark}, {}), InputError);
  RatedPoint impossible{1000, 298.15, 5.0, 20.0, 6.0, 16.0};
  EXPECT_THROW(fit_rated_points(std::array{impossible}, {}, 1.0), InputError);
}

}  // namespace
}  // namespace photorque

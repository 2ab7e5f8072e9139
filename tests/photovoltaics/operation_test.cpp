// Trackers, losses, a day with battery, and the search for a wiring.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/numerics/random.h"
#include "photovoltaics/array/day.h"
#include "photovoltaics/array/layout.h"
#include "photovoltaics/array/losses.h"
#include "photovoltaics/array/tracker.h"
#include "reference.h"

namespace photorque {
namespace {

constexpr size_t cells = 12;

ArrayWiring three_substrings() {
  return reference::series(3, 4, 4);
}

CellTables tables() {
  return CellTables(cells, reference::table(reference::cell()));
}

// Columns of one light each: 5, `second` and `third` ampere.
std::vector<double> light_of_columns(double first, double second, double third) {
  std::vector<double> light;
  for (size_t i = 0; i < cells; ++i)
    light.push_back(i % 3 == 0 ? first : i % 3 == 1 ? second : third);
  return light;
}

std::vector<TrackerRun> run(const LightHistory& light) {
  std::vector<Tracker> trackers;
  for (const auto kind :
       {Tracker::Kind::perturb_and_observe, Tracker::Kind::incremental_conductance,
        Tracker::Kind::global_scan, Tracker::Kind::periodic_sweep}) {
    Tracker tracker;
    tracker.kind = kind;
    tracker.sweep_every_s = 10.0;
    trackers.push_back(tracker);
  }
  return run_trackers(trackers, three_substrings(), tables(), light);
}

TEST(PhotovoltaicTracker, EvenSteadyLightIsTrackedToTheStep) {
  for (const TrackerRun& r :
       run({{0.0, 60.0}, {light_of_columns(5, 5, 5), light_of_columns(5, 5, 5)}})) {
    EXPECT_LE(r.energy_J, r.best_energy_J * (1 + 1e-12));
    EXPECT_EQ(r.false_maximum_s, 0.0);
    // A step of 1 % of the range costs less than 0.5 %; sweeps of 4 s in 14 s cost more.
    const bool sweeps = r.tracker.kind == Tracker::Kind::periodic_sweep;
    const bool scans = sweeps || r.tracker.kind == Tracker::Kind::global_scan;
    EXPECT_GT(r.efficiency, sweeps ? 0.75 : scans ? 0.94 : 0.985) << name_of(r.tracker.kind);
  }
}

// The light moves off two thirds of the array: the best voltage jumps to that of one column.
TEST(PhotovoltaicTracker, StepwiseTrackersStayOnAFalseMaximumAndScansLeaveIt) {
  const LightHistory light{{0.0, 10.0, 11.0, 80.0},
                           {light_of_columns(5, 5, 5), light_of_columns(5, 5, 5),
                            light_of_columns(5, 0.8, 0.8), light_of_columns(5, 0.8, 0.8)}};
  const ArrayCurve shaded(three_substrings(), tables(), light_of_columns(5, 0.8, 0.8));
  ASSERT_EQ(shaded.maxima().size(), 2u);
  const std::vector<TrackerRun> runs = run(light);
  const auto of = [&](Tracker::Kind kind) { return runs[static_cast<size_t>(kind)]; };
  EXPECT_GT(of(Tracker::Kind::perturb_and_observe).false_maximum_s, 50.0);
  EXPECT_LT(of(Tracker::Kind::global_scan).false_maximum_s, 10.0);
  EXPECT_LT(of(Tracker::Kind::periodic_sweep).false_maximum_s, 30.0);
  EXPECT_GT(of(Tracker::Kind::global_scan).power_W.back(),
            1.1 * of(Tracker::Kind::perturb_and_observe).power_W.back());
  for (const TrackerRun& r : runs) {
    for (size_t i = 0; i < r.power_W.size(); ++i) {
      ASSERT_LE(r.power_W[i], r.best_W[i] * (1 + 1e-9)) << name_of(r.tracker.kind);
    }
  }
}

TEST(PhotovoltaicTracker, LightIsStraightBetweenInstants) {
  const LightHistory light{{1.0, 3.0}, {{2.0}, {4.0}}};
  EXPECT_EQ(light.at(0.0)[0], 2.0);
  EXPECT_DOUBLE_EQ(light.at(1.5)[0], 2.5);
  EXPECT_EQ(light.at(9.0)[0], 4.0);
}

// --- an array in light that falls off across it ---------------------------------------------

struct Lit {
  ArrayDesign design;
  ArrayLight light;
  ArrayResult result;
};

Lit lit(double slope) {
  Lit l;
  l.design = reference::array_in_series(3, 4, 4);
  std::vector<double> irradiance;
  for (int i = 0; i < 12; ++i) irradiance.push_back(1000.0 * (1.0 - slope * (i % 3)));
  l.light = array_light(3, 4, 0.3, 0.4, irradiance);
  l.result = evaluate_array(l.design, l.light, std::array{0.55});
  return l;
}

TEST(PhotovoltaicLosses, FallFromStageToStageAndEndAtTheArray) {
  const Lit l = lit(0.2);
  LossInputs in;
  in.emitted_W = 150.0;
  in.on_receiver_W = 125.0;
  in.photon_V = 1.698;
  in.quantum_efficiency = 0.55 * 1.698;
  in.wall_plug_efficiency = 0.5;
  in.converter_efficiency = 0.9;
  const auto stages = loss_waterfall(l.result, in);
  EXPECT_NEAR(stages.front().power_W, 300.0, 1e-12);
  for (size_t i = 1; i < stages.size(); ++i) {
    EXPECT_LE(stages[i].power_W, stages[i - 1].power_W * (1 + 1e-12)) << stages[i].name;
  }
  EXPECT_NEAR(stages.back().power_W, 0.9 * l.result.power_W.value, 1e-12);
}

TEST(PhotovoltaicLosses, UniformityOfALinearSlope) {
  const Lit l = lit(0.2);
  std::vector<int> all(12);
  std::iota(all.begin(), all.end(), 0);
  const Uniformity u = uniformity(l.result, all);
  EXPECT_NEAR(u.mean_W_m2, 800.0, 1e-9);
  EXPECT_NEAR(u.minimum_over_mean, 0.75, 1e-12);
  EXPECT_NEAR(u.variation, 0.25 * std::sqrt(2.0 / 3.0), 1e-12);
}

TEST(PhotovoltaicLosses, KnownCellsAt730NanometresStayBelowTheirPhotons) {
  // 730 nm: 1.6984 eV per photon, so 0.5888 A/W at most; 38 % then needs EQE V_oc FF = 0.645 V.
  const double photon_V = 1.239841984e-6 / 730e-9;
  EXPECT_NEAR(1.0 / photon_V, 0.5888, 5e-5);
  EXPECT_NEAR(0.38 * photon_V, 0.645, 5e-4);
  for (const CellFigures& f : known_cell_figures(1000.0, photon_V, 0.95, 298.15)) {
    EXPECT_NEAR(f.efficiency, f.product_V / photon_V, 1e-12);
    EXPECT_LT(f.efficiency, 0.38) << f.name;
    EXPECT_GT(f.efficiency, 0.25) << f.name;
  }
}

TEST(PhotovoltaicLosses, SensitivitiesHaveTheirSigns) {
  const Lit l = lit(0.1);
  for (const ArraySensitivity& s : sensitivities(l.design, l.result)) {
    const bool more_light = s.change.find("+1 %") != std::string::npos;
    EXPECT_EQ(s.relative > 0, more_light) << s.change;
    // The power rises as the light, and with it slowly the voltage.
    if (more_light) {
      EXPECT_NEAR(s.relative, 0.01, 0.001);
    }
  }
}

// --- a day ------------------------------------------------------------------------------------

// The battery alone, without losses.
DaySettings night() {
  DaySettings day;
  day.lamps_on = false;
  day.battery.discharge_efficiency = 1.0;
  return day;
}

TEST(PhotovoltaicDay, BatteryAloneLastsItsCapacityOverTheLoad) {
  const Lit l = lit(0.0);
  DaySettings day = night();
  day.load_W = 15.0;
  DayResult result = run_day(l.design, l.result, day);
  EXPECT_FALSE(result.empty_after_s.has_value());  // 360 Wh are 24 h of 15 W to the last second
  EXPECT_NEAR(result.charge_J.back(), 0.0, 1e-3);
  day.load_W = 25.0;
  result = run_day(l.design, l.result, day);
  ASSERT_TRUE(result.empty_after_s.has_value());
  EXPECT_NEAR(*result.empty_after_s, 14.4 * 3600.0, day.step_s);
}

TEST(PhotovoltaicDay, EnergyOfTheBatteryIsThatOfTheArrayLessTheLoad) {
  const Lit l = lit(0.1);
  DaySettings day;
  day.converter_efficiency = 0.9;
  day.load_W = 0.5 * l.result.power_W.value;
  day.duration_s = 7200.0;
  day.battery.capacity_J = 1e9;
  day.battery.charge = 0.5;
  day.battery.charge_efficiency = 1.0;
  const DayResult result = run_day(l.design, l.result, day);
  EXPECT_NEAR(result.charge_J.back() - result.charge_J.front(),
              0.9 * result.array_energy_J - day.load_W * day.duration_s,
              1e-6 * result.array_energy_J);
}

// A duration that is no whole number of steps is kept: 25 W for 100 s are 2500 J.
TEST(PhotovoltaicDay, EndsWhenItsDurationIsOver) {
  const Lit l = lit(0.0);
  DaySettings day = night();
  day.duration_s = 100.0;
  const DayResult result = run_day(l.design, l.result, day);
  EXPECT_NEAR(result.time_s.back(), 100.0, 1e-9);
  EXPECT_NEAR(result.charge_J.front() - result.charge_J.back(), 2500.0, 1e-6);
}

// 0.5 % per kelvin over 40 K leave 0.8; half of the rise is reached after τ ln 2.
TEST(PhotovoltaicDay, WarmLampsGiveLessByTheirRollOff) {
  LampDroop lamp;
  lamp.roll_off_1_K = 0.005;
  lamp.rise_K = 40.0;
  lamp.rise_time_constant_s = 100.0;
  EXPECT_EQ(lamp.light_at(0.0), 1.0);
  EXPECT_NEAR(lamp.light_at(100.0 * std::log(2.0)), 0.9, 1e-15);
  EXPECT_NEAR(lamp.light_at(1e6), 0.8, 1e-15);
  EXPECT_NEAR(lamp.min_light(), 0.8, 1e-15);
  lamp.depth = 0.1;
  EXPECT_NEAR(lamp.light_at(1e6), 0.72, 1e-15);
}

// The steady state that evaluate_array() finds is where a long day ends.
TEST(PhotovoltaicDay, CellsWarmUpToTheSteadyState) {
  Lit l = lit(0.0);
  DaySettings day;
  day.duration_s = 7200.0;
  for (const bool still_air : {true, false}) {
    l.design.heat = CellHeat{};
    if (!still_air) l.design.heat->convection_W_m2_K = 6.0;
    l.result = evaluate_array(l.design, l.light, std::array{0.55});
    ArrayDesign warm = l.design;
    warm.temperature_K = l.result.temperature_K.value;
    const DayResult result = run_day(warm, l.result, day);
    EXPECT_GT(l.result.temperature_K.value, 310.0);
    EXPECT_NEAR(result.temperature_K.back(), l.result.temperature_K.value, 0.02);
    EXPECT_NEAR(result.array_W.back(), l.result.power_W.value, 1e-3 * l.result.power_W.value);
    EXPECT_EQ(result.temperature_K.front(), 293.15);
    EXPECT_GT(result.array_W.front(), 1.02 * result.array_W.back());
  }
}

// --- layout ---------------------------------------------------------------------------------

TEST(PhotovoltaicLayout, ExactSearchFindsThePlantedAnswer) {
  // Six cells of two lights, interleaved: the best of the ten ways into two substrings of three
  // keeps like with like.
  const ArrayWiring start = reference::series(1, 6, 3);
  const CellTables six(6, reference::table(reference::cell()));
  const AttitudeLights light{{5.0, 1.0, 5.0, 1.0, 5.0, 1.0}};
  const LayoutResult found = search_layout(start, six, light, 1000);
  EXPECT_TRUE(found.exact);
  EXPECT_EQ(found.tried, 10 + 1);
  const ArrayCurve sorted(start, six, {5.0, 5.0, 5.0, 1.0, 1.0, 1.0});
  EXPECT_NEAR(found.power_W, sorted.maximum_power().power_W(), 1e-12);
  EXPECT_GT(found.power_W, 1.2 * found.start_power_W);
  EXPECT_LE(found.power_W, found.bound_W);
  // One string under one light reaches its bound, and the search stops there.
  EXPECT_NEAR(found.bound_W, found.power_W, 1e-10 * found.power_W);
  const LayoutResult quick = search_layout(start, six, light, 3);
  EXPECT_TRUE(quick.exact);
  EXPECT_NEAR(quick.power_W, found.power_W, 1e-10 * found.power_W);
}

// Against every way to join eight cells into two strings of two substrings of two, or one string of
// a substring of two and one of six.
TEST(PhotovoltaicLayout, NoWiringExceedsTheBound) {
  const CellTables eight(8, reference::table(reference::cell()));
  Diode junction;
  junction.kind = Diode::Kind::junction;
  const std::array<Diode, 3> diodes = {Diode{}, reference::clamp(), junction};
  for (uint64_t seed = 0; seed < 6; ++seed) {
    AttitudeLights light(1);
    double alone_W = 0.0;
    for (uint64_t i = 0; i < 8; ++i) {
      light[0].push_back(0.5 + 5.0 * unit_interval(hash_words(seed, 77, i)));
      alone_W += eight[i]->curve().maximum_power(light[0][i]).power_W();
    }
    for (const int strings : {1, 2}) {
      RegularWiring options;
      options.strings = strings;
      options.bypass_every = strings == 1 ? 6 : 2;
      options.bypass = diodes[seed % 3];
      options.blocking = strings == 1 ? Diode{} : diodes[(seed + seed / 3) % 3];
      const LayoutResult all = search_layout(regular_wiring(2, 4, options), eight, light, 100000);
      EXPECT_TRUE(all.exact);
      EXPECT_GT(all.tried, 20);
      EXPECT_LE(all.power_W, all.bound_W);
      EXPECT_LE(all.bound_W, alone_W * (1 + 1e-12));
      // Substrings of six and two make the first bound looser.
      EXPECT_LE(all.bound_W, (strings == 1 ? 1.6 : 1.35) * all.power_W) << seed;
    }
  }
}

TEST(PhotovoltaicLayout, HeuristicComesWithinAPercentOfTheExactAnswer) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    AttitudeLights lights(2);
    for (uint64_t a = 0; a < 2; ++a) {
      for (uint64_t i = 0; i < 9; ++i)
        lights[a].push_back(1.0 + 5.0 * unit_interval(hash_words(seed, a, i)));
    }
    const ArrayWiring start = reference::series(3, 3, 3);
    const CellTables nine(9, reference::table(reference::cell()));
    const LayoutResult exact = search_layout(start, nine, lights, 1000);
    const LayoutResult quick = search_layout(start, nine, lights, 279);
    EXPECT_TRUE(exact.exact);
    EXPECT_EQ(exact.tried, 280 + 1);  // 9!/(3!³ 3!) ways, and the start
    EXPECT_LT(quick.tried, exact.tried);
    EXPECT_LE(exact.power_W, exact.bound_W);
    EXPECT_LE(exact.bound_W, 1.1 * exact.power_W) << "5.9 % and 9.7 % in two of four";
    EXPECT_LE(quick.power_W, exact.power_W * (1 + 1e-12));
    EXPECT_GE(quick.power_W, 0.99 * exact.power_W);
  }
}

}  // namespace
}  // namespace photorque

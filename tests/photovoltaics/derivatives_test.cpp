// Derivatives of points of a curve with respect to the photocurrents, against central differences;
// curves with changes to the array; points near readings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "photovoltaics/array/design.h"
#include "photovoltaics/network/curve.h"
#include "tests/photovoltaics/reference.h"

namespace photorque {
namespace {

constexpr int columns = 4, rows = 3;

// One diode without breakdown, for which every law is tried; 25 cm² of silicon.
CellParameters a_cell() {
  return {1.2e-11, 1.05, 0.0, 2.0, 0.01, 150.0, 0.0, -15.0, 3.0, 298.15};
}

struct ArrayUnderTest {
  ArrayWiring wiring;
  std::vector<double> photocurrents_A;
  ArrayChanges changes;
  std::shared_ptr<const DiodeVoltageLaw> law = diode_voltage_law(a_cell());

  explicit ArrayUnderTest(int strings, Diode::Kind diodes = Diode::Kind::clamp,
                          bool cross_tied = false) {
    RegularWiring options;
    options.strings = strings;
    options.bypass_every = cross_tied ? 2 : 3;
    options.cross_tied = cross_tied;
    options.bypass.kind = diodes;
    if (diodes == Diode::Kind::junction) options.blocking.kind = diodes;
    wiring = regular_wiring(columns, rows, options);
    for (int i = 0; i < columns * rows; ++i) {
      photocurrents_A.push_back(0.8 + 0.3 * std::sin(1.7 * i));
    }
  }
  ArrayCurve curve() const {
    return {wiring, CellTables(photocurrents_A.size(), law), photocurrents_A, changes};
  }
  // Central difference by the photocurrent of a cell.
  template <class F>
  double difference(size_t cell, const F& of_curve) const {
    constexpr double step_A = 1e-5;
    ArrayUnderTest high = *this, low = *this;
    high.photocurrents_A[cell] += step_A;
    low.photocurrents_A[cell] -= step_A;
    return (of_curve(high.curve()) - of_curve(low.curve())) / (2.0 * step_A);
  }
};

std::vector<ArrayUnderTest> arrays_under_test() {
  std::vector<ArrayUnderTest> all = {
      ArrayUnderTest(1), ArrayUnderTest(2), ArrayUnderTest(1, Diode::Kind::junction),
      ArrayUnderTest(2, Diode::Kind::junction), ArrayUnderTest(2, Diode::Kind::junction, true)};
  // Pairs of pairs in parallel, beside diodes of both kinds.
  for (const Diode::Kind kind : {Diode::Kind::clamp, Diode::Kind::junction}) {
    ArrayUnderTest nested(1);
    Diode d;
    d.kind = kind;
    using Join = CellGroup::Join;
    std::vector<CellGroup> groups;
    for (int first = 0; first < columns * rows; first += 4) {
      groups.push_back({Join::parallel,
                        {{Join::series, {first, first + 1}, first == 4 ? d : Diode{}},
                         {Join::series, {first + 2, first + 3}, first == 4 ? d : Diode{}}},
                        first == 4 ? Diode{} : d});
    }
    nested.wiring = wiring_of({Join::series, groups}, {});
    all.push_back(nested);
  }
  const size_t plain = all.size();
  for (size_t i = 0; i < plain; ++i) {
    ArrayUnderTest with_resistance = all[i];
    with_resistance.changes.series_ohm = 0.15;
    with_resistance.changes.cell_offset_V = 0.01;
    all.push_back(with_resistance);
  }
  return all;
}

TEST(PhotovoltaicDerivatives, MaximumMovesWithEveryPhotocurrent) {
  for (const ArrayUnderTest& array : arrays_under_test()) {
    const ArrayCurve curve = array.curve();
    const auto moved = curve.maximum_by_photocurrent(curve.maximum_power());
    for (size_t k = 0; k < array.photocurrents_A.size(); ++k) {
      const double voltage_ohm =
          array.difference(k, [](const ArrayCurve& c) { return c.maximum_power().voltage_V; });
      const double current =
          array.difference(k, [](const ArrayCurve& c) { return c.maximum_power().current_A; });
      EXPECT_NEAR(moved.voltage_ohm[k], voltage_ohm, 1e-4 * std::max(1.0, std::abs(voltage_ohm)));
      EXPECT_NEAR(moved.current[k], current, 1e-4);
    }
  }
}

TEST(PhotovoltaicDerivatives, CurrentAtAVoltageMovesWithEveryPhotocurrent) {
  for (const ArrayUnderTest& array : arrays_under_test()) {
    const ArrayCurve curve = array.curve();
    for (const double part : {0.3, 0.7, 0.9}) {
      const double voltage_V = part * curve.open_circuit_V();
      const auto current_A = [&](const ArrayCurve& c) { return c.current_A(voltage_V); };
      const auto moved = curve.current_by_photocurrent({voltage_V, current_A(curve)});
      for (size_t k = 0; k < array.photocurrents_A.size(); ++k) {
        EXPECT_NEAR(moved[k], array.difference(k, current_A), 1e-5) << part;
      }
    }
  }
}

// The maxima are equal for each law of the cells' voltages.
TEST(PhotovoltaicDerivatives, EveryLawOfTheDiodeGivesTheSameMaxima) {
  for (const int strings : {1, 2}) {
    ArrayUnderTest array(strings);
    const std::vector<ArrayPoint> closed_form = array.curve().maxima();
    ASSERT_GE(closed_form.size(), 2u);
    CellParameters hardly_breaking = a_cell();
    hardly_breaking.breakdown_fraction = 1e-300;  // leaves nothing but the search
    const CellTables others = {reference::table(a_cell()), diode_voltage_law(hardly_breaking)};
    for (const auto& law : others) {
      array.law = law;
      const std::vector<ArrayPoint> maxima = array.curve().maxima();
      ASSERT_EQ(maxima.size(), closed_form.size());
      for (size_t i = 0; i < maxima.size(); ++i) {
        EXPECT_NEAR(maxima[i].voltage_V, closed_form[i].voltage_V, 1e-9);
        EXPECT_NEAR(maxima[i].current_A, closed_form[i].current_A, 1e-9);
      }
    }
  }
}

// A shunt that changes with the light is in each cell the one that its light makes.
TEST(PhotovoltaicChanges, ShuntsFollowTheLightOfTheirCells) {
  CellParameters changing = a_cell();
  changing.shunt_ohm = 2.0;
  changing.shunt_light_A = 1.0;
  for (const int strings : {1, 2}) {
    const ArrayUnderTest array(strings);
    CellTables stated;
    for (const double light_A : array.photocurrents_A) {
      CellParameters p = a_cell();
      p.shunt_ohm = 2.0 / light_A;
      stated.push_back(diode_voltage_law(p));
    }
    const size_t cells = array.photocurrents_A.size();
    const ArrayCurve by_light(array.wiring, CellTables(cells, diode_voltage_law(changing)),
                              array.photocurrents_A);
    const ArrayCurve by_cell(array.wiring, stated, array.photocurrents_A);
    EXPECT_NEAR(by_light.maximum_power().power_W(), by_cell.maximum_power().power_W(), 1e-12);
    // It matters: a constant one gives another maximum.
    changing.shunt_light_A = 0.0;
    const ArrayCurve constant(array.wiring, CellTables(cells, diode_voltage_law(changing)),
                              array.photocurrents_A);
    EXPECT_GT(std::abs(constant.maximum_power().power_W() - by_cell.maximum_power().power_W()),
              1e-3);
    changing.shunt_light_A = 1.0;
  }
}

TEST(PhotovoltaicChanges, ResistanceTakesItsVoltage) {
  for (const int strings : {1, 2}) {
    ArrayUnderTest array(strings);
    const ArrayCurve plain = array.curve();
    array.changes.series_ohm = 0.3;
    const ArrayCurve behind = array.curve();
    double best_W = 0.0;
    for (int i = 1; i < 4000; ++i) {
      const double I = plain.short_circuit_A() * i / 4000.0;
      const double V = plain.voltage_V(I) - 0.3 * I;
      best_W = std::max(best_W, V * I);
      if (i % 400 != 0 || V <= 0.0) continue;
      EXPECT_NEAR(behind.voltage_V(I), V, 1e-9);
      EXPECT_NEAR(behind.current_A(V), I, 1e-8);
    }
    EXPECT_NEAR(behind.maximum_power().power_W(), best_W, 1e-5 * best_W);
  }
}

TEST(PhotovoltaicChanges, OpenStringsAndShortedDiodesLeaveTheOthers) {
  ArrayUnderTest array(2);
  const auto power_W = [](const ArrayUnderTest& a) { return a.curve().maximum_power().power_W(); };
  ArrayUnderTest one = array;
  one.wiring.strings.pop_back();
  array.changes.string_open = {false, true};
  EXPECT_DOUBLE_EQ(power_W(array), power_W(one));
  one.wiring.strings[0].substrings.pop_back();
  array.changes.bypass_shorted = {false, true, false, false};
  EXPECT_DOUBLE_EQ(power_W(array), power_W(one));
  array.changes.bypass_shorted = {true, true, false, false};
  EXPECT_EQ(power_W(array), 0.0);
  array.changes.string_open = {true, true};
  EXPECT_EQ(power_W(array), 0.0);
}

// As a shaded cell gets more light, a maximum vanishes: in a corner of the curve, which stays where
// the maximum was last, and is listed as long as a little less light brings it back.
TEST(PhotovoltaicChanges, MaximumThatVanishesLeavesACorner) {
  for (const int strings : {1, 2}) {
    ArrayUnderTest array(strings);
    std::ranges::fill(array.photocurrents_A, 1.0);
    const auto at = [&](double light) {
      array.photocurrents_A[4] = light;
      return array.curve().scan(1);
    };
    double with = 0.5, without = 1.0;
    ASSERT_EQ(at(with).maxima.size(), 2u);
    ASSERT_EQ(at(without).maxima.size(), 1u);
    while (without - with > 1e-7) {
      const double middle = std::midpoint(with, without);
      (at(middle).maxima.size() == 2 ? with : without) = middle;
    }
    const auto before = at(with).maxima;
    const ArrayPoint last = std::ranges::min(before, {}, &ArrayPoint::power_W);
    const auto after = at(without).corners;
    ASSERT_EQ(after.size(), 1u);
    EXPECT_NEAR(after[0].voltage_V, last.voltage_V, 2e-3 * last.voltage_V);
    EXPECT_NEAR(after[0].current_A, last.current_A, 2e-3 * last.current_A);
    EXPECT_EQ(at(without + 0.001).corners.size(), 1u);
    EXPECT_TRUE(at(1.0).corners.empty());
  }
}

TEST(PhotovoltaicPoints, NearestPointLiesOnTheCurveAndAcrossIt) {
  for (const int strings : {1, 2}) {
    const ArrayCurve curve = ArrayUnderTest(strings).curve();
    constexpr double sigma_V = 0.01, sigma_A = 0.006;
    for (const bool traced : {false, true}) {
      const std::vector<ArrayPoint> trace = traced ? curve.trace() : std::vector<ArrayPoint>{};
      for (double part = -0.02; part < 1.03; part += 0.07) {
        const double voltage_V = part * curve.open_circuit_V();
        const double on_A = curve.at_voltages({voltage_V}).front().current_A;
        const double current_A = on_A + 0.004;
        const auto p = curve.nearest({voltage_V, current_A}, {sigma_V, sigma_A}, trace);
        EXPECT_NEAR(p.current_A, curve.at_voltages({p.voltage_V}).front().current_A, 1e-6) << part;
        // At the foot the way to the reading is at right angles to the curve, in errors.
        const double along = (voltage_V - p.voltage_V) / (sigma_V * sigma_V) -
                             p.slope_S * (current_A - p.current_A) / (sigma_A * sigma_A);
        const double length = std::hypot(1.0 / sigma_V, p.slope_S / sigma_A);
        EXPECT_LT(std::abs(along) / length, 0.02) << part;
      }
    }
  }
}

// Beyond both ends the curve goes on.
TEST(PhotovoltaicPoints, CurveGoesOnBeyondBothEnds) {
  for (const int strings : {1, 2}) {
    const ArrayCurve curve = ArrayUnderTest(strings).curve();
    std::vector<double> voltage_V;
    for (int i = -10; i <= 110; ++i) voltage_V.push_back(0.01 * i * curve.open_circuit_V());
    const auto points = curve.at_voltages(voltage_V);
    for (size_t i = 1; i < points.size(); ++i) {
      EXPECT_LT(points[i].current_A, points[i - 1].current_A);
      EXPECT_GT(points[i].slope_S, 0.0);
      const double V = points[i].voltage_V;
      if (V < 0.0 || V > curve.open_circuit_V()) continue;
      EXPECT_NEAR(points[i].current_A, curve.current_A(V), 1e-9);
    }
    EXPECT_LT(points.back().current_A, 0.0);
  }
}

}  // namespace
}  // namespace photorque

// Networks of cells against plain bisection, against another program's system, and by laws.
#include <algorithm>

#include "bisection.h"
#include "core/errors.h"
#include "core/numerics/random.h"
#include "reference.h"

namespace photorque {
namespace {

std::vector<double> random_suns(uint64_t seed, size_t count) {
  std::vector<double> suns;
  for (size_t i = 0; i < count; ++i) {
    const double u = unit_interval(hash_words(seed, i));
    // Some cells in the dark and some alike.
    suns.push_back(u < 0.05 ? 0.0 : u < 0.3 ? 0.6 : u);
  }
  return suns;
}

struct Wired {
  std::string name;
  ArrayWiring wiring;
  bool is_costly = false;  // nested searches of bisection take minutes
};

RegularWiring options(int strings, int bypass_every, const Diode& bypass, const Diode& blocking,
                      bool cross_tied = false) {
  RegularWiring regular;
  regular.strings = strings;
  regular.bypass_every = bypass_every;
  regular.bypass = bypass;
  regular.blocking = blocking;
  regular.cross_tied = cross_tied;
  return regular;
}

CellGroup in_series(std::vector<CellGroup> parts, const Diode& bypass = {}) {
  return {CellGroup::Join::series, std::move(parts), bypass};
}
CellGroup in_parallel(std::vector<CellGroup> parts, const Diode& bypass = {}) {
  return {CellGroup::Join::parallel, std::move(parts), bypass};
}

// Two pairs of cells in parallel, with diodes beside both or beside each.
CellGroup pairs(int first, const Diode& beside, const Diode& each) {
  return in_parallel({in_series({first, first + 1}, each), in_series({first + 2, first + 3}, each)},
                     beside);
}

// Twelve cells joined at more than three levels.
std::vector<Wired> nested_networks(const char* diodes, const Diode& d) {
  const Diode none;
  const std::string with = std::string(", ") + diodes;
  return {
      {"half-cut" + with,
       wiring_of(in_series({pairs(0, d, none), pairs(4, d, none), pairs(8, d, none)}), none)},
      {"tied modules" + with,
       wiring_of(in_series({pairs(0, none, d), pairs(4, none, d), pairs(8, none, d)}), none)},
      {"branches of bypassed pairs" + with,
       wiring_of(in_series({in_parallel({in_series({in_series({0, 1}, d), in_series({2, 3}, d)}),
                                         in_series({in_series({4, 5}, d), in_series({6, 7}, d)})}),
                            8, 9, 10, 11}),
                 none)},
      {"diodes at three levels" + with,
       wiring_of(in_series({in_parallel({in_series({in_series({0}, d), 1, 2}, d),
                                         in_series({3, 4, in_series({5}, d)}, d)},
                                        d),
                            in_series({6, 7, 8, 9, 10, 11}, d)}),
                 none)},
      {"strings with tied parts" + with,
       wiring_of(in_parallel({in_series({pairs(0, none, d), 4, 5}),
                              in_series({pairs(6, d, none), 10, 11})}),
                 none)}};
}

// Every kind of joint, on 3 × 4 cells.
std::vector<Wired> small_networks() {
  const Diode none, clamp = reference::clamp();
  Diode ideal = clamp;
  ideal.drop_V = 0.0;
  Diode real = reference::schottky();
  real.temperature_K = 298.15;
  const auto make = [](const RegularWiring& regular) { return regular_wiring(3, 4, regular); };
  std::vector<Wired> all = {{"series, no diodes", make(options(1, 12, none, none))},
                            {"series, clamps", make(options(1, 4, clamp, none))},
                            {"series, real diodes", make(options(1, 4, real, none))},
                            {"series, real diodes, real blocking", make(options(1, 3, real, real))},
                            {"parallel, no diodes", make(options(3, 4, none, none))},
                            {"parallel, clamps", make(options(3, 2, clamp, none))},
                            {"parallel, clamps, ideal blocking", make(options(3, 2, clamp, ideal))},
                            {"parallel, real diodes", make(options(3, 2, real, real))},
                            {"cross-tied, no diodes", make(options(3, 4, none, none, true))},
                            {"cross-tied, clamps", make(options(3, 2, clamp, none, true))},
                            {"cross-tied, real diodes", make(options(3, 2, real, none, true))}};
  for (const auto& more : {nested_networks("no diodes", none), nested_networks("clamps", clamp),
                           nested_networks("real diodes", real)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  for (Wired& one : all) {
    const bool deep = one.name.starts_with("branches") || one.name.starts_with("diodes at");
    const bool searched = one.name.ends_with("real diodes") &&
                          (deep || one.name.starts_with("tied") || one.name.starts_with("strings"));
    one.is_costly = searched || one.name == "diodes at three levels, clamps";
  }
  return all;
}

bisection::Array plain(const std::vector<double>& suns) {
  bisection::Array array{reference::cell(), {}};
  for (const double s : suns) {
    array.photocurrents_A.push_back(reference::photocurrent_A(s, array.cell));
  }
  return array;
}

TEST(PhotovoltaicNetwork, CurvesMatchPlainBisection) {
  for (const auto& [name, wiring, is_costly] : small_networks()) {
    if (is_costly) continue;
    const std::vector<double> suns = random_suns(3, 12);
    const ArrayCurve curve = reference::curve(wiring, suns, reference::cell());
    const bisection::Array exact = plain(suns);
    for (const double part : {0.2, 0.55, 0.85}) {
      if (wiring.strings.size() == 1) {
        const double i = curve.short_circuit_A() * part;
        const double v = static_cast<double>(exact.string_V(wiring.strings[0], i));
        EXPECT_NEAR(curve.voltage_V(i), v, 1e-11) << name << " at " << i << " A";
      } else {
        const double v = curve.open_circuit_V() * part;
        const double i = static_cast<double>(exact.array_A(wiring, v));
        EXPECT_NEAR(curve.current_A(v), i, 1e-10 * curve.short_circuit_A()) << name << " at " << v;
      }
    }
  }
}

TEST(PhotovoltaicNetwork, PowersMatchPlainBisection) {
  for (const auto& [name, wiring, is_costly] : small_networks()) {
    if (is_costly) continue;
    const std::vector<double> suns = random_suns(4, 12);
    const ArrayPoint found = reference::curve(wiring, suns, reference::cell()).maximum_power();
    const double x = wiring.strings.size() == 1 ? found.current_A : found.voltage_V;
    const double power_W = static_cast<double>(plain(suns).power_near(wiring, x));
    EXPECT_NEAR(found.power_W(), power_W, 2e-11 * power_W) << name;
  }
}

// No grid may show a maximum that the search does not have, and vice versa.
TEST(PhotovoltaicNetwork, MaximaAreThoseOfADenseGrid) {
  size_t several = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    for (const auto& [name, wiring, is_costly] : small_networks()) {
      const ArrayCurve curve =
          reference::curve(wiring, random_suns(100 + seed, 12), reference::cell());
      const ArrayCurve::Scan scan = curve.scan(1500);
      const std::vector<ArrayPoint> found = curve.maxima();
      ASSERT_EQ(found.size(), scan.maxima.size()) << name << " seed " << seed;
      several += found.size() > 1 ? 1 : 0;
      for (size_t i = 1; i + 1 < scan.points.size(); ++i) {
        const double before = scan.points[i - 1].power_W(), at = scan.points[i].power_W(),
                     after = scan.points[i + 1].power_W();
        if (!(at > before && at > after)) continue;
        const bool there = std::ranges::any_of(found, [&](const ArrayPoint& p) {
          return p.voltage_V >= scan.points[i - 1].voltage_V &&
                 p.voltage_V <= scan.points[i + 1].voltage_V && p.power_W() >= at * (1 - 1e-12);
        });
        EXPECT_TRUE(there) << name << " seed " << seed << " at " << scan.points[i].voltage_V;
      }
    }
  }
  EXPECT_GT(several, 20u);  // or the test says little
}

// Pieces that cannot hold the largest maximum are passed over: it is still the largest of all,
// which scan() finds piece by piece, and no point of a dense grid exceeds it.
TEST(PhotovoltaicNetwork, LargestMaximumOfHundredsOfPieces) {
  size_t several = 0;
  for (uint64_t seed = 0; seed < 12; ++seed) {
    for (const auto& [strings, blocking] :
         {std::pair(1, Diode{}), std::pair(6, Diode{}), std::pair(6, reference::clamp())}) {
      const ArrayWiring wiring =
          regular_wiring(20, 30, options(strings, 2, reference::clamp(), blocking));
      // Brightest towards one end, as under a beam beside the array, with drawn differences.
      std::vector<double> suns = random_suns(400 + seed, 600);
      for (size_t i = 0; i < suns.size(); ++i) {
        suns[i] *= std::exp(-0.5 * static_cast<double>(seed * i) / 600.0);
      }
      const ArrayCurve curve = reference::curve(wiring, suns, reference::cell());
      const ArrayCurve::Scan scan = curve.scan(500);
      several += scan.maxima.size() > 1 ? 1 : 0;
      const double largest_W = std::ranges::max(scan.maxima, {}, &ArrayPoint::power_W).power_W();
      const ArrayPoint found = curve.maximum_power();
      EXPECT_NEAR(found.power_W(), largest_W, 1e-11 * largest_W) << strings << " seed " << seed;
      for (const ArrayPoint& point : scan.points) {
        ASSERT_LE(point.power_W(), found.power_W() * (1.0 + 1e-11)) << strings << " seed " << seed;
      }
    }
  }
  EXPECT_GT(several, 12u);  // or the test says little
}

// The power of the cells equals that of the array plus the loss in its diodes: for clamps, the drop
// times the current that the cells do not carry.
TEST(PhotovoltaicNetwork, EnergyIsConserved) {
  const ArrayWiring wiring = regular_wiring(3, 4, options(1, 4, reference::clamp(), {}));
  for (uint64_t seed = 0; seed < 30; ++seed) {
    const ArrayCurve curve =
        reference::curve(wiring, random_suns(300 + seed, 12), reference::cell());
    for (int k = 1; k < 10; ++k) {
      const double v = curve.open_circuit_V() * k / 10.0, i = curve.current_A(v);
      const CellStates cells = curve.cells_at(v);
      double made_W = 0.0, burnt_W = 0.0;
      for (const auto& substring : wiring.strings[0].substrings) {
        double rows_V = 0.0;
        for (const auto& row : substring.rows)
          rows_V += cells.voltages_V[static_cast<size_t>(row.cell)];
        // In series: each cell has the string's current, or what its diode leaves of it.
        const double left_A = cells.currents_A[static_cast<size_t>(substring.rows[0].cell)];
        for (const auto& row : substring.rows) {
          EXPECT_NEAR(cells.currents_A[static_cast<size_t>(row.cell)], left_A, 1e-12);
        }
        made_W += rows_V * left_A;
        EXPECT_GE(rows_V, -0.5 - 1e-12);
        if (rows_V < -0.5 + 1e-9) {
          EXPECT_LE(left_A, i + 1e-12);
          burnt_W += 0.5 * (i - left_A);
        } else {
          EXPECT_NEAR(left_A, i, 1e-9);
        }
      }
      EXPECT_NEAR(made_W, v * i + burnt_W, 1e-8);
    }
  }
}

// Without diodes nothing is lost, however the cells are joined.
TEST(PhotovoltaicNetwork, CellsOfNestedGroupsSumToTheArray) {
  for (const auto& [name, wiring, is_costly] : nested_networks("no diodes", {})) {
    for (uint64_t seed = 0; seed < 10; ++seed) {
      const ArrayCurve curve =
          reference::curve(wiring, random_suns(700 + seed, 12), reference::cell());
      for (const double part : {0.2, 0.7, 0.95}) {
        const double v = curve.open_circuit_V() * part;
        const CellStates cells = curve.cells_at(v);
        double made_W = 0.0;
        for (size_t i = 0; i < 12; ++i) made_W += cells.voltages_V[i] * cells.currents_A[i];
        EXPECT_NEAR(made_W, v * curve.current_A(v), 1e-8) << name << " seed " << seed;
      }
    }
  }
}

// With soft breakdown the dark cell conducts at −5.5 V, which a substring of 20 lit cells can give:
// the bypass diode stays off and less is lost.
TEST(PhotovoltaicNetwork, SoftBreakdownCarriesCurrentThroughADarkCell) {
  std::vector<double> suns(100, 1.0);
  suns[42] = 0.0;
  const ArrayCurve curve = reference::curve(
      regular_wiring(10, 10, options(1, 20, reference::clamp(), {})), suns, reference::cell());
  const ArrayPoint best = curve.maximum_power();
  const double dark_V = curve.cells_at(best.voltage_V).voltages_V[42];
  EXPECT_LT(dark_V, -4.0);
  EXPECT_GT(dark_V, reference::cell().breakdown_V);
}

TEST(PhotovoltaicNetwork, DarkStringBehindABlockingDiodeIsNotThere) {
  Diode ideal = reference::clamp();
  ideal.drop_V = 0.0;
  std::vector<double> suns(20, 0.8);
  for (size_t i = 10; i < 20; ++i) suns[i] = 0.0;  // row-major: 2 columns of 10
  const std::vector<double> lit_first = [&] {
    std::vector<double> order(20);
    for (size_t i = 0; i < 20; ++i) order[i] = i % 2 == 0 ? 0.8 : 0.0;
    return order;
  }();
  const ArrayWiring two = regular_wiring(2, 10, options(2, 10, {}, ideal));
  const ArrayWiring one = regular_wiring(1, 10, options(1, 10, {}, ideal));
  const ArrayPoint both = reference::curve(two, lit_first, reference::cell()).maximum_power();
  const ArrayPoint alone =
      reference::curve(one, std::vector<double>(10, 0.8), reference::cell()).maximum_power();
  EXPECT_NEAR(both.power_W(), alone.power_W(), 1e-11 * alone.power_W());
  // Without the diode the dark string takes current from the lit one.
  const ArrayWiring open = regular_wiring(2, 10, options(2, 10, {}, {}));
  EXPECT_LT(reference::curve(open, lit_first, reference::cell()).maximum_power().power_W(),
            alone.power_W() * 0.97);
}

// A cell that conducts neither forwards nor backwards is a cut wire.
TEST(PhotovoltaicNetwork, OpenStringGivesNothingAndTakesNothing) {
  CellParameters cell = reference::cell();
  cell.breakdown_fraction = 0.0;
  CellParameters cut = cell;
  cut.saturation_1_A = 1e-30;
  cut.saturation_2_A = 0.0;
  cut.shunt_ohm = 1e14;
  const ArrayWiring two{{{{{{{0}, {1}, {2}}, {}}}, {}}, {{{{{3}, {4}, {5}}, {}}}, {}}}};
  CellTables tables(6, reference::table(cell));
  tables[1] = reference::table(cut);
  const double light_A = reference::photocurrent_A(0.7, cell);
  const ArrayCurve both(two, tables, {light_A, 0.0, light_A, light_A, light_A, light_A});
  const ArrayWiring one{{{{{{{0}, {1}, {2}}, {}}}, {}}}};
  const ArrayCurve alone(one, CellTables(3, reference::table(cell)), {light_A, light_A, light_A});
  EXPECT_NEAR(both.maximum_power().power_W(), alone.maximum_power().power_W(), 1e-11);
  EXPECT_NEAR(both.short_circuit_A(), alone.short_circuit_A(), 1e-11);
  EXPECT_NEAR(both.open_circuit_V(), alone.open_circuit_V(), 1e-11);
}

TEST(PhotovoltaicNetwork, RandomCellsAndWiringsNeverFail) {
  const std::vector<Wired> networks = small_networks();
  for (uint64_t k = 0; k < 150; ++k) {
    const auto draw = [&](uint64_t d) { return unit_interval(hash_words(77, k, d)); };
    const auto decades = [&](uint64_t d, double low, double high) {
      return std::pow(10.0, low + (high - low) * draw(d));
    };
    CellParameters p;
    p.saturation_1_A = decades(0, -18.0, -6.0);
    p.ideality_1 = 0.8 + draw(1);
    p.saturation_2_A = draw(2) < 0.5 ? 0.0 : decades(3, -10.0, -5.0);
    p.series_ohm = draw(4) < 0.2 ? 0.0 : decades(5, -4.0, -0.5);
    p.shunt_ohm = decades(6, 0.0, 6.0);
    p.breakdown_fraction = draw(7) < 0.3 ? 0.0 : decades(8, -5.0, -0.5);
    p.breakdown_V = -decades(9, 0.5, 1.7);
    p.breakdown_exponent = 1.0 + 5.0 * draw(10);
    p.temperature_K = 150.0 + 300.0 * draw(11);
    const std::vector<double> suns = random_suns(1000 + k, 12);
    const auto& [name, wiring, is_costly] = networks[k % networks.size()];
    const CellCurve cell(p);
    double alone_W = 0.0;
    std::vector<double> light_A;
    for (const double s : suns) {
      light_A.push_back(6.0 * s);
      alone_W += cell.maximum_power(light_A.back()).power_W();
    }
    const ArrayCurve curve(wiring, CellTables(12, reference::table(p)), light_A);
    const ArrayPoint best = curve.maximum_power();
    EXPECT_GT(best.power_W(), 0.0) << name << " set " << k;
    EXPECT_LE(best.power_W(), alone_W * (1 + 1e-12)) << name << " set " << k;
    for (const ArrayPoint& point : curve.scan(40).points) {
      ASSERT_LE(point.power_W(), best.power_W() * (1 + 1e-12)) << name << " set " << k;
    }
  }
}

TEST(PhotovoltaicNetwork, AllDarkGivesNothing) {
  for (const auto& [name, wiring, is_costly] : small_networks()) {
    const ArrayCurve curve =
        reference::curve(wiring, std::vector<double>(12, 0.0), reference::cell());
    EXPECT_TRUE(curve.maxima().empty()) << name;
    EXPECT_EQ(curve.maximum_power().power_W(), 0.0) << name;
    EXPECT_NEAR(curve.open_circuit_V(), 0.0, 1e-12) << name;
    EXPECT_EQ(curve.scan(10).points.size(), 1u) << name;
  }
}

TEST(PhotovoltaicNetwork, CrossTyingEqualsParallelCellsOfSummedLight) {
  // Two tied cells without series resistance are one with twice everything.
  CellParameters small = reference::cell(), large = small;
  small.series_ohm = large.series_ohm = 0.0;
  large.saturation_1_A *= 2;
  large.saturation_2_A *= 2;
  large.shunt_ohm /= 2;
  const ArrayWiring tied = regular_wiring(2, 6, options(2, 3, reference::clamp(), {}, true));
  const ArrayWiring plain_string = regular_wiring(1, 6, options(1, 3, reference::clamp(), {}));
  std::vector<double> currents, sums;
  for (size_t i = 0; i < 12; ++i) currents.push_back(6.0 * unit_interval(hash_words(9, i)));
  // Serpentine: column 0 downwards and column 1 upwards make the two strings.
  for (size_t i = 0; i < 6; ++i) sums.push_back(currents[2 * i] + currents[2 * (5 - i) + 1]);
  const ArrayCurve a(tied, CellTables(12, reference::table(small)), currents);
  const ArrayCurve b(plain_string, CellTables(6, reference::table(large)), sums);
  const auto maxima_a = a.maxima(), maxima_b = b.maxima();
  ASSERT_EQ(maxima_a.size(), maxima_b.size());
  for (size_t i = 0; i < maxima_a.size(); ++i) {
    EXPECT_NEAR(maxima_a[i].power_W(), maxima_b[i].power_W(), 1e-10 * maxima_b[i].power_W());
  }
}

TEST(PhotovoltaicNetwork, WiringMistakesAreRefused) {
  const auto table = reference::table(reference::cell());
  ArrayWiring twice{{{{{{{0}, {0}}, {}}}, {}}}};
  EXPECT_THROW(ArrayCurve(twice, {table}, {1.0}), InputError);
  ArrayWiring beyond{{{{{{{1}}, {}}}, {}}}};
  EXPECT_THROW(ArrayCurve(beyond, {table}, {1.0}), InputError);
  EXPECT_THROW(ArrayCurve({}, {table}, {1.0}), InputError);
}

// PVMismatch's test system: 10 strings × 10 modules × 96 cells in substrings of 24, 48, 24.
ArrayPoint system_maximum(const std::vector<double>& suns, double* second_W) {
  ArrayWiring wiring;
  int cell = 0;
  for (int s = 0; s < 10; ++s) {
    ArrayWiring::String string;
    for (int m = 0; m < 10; ++m) {
      for (const int length : {24, 48, 24}) {
        ArrayWiring::Substring substring{{}, reference::clamp()};
        for (int i = 0; i < length; ++i) substring.rows.push_back({cell++});
        string.substrings.push_back(substring);
      }
    }
    wiring.strings.push_back(string);
  }
  auto maxima = reference::curve(wiring, suns, reference::cell()).maxima();
  std::ranges::sort(maxima, std::greater<>(), &ArrayPoint::power_W);
  *second_W = maxima.size() > 1 ? maxima[1].power_W() : 0.0;
  return maxima.front();
}

void shade(std::vector<double>& suns, int string, int module, int cells, double to) {
  const auto first = static_cast<std::ptrdiff_t>(string * 960 + module * 96);
  std::fill_n(suns.begin() + first, cells, to);
}

TEST(PhotovoltaicNetwork, PVMismatchSystemHasTheExactMaxima) {
  struct Expected {
    double power_W, voltage_V, current_A, second_W;
  };
  const auto check = [](const std::vector<double>& suns, const Expected& e) {
    double second_W = 0.0;
    const ArrayPoint best = system_maximum(suns, &second_W);
    EXPECT_NEAR(best.power_W(), e.power_W, 0.6e-6);
    EXPECT_NEAR(best.voltage_V, e.voltage_V, 0.6e-5);
    EXPECT_NEAR(best.current_A, e.current_A, 0.6e-6);
    if (e.second_W > 0) {
      EXPECT_NEAR(second_W, e.second_W, 0.6e-6);
    }
  };
  std::vector<double> suns(9600, 1.0);
  check(suns, {32128.134798, 543.12581, 59.154131, 0});
  check(std::vector<double>(9600, 0.75), {23910.809422, 540.91610, 44.204285, 0});
  shade(suns, 1, 3, 30, 0.25);
  check(suns, {31621.384487, 534.72854, 59.135397, 0});
  suns.assign(9600, 1.0);
  shade(suns, 1, 3, 96, 0.2);
  shade(suns, 1, 0, 96, 0.1);
  check(suns, {29579.427707, 543.36371, 54.437621, 28827.893268});
  suns.assign(9600, 1.0);
  shade(suns, 1, 0, 960, 0.1);
  check(suns, {29141.834072, 541.97089, 53.770110, 0});
}

}  // namespace
}  // namespace photorque

// Light that comes at a slant onto cells under glass.
#include "photovoltaics/array/incidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "photovoltaics/array/losses.h"
#include "raytrace/surfaces/glass.h"
#include "reference.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/receivers/receiver_scenes.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

constexpr double any_m = 550e-9;

CellFront clear_glass(double index) {
  CellFront front;
  front.index = index;
  return front;
}

// J. A. Duffie and W. A. Beckman, Solar Engineering of Thermal Processes, 4th ed., example 5.1.1:
// glass of index 1.526 reflects 0.0434 of perpendicular light and 0.093 at 60 deg.
TEST(CellFront, HasTheTextbookReflectance) {
  const CellFront front = clear_glass(1.526);
  EXPECT_NEAR(1.0 - front.transmitted(1.0, any_m), 0.0434, 5e-5);
  EXPECT_NEAR(1.0 - front.transmitted(0.5, any_m), 0.093, 5e-4);
  EXPECT_EQ(front.modifier(1.0, any_m), 1.0);
  EXPECT_EQ(front.transmitted(0.0, any_m), 0.0);
}

// The transmission of the paper's equation 29: T = cos θ.
TEST(CellFront, CosineTwiceIsTheCosine) {
  CellFront front;
  front.cosine_twice = true;
  EXPECT_DOUBLE_EQ(front.modifier(std::cos(pi / 6.0), any_m), std::cos(pi / 6.0));
  EXPECT_EQ(front.modifier(1.0, any_m), 1.0);
  EXPECT_EQ(front.transmitted(0.0, any_m), 0.0);
}

// A film of a quarter wave reflects ((n − f²)/(n + f²))² of perpendicular light, one of half a wave
// is as if it were not there (Born and Wolf, section 1.6.4).
TEST(CellFront, QuarterWaveAndHalfWaveFilmsAreTheirClosedForms) {
  constexpr double n = 1.52, f = 1.38, wavelength_m = 730e-9;
  const double quarter = (n - f * f) / (n + f * f), bare = (n - 1) / (n + 1);
  const double quarter_m = wavelength_m / (4 * f);
  EXPECT_NEAR(film_reflectance(1.0, {f, quarter_m}, n, wavelength_m), quarter * quarter, 1e-15);
  EXPECT_NEAR(film_reflectance(1.0, {f, 2 * quarter_m}, n, wavelength_m), bare * bare, 1e-15);
  const double root = std::sqrt(n);
  EXPECT_NEAR(film_reflectance(1.0, {root, wavelength_m / (4 * root)}, n, wavelength_m), 0.0,
              1e-15);
}

// Reflectance by the characteristic matrix of the film, fields instead of a sum of reflected waves
// (Born and Wolf, section 1.6.2).
double matrix_reflectance(double angle, double f, double thickness_m, double n, double wave_m) {
  using Complex = std::complex<double>;
  const double c0 = std::cos(angle);
  const double c1 = std::sqrt(1 - std::pow(std::sin(angle) / f, 2));
  const double c2 = std::sqrt(1 - std::pow(std::sin(angle) / n, 2));
  const double beta = 2 * pi * f * thickness_m * c1 / wave_m;
  double sum = 0.0;
  for (const bool across : {true, false}) {
    const double q0 = across ? c0 : 1 / c0, q1 = across ? f * c1 : f / c1;
    const double q2 = across ? n * c2 : n / c2;
    const Complex i(0, 1);
    const Complex field = std::cos(beta) - i * q2 * std::sin(beta) / q1;
    const Complex flow = q2 * std::cos(beta) - i * q1 * std::sin(beta);
    sum += 0.5 * std::norm((q0 * field - flow) / (q0 * field + flow));
  }
  return sum;
}

TEST(CellFront, FilmsAtAnyAngleMatchTheCharacteristicMatrix) {
  for (const double angle : {0.1, 0.5, 0.9, 1.2, 1.5}) {
    for (const double thickness_m : {20e-9, 132e-9, 700e-9}) {
      EXPECT_NEAR(film_reflectance(std::cos(angle), {1.38, thickness_m}, 1.52, 600e-9),
                  matrix_reflectance(angle, 1.38, thickness_m, 1.52, 600e-9), 1e-14);
    }
  }
}

TEST(CellFront, TablesAreStraightBetweenTheirAnglesAndZeroAtGrazing) {
  CellFront front;
  front.angle_rad = {0.0, 0.5, 1.0};
  front.transmittance = {0.8, 0.6, 0.4};
  EXPECT_NEAR(front.modifier(std::cos(0.25), any_m), 0.7 / 0.8, 1e-12);
  EXPECT_NEAR(front.modifier(std::cos(1.0), any_m), 0.5, 1e-12);
  EXPECT_NEAR(front.modifier(std::cos(0.5 * (1.0 + 0.5 * pi)), any_m), 0.25, 1e-12);
  EXPECT_NEAR(front.modifier(0.0, any_m), 0.0, 1e-12);
}

OpticalSurface black() {
  return grey_surface("black", 0.0, 0.0);
}

struct LitPlate {
  Scene scene;
  SurfaceGrid grid;
};

LitPlate lit_plate(const OpticalSurface& surface) {
  LitPlate lit;
  fixtures::add(lit.scene, fixtures::rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), surface, "plate");
  SurfaceGridOptions options;
  options.width = options.height = 4;
  lit.grid = make_surface_grid(lit.scene, {{0}}, options);
  return lit;
}

// The fraction that enters, over all bins, of parallel light at an angle.
double traced_fraction(const LitPlate& lit, const std::optional<CellFront>& front, double angle) {
  const IncidenceReceiver receiver(lit.scene, lit.grid, front, std::array{any_m});
  const Vec3 direction(std::sin(angle), 0, -std::cos(angle));
  const std::vector<Beam> beams = {fixtures::beam(
      std::make_shared<fixtures::ParallelBeam>(1.0, 0.2), Vec3(-direction), direction)};
  const std::vector<const Receiver*> receivers = {&receiver};
  TraceOptions options;
  options.rays = 4096;
  options.replicates = 8;
  const TraceResult result =
      trace(TraceableScene(lit.scene), RigidTransform{}, beams, receivers, options);
  const BinSums& sums = result.sums[0];
  double all = 0.0, entering = 0.0;
  for (size_t i = 0; i < sums.bins / 2; ++i) {
    all += sums.estimate(i).value;
    entering += sums.estimate(sums.bins / 2 + i).value;
  }
  EXPECT_NEAR(all, 1.0, 1e-9);
  return entering / all;
}

// At Brewster's angle, tan θ = n, only the polarisation across is reflected: ((n² − 1)/(n² + 1))².
double brewster_modifier(double n) {
  const double across = std::pow((n * n - 1) / (n * n + 1), 2);
  return (1 - 0.5 * across) / (1 - std::pow((n - 1) / (n + 1), 2));
}

TEST(IncidenceReceiver, RaysAtBrewstersAngleLoseTheClosedForm) {
  const LitPlate lit = lit_plate(black());
  for (const double n : {1.33, 1.5, 2.0}) {
    EXPECT_NEAR(traced_fraction(lit, clear_glass(n), std::atan(n)), brewster_modifier(n), 1e-6);
    EXPECT_NEAR(traced_fraction(lit, clear_glass(n), 0.0), 1.0, 1e-7);
  }
  EXPECT_EQ(traced_fraction(lit, std::nullopt, std::atan(1.5)), 1.0);
}

// A surface that is glass itself has lost its reflection already: the receiver takes the angle from
// it, and refuses a second glass.
TEST(IncidenceReceiver, GlassOfTheSurfaceItselfIsNotCountedTwice) {
  const LitPlate lit = lit_plate(behind_glass(black(), 1.5));
  ASSERT_TRUE(has_own_front(lit.scene, lit.grid));
  EXPECT_NEAR(traced_fraction(lit, std::nullopt, std::atan(1.5)), brewster_modifier(1.5), 1e-6);
  EXPECT_THAT(refusal_of([&] {
                IncidenceReceiver(lit.scene, lit.grid, clear_glass(1.5), std::array{any_m},
                                  {"array.toml", 5});
              }),
              testing::HasSubstr("array.toml:5: array.cover"));
  EXPECT_FALSE(has_own_front(lit_plate(black()).scene, lit.grid));
}

// J. W. T. Walsh (1926), in D. B. Judd, J. Res. NBS 29 (1942) 329: glass of index 1.5 reflects
// 0.0918 of light that comes evenly from all directions outside.
TEST(IncidenceReceiver, DiffuseLightHasWalshsReflectance) {
  const LitPlate lit = lit_plate(black());
  const IncidenceReceiver receiver(lit.scene, lit.grid, clear_glass(1.5), std::array{any_m});
  std::vector<fixtures::HitMaker> hits;
  constexpr int count = 20000;
  for (int i = 0; i < count; ++i) {
    fixtures::HitMaker hit;
    hit.cosine = std::sqrt((i + 0.5) / count);
    hits.push_back(hit);
  }
  const BinSums sums = fixtures::sums_of(receiver, {hits});
  double all = 0.0, entering = 0.0;
  for (size_t i = 0; i < sums.bins / 2; ++i) {
    all += sums.sums[i];
    entering += sums.sums[sums.bins / 2 + i];
  }
  EXPECT_NEAR(1.0 - 0.96 * entering / all, 0.0918, 5e-5);
}

// An array whose left half is lit straight and whose right half at a slant.
TEST(PhotovoltaicArray, PhotocurrentAndWaterfallFollowTheEnteringLight) {
  ArrayLight light = array_light(2, 2, 0.2, 0.2, std::vector<double>(4, 500.0));
  light.entry = {8, 1, {1, 1, 1, 1, 1.0, 0.9, 1.0, 0.9}};
  const ArrayDesign design = reference::array_in_series(2, 2, 4);
  const ArrayResult result = evaluate_array(design, light, std::array{0.5});
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(result.cell_photocurrent_A[i], 0.5 * 5.0 * (i % 2 == 0 ? 1.0 : 0.9), 1e-14);
  }
  EXPECT_NEAR(result.power_on_cells_W.value, 20.0, 1e-13);
  EXPECT_NEAR(result.power_entering_W.value, 19.0, 1e-13);
  bool found = false;
  LossInputs inputs;
  inputs.emitted_W = 25.0;
  inputs.on_receiver_W = 20.0;
  for (const LossStage& stage : loss_waterfall(result, inputs)) {
    if (stage.loss != "angle of incidence") continue;
    found = true;
    EXPECT_NEAR(stage.power_W, 19.0, 1e-13);
  }
  EXPECT_TRUE(found);
}

TEST(CellFront, WrongCoversNameTheirKey) {
  using test::numbers_node;
  const auto message = [](const SettingsNode::Table& keys) {
    return refusal_of([&] { read_cell_front(test::settings_of(keys, "cover")); });
  };
  EXPECT_THAT(message({{"refractive_index", {0.5}}}), testing::HasSubstr("refractive_index"));
  EXPECT_THAT(message({{"coating_index", {1.38}}}), testing::HasSubstr("coating_thickness"));
  EXPECT_THAT(message({{"angle_deg", numbers_node({10.0, 20.0})},
                       {"transmittance", numbers_node({1.0, 0.9})}}),
              testing::HasSubstr("ascending angles from 0"));
  EXPECT_NE(message({{"angle_deg", numbers_node({0.0, 60.0})},
                     {"transmittance", numbers_node({1.0, 0.9})},
                     {"refractive_index", {1.5}}})
                .find("a table by angle too"),
            std::string::npos);
  EXPECT_THAT(message({{"cosine_twice", {true}}, {"refractive_index", {1.5}}}),
              testing::HasSubstr("a front beside cosine_twice"));
}

}  // namespace
}  // namespace photorque

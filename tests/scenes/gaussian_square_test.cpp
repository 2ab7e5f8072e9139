// A source and the tracer together, against a closed form that neither uses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "raytrace/tracing/tracer.h"
#include "tests/raytrace/test_scenes.h"
#include "tests/settings.h"

namespace photorque {
namespace {

// A Gaussian beam of 1/e² radius w on a centred square of side s: P erf(s/(√2 w))².
TEST(GaussianBeam, EncircledPowerOnASquareMatchesClosedForm) {
  const double w = 0.1;
  const std::vector<Beam> beams =
      test::make_beams("laser", {{"power_W", {2.0}},
                                 {"wavelength_nm", {730.0}},
                                 {"waist_radius_m", {w}},
                                 {"position_m", test::vector_node(0, 0, 1)},
                                 {"direction", test::vector_node(0, 0, -1)}});
  ASSERT_EQ(beams.size(), 1u);
  for (const double side : {0.1, 0.2, 0.3}) {
    const TraceableScene traceable(fixtures::scene_of_part(
        fixtures::rectangle(Vec3::Zero(), Vec3(side, 0, 0), Vec3(0, side, 0)),
        grey_surface("black", 0, 0), "square"));
    const Estimate power =
        trace(traceable, {}, beams, {}, {.rays = 1 << 21}).power_balance.absorbed_W;
    const double exact = 2.0 * std::pow(std::erf(side / (std::numbers::sqrt2 * w)), 2);
    EXPECT_LE(std::abs(power.value - exact), 3 * power.standard_error);
    EXPECT_LE(std::abs(power.value - exact), 1e-4 * 2.0);
    // As if w were the radius at half of the maximum.
    const double mistaken =
        2.0 * std::pow(std::erf(side * std::sqrt(std::numbers::ln2) / (2 * w)), 2);
    EXPECT_GT(std::abs(power.value - mistaken), 10 * power.standard_error);
  }
}

}  // namespace
}  // namespace photorque

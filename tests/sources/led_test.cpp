#include "core/constants.h"
#include "sampling.h"
#include "sources/lamps/settings.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using test::changed;
using test::make_beams;
using test::vector_node;

SettingsNode::Table led() {
  return {{"power_W", {2.0}},
          {"aperture_diameter_m", {0.02}},
          {"profile", {"gaussian"}},
          {"fwhm_deg", {3.0}},
          {"wavelength_nm", {730.0}},
          {"spectral_fwhm_nm", {30.0}},
          {"position_m", vector_node(0.1, 0.2, 1.5)},
          {"direction", vector_node(0, 0, -2)}};
}

void expect_error(const std::string& kind, SettingsNode::Table table, const std::string& words) {
  const std::string message = refusal_of([&] { make_beams(kind, std::move(table)); });
  EXPECT_THAT(message, testing::HasSubstr(words));
  EXPECT_THAT(message, testing::HasSubstr("test.toml:7"));
}

TEST(Led, StandsWhereItIsPutAndLooksWhereItIsAimed) {
  const Beam down = make_beams("led", led()).at(0);
  EXPECT_TRUE(down.lab_from_emitter.point(Vec3::Zero()).isApprox(Vec3(0.1, 0.2, 1.5)));
  EXPECT_TRUE(down.lab_from_emitter.direction(Vec3::UnitZ()).isApprox(-Vec3::UnitZ()));
  const Beam aimed =
      make_beams("led", changed(led(), {{"aim_m", vector_node(0.3, 0, 0)}}, {"direction"})).at(0);
  EXPECT_TRUE(aimed.lab_from_emitter.direction(Vec3::UnitZ())
                  .isApprox(Vec3(0.2, -0.2, -1.5).normalized(), 1e-12));
  EXPECT_DOUBLE_EQ(down.emitter->power_W(), 2.0);
  EXPECT_DOUBLE_EQ(down.spectrum.centre_m, 730e-9);
  EXPECT_DOUBLE_EQ(down.spectrum.fwhm_m, 30e-9);
}

TEST(Led, ReadsMillimetres) {
  const auto table = changed(led(), {{"aperture_diameter_mm", {20.0}}}, {"aperture_diameter_m"});
  double widest_m = 0.0;
  for (const auto& ray : test::rays_of(*make_beams("led", table).at(0).emitter, 4096)) {
    widest_m = std::max(widest_m, ray.origin_m.norm());
  }
  EXPECT_LE(widest_m, 0.01);
  EXPECT_GT(widest_m, 0.00999);
}

TEST(Led, EachPillboxMeasureFillsItsOwnMeasureEvenly) {
  const double edge = 40 * degree_rad;
  const auto check = [&](const std::string& measure, const std::function<double(double)>& size) {
    const auto table = changed(
        led(),
        {{"profile", {"pillbox"}}, {"half_angle_deg", {40.0}}, {"pillbox_measure", {measure}}},
        {"fwhm_deg"});
    const auto angles =
        test::sorted_angles(test::rays_of(*make_beams("led", table).at(0).emitter, 65536));
    EXPECT_LT(test::largest_deviation(angles, [&](double t) { return size(t) / size(edge); }), 2e-5)
        << measure;
  };
  check("angle", [](double t) { return t * t; });
  check("solid_angle", [](double t) { return 1.0 - std::cos(t); });
  check("projected", [](double t) { return std::sin(t) * std::sin(t); });
}

TEST(Led, ReportsTheMistake) {
  expect_error("led", changed(led(), {{"power_W", {-3.0}}}), "power_W: found -3");
  expect_error("led", changed(led(), {{"power_W", {0.0}}}), "power_W: found 0");
  expect_error("led", changed(led(), {{"aperture_diameter_m", {0.0}}}), "aperture_diameter_m");
  // Their squares were no numbers, which was reported as a failure of the computation.
  expect_error("led", changed(led(), {{"aperture_diameter_m", {1e-160}}}), "a number >= 1e-12 m");
  expect_error("led", changed(led(), {{"fwhm_deg", {1e-160}}}), "fwhm_deg: found 1e-160");
  expect_error("led", changed(led(), {{"aim_m", vector_node(0, 0, 0)}}), "also aim_m");
  expect_error("led", changed(led(), {}, {"direction"}), "neither direction nor aim_m");
  expect_error("led", changed(led(), {{"direction", vector_node(0, 0, 0)}}), "[0, 0, 0]");
  expect_error("led", changed(led(), {{"aim_m", vector_node(0.1, 0.2, 1.5)}}, {"direction"}),
               "position of the source itself");
  expect_error("led", changed(led(), {{"fwhm_deg", {180.0}}}), "in [1e-12, 180) deg");
  expect_error("led", changed(led(), {{"fwhm_deg", {0.0}}}), "in [1e-12, 180) deg");
  expect_error("led", changed(led(), {}, {"fwhm_deg"}), "fwhm_deg: found nothing");
  expect_error("led", changed(led(), {{"profile", {"gausian"}}}), "did you mean \"gaussian\"");
  expect_error("led", changed(led(), {{"profile", {"super_gaussian"}}}), "order: found nothing");
  expect_error("led", changed(led(), {{"profile", {"super_gaussian"}}, {"order", {1.5}}}),
               "order: found 1.5");
  expect_error("led", changed(led(), {{"profile", {"pillbox"}}}, {"fwhm_deg"}),
               "half_angle_deg: found nothing");
  expect_error("led",
               changed(led(), {{"profile", {"pillbox"}}, {"half_angle_deg", {20.0}}}, {"fwhm_deg"}),
               "pillbox_measure: found nothing");
  expect_error("led", changed(led(), {{"profile", {"pillbox"}}, {"half_angle_deg", {91.0}}}),
               "half_angle_deg: found 91");
  expect_error("led", changed(led(), {{"profile", {"cosine_power"}}}, {"fwhm_deg"}),
               "exponent: found nothing");
  expect_error("led", changed(led(), {{"half_angle_deg", {2.0}}}), "half_angle_deg");
  expect_error("led", changed(led(), {{"halo_fraction", {0.2}}}), "halo_fwhm_deg");
  expect_error("led", changed(led(), {{"halo_fwhm_deg", {9.0}}}), "halo_fraction");
  expect_error("led", changed(led(), {{"halo_fraction", {1.0}}, {"halo_fwhm_deg", {9.0}}}),
               "halo_fraction: found 1");
  expect_error("led", changed(led(), {}, {"wavelength_nm"}), "wavelength_nm: found nothing");
  expect_error("led", changed(led(), {{"fwhm", {3.0}}}, {"fwhm_deg"}), "fwhm");
}

// optics.md of the requirements: a 1 mm bare (square) die into a 3 deg full cone needs 43 mm:
// D = 2 √(A/π)/sin 1.5° = 43.11 mm.
TEST(Etendue, BareMillimetreDieNeeds43MillimetresForAThreeDegreeCone) {
  const auto lamp = [](double diameter_m) {
    return changed(led(),
                   {{"profile", {"pillbox"}},
                    {"half_angle_deg", {1.5}},
                    {"pillbox_measure", {"projected"}},
                    {"die_size_mm", {1.0}},
                    {"aperture_diameter_m", {diameter_m}}},
                   {"fwhm_deg"});
  };
  std::vector<std::string> notices;
  SourceContext context;
  context.notice = [&](const std::string& line) { notices.push_back(line); };
  make_beams("led", lamp(0.0432), context);
  EXPECT_TRUE(notices.empty());
  make_beams("led", lamp(0.0430), context);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_THAT(notices[0], testing::HasSubstr("43.11 mm"));
  EXPECT_NO_THROW(make_beams("led", lamp(0.01)));  // without a listener
}

TEST(Etendue, GrowsWithTheDieAndTheIndexSquared) {
  const double cone_sr = 1e-3, aperture_m = 0.01;
  const double max_m2 = 0.25 * aperture_m * aperture_m * cone_sr;  // A_die at n = 1
  EXPECT_FALSE(etendue_notice("a", {0.999 * max_m2, 1.0}, aperture_m, cone_sr));
  EXPECT_TRUE(etendue_notice("a", {1.001 * max_m2, 1.0}, aperture_m, cone_sr));
  EXPECT_FALSE(etendue_notice("a", {0.999 * max_m2 / 2.25, 1.5}, aperture_m, cone_sr));
  EXPECT_TRUE(etendue_notice("a", {1.001 * max_m2 / 2.25, 1.5}, aperture_m, cone_sr));
}

}  // namespace
}  // namespace photorque

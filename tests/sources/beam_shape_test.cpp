#include "sources/profiles/beam_shape.h"

#include "core/constants.h"
#include "sampling.h"
#include "sources/lamps/settings.h"

namespace photorque {
namespace {

// A test emitter that is nothing but its intensity.
class Pattern : public Emitter {
 public:
  explicit Pattern(std::function<double(double)> intensity) : intensity_(std::move(intensity)) {}
  double power_W() const override { return 1.0; }
  void emit(const SampleBlock&, RayBlock&) const override {}
  double relative_intensity(double angle_rad) const override { return intensity_(angle_rad); }

 private:
  std::function<double(double)> intensity_;
};

DiscLamp lamp(AngularProfile core, std::optional<Halo> halo = std::nullopt) {
  return DiscLamp(1.0, 0.01, AngularDistribution(std::move(core), std::move(halo)));
}

// The three examples of optics.md of the requirements, to the digits that it gives, and the closed
// forms for small angles.
TEST(BeamShape, ThreeDegreesMeanThreeDifferentBeams) {
  const BeamShape gaussian = describe(lamp(gaussian_profile(3 * deg)));
  EXPECT_NEAR(gaussian.fwhm_rad, 3 * deg, 1e-9);
  EXPECT_NEAR(gaussian.full_width_tenth_rad, 3 * deg * std::sqrt(std::log2(10.0)), 1e-9);
  EXPECT_NEAR(gaussian.within_half_fwhm, 0.5, 1e-4);
  EXPECT_NEAR(gaussian.within_fwhm, 0.9375, 1e-4);
  EXPECT_NEAR(gaussian.half_angle_50_rad, 1.5 * deg, 1e-5);
  EXPECT_NEAR(gaussian.half_angle_86_rad, 1.5 * deg * std::sqrt(2.0 / std::numbers::ln2), 1e-5);
  EXPECT_NEAR(gaussian.half_angle_90_rad, 1.5 * deg * std::sqrt(std::log2(10.0)), 1e-5);

  const BeamShape quartic = describe(lamp(super_gaussian_profile(3 * deg, 4)));
  EXPECT_NEAR(quartic.fwhm_rad, 3 * deg, 1e-9);
  EXPECT_NEAR(quartic.within_half_fwhm, std::erf(std::sqrt(std::numbers::ln2)), 1e-4);  // 76 %
  EXPECT_NEAR(quartic.within_fwhm, 1.0, 3e-6);

  const DiscLamp with_halo = lamp(gaussian_profile(3 * deg), Halo{gaussian_profile(12 * deg), 0.2});
  const EncircledFlux flux(with_halo);
  EXPECT_NEAR(flux.within(1.5 * deg), 0.41, 0.005);
  EXPECT_NEAR(flux.within(3.0 * deg), 0.78, 0.005);
}

TEST(BeamShape, HoldsFromNarrowestToWholeSphere) {
  for (const double width : {1e-7, 1e-5, 1e-3}) {
    const BeamShape shape =
        describe(Pattern([=](double t) { return std::exp2(-std::pow(2 * t / width, 2)); }));
    EXPECT_NEAR(shape.fwhm_rad / width, 1.0, 1e-10);
    EXPECT_NEAR(shape.within_half_fwhm, 0.5, 1e-6);
    EXPECT_FALSE(shape.collimated);
  }
  const BeamShape sphere = describe(Pattern([](double) { return 1.0; }));
  EXPECT_DOUBLE_EQ(sphere.fwhm_rad, 2 * pi);
  EXPECT_NEAR(sphere.half_angle_50_rad, pi / 2, 1e-9);
  const DiscLamp lambertian = lamp(cosine_power_profile(1));
  const BeamShape hemisphere = describe(lambertian);
  EXPECT_NEAR(hemisphere.fwhm_rad, 120 * deg, 1e-9);
  EXPECT_NEAR(hemisphere.half_angle_50_rad, 45 * deg, 1e-8);
  EXPECT_NEAR(EncircledFlux(lambertian).solid_angle_sr(), pi, 1e-9);
}

// Edges anywhere, also where no node of a quadrature lies beyond them.
TEST(BeamShape, FindsEdgesExactly) {
  for (int i = 0; i < 400; ++i) {
    const double edge = 1e-3 * std::pow(1.0113, i);
    const Pattern disc([=](double t) { return t <= edge ? 1.0 : 0.0; });
    const BeamShape shape = describe(disc);
    EXPECT_NEAR(shape.fwhm_rad / (2 * edge), 1.0, 1e-12);
    EXPECT_NEAR(shape.full_width_tenth_rad / (2 * edge), 1.0, 1e-12);
    EXPECT_NEAR(shape.within_fwhm, 1.0, 1e-12);
    const double half = std::pow(std::sin(0.5 * shape.half_angle_50_rad), 2);
    EXPECT_NEAR(half / std::pow(std::sin(0.5 * edge), 2), 0.5, 1e-8);
  }
}

TEST(BeamShape, OfARingCountsFromItsOuterEdge) {
  const BeamShape ring = describe(Pattern([](double t) { return t > 0.1 && t < 0.2 ? 1.0 : 0.0; }));
  EXPECT_NEAR(ring.fwhm_rad, 0.4, 1e-12);
  EXPECT_NEAR(std::cos(ring.half_angle_50_rad), 0.5 * (std::cos(0.1) + std::cos(0.2)), 1e-9);
}

TEST(BeamShape, OfParallelLightIsCollimated) {
  const Pattern parallel([](double t) { return t <= 0.0 ? 1.0 : 0.0; });
  const BeamShape shape = describe(parallel);
  EXPECT_TRUE(shape.collimated);
  EXPECT_EQ(shape.fwhm_rad, 0.0);
  EXPECT_EQ(shape.half_angle_90_rad, 0.0);
  EXPECT_EQ(shape.within_half_fwhm, 1.0);
  EXPECT_THAT(one_line("sun", shape), testing::HasSubstr("collimated"));
}

TEST(BeamShape, LinesAndTableNameEveryDifferentEmitterOnce) {
  std::vector<Beam> beams;
  for (const SourceKind& kind : all_source_kinds()) {
    for (Beam& beam : kind.make(test::settings_of(test::example_of(kind.name)), test::with_files()))
      beams.push_back(beam);
  }
  const Table table = beam_shape_table(beams);
  const auto lines = beam_shape_lines(beams);
  ASSERT_EQ(lines.size(), all_source_kinds().size());
  double count = 0.0, power_W = 0.0, expected_W = 0.0;
  for (size_t row = 0; row < lines.size(); ++row) {
    EXPECT_TRUE(lines[row].starts_with(table.columns[0].texts[row])) << lines[row];
    count += table.columns[1].values[row];
    power_W += table.columns[1].values[row] * table.columns[2].values[row];
  }
  for (const Beam& beam : beams) expected_W += beam.emitter->power_W();
  EXPECT_EQ(count, static_cast<double>(beams.size()));
  EXPECT_NEAR(power_W / expected_W, 1.0, 1e-12);
  for (const auto& column : table.columns) {
    EXPECT_EQ(column.texts.size() + column.values.size(), lines.size()) << column.name;
  }
  const BeamShape gaussian = describe(lamp(gaussian_profile(3 * deg)));
  EXPECT_THAT(one_line("lamp", gaussian), testing::HasSubstr("lamp: FWHM 3 deg"));
}

}  // namespace
}  // namespace photorque

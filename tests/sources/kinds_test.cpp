// Laws that every kind of source obeys, tested on its example.
#include "core/constants.h"
#include "sampling.h"
#include "sources/profiles/beam_shape.h"

namespace photorque {
namespace {

using test::rays_of;
using test::settings_of;
using test::sorted_angles;

std::vector<Beam> beams_of(const SourceKind& kind) {
  return kind.make(settings_of(test::example_of(kind.name)), test::with_files());
}

TEST(EverySource, HasANameASummaryAndAReadableExample) {
  for (const SourceKind& kind : all_source_kinds()) {
    EXPECT_FALSE(kind.name.empty());
    EXPECT_FALSE(kind.summary.empty() || kind.summary.ends_with('.')) << kind.name;
    const Settings settings = settings_of(test::example_of(kind.name));
    EXPECT_FALSE(kind.make(settings, test::with_files()).empty()) << kind.name;
    EXPECT_NO_THROW(settings.finish()) << kind.name;
  }
}

// Kinds whose light depends on the azimuth about the beam. By Rodrigues' formula, a rotation by θ
// from straight down towards the azimuth φ takes lab x to
// (cos θ + (1 − cos θ) sin²φ, −(1 − cos θ) sin φ cos φ, sin θ cos φ).
TEST(EverySource, OfAFileTurnsWithItsBeamFromStraightDown) {
  for (const char* name : {"ies", "ray_file"}) {
    const SourceKind kind = test::kind_called(name);
    const auto x_of = [&](const Vec3& beam, double turn_deg) {
      const SettingsNode::Table keys =
          test::changed(test::example_of(kind.name),
                        {{"position_m", test::vector_node(-beam.x(), -beam.y(), -beam.z())},
                         {"aim_m", test::vector_node(0, 0, 0)},
                         {"turn_deg", {turn_deg}}},
                        {"direction"});
      const std::vector<Beam> beams = kind.make(settings_of(keys), test::with_files());
      return beams.front().lab_from_emitter.direction(Vec3::UnitX());
    };
    for (const double azimuth_rad : {0.0, 0.4, 0.5 * pi, 2.5, 5.0}) {
      const double c = std::cos(azimuth_rad), s = std::sin(azimuth_rad);
      for (const double tilt_rad : {0.0, 1e-4, 0.5, 0.5 * pi, 3.0}) {
        const Vec3 beam(std::sin(tilt_rad) * c, std::sin(tilt_rad) * s, -std::cos(tilt_rad));
        const double rest = 1.0 - std::cos(tilt_rad);
        const Vec3 x(std::cos(tilt_rad) + rest * s * s, -rest * s * c, std::sin(tilt_rad) * c);
        EXPECT_LT((x_of(beam, 0.0) - x).norm(), 1e-9) << name << tilt_rad << azimuth_rad;
      }
      EXPECT_LT((x_of({c, s, 0.0}, -azimuth_rad / deg) - Vec3::UnitZ()).norm(), 1e-9) << name;
    }
  }
}

TEST(EverySource, TakesItsNameFromTheUser) {
  for (const SourceKind& kind : all_source_kinds()) {
    for (const Beam& beam :
         kind.make(settings_of(test::changed(test::example_of(kind.name), {{"name", {"lamp 7"}}})),
                   test::with_files())) {
      EXPECT_TRUE(beam.name.starts_with("lamp 7")) << beam.name;
    }
  }
}

TEST(EverySource, EmitsUnitDirectionsForwardFromFiniteOrigins) {
  for (const SourceKind& kind : all_source_kinds()) {
    for (const Beam& beam : beams_of(kind)) {
      EXPECT_GT(beam.emitter->power_W(), 0.0) << beam.name;
      for (const auto& ray : rays_of(*beam.emitter, 4096)) {
        ASSERT_NEAR(ray.direction.norm(), 1.0, 3e-7) << beam.name;
        ASSERT_GE(ray.direction.z(), 0.0) << beam.name;
        ASSERT_TRUE(ray.origin_m.allFinite()) << beam.name;
        ASSERT_EQ(ray.origin_m.z(), 0.0) << beam.name;
      }
    }
  }
}

TEST(EverySource, SamplesTheIntensityThatItStates) {
  for (const SourceKind& kind : all_source_kinds()) {
    const Beam beam = beams_of(kind).front();
    const EncircledFlux flux(*beam.emitter);
    // A set of rays states its intensity in steps of 1 % of them.
    const double tolerance = kind.name == "ray_file" ? 5e-4 : 1e-4;
    EXPECT_LT(test::largest_deviation(sorted_angles(rays_of(*beam.emitter, 65536)),
                                      [&](double t) { return flux.within(t); }),
              tolerance)
        << kind.name;
  }
}

TEST(EverySource, IsEvenAroundItsAxis) {
  for (const SourceKind& kind : all_source_kinds()) {
    const Beam beam = beams_of(kind).front();
    std::vector<double> turns;
    for (const auto& ray : rays_of(*beam.emitter, 65536)) {
      turns.push_back(std::atan2(ray.direction.y(), ray.direction.x()) / (2.0 * pi) + 0.5);
    }
    std::sort(turns.begin(), turns.end());
    EXPECT_LT(test::largest_deviation(turns, [](double x) { return x; }), 1e-4) << kind.name;
  }
}

TEST(EverySource, StatesAnIntensityBetweenZeroAndOne) {
  for (const SourceKind& kind : all_source_kinds()) {
    const Beam beam = beams_of(kind).front();
    double largest = 0.0;
    for (double angle_rad = 0.0; angle_rad <= pi; angle_rad += 1e-4) {
      const double intensity = beam.emitter->relative_intensity(angle_rad);
      ASSERT_GE(intensity, 0.0) << kind.name;
      ASSERT_LE(intensity, 1.0) << kind.name;
      largest = std::max(largest, intensity);
    }
    EXPECT_GT(largest, 0.999) << kind.name;
  }
}

TEST(EverySource, GivesTheSameBitsEveryTimeAndInAnyOrderOfBlocks) {
  for (const SourceKind& kind : all_source_kinds()) {
    const auto first = rays_of(*beams_of(kind).front().emitter, 1024);
    const auto second = rays_of(*beams_of(kind).front().emitter, 512);
    for (size_t i = 0; i < second.size(); ++i) {
      ASSERT_EQ(first[i].origin_m, second[i].origin_m) << kind.name;
      ASSERT_EQ(first[i].direction, second[i].direction) << kind.name;
    }
  }
}

TEST(EverySource, PutsAllItsPowerInTheSpectrum) {
  for (const SourceKind& kind : all_source_kinds()) {
    for (const Beam& beam : beams_of(kind)) {
      const BandValues fraction = band_fractions(beam.spectrum, Bands{{0.0, 600e-9, 1e-3}});
      EXPECT_NEAR(fraction[0] + fraction[1], 1.0, 1e-9) << beam.name;
    }
  }
}

TEST(EverySource, RejectsUnknownKeys) {
  for (const SourceKind& kind : all_source_kinds()) {
    const Settings settings =
        settings_of(test::changed(test::example_of(kind.name), {{"colour", {"red"}}}));
    kind.make(settings, test::with_files());
    EXPECT_THROW(settings.finish(), InputError) << kind.name;
  }
}

TEST(EverySource, RefusesADirectionWithoutLength) {
  for (const SourceKind& kind : all_source_kinds()) {
    const auto table =
        test::changed(test::example_of(kind.name), {{"direction", test::vector_node(0, 0, 0)}});
    EXPECT_THROW(kind.make(settings_of(table), test::with_files()), InputError) << kind.name;
  }
}

}  // namespace
}  // namespace photorque

#include <gtest/gtest.h>

#include "images/drawing/colour.h"

namespace photorque {
namespace {

double distance(const Rgb& a, const Rgb& b) {
  const Lab p = lab_from_rgb(a);
  const Lab q = lab_from_rgb(b);
  return std::hypot(p.lightness - q.lightness, p.a - q.a, p.b - q.b);
}

struct ColourVision {
  std::string name;
  Eigen::Matrix3d matrix;
};

// G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A physiologically-based model for simulation
// of color vision deficiency", IEEE TVCG 15(6), 2009: the matrices for severity 1.0, on linear
// sRGB.
std::vector<ColourVision> kinds_of_vision() {
  Eigen::Matrix3d protanopia;
  protanopia << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116,
      1.051998;
  Eigen::Matrix3d deuteranopia;
  deuteranopia << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940,
      0.968881;
  return {{"usual", Eigen::Matrix3d::Identity()},
          {"protanopia", protanopia},
          {"deuteranopia", deuteranopia}};
}

Lab seen(const Rgb& colour, const ColourVision& vision) {
  const Eigen::Vector3d linear = vision.matrix * Eigen::Vector3d(linear_from_encoded(colour.red),
                                                                 linear_from_encoded(colour.green),
                                                                 linear_from_encoded(colour.blue));
  const auto encode = [](double x) { return encoded_from_linear(std::clamp(x, 0.0, 1.0)); };
  return lab_from_rgb({encode(linear.x()), encode(linear.y()), encode(linear.z())});
}

// B. Lindbloom's CIE colour calculator (brucelindbloom.com), sRGB, D65, no adaptation.
TEST(Colour, LabAgreesWithPublishedCalculator) {
  const Lab red = lab_from_rgb({1.0, 0.0, 0.0});
  EXPECT_NEAR(red.lightness, 53.2408, 1e-3);
  EXPECT_NEAR(red.a, 80.0925, 1e-2);
  EXPECT_NEAR(red.b, 67.2032, 1e-2);
  const Lab white = lab_from_rgb({1.0, 1.0, 1.0});
  EXPECT_NEAR(white.lightness, 100.0, 1e-9);
  EXPECT_NEAR(white.a, 0.0, 1e-9);
  EXPECT_NEAR(white.b, 0.0, 1e-9);
}

TEST(Colour, LabReturnsToTheSameColour) {
  for (const uint32_t hex : {0x000000u, 0x0102FEu, 0x7F7F7Fu, 0xFFC801u, 0x2A788Eu}) {
    const Rgb colour = rgb_from_hex(hex);
    const Rgb back = rgb_from_lab(lab_from_rgb(colour));
    EXPECT_NEAR(back.red, colour.red, 1e-7);
    EXPECT_NEAR(back.green, colour.green, 1e-7);
    EXPECT_NEAR(back.blue, colour.blue, 1e-7);
  }
}

// Entries of the table that its authors published (BIDS colormap, also matplotlib's viridis), none
// of which is one of the sixteen that our map is made of.
TEST(Viridis, AgreesWithPublishedTable) {
  const std::vector<std::pair<size_t, Rgb>> published = {
      {8, {0.277018, 0.050344, 0.375715}},   {43, {0.26658, 0.228262, 0.514349}},
      {76, {0.206756, 0.371758, 0.553117}},  {110, {0.151918, 0.500685, 0.557587}},
      {128, {0.127568, 0.566949, 0.550556}}, {145, {0.12138, 0.629492, 0.531973}},
      {178, {0.259857, 0.745492, 0.444467}}, {196, {0.404001, 0.800275, 0.362552}},
      {230, {0.741388, 0.873449, 0.149561}}, {247, {0.916242, 0.896091, 0.100717}}};
  const ColourMap map = viridis();
  for (const auto& [index, colour] : published) {
    EXPECT_LT(distance(map.colours[index], colour), 1.2) << index;
  }
}

// K. Moreland's own table, CoolWarmFloat33.csv.
TEST(CoolWarm, AgreesWithPublishedTable) {
  const std::vector<std::pair<double, Rgb>> published = {
      {0.0, {0.229806, 0.298718, 0.753683}},  {0.125, {0.383013, 0.509419, 0.917388}},
      {0.25, {0.552953, 0.688929, 0.995376}}, {0.375, {0.722193, 0.813953, 0.976575}},
      {0.5, {0.865395, 0.865410, 0.865396}},  {0.625, {0.958853, 0.769768, 0.678008}},
      {0.75, {0.958003, 0.602842, 0.481776}}, {0.875, {0.869187, 0.378313, 0.300267}},
      {1.0, {0.705673, 0.015556, 0.150233}}};
  const ColourMap map = cool_warm();
  for (const auto& [fraction, expected] : published) {
    const Rgb& colour = map(fraction);
    // Our 256 entries lie up to 1/510 from the table's fractions.
    EXPECT_NEAR(colour.red, expected.red, 0.012) << fraction;
    EXPECT_NEAR(colour.green, expected.green, 0.012) << fraction;
    EXPECT_NEAR(colour.blue, expected.blue, 0.012) << fraction;
  }
}

TEST(Viridis, LightnessRisesForEveryVision) {
  const ColourMap map = viridis();
  for (const ColourVision& vision : kinds_of_vision()) {
    for (size_t i = 1; i < map.colours.size(); ++i) {
      EXPECT_GT(seen(map.colours[i], vision).lightness, seen(map.colours[i - 1], vision).lightness)
          << vision.name << " " << i;
    }
  }
}

TEST(CoolWarm, LightnessRisesTowardsTheMiddleForEveryVision) {
  const ColourMap map = cool_warm();
  for (const ColourVision& vision : kinds_of_vision()) {
    for (size_t i = 1; i < map.colours.size() / 2; ++i) {
      const size_t mirrored = map.colours.size() - 1 - i;
      EXPECT_GT(seen(map.colours[i], vision).lightness, seen(map.colours[i - 1], vision).lightness)
          << vision.name << " " << i;
      EXPECT_GT(seen(map.colours[mirrored], vision).lightness,
                seen(map.colours[mirrored + 1], vision).lightness)
          << vision.name << " " << mirrored;
    }
  }
}

// The two signs must not be mistaken for each other; ΔE*ab = 10 is plain at a glance.
TEST(CoolWarm, SignsDifferForEveryVision) {
  const ColourMap map = cool_warm();
  for (const ColourVision& vision : kinds_of_vision()) {
    for (size_t i = 0; i <= 100; ++i) {  // from the ends to a fifth of full scale
      const Lab negative = seen(map.colours[i], vision);
      const Lab positive = seen(map.colours[map.colours.size() - 1 - i], vision);
      EXPECT_GT(std::hypot(negative.lightness - positive.lightness, negative.a - positive.a,
                           negative.b - positive.b),
                10.0)
          << vision.name << " " << i;
    }
  }
}

TEST(ColourScale, CoversTheValues) {
  const auto range = [](double smallest, double largest, bool is_signed) {
    const ColourScale scale = colour_scale({smallest, largest}, is_signed);
    return std::pair(scale.low, scale.high);
  };
  EXPECT_EQ(range(3.0, 10.0, false), std::pair(0.0, 10.0));
  EXPECT_EQ(range(9.0, 10.0, false), std::pair(9.0, 10.0));
  EXPECT_EQ(range(-2.0, 10.0, false), std::pair(-2.0, 10.0));
  EXPECT_EQ(range(7.0, 7.0, false), std::pair(0.0, 7.0));
  EXPECT_EQ(range(0.0, 0.0, false), std::pair(0.0, 1.0));
  EXPECT_EQ(range(-2.0, 10.0, true), std::pair(-10.0, 10.0));
  EXPECT_EQ(range(0.0, 0.0, true), std::pair(-1.0, 1.0));
  EXPECT_EQ(range(9.0, 10.0, true), std::pair(9.0, 10.0));
  EXPECT_EQ(range(-10.0, -9.0, true), std::pair(-10.0, -9.0));
}

}  // namespace
}  // namespace photorque

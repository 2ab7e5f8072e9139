#include "images/scene/picture.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/errors.h"
#include "tests/images/sample_product.h"

namespace photorque {
namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();
constexpr float not_a_receiver = std::numeric_limits<float>::quiet_NaN();

struct Sample {
  float depth_m = nothing;
  int32_t part = 0;
  Eigen::Vector3f normal_lab = Eigen::Vector3f::UnitZ();
  float cos_view = 1.0F;
  float irradiance_W_m2 = not_a_receiver;
};

// A view whose sample at (column, row) is that of `look`.
template <class Look>
SceneView view_of(int width, int height, int oversampling, const Look& look) {
  SceneView view;
  view.width = width;
  view.height = height;
  view.oversampling = oversampling;
  view.part_colour = {{0.7, 0.7, 0.7}, {0.3, 0.4, 0.5}};
  for (int row = 0; row < view.sample_rows(); ++row) {
    for (int column = 0; column < view.sample_columns(); ++column) {
      const Sample sample = look(column, row);
      view.depth_m.push_back(sample.depth_m);
      view.part.push_back(sample.part);
      view.normal_lab.push_back(sample.normal_lab);
      view.cos_view.push_back(sample.cos_view);
      view.irradiance_W_m2.push_back(sample.irradiance_W_m2);
    }
  }
  return view;
}

float strongest(const std::vector<float>& edges) {
  return *std::ranges::max_element(edges);
}

TEST(Shaded, ReceiversHaveTheExactColourOfTheScale) {
  const SceneView view = view_of(16, 16, 2, [](int column, int) {
    const int receiver = column / 2;
    return Sample{2.0F, 0, Eigen::Vector3f(0.6F, 0.0F, 0.8F), 0.5F, 10.0F * float(receiver)};
  });
  const ColourScale scale = colour_scale({0.0, 150.0}, false);
  const Picture picture = shaded(view, scale);
  for (int column = 0; column < 16; ++column) {
    EXPECT_EQ(picture.pixel(column, 8), rgb_bytes(viridis()(column / 15.0)));
  }
}

TEST(Shaded, NothingIsTheBackground) {
  const SceneView view = view_of(4, 4, 3, [](int, int) { return Sample{}; });
  const Picture picture = shaded(view, colour_scale({0.0, 1.0}, false));
  EXPECT_EQ(picture.pixel(2, 2), rgb_bytes(scene_background));
}

// Halves of black and white light mix to a half of the light: 188, not 128, of 255 (IEC 61966-2-1).
TEST(Shaded, AveragesLightNotBytes) {
  ColourScale scale{0.0, 1.0, {}};
  scale.map.colours.fill({0.0, 0.0, 0.0});
  scale.map.colours.back() = {1.0, 1.0, 1.0};
  const SceneView view = view_of(2, 2, 2, [](int column, int) {
    return Sample{1.0F, 0, Eigen::Vector3f::UnitZ(), 1.0F, float(column % 2)};
  });
  EXPECT_EQ(shaded(view, scale).pixel(0, 0), (std::array<uint8_t, 3>{188, 188, 188}));
}

TEST(Shaded, SurfacesDarkenAsTheyTurnAway) {
  const auto grey = [](float cos_view, const Eigen::Vector3f& normal) {
    const SceneView view = view_of(3, 3, 1, [&](int, int) {
      return Sample{1.0F, 0, normal, cos_view};
    });
    return shaded(view, colour_scale({0.0, 1.0}, false)).pixel(1, 1)[0];
  };
  EXPECT_GT(grey(1.0F, Eigen::Vector3f::UnitX()), grey(0.5F, Eigen::Vector3f::UnitX()));
  EXPECT_GT(grey(0.5F, Eigen::Vector3f::UnitX()), grey(0.0F, Eigen::Vector3f::UnitX()));
  EXPECT_GT(grey(0.5F, Eigen::Vector3f::UnitZ()), grey(0.5F, -Eigen::Vector3f::UnitZ()));
}

TEST(EdgeStrength, FollowsTheOutline) {
  const SceneView view = view_of(20, 20, 1, [](int column, int row) {
    const bool inside = column >= 5 && column < 15 && row >= 5 && row < 15;
    return Sample{inside ? 1.0F : nothing};
  });
  const std::vector<float> edges = edge_strength(view);
  for (int i = 5; i < 15; ++i) {
    EXPECT_GT(edges[5 * 20 + i], 0.0F);
    EXPECT_GT(edges[14 * 20 + i], 0.0F);
    EXPECT_EQ(edges[10 * 20 + i] > 0.0F, i == 5 || i == 14) << i;
  }
  EXPECT_EQ(edges[4 * 20 + 10], 0.0F) << "the line stays on the thing";
}

TEST(EdgeStrength, IsZeroOnSlantedPlanesAndRoundSurfaces) {
  // Perspective on a plane at grazing incidence: depth 1/(a − b·row).
  const SceneView plane =
      view_of(40, 40, 1, [](int, int row) { return Sample{1.0F / (1.0F - 0.02F * float(row))}; });
  EXPECT_EQ(strongest(edge_strength(plane)), 0.0F);
  // A cylinder of 40 samples' radius, seen up to 60 deg from its crest.
  const SceneView cylinder = view_of(70, 10, 1, [](int column, int) {
    const float s = float(column - 35) / 40.0F;
    const float c = std::sqrt(1.0F - s * s);
    return Sample{10.0F - c, 0, Eigen::Vector3f(s, 0.0F, c), c};
  });
  EXPECT_EQ(strongest(edge_strength(cylinder)), 0.0F);
}

TEST(EdgeStrength, MarksCreasesStepsAndBorders) {
  const auto with = [](const Sample& left, const Sample& right) {
    return strongest(edge_strength(
        view_of(10, 10, 1, [&](int column, int) { return column < 5 ? left : right; })));
  };
  const Sample base{1.0F};
  EXPECT_EQ(with(base, base), 0.0F);
  EXPECT_GT(with(base, Sample{1.0F, 0, Eigen::Vector3f::UnitX()}), 0.0F) << "crease";
  EXPECT_GT(with(base, Sample{1.5F}), 0.0F) << "step";
  EXPECT_GT(with(base, Sample{1.0F, 1}), 0.0F) << "border";
}

// A view of 101 × 101 pixels contains only the drawn parts.
SceneView empty_view() {
  SceneView view = view_of(101, 101, 1, [](int, int) { return Sample{}; });
  view.part_colour.clear();
  return view;
}

const Pinhole from_above = Pinhole::looking(Vec3(0.0, 0.0, 10.0), Vec3::Zero(), 0.2);

TEST(DrawnLamps, AreRoundAndOpaque) {
  SceneView view = empty_view();
  draw_lamps(view, from_above,
             {{Vec3::Zero(), Vec3::UnitZ(), 0.5}, {Vec3(0.0, 0.0, -1.0), -Vec3::UnitZ(), 0.5}});
  size_t seen = 0;
  for (size_t i = 0; i < view.depth_m.size(); ++i) {
    if (!std::isfinite(view.depth_m[i])) continue;
    ++seen;
    EXPECT_EQ(view.part[i], 0) << "the lamp behind shows";
    EXPECT_NEAR(view.depth_m[i], 10.0, 0.02);
  }
  // A disc of radius 0.5 m at 10 m: area in pixels of 20 tan(0.1)/101 m a side.
  const double side_m = 20.0 * std::tan(0.1) / 101.0;
  EXPECT_NEAR(static_cast<double>(seen), 0.25 * pi / (side_m * side_m), 25.0);
  SceneView below = empty_view();
  draw_lamps(below, from_above, {{Vec3::Zero(), -Vec3::UnitZ(), 0.5}});
  EXPECT_EQ(below.part[50 * 101 + 50], 1) << "the side that does not shine";
}

TEST(DrawnRays, EndAtTheFirstSurface) {
  const auto rays = [](float x) { return std::vector<float>{x, 0.5F, 0.0F, x, -0.5F, 0.0F}; };
  SceneView view = empty_view();
  draw_lamps(view, from_above, {{Vec3(0.0, 0.0, 1.0), Vec3::UnitZ(), 0.2}});
  draw_rays(view, from_above, rays(0.0F));
  EXPECT_EQ(view.ray[50 * 101 + 50], 0.0F) << "a lamp above hides it";
  EXPECT_GT(view.ray[35 * 101 + 50], 0.2F);
  EXPECT_GT(view.ray[65 * 101 + 50], 0.2F);
  EXPECT_EQ(view.ray[50 * 101 + 60], 0.0F);
  EXPECT_EQ(view.ray[10 * 101 + 50], 0.0F) << "beyond its end";
  const ColourScale scale = colour_scale({0.0, 1.0}, false);
  EXPECT_NE(shaded(view, scale).pixel(50, 35), rgb_bytes(scene_background));
  // Rays behind the camera, or through it, draw nothing wrong.
  draw_rays(view, from_above, {0.0F, 0.0F, 20.0F, 0.0F, 0.0F, 30.0F});
  draw_rays(view, from_above, {0.1F, 0.0F, 20.0F, 0.1F, 0.0F, -1.0F});
  for (const float ray : view.ray) EXPECT_TRUE(ray >= 0.0F && ray < 1.0F);
}

TEST(Framing, HoldsEveryPointWithRoom) {
  const std::vector<Vec3> points = {Vec3(0.3, 0.1, -0.2), Vec3(-0.4, 0.2, 0.1),
                                    Vec3(0.0, -0.3, 1.5)};
  const Pinhole camera =
      framing(Pinhole::looking(Vec3(5.0, -7.0, 5.0), Vec3::Zero(), 0.6), points, 0.75);
  double widest = 0.0;
  for (const Vec3& at : points) {
    const Vec3 from = at - camera.position_m;
    const double along = -from.dot(camera.back);
    ASSERT_GT(along, 0.0);
    widest = std::max({widest, std::abs(from.dot(camera.right)) / along / camera.half_width,
                       std::abs(from.dot(camera.up)) / along / (0.75 * camera.half_width)});
  }
  EXPECT_LT(widest, 0.95);
  EXPECT_GT(widest, 0.8);
}

SceneView lit_square(int size) {
  return view_of(size, size, 1, [size](int column, int row) {
    const bool inside = column > size / 4 && column < size * 3 / 4 && row > size / 4;
    return inside ? Sample{1.0F, 0, Eigen::Vector3f::UnitZ(), 1.0F, 400.0F} : Sample{};
  });
}

TEST(ScenePicture, ShowsTheViewAtItsOwnPixels) {
  SceneLabels labels{.title = "Square", .caption = ""};
  const Picture picture = scene_picture(lit_square(200), labels, sample_provenance());
  const auto brightest = rgb_bytes(viridis()(1.0));
  int pixels = 0;
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      pixels += picture.pixel(column, row) == brightest ? 1 : 0;
    }
  }
  // 99 columns by 149 rows, less the drawn outline of one pixel and plus a line in the colour bar.
  EXPECT_NEAR(pixels, 97 * 147, 300);
}

TEST(ScenePicture, DrawsTheBodyAxes) {
  SceneLabels labels{.title = "Axes", .caption = ""};
  const Picture without = scene_picture(lit_square(200), labels, {});
  labels.body_axes_camera = std::array<Vec3, 3>{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const Picture with = scene_picture(lit_square(200), labels, {});
  ASSERT_EQ(with.rgb.size(), without.rgb.size());
  EXPECT_NE(with.rgb, without.rgb);
}

TEST(ScenePicture, RefusesArraysThatDisagree) {
  SceneView view = lit_square(20);
  view.cos_view.pop_back();
  EXPECT_THROW(scene_picture(view, {}, {}), InputError);
  SceneView without_colour = lit_square(20);
  without_colour.part_colour.clear();
  EXPECT_THROW(scene_picture(without_colour, {}, {}), InputError);
  EXPECT_THROW(scene_picture({}, {}, {}), InputError);
}

TEST(ScenePicture, NeedsNothingInView) {
  const SceneView view = view_of(30, 20, 1, [](int, int) { return Sample{}; });
  EXPECT_GT(scene_picture(view, {.title = "Empty", .caption = ""}, {}).height, 20);
}

}  // namespace
}  // namespace photorque

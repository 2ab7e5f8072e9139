#include "receivers/surface_grid.h"

#include <gmock/gmock.h>

#include <random>

#include "receiver_scenes.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using fixtures::box;
using fixtures::plate;
using fixtures::polygon;
using fixtures::ring;
using fixtures::scene_of;
using fixtures::sphere;
using ::testing::HasSubstr;

constexpr uint32_t first[] = {0};

SurfaceGrid grid_over(const Scene& scene, int width, int height,
                      SurfaceGridOptions options = SurfaceGridOptions()) {
  options.width = width;
  options.height = height;
  return make_surface_grid(scene, first, options);
}

SurfaceGridOptions facing(const Vec3& direction) {
  SurfaceGridOptions options;
  options.facing_body = direction;
  return options;
}

SurfaceGridOptions over_texture() {
  SurfaceGridOptions options;
  options.over = SurfaceGrid::Over::texture;
  return options;
}

// Heron's formula in Kahan's stable form: the area from the lengths of the sides alone.
double triangle_area(const Vec3& p, const Vec3& q, const Vec3& r) {
  std::array<double, 3> s = {(p - q).norm(), (q - r).norm(), (r - p).norm()};
  std::sort(s.begin(), s.end());
  const double a = s[2], b = s[1], c = s[0];
  return 0.25 * std::sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)));
}

double mesh_area(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    area += triangle_area(mesh.vertices_m[t[0]], mesh.vertices_m[t[1]], mesh.vertices_m[t[2]]);
  }
  return area;
}

Mesh turned_about_z(Mesh mesh, double angle_rad) {
  const Eigen::AngleAxisd turn(angle_rad, Vec3::UnitZ());
  for (Vec3& vertex : mesh.vertices_m) vertex = turn * vertex;
  return mesh;
}

TEST(SurfaceClip, FractionsOfAnyTriangleSumToOne) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 3000; ++trial) {
    const int width = 1 + static_cast<int>(random() % 9),
              height = 1 + static_cast<int>(random() % 9);
    std::array<Vec2, 3> corners;
    for (Vec2& corner : corners) corner = Vec2(uniform(random) * width, uniform(random) * height);
    // A third of the triangles have corners on lines of the grid, a third are seen edge-on.
    if (trial % 3 == 1) {
      for (Vec2& corner : corners) corner = corner.array().round();
    }
    if (trial % 3 == 2) corners[2] = corners[0] + uniform(random) * (corners[1] - corners[0]);
    double sum = 0.0;
    split_over_cells(corners, width, height, [&](int column, int row, double fraction) {
      ASSERT_TRUE(column >= 0 && column < width && row >= 0 && row < height);
      ASSERT_GE(fraction, 0.0);
      sum += fraction;
    });
    ASSERT_NEAR(sum, 1.0, 1e-13) << "trial " << trial;
  }
}

TEST(SurfaceClip, TriangleOnALineOfTheGridIsCountedOnce) {
  std::vector<std::pair<int, double>> parts;
  split_over_cells({Vec2(0.5, 2.0), Vec2(1.5, 2.0), Vec2(0.5, 2.0 + 1e-15)}, 2, 4,
                   [&](int column, int row, double fraction) {
                     EXPECT_EQ(row, 2);
                     parts.emplace_back(column, fraction);
                   });
  // Corners at u = 0.5, 1.5, 0.5: the part beyond the middle line is a similar triangle of half the
  // size, a quarter of the area.
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(parts[0].second, 0.75, 1e-14);
  EXPECT_NEAR(parts[1].second, 0.25, 1e-14);
}

TEST(SurfaceGrid, SquareOnItsCornerFillsCellsByHalves) {
  // |x| + |y| ≤ 1 on cells of 1/2: in each quadrant one whole cell, two halves, one empty.
  const SurfaceGrid grid = grid_over(scene_of(polygon(4)), 4, 4);
  const double w = 0.25, h = 0.125;
  const std::vector<double> expected = {0, h, h, 0, h, w, w, h, h, w, w, h, 0, h, h, 0};
  ASSERT_EQ(grid.bins(), 16u);
  for (size_t bin = 0; bin < 16; ++bin) EXPECT_NEAR(grid.area_m2[bin], expected[bin], 1e-14);
  EXPECT_EQ(grid.area_m2[0], 0.0);
  EXPECT_DOUBLE_EQ(grid.u_low, -1.0);
  EXPECT_DOUBLE_EQ(grid.v_high, 1.0);
}

TEST(SurfaceGrid, TurnedSquareKeepsItsArea) {
  for (const double angle_deg : {0.0, 1e-7, 10.0, 45.0, 89.9}) {
    const Mesh mesh = turned_about_z(plate(-0.3, 0.3, -0.3, 0.3), angle_deg * degree_rad);
    const SurfaceGrid grid = grid_over(scene_of(mesh), 100, 100);
    EXPECT_NEAR(grid.total_area_m2(), 0.36, 0.36e-12) << angle_deg;
    // A cell at the centre lies inside the square: its area is that of the cell.
    const double cell_m2 = (grid.u_high - grid.u_low) * (grid.v_high - grid.v_low) / 1e4;
    EXPECT_NEAR(grid.area_m2[50 * 100 + 50], cell_m2, 1e-12 * cell_m2) << angle_deg;
  }
}

TEST(SurfaceGrid, RingHasAHoleWithoutSurface) {
  const uint32_t corners = 360;
  const double inner = 0.3, outer = 0.5;
  const SurfaceGrid grid = grid_over(scene_of(ring(corners, inner, outer)), 100, 100);
  const double expected =
      0.5 * corners * std::sin(2 * pi / corners) * (outer * outer - inner * inner);
  EXPECT_NEAR(grid.total_area_m2(), expected, 1e-12 * expected);
  const double cell_m2 = 1e-4;
  for (int row = 0; row < 100; ++row) {
    for (int column = 0; column < 100; ++column) {
      const double near =
          std::hypot(std::abs(column - 49.5) - 0.5, std::abs(row - 49.5) - 0.5) / 100;
      const double far =
          std::hypot(std::abs(column - 49.5) + 0.5, std::abs(row - 49.5) + 0.5) / 100;
      const double area_m2 = grid.area_m2[static_cast<size_t>(row * 100 + column)];
      if (far < inner * std::cos(pi / corners) || near > outer) {
        EXPECT_EQ(area_m2, 0.0);
      } else if (near > inner && far < outer * std::cos(pi / corners)) {
        EXPECT_NEAR(area_m2, cell_m2, 1e-11 * cell_m2);
      }
    }
  }
}

// A quarter of a square metre above a square metre: more area than the bins have.
TEST(SurfaceGrid, ReportsTheAreaInLayers) {
  Mesh mesh = plate(-0.5, 0.5, -0.5, 0.5);
  EXPECT_NEAR(grid_over(scene_of(mesh), 20, 20).overlapping_m2, 0.0, 1e-12);
  const auto below = static_cast<uint32_t>(mesh.vertices_m.size());
  const Mesh above = plate(-0.25, 0.25, -0.25, 0.25, 0.1);
  mesh.vertices_m.insert(mesh.vertices_m.end(), above.vertices_m.begin(), above.vertices_m.end());
  for (const auto& t : above.triangles) {
    mesh.triangles.push_back({t[0] + below, t[1] + below, t[2] + below});
  }
  EXPECT_NEAR(grid_over(scene_of(mesh), 20, 20).overlapping_m2, 0.25, 1e-12);
}

TEST(SurfaceGrid, CurvedSurfaceKeepsItsTrueArea) {
  const Mesh mesh = sphere(1.0, 24);
  Mesh upper = mesh;
  std::erase_if(upper.triangles, [&](const auto& t) {
    return mesh.vertices_m[t[0]].z() + mesh.vertices_m[t[1]].z() + mesh.vertices_m[t[2]].z() < 0;
  });
  const double expected = mesh_area(upper);
  EXPECT_NEAR(expected, 2 * pi, 0.03);
  for (const int bins : {1, 7, 100}) {
    const SurfaceGrid dome = grid_over(scene_of(upper), bins, bins);
    EXPECT_NEAR(dome.total_area_m2(), expected, 1e-12 * expected);
    EXPECT_NEAR(dome.normal_body.z(), 1.0, 1e-12);
    const SurfaceGrid half = grid_over(scene_of(mesh), bins, bins, facing({0, 0, 2}));
    EXPECT_NEAR(half.total_area_m2(), expected, 1e-12 * expected);
  }
}

TEST(SurfaceGrid, ClosedBodyNeedsADirection) {
  const Scene scene = scene_of(box({-0.2, -0.1, -0.01}, {0.2, 0.1, 0.01}));
  EXPECT_THAT(refusal_of([&] { grid_over(scene, 10, 10); }), HasSubstr("closed surface"));
  const SurfaceGrid top = grid_over(scene, 10, 10, facing(Vec3::UnitZ()));
  EXPECT_NEAR(top.total_area_m2(), 0.4 * 0.2, 1e-15);  // neither the bottom nor the sides
  const SurfaceGrid side = grid_over(scene, 10, 10, facing(-Vec3::UnitY()));
  EXPECT_NEAR(side.total_area_m2(), 0.4 * 0.02, 1e-15);
  EXPECT_NEAR(side.v_high, 0.01, 1e-15);
}

TEST(SurfaceGrid, AxesAreTheProjectedBodyAxes) {
  struct Case {
    Vec3 normal, u;
  };
  const double c = std::cos(30 * degree_rad), s = std::sin(30 * degree_rad);
  for (const Case& expected :
       {Case{{0, 0, 1}, {1, 0, 0}}, Case{{0, 0, -1}, {1, 0, 0}}, Case{{0, 1, 0}, {1, 0, 0}},
        Case{{1, 0, 0}, {0, 1, 0}}, Case{{-1, 0, 0}, {0, 1, 0}}, Case{{s, 0, c}, {c, 0, -s}}}) {
    Affine turn = Affine::Identity();
    turn.linear() = Quat::FromTwoVectors(Vec3::UnitZ(), expected.normal).toRotationMatrix();
    const SurfaceGrid grid = grid_over(scene_of(plate(-1, 1, -2, 2), turn), 4, 4);
    EXPECT_LT((grid.normal_body - expected.normal).norm(), 1e-12);
    EXPECT_LT((grid.u_axis_body - expected.u).norm(), 1e-12);
    EXPECT_LT((grid.v_axis_body - expected.normal.cross(expected.u)).norm(), 1e-12);
  }
}

TEST(SurfaceGrid, MirroredInstanceKeepsItsFront) {
  Affine mirror = Affine::Identity();
  mirror.linear() = Vec3(-2, 3, 1).asDiagonal();
  const SurfaceGrid grid = grid_over(scene_of(plate(0, 1, 0, 1), mirror), 2, 2);
  EXPECT_LT((grid.normal_body - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_NEAR(grid.total_area_m2(), 6.0, 1e-12);
  EXPECT_DOUBLE_EQ(grid.u_low, -2.0);
}

TEST(SurfaceGrid, TextureBinsHoldTheAreaThatMapsThere) {
  // u runs over x in [0, 2], v over y in [0, 1]: each of 4 × 5 bins holds 2/20.
  const SurfaceGrid grid = grid_over(scene_of(plate(0, 2, 0, 1)), 4, 5, over_texture());
  for (const double area_m2 : grid.area_m2) EXPECT_NEAR(area_m2, 0.1, 1e-15);
}

TEST(SurfaceGrid, TextureMustBeThereAndInRange) {
  Mesh bare = plate(0, 1, 0, 1);
  bare.uv.clear();
  EXPECT_THAT(refusal_of([&] { grid_over(scene_of(bare), 2, 2, over_texture()); }),
              HasSubstr("without texture coordinates"));
  Mesh repeated = plate(0, 1, 0, 1);
  repeated.uv[2] = {1, 3};
  EXPECT_THAT(refusal_of([&] { grid_over(scene_of(repeated), 2, 2, over_texture()); }),
              HasSubstr("from 0 to 1"));
}

TEST(SurfaceGrid, RefusesBinsOutOfRangeAndNoArea) {
  const Scene scene = scene_of(plate(0, 1, 0, 1));
  EXPECT_THAT(refusal_of([&] { grid_over(scene, 0, 5); }), HasSubstr("1 to 4096"));
  EXPECT_THAT(refusal_of([&] { grid_over(scene, 5, 4097); }), HasSubstr("4097"));
  EXPECT_THAT(refusal_of([&] { grid_over(scene_of(plate(0, 1, 2, 2)), 5, 5); }),
              HasSubstr("zero area"));
  EXPECT_THAT(refusal_of([&] { grid_over(scene, 5, 5, facing(-Vec3::UnitZ())); }),
              HasSubstr("no surface that faces that way"));
}

TEST(SurfaceGrid, BinOfAPointIsTheOneAroundItOrNearest) {
  const SurfaceGrid grid = grid_over(scene_of(plate(-1, 1, 0, 3)), 4, 6);
  EXPECT_EQ(bin_of_position(grid, {-0.99, 0.01, 5.0}), 0u);
  EXPECT_EQ(bin_of_position(grid, {0.25, 1.75, 0.0}), 3u * 4 + 2);
  EXPECT_EQ(bin_of_position(grid, {9, 9, 0}), 23u);
  EXPECT_EQ(bin_of_position(grid, {-9, -9, 0}), 0u);
  const SurfaceGrid texture = grid_over(scene_of(plate(-1, 1, 0, 3)), 4, 6, over_texture());
  EXPECT_EQ(bin_of_texture(texture, {0.30, 0.95}), 5u * 4 + 1);
}

}  // namespace
}  // namespace photorque

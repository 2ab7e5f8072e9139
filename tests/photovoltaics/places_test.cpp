// Cells found in a mesh, and rectangles anywhere.
#include "photovoltaics/array/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "photovoltaics/array/array.h"
#include "reference.h"
#include "tests/receivers/receiver_scenes.h"
#include "tests/refusal.h"

namespace photorque {
namespace {

using fixtures::append;
using fixtures::plate;
using test::numbers_node;
using test::settings_of;

// Two triangles without a common index, as exporters without indices write a rectangle.
Mesh loose_plate(double x0, double x1, double y0, double y1) {
  const Mesh whole = plate(x0, x1, y0, y1);
  Mesh mesh;
  for (const auto& t : whole.triangles) {
    mesh.triangles.push_back({});
    for (size_t i = 0; i < 3; ++i) {
      mesh.triangles.back()[i] = static_cast<uint32_t>(mesh.vertices_m.size());
      mesh.vertices_m.push_back(whole.vertices_m[t[i]]);
      mesh.uv.push_back(whole.uv[t[i]]);
    }
  }
  return mesh;
}

constexpr double side_m = 0.09, pitch_m = 0.1;

// Three columns and two rows of squares, 10 mm apart, in one mesh and in no good order.
Mesh six_squares() {
  Mesh all;
  for (const auto& [column, row] : {std::pair{2, 1}, {0, 0}, {1, 1}, {2, 0}, {0, 1}, {1, 0}}) {
    append(all, loose_plate(column * pitch_m, column * pitch_m + side_m, row * pitch_m,
                            row * pitch_m + side_m));
  }
  return all;
}

SurfaceGrid grid_over(const Scene& scene, int width = 29, int height = 19) {
  std::vector<uint32_t> all(scene.instances.size());
  std::iota(all.begin(), all.end(), 0u);
  SurfaceGridOptions options;
  options.width = width;
  options.height = height;
  return make_surface_grid(scene, all, options);
}

double area_of(const CellPlaces& places, const SurfaceGrid& grid, size_t cell) {
  double area_m2 = 0.0;
  for (const BinPart& part : places.parts[cell]) area_m2 += part.fraction * grid.area_m2[part.bin];
  return area_m2;
}

TEST(CellPlaces, SeparatePiecesOfAMeshAreCellsNumberedRowByRow) {
  const Scene scene = fixtures::scene_of(six_squares());
  // 29 × 19 bins of 10 mm fit the squares; 10 × 7 cut them.
  for (const auto& [width, height] : {std::pair{29, 19}, {10, 7}}) {
    const SurfaceGrid grid = grid_over(scene, width, height);
    const CellPlaces places = places_from_mesh(scene, grid);
    ASSERT_EQ(places.parts.size(), 6u);
    EXPECT_EQ(places.columns, 3);
    EXPECT_EQ(places.rows, 2);
    for (size_t cell = 0; cell < 6; ++cell) {
      EXPECT_NEAR(area_of(places, grid, cell), side_m * side_m, 1e-12);
      const size_t column = cell % 3, row = cell / 3;
      EXPECT_NEAR(places.centres[cell].x(), pitch_m * static_cast<double>(column) + 0.045, 1e-9);
      EXPECT_NEAR(places.centres[cell].y(), pitch_m * static_cast<double>(row) + 0.045, 1e-9);
    }
  }
}

// The array as equal rectangles over a sheet with gaps: the same light on every cell.
TEST(CellPlaces, MeshAndRegularRectanglesGiveTheSameArray) {
  const Scene squares = fixtures::scene_of(six_squares());
  const SurfaceGrid grid = grid_over(squares);
  std::vector<double> irradiance;
  for (int row = 0; row < 19; ++row) {
    for (int column = 0; column < 29; ++column)
      irradiance.push_back(300.0 + 2.0 * column + 5.0 * row);
  }
  const ArrayLight sheet = array_light(29, 19, 0.29, 0.19, irradiance);
  ArrayLight lit = sheet;
  lit.grid.area_m2 = grid.area_m2;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    lit.power_W.sums[i] = irradiance[i] * grid.area_m2[i];
  }
  ArrayDesign regular = reference::array_in_series(3, 2, 6);
  regular.gap_m = pitch_m - side_m;
  ArrayDesign meshed = regular;
  meshed.gap_m = 0.0;
  meshed.places = places_from_mesh(squares, grid);
  const ArrayResult a = evaluate_array(regular, sheet, std::array{0.5});
  const ArrayResult b = evaluate_array(meshed, lit, std::array{0.5});
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(b.cell_photocurrent_A[i], a.cell_photocurrent_A[i],
                1e-12 * a.cell_photocurrent_A[i]);
  }
  EXPECT_NEAR(b.power_W.value, a.power_W.value, 1e-11 * a.power_W.value);
  // And as six rectangles in the experiment.
  std::vector<CellRectangle> rectangles;
  for (int cell = 0; cell < 6; ++cell) {
    const int column = cell % 3, row = cell / 3;
    const double u = pitch_m * column, v = pitch_m * row;
    rectangles.push_back({u, u + side_m, v, v + side_m});
  }
  const Scene whole = fixtures::scene_of(plate(0, 0.29, 0, 0.19));
  meshed.places = places_from_rectangles(rectangles, grid_over(whole));
  const ArrayResult c = evaluate_array(meshed, sheet, std::array{0.5});
  EXPECT_NEAR(c.power_W.value, a.power_W.value, 1e-11 * a.power_W.value);
}

TEST(CellPlaces, InstancesAreCellsAlsoWhenTheyTouch) {
  Scene scene;
  for (const int x : {0, 1, 2}) {
    Affine at = Affine::Identity();
    at.translation() = Vec3(0.1 * x, 0, 0);
    fixtures::add_instance(scene, plate(0, 0.1, 0, 0.2), "cell", at);
  }
  const SurfaceGrid grid = grid_over(scene, 6, 4);
  EXPECT_EQ(places_from_mesh(scene, grid).parts.size(), 3u);
  // Squares of one mesh that share an edge are one cell.
  Mesh touching;
  append(touching, loose_plate(0, 0.1, 0, 0.1));
  append(touching, loose_plate(0.1, 0.2, 0, 0.1));
  const Scene joined = fixtures::scene_of(touching);
  EXPECT_EQ(places_from_mesh(joined, grid_over(joined)).parts.size(), 1u);
}

TEST(CellPlaces, CellsOutOfLineStandInOneRow) {
  Mesh all;
  append(all, plate(0, 1, 0, 1));
  append(all, plate(2, 3, 0.5, 1.5));
  append(all, plate(0, 1, 2, 3));
  append(all, plate(2, 3, 2, 3));
  const Scene scene = fixtures::scene_of(all);
  const CellPlaces places = places_from_mesh(scene, grid_over(scene));
  EXPECT_EQ(places.columns, 4);
  EXPECT_EQ(places.rows, 1);
  EXPECT_NEAR(places.centres[1].y(), 1.0, 1e-9);
}

SettingsNode rectangle(const std::vector<double>& low, const std::vector<double>& high) {
  return {SettingsNode::Table{{"low_mm", numbers_node(low)}, {"high_mm", numbers_node(high)}}};
}

TEST(CellPlaces, WrongPlacesNameTheirKey) {
  const Scene scene = fixtures::scene_of(plate(0, 0.29, 0, 0.19));
  const SurfaceGrid grid = grid_over(scene);
  const auto message = [&](const SettingsNode::Table& keys) {
    return refusal_of([&] { read_cell_places(settings_of(keys), scene, grid); });
  };
  const auto rectangles = [](SettingsNode::Array all) { return SettingsNode{std::move(all)}; };
  const SettingsNode good = rectangle({0, 0}, {100, 100});
  EXPECT_EQ(message({{"rectangle", rectangles({good, rectangle({100, 0}, {200, 100})})}}), "");
  EXPECT_THAT(message({{"rectangle", rectangles({good, rectangle({50, 0}, {150, 100})})}}),
              testing::HasSubstr("a cell over cell 0"));
  EXPECT_THAT(message({{"rectangle", rectangles({rectangle({0, 0}, {300, 100})})}}),
              testing::HasSubstr("a rectangle within u = 0.000000 to 0.290000"));
  EXPECT_THAT(message({{"rectangle", rectangles({rectangle({0, 0, 1}, {300, 100})})}}),
              testing::HasSubstr("[u, v]"));
  EXPECT_THAT(message({{"cells", {"meshh"}}}), testing::HasSubstr("did you mean"));
  EXPECT_THAT(message({{"cells", {"mesh"}}, {"gap_m", {0.1}}}), testing::HasSubstr("gap_m"));
  EXPECT_FALSE(read_cell_places(settings_of({{"cells", numbers_node({3.0, 2.0})}}), scene, grid)
                   .has_value());
}

}  // namespace
}  // namespace photorque

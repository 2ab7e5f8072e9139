// The cells of an array from a glTF file: written, read, lit, and turned into power.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "photovoltaics/array/array.h"
#include "scenes/experiment/experiment.h"
#include "scenes/gltf/writer.h"

namespace photorque {
namespace {

namespace fs = std::filesystem;

constexpr double cell_x_m = 0.02, cell_y_m = 0.04, pitch_x_m = 0.022, pitch_y_m = 0.043;
constexpr int cell_columns = 4, cell_rows = 3;

// One mesh of a cell, a node for each, under "cells"; a board below them.
std::string model_text() {
  GltfWriterModel model;
  Mesh cell;
  cell.vertices_m = {{0, 0, 0}, {cell_x_m, 0, 0}, {cell_x_m, cell_y_m, 0}, {0, cell_y_m, 0}};
  cell.triangles = {{0, 1, 2}, {0, 2, 3}};
  Mesh board = cell;
  for (Vec3& at : board.vertices_m) at = Vec3(10 * at.x() - 0.05, 5 * at.y() - 0.05, -0.001);
  model.meshes = {cell, board};
  model.materials.emplace_back().name = "cell";
  model.nodes.push_back({"board", -1, Vec3::Zero(), 1, 0});
  model.nodes.push_back({"cells"});
  for (int i = cell_columns * cell_rows - 1; i >= 0; --i) {
    const int column = i % cell_columns, row = i / cell_columns;
    const Vec3 place_m(pitch_x_m * column, pitch_y_m * row, 0.0);
    model.nodes.push_back({"cell" + std::to_string(i), 1, place_m, 0, 0});
  }
  return gltf_text(model);
}

TEST(ArrayCells, NodesOfAGltfFileAreTheCells) {
  const fs::path folder = fs::path(::testing::TempDir()) / "array_cells";
  fs::create_directories(folder);
  std::ofstream(folder / "model.gltf") << model_text();
  std::ofstream(folder / "array.toml") << R"(
[scene]
file = "model.gltf"
[[source]]
kind = "sun"
irradiance_W_m2 = 1000
angular_radius_deg = 0
direction = [0.6, 0, -0.8]
[[receiver]]
kind = "flux_map"
node = "cells"
bins = [43, 63]
[trace]
rays = 65536
[array]
cells = "mesh"
)";
  const Experiment experiment = resolve_experiment(read_experiment_file(folder / "array.toml"));
  const FluxMapReceiver& map = *experiment.receivers[0].flux_map;
  const Settings array = experiment.file.others("array")[0];
  const auto places = read_cell_places(array, experiment.scene, map.grid());
  ASSERT_TRUE(places.has_value());
  EXPECT_EQ(places->columns, cell_columns);
  EXPECT_EQ(places->rows, cell_rows);
  const ArrayDesign design = read_array_design(array, places);
  const TraceResult traced =
      trace(TraceableScene(experiment.scene), experiment.lab_from_body, experiment.beams,
            experiment.receiver_pointers(), experiment.file.trace);
  const ArrayResult result =
      evaluate_array(design, array_light(map, traced.sums[0]),
                     std::vector<double>(static_cast<size_t>(map.bands().count()), 0.5));
  // 1000 W/m² at a cosine of 0.8; the noise of 65536 rays over the whole field is some percent.
  constexpr double cell_m2 = cell_x_m * cell_y_m, cells = cell_columns * cell_rows;
  EXPECT_NEAR(result.area_of_cells_m2, cells * cell_m2, 1e-9);
  EXPECT_NEAR(result.power_on_cells_W.value, 800.0 * cells * cell_m2,
              5.0 * result.power_on_cells_W.standard_error);
  EXPECT_LT(result.power_on_cells_W.standard_error, 0.02 * result.power_on_cells_W.value);
  for (int i = 0; i < cell_columns * cell_rows; ++i) {
    const Vec2 centre = result.cell_centre_m[static_cast<size_t>(i)];
    const int column = i % cell_columns, row = i / cell_columns;
    EXPECT_NEAR(centre.x(), pitch_x_m * column + 0.5 * cell_x_m, 1e-7);
    EXPECT_NEAR(centre.y(), pitch_y_m * row + 0.5 * cell_y_m, 1e-7);
  }
}

}  // namespace
}  // namespace photorque

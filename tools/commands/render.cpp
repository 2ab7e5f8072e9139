// photorque render: a picture of the scene with the irradiance painted on its receivers.
#include <cmath>

#include "core/constants.h"
#include "images/publishing/staged_files.h"
#include "images/scene/picture.h"
#include "raytrace/tracing/view.h"
#include "tools/commands/terminal.h"
#include "tools/runs/optical_run.h"

namespace photorque {
namespace {

constexpr int oversampling = 3;  // per pixel and direction

// A pinhole camera: x right, y up, z towards the viewer.
struct CameraFrame {
  Vec3 right, up, back;
  double half_width;  // of the picture at distance 1
};

CameraFrame camera_frame(const Camera& camera) {
  CameraFrame frame;
  frame.back = (camera.position_m - camera.target_m).normalized();
  Vec3 side = Vec3::UnitZ().cross(frame.back);
  if (side.norm() < 1e-9) side = Vec3::UnitX();  // straight down or up: x to the right
  frame.right = side.normalized();
  frame.up = frame.back.cross(frame.right);
  frame.half_width = std::tan(0.5 * camera.field_of_view_rad);
  return frame;
}

// A grey that shows how much a surface reflects; the eye takes reflectance in powers.
Rgb part_colour(const OpticalSurface& surface) {
  const float reflectance = static_cast<float>(surface.specular[0] + surface.diffuse[0]);
  const float grey = 0.30f + 0.60f * std::sqrt(reflectance);
  return {grey, grey, grey};
}

float irradiance_at(const OpticalRun& run, const std::vector<std::pair<size_t, FluxMap>>& maps,
                    const VisiblePoint& point) {
  for (const auto& [index, map] : maps) {
    const SurfaceGrid& grid = map.grid;
    const bool on_it = std::find(grid.instances.begin(), grid.instances.end(), point.instance) !=
                       grid.instances.end();
    const bool lit_side = grid.side == Side::both || (grid.side == Side::front) == point.front;
    if (!on_it || !lit_side) continue;
    size_t bin = 0;
    if (grid.over == SurfaceGrid::Over::plane) {
      bin = bin_of_position(grid, point.position_m);
    } else {
      const Scene& scene = run.experiment().scene;
      const Mesh& mesh = scene.meshes[scene.instances[point.instance].mesh];
      const auto& corner = mesh.triangles[point.triangle];
      const double u = point.barycentric[0], v = point.barycentric[1];
      bin = bin_of_texture(
          grid, (1 - u - v) * mesh.uv[corner[0]] + u * mesh.uv[corner[1]] + v * mesh.uv[corner[2]]);
    }
    return static_cast<float>(map.incident.per_bin_W_m2[bin].value);
  }
  return std::numeric_limits<float>::quiet_NaN();
}

SceneView make_view(const OpticalRun& run, const TraceResult& result, int threads) {
  const Experiment& experiment = run.experiment();
  const Camera& camera = experiment.camera;
  const CameraFrame frame = camera_frame(camera);
  const RigidTransform body_from_lab = experiment.lab_from_body.inverse();
  SceneView view;
  view.width = camera.width;
  view.height = camera.height;
  view.oversampling = oversampling;
  const int columns = view.sample_columns(), rows = view.sample_rows();
  const auto sight = [&](size_t i) {
    const double x =
        (static_cast<double>(i % static_cast<size_t>(columns)) + 0.5) / columns * 2 - 1;
    const double y =
        (1 - (static_cast<double>(i / static_cast<size_t>(columns)) + 0.5) / rows * 2) * rows /
        columns;
    const Vec3 direction = frame.half_width * (x * frame.right + y * frame.up) - frame.back;
    return Sight{body_from_lab.point(camera.position_m),
                 body_from_lab.direction(direction.normalized())};
  };
  const auto points =
      look(run.scene(), static_cast<size_t>(columns) * static_cast<size_t>(rows), sight, threads);

  std::vector<std::pair<size_t, FluxMap>> maps;
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    if (experiment.receivers[i].kind == "flux_map")
      maps.emplace_back(i, run.flux_map(i).flux_map(result.sums[i]));
  }
  for (const Instance& instance : experiment.scene.instances) {
    view.part_colour.push_back(part_colour(experiment.scene.surfaces[instance.front_surface]));
  }
  for (size_t i = 0; i < points.size(); ++i) {
    const VisiblePoint& point = points[i];
    view.depth_m.push_back(static_cast<float>(point.distance_m));
    view.part.push_back(static_cast<int32_t>(point.instance));
    view.normal_lab.push_back(experiment.lab_from_body.direction(point.normal).cast<float>());
    view.cos_view.push_back(static_cast<float>(std::abs(point.normal.dot(sight(i).direction))));
    view.irradiance_W_m2.push_back(point.hit ? irradiance_at(run, maps, point)
                                             : std::numeric_limits<float>::quiet_NaN());
  }
  return view;
}

void run_render(const CommandLine& line) {
  const Console console = terminal(line);
  const OpticalRun run(line, console);
  const Experiment& experiment = run.experiment();
  const OpticalResult result = run.run(experiment.lab_from_body, console.progress("tracing"));
  console.done();
  const SceneView view = make_view(run, result, line.threads);

  const CameraFrame frame = camera_frame(experiment.camera);
  SceneLabels labels;
  labels.title = experiment.file.path.stem().string() + ": irradiance";
  labels.caption =
      "tilt " + show(experiment.file.attitude.tilt_rad / degree_rad) + " deg, heading " +
      show(experiment.file.attitude.heading_rad / degree_rad) + " deg; " +
      show(result.power_balance.emitted_W) + " W emitted, " +
      show(100 * result.power_balance.absorbed_W.value / result.power_balance.emitted_W) +
      " % absorbed";
  std::array<Vec3, 3> axes;
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = experiment.lab_from_body.direction(Vec3::Unit(k));
    axes[static_cast<size_t>(k)] = {axis.dot(frame.right), axis.dot(frame.up),
                                    axis.dot(frame.back)};
  }
  labels.body_axes_camera = axes;
  const auto path = line.out_folder() / "render.png";
  StagedFiles staged(line.out_folder());
  write_scene_picture(staged.path() / path.filename(), view, labels, run.provenance());
  staged.publish_as(line.verb, run.provenance());
  console.heading("Written to " + path.string());
}

}  // namespace

Verb render_verb() {
  return {"render", "A picture of the scene with the irradiance painted on its receivers",
          run_render, true};
}

}  // namespace photorque

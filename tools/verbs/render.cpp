// photorque render: a picture of the scene with the irradiance painted on its receivers.
#include "tools/verbs/render.h"

#include <cmath>

#include "core/constants.h"
#include "images/scene/picture.h"
#include "images/writers/staged_files.h"
#include "raytrace/tracing/view.h"
#include "tools/pages/parts.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

constexpr int oversampling = 3;  // per pixel in each direction
constexpr size_t drawn_rays = 200;

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

// The lamps near the scene, for drawing.
std::vector<DrawnLamp> drawn_lamps(const Experiment& experiment) {
  const double radius_m = experiment.scene.radius_m();
  std::vector<DrawnLamp> lamps;
  for (const Beam& beam : experiment.beams) {
    if (is_too_far_to_draw(beam, radius_m)) continue;
    // A lamp without an opening is drawn as a dot.
    lamps.push_back({beam.lab_from_emitter.translation_m,
                     beam.lab_from_emitter.direction(Vec3::UnitZ()),
                     beam.aperture ? beam.aperture->radius_m : 0.02 * radius_m});
  }
  return lamps;
}

// The experiment's camera; if it states no position and shows the lamps, a camera that shows body
// and lamps.
Pinhole camera_of(const Experiment& experiment, const std::vector<DrawnLamp>& lamps) {
  const Camera& given = experiment.camera;
  Pinhole camera = Pinhole::looking(given.position_m, given.target_m, given.field_of_view_rad);
  if (given.placed || lamps.empty()) return camera;
  std::vector<Vec3> points_m;
  for (const Instance& instance : experiment.scene.instances) {
    for (const Vec3& vertex : experiment.scene.meshes[instance.mesh].vertices_m) {
      points_m.push_back(experiment.lab_from_body.point(instance.body_from_mesh * vertex));
    }
  }
  for (const DrawnLamp& lamp : lamps) points_m.push_back(lamp.position_m);
  return framing(camera, points_m, static_cast<double>(given.height) / given.width);
}

// Computes the view in strips of the picture: all points of a large one would need gigabytes.
SceneView make_view(const OpticalRun& run, const TraceResult& result, const Pinhole& pinhole,
                    int threads, const std::function<void(double)>& progress) {
  const Experiment& experiment = run.experiment();
  const Camera& camera = experiment.camera;
  const RigidTransform body_from_lab = experiment.lab_from_body.inverse();
  SceneView view;
  view.width = camera.width;
  view.height = camera.height;
  view.oversampling = oversampling;
  const int columns = view.sample_columns(), rows = view.sample_rows();
  const auto across = static_cast<size_t>(columns), samples = across * static_cast<size_t>(rows);
  const auto sight = [&](size_t i) {
    const Vec3 direction =
        pinhole.direction(view, static_cast<int>(i % across), static_cast<int>(i / across));
    return Sight{body_from_lab.point(pinhole.position_m), body_from_lab.direction(direction)};
  };

  std::vector<std::pair<size_t, FluxMap>> maps;
  for (size_t i = 0; i < experiment.receivers.size(); ++i) {
    if (experiment.receivers[i].kind == "flux_map")
      maps.emplace_back(i, run.flux_map(i).flux_map(result.sums[i]));
  }
  for (const Instance& instance : experiment.scene.instances) {
    view.part_colour.push_back(reflectance_grey(experiment.scene.surfaces[instance.front_surface]));
  }
  view.depth_m.resize(samples);
  view.part.resize(samples);
  view.normal_lab.resize(samples);
  view.cos_view.resize(samples);
  view.irradiance_W_m2.resize(samples, std::numeric_limits<float>::quiet_NaN());
  constexpr size_t strip_rows = 64;
  for (size_t begin = 0; begin < samples; begin += strip_rows * across) {
    const size_t end = std::min(samples, begin + strip_rows * across);
    const auto points = look(
        run.scene(), end - begin, [&](size_t i) { return sight(begin + i); }, threads);
    for (size_t i = begin; i < end; ++i) {
      const VisiblePoint& point = points[i - begin];
      view.depth_m[i] = static_cast<float>(point.distance_m);
      view.part[i] = static_cast<int32_t>(point.instance);
      view.normal_lab[i] = experiment.lab_from_body.direction(point.normal).cast<float>();
      view.cos_view[i] = static_cast<float>(std::abs(point.normal.dot(sight(i).direction)));
      if (point.hit) view.irradiance_W_m2[i] = irradiance_at(run, maps, point);
    }
    if (progress) progress(static_cast<double>(end) / static_cast<double>(samples));
  }
  return view;
}

SceneLabels labels_of(const Experiment& experiment, const OpticalResult& light,
                      const Pinhole& camera) {
  SceneLabels labels;
  labels.title = experiment.file.path.stem().string() + ": irradiance";
  labels.caption =
      "tilt " + show(experiment.file.attitude.tilt_rad / degree_rad) + " deg, heading " +
      show(experiment.file.attitude.heading_rad / degree_rad) + " deg; " +
      show(light.power_balance.emitted_W) + " W emitted, " +
      show(100 * light.power_balance.absorbed_W.value / light.power_balance.emitted_W) +
      " % absorbed";
  std::array<Vec3, 3> axes;
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = experiment.lab_from_body.direction(Vec3::Unit(k));
    axes[static_cast<size_t>(k)] = {axis.dot(camera.right), axis.dot(camera.up),
                                    axis.dot(camera.back)};
  }
  labels.body_axes_camera = axes;
  return labels;
}

}  // namespace

RenderRun run_render(const RunOptions& options, const Console& console) {
  const auto run = std::make_shared<const OpticalRun>(options, console);
  const Experiment& experiment = run->experiment();
  OpticalResult light = run->run(experiment.lab_from_body, console.progress("tracing"));
  console.done();
  const bool with_lamps = experiment.camera.lamps;
  const auto lamps = with_lamps ? drawn_lamps(experiment) : std::vector<DrawnLamp>();
  const Pinhole camera = camera_of(experiment, lamps);
  SceneView view = make_view(*run, light, camera, options.threads, console.progress("drawing"));
  console.done();
  if (with_lamps) {
    draw_lamps(view, camera, lamps);
    draw_rays(view, camera,
              shown_rays(run->scene(), experiment.beams, experiment.lab_from_body,
                         experiment.scene.radius_m(), drawn_rays));
  }
  const SceneLabels labels = labels_of(experiment, light, camera);
  Provenance provenance = run->provenance();
  Picture picture = scene_picture(view, labels, provenance);
  return {run, std::move(light), std::move(picture), labels.title, std::move(provenance)};
}

std::filesystem::path write_render(const RenderRun& rendered, const std::filesystem::path& folder) {
  const auto path = folder / "render.png";
  StagedFiles staged(folder);
  write_scene_picture(staged.path() / path.filename(), rendered.picture, rendered.title,
                      rendered.provenance);
  staged.publish_as("render", rendered.provenance);
  return path;
}

}  // namespace photorque

namespace photorque::verbs::render {
namespace {

void run(const CommandOptions& options, const Program&) {
  const Console console = terminal(options);
  const RenderRun rendered = run_render(options, console);
  console.heading("Written to " + write_render(rendered, options.out_folder()).string());
}

}  // namespace

Verb kind() {
  return {"render",
          "A picture of the scene with the irradiance on its receivers",
          command_with(traced_options, run),
          {"scene", "material", "source", "receiver", "joint", "attitude", "trace", "camera"},
          "[scene] and [[source]]"};
}

}  // namespace photorque::verbs::render

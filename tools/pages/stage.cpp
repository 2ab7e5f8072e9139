#include "tools/pages/parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "core/constants.h"
#include "images/browser/content.h"
#include "raytrace/tracing/view.h"
#include "receivers/surface_grid.h"

namespace photorque {
namespace {

constexpr size_t most_lamps = 2000;

StagePart part_of(const Scene& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  StagePart part{instance.path, reflectance_grey(scene.surfaces[instance.front_surface]), {}, {}};
  for (const Vec3& vertex : mesh.vertices_m) {
    const Vec3 at = instance.body_from_mesh * vertex;
    for (int k = 0; k < 3; ++k) part.position_m.push_back(static_cast<float>(at[k]));
  }
  const bool mirrors = instance.body_from_mesh.linear().determinant() < 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    part.triangles.insert(part.triangles.end(), {a, mirrors ? c : b, mirrors ? b : c});
  }
  return part;
}

// Merges corners with equal position and texture coordinates into one vertex.
class VertexPool {
 public:
  explicit VertexPool(PaintedSurface& surface) : surface_(surface) {}
  void add(const Vec3& at_m, const Vec2& uv) {
    const std::array<float, 5> corner = {static_cast<float>(at_m.x()), static_cast<float>(at_m.y()),
                                         static_cast<float>(at_m.z()), static_cast<float>(uv.x()),
                                         static_cast<float>(uv.y())};
    std::string key(sizeof corner, '\0');
    std::memcpy(key.data(), corner.data(), sizeof corner);
    const auto [entry, is_new] =
        index_.try_emplace(std::move(key), static_cast<uint32_t>(index_.size()));
    if (is_new) {
      surface_.position_m.insert(surface_.position_m.end(), corner.begin(), corner.begin() + 3);
      surface_.uv.insert(surface_.uv.end(), corner.begin() + 3, corner.end());
    }
    surface_.triangles.push_back(entry->second);
  }

 private:
  PaintedSurface& surface_;
  std::unordered_map<std::string, uint32_t> index_;
};

PaintedSurface painted(const Scene& scene, const SurfaceGrid& grid, const std::string& name,
                       const std::string& map) {
  PaintedSurface surface;
  surface.name = name;
  surface.map = map;
  surface.side = grid.side == Side::front  ? PaintedSurface::Side::front
                 : grid.side == Side::back ? PaintedSurface::Side::back
                                           : PaintedSurface::Side::both;
  VertexPool pool(surface);
  for (const SurfaceFace& face : faces_of(scene, grid.instances, grid.facing_body)) {
    const auto corners = corners_in_bins(grid, scene, face);
    const Vec3 normal = (face.corner_body_m[1] - face.corner_body_m[0])
                            .cross(face.corner_body_m[2] - face.corner_body_m[0]);
    // In a mirrored instance, the order of the corners is reversed.
    const bool turned = normal.dot(face.area_body_m2) < 0.0;
    for (const size_t k : {size_t{0}, size_t{turned ? 2u : 1u}, size_t{turned ? 1u : 2u}}) {
      pool.add(face.corner_body_m[k], {corners[k].x() / grid.width, corners[k].y() / grid.height});
    }
  }
  return surface;
}

std::vector<Painting> paintings_of(const Experiment& experiment, StageMaps maps) {
  const bool own = maps == StageMaps::own;
  Painting irradiance{"Irradiance", "W/m²", false, {}};
  std::array<Painting, 3> torques;
  for (size_t axis = 0; axis < 3; ++axis) {
    torques[axis] = {std::string("Torque about ") + "xyz"[axis] + " per bin", "N m", true, {}};
  }
  for (const NamedReceiver& receiver : experiment.receivers) {
    if (receiver.flux_map) {
      irradiance.surfaces.push_back(painted(experiment.scene, receiver.flux_map->grid(),
                                            receiver.name,
                                            own ? "" : "irradiance_" + receiver.name));
    }
    if (!receiver.torque_map || own) continue;
    for (size_t axis = 0; axis < 3; ++axis) {
      torques[axis].surfaces.push_back(
          painted(experiment.scene, receiver.torque_map->grid(), receiver.name,
                  std::string("torque_") + "xyz"[axis] + "_" + receiver.name));
    }
  }
  std::vector<Painting> all;
  if (!irradiance.surfaces.empty()) all.push_back(std::move(irradiance));
  for (Painting& torque : torques) {
    if (!torque.surfaces.empty()) all.push_back(std::move(torque));
  }
  return all;
}

std::vector<StageLamp> lamps_of(const std::vector<Beam>& beams, double radius_m) {
  std::vector<StageLamp> lamps;
  const size_t stride = (beams.size() + most_lamps - 1) / most_lamps;
  for (size_t i = 0; i < beams.size(); i += stride) {
    const Beam& beam = beams[i];
    lamps.push_back(
        {beam.name, beam.lab_from_emitter.translation_m,
         beam.lab_from_emitter.direction(Vec3::UnitZ()),
         beam.aperture && std::isfinite(beam.aperture->radius_m) ? beam.aperture->radius_m : 0.0,
         is_too_far_to_draw(beam, radius_m)});
  }
  return lamps;
}

}  // namespace

Rgb reflectance_grey(const OpticalSurface& surface) {
  const float reflectance = static_cast<float>(surface.specular[0] + surface.diffuse[0]);
  const float grey = 0.30f + 0.60f * std::sqrt(reflectance);
  return {grey, grey, grey};
}

SceneStage stage_of(const OpticalRun& run, StageMaps maps) {
  const Experiment& experiment = run.experiment();
  SceneStage stage;
  stage.radius_m = experiment.scene.radius_m();
  for (const Instance& instance : experiment.scene.instances) {
    stage.parts.push_back(part_of(experiment.scene, instance));
  }
  stage.paintings = paintings_of(experiment, maps);
  stage.lamps = lamps_of(experiment.beams, stage.radius_m);
  stage.camera = {experiment.camera.position_m, experiment.camera.target_m,
                  experiment.camera.field_of_view_rad / degree_rad};
  stage.arrows = {{"force of light", "N", StageArrow::Kind::force},
                  {"torque of light", "N m", StageArrow::Kind::torque}};
  return stage;
}

StageState lit_state(const OpticalRun& run, const RigidTransform& lab_from_body,
                     const OpticalResult& result) {
  const WrenchEstimate wrench =
      wrench_about(run.wrench().total(result.sums[run.wrench_index()]), Vec3::Zero());
  StageState state;
  state.lab_from_body = {lab_from_body.rotation};
  state.arrow_body = {wrench.mean.force_N, wrench.mean.torque_N_m};
  state.arrow_error_body = {wrench.force_error_N(), wrench.torque_error_N_m()};
  return state;
}

void light_along(SceneStage& stage, const OpticalRun& run, const std::vector<Quat>& lab_from_body) {
  constexpr size_t most_lights = 12;
  constexpr uint64_t rays = 1u << 18;  // direct light on flat maps is gathered without noise
  const size_t states = lab_from_body.size(), lights = std::min(most_lights, states);
  for (size_t i = 0; i < lights; ++i) {
    const RigidTransform at{lab_from_body[(2 * i + 1) * states / (2 * lights)], Vec3::Zero()};
    add_light(stage, run, at, run.run(at, {}, rays), lights);
  }
  for (size_t i = 0; i < states; ++i) {
    stage.light_of_state.push_back(std::min(i * lights / states, lights - 1));
  }
  add_sentence(stage.remark,
               "Irradiance and rays are traced at " + std::to_string(lights) +
                   " instants of the run, with all lamps at full power; shown are those of the "
                   "nearest instant.");
}

void add_light(SceneStage& stage, const OpticalRun& run, const RigidTransform& lab_from_body,
               const OpticalResult& result, size_t lights) {
  // Enough rays to show the beams without hiding the body. The rays of many lights together take
  // about half a megabyte.
  constexpr size_t most_rays = 400, most_rays_together = 24'000;
  constexpr size_t most_bins_together = 1u << 20;
  stage.rays_of_light_lab_m.push_back(shown_rays(run.scene(), run.experiment().beams, lab_from_body,
                                                 stage.radius_m,
                                                 std::min(most_rays, most_rays_together / lights)));
  size_t surface = 0;
  const auto& receivers = run.experiment().receivers;
  for (size_t i = 0; i < receivers.size(); ++i) {
    if (!receivers[i].flux_map) continue;
    PaintedSurface& painted = stage.paintings.front().surfaces[surface++];
    if (!painted.map.empty()) continue;
    const FluxMap map = receivers[i].flux_map->flux_map(result.sums[i]);
    const Map picture =
        grid_map(map.grid, map.incident.per_bin_W_m2, receivers[i].name, receivers[i].name, "W/m²");
    int factor = 1;
    while (picture.value.size() * lights >
           most_bins_together * static_cast<size_t>(factor) * static_cast<size_t>(factor)) {
      factor *= 2;
    }
    painted.map_of_light.push_back(factor > 1 ? reduced(picture, factor) : picture);
  }
}

}  // namespace photorque

#include "scenes/effects/parts.h"

#include <algorithm>

#include "core/errors.h"
#include "photovoltaics/array/keys.h"
#include "receivers/flux_map.h"
#include "receivers/kind.h"

namespace photorque {
namespace {

void find_receiver(const Experiment& experiment, LightParts& parts) {
  const auto arrays = experiment.file.others("array");
  const std::string wanted = arrays.size() == 1 ? arrays[0].text_or("receiver", "") : "";
  for (const NamedReceiver& named : experiment.receivers) {
    if (!named.flux_map || (!wanted.empty() && named.name != receiver_name(wanted))) continue;
    parts.grid = &named.flux_map->grid();
    parts.receiver = named.name;
    break;
  }
  if (parts.grid == nullptr || parts.grid->over != SurfaceGrid::Over::plane) {
    throw InputError(
        {experiment.file.path.string()}, "receiver", "no flat flux map",
        "a [[receiver]] of kind \"flux_map\" over a plane, on which light is measured");
  }
  const std::vector<SurfaceFace> faces =
      faces_of(experiment.scene, parts.grid->instances, parts.grid->facing_body);
  parts.plane_m = faces.front().corner_body_m[0].dot(parts.grid->normal_body);
}

std::vector<LightWall> walls_of(const Scene& scene, const SurfaceGrid& grid, double plane_m) {
  std::vector<LightWall> walls;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (std::ranges::find(grid.instances, i) != grid.instances.end()) continue;
    LightWall wall;
    wall.node = scene.instances[i].node;
    const uint32_t one[] = {i};
    for (const SurfaceFace& face : faces_of(scene, one)) {
      // Parts behind the receiver neither shade nor light it.
      const bool above = std::ranges::any_of(face.corner_body_m, [&](const Vec3& p) {
        return p.dot(grid.normal_body) > plane_m + 1e-6;
      });
      if (above) wall.triangles.push_back(face.corner_body_m);
    }
    if (wall.triangles.empty()) continue;
    for (const auto& t : wall.triangles) {
      wall.centre_m += (t[0] + t[1] + t[2]) / (3.0 * static_cast<double>(wall.triangles.size()));
    }
    for (const auto& t : wall.triangles) {
      for (const Vec3& p : t) wall.radius_m = std::max(wall.radius_m, (p - wall.centre_m).norm());
    }
    wall.is_sheet = is_sheet(wall.triangles);
    walls.push_back(std::move(wall));
  }
  return walls;
}

}  // namespace

bool is_sheet(const std::vector<std::array<Vec3, 3>>& triangles) {
  constexpr size_t most = 64;
  constexpr double flat = 1e-6;  // of the triangles' size, and of their directions
  if (triangles.empty() || triangles.size() > most) return false;
  const auto area = [](const std::array<Vec3, 3>& t) {
    return Vec3((t[1] - t[0]).cross(t[2] - t[0]));
  };
  const Vec3 first = triangles.front()[0];
  const Vec3 normal = area(triangles.front()).normalized();
  double size_m = 0.0;
  for (const auto& t : triangles) {
    for (const Vec3& p : t) size_m = std::max(size_m, (p - first).norm());
  }
  for (const auto& t : triangles) {
    if (!(normal.dot(area(t)) > (1.0 - flat) * area(t).norm())) return false;
    for (const Vec3& p : t) {
      if (std::abs(normal.dot(p - first)) > flat * size_m) return false;
    }
    // Test whether the centre of a triangle is inside another one.
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    const auto holds_middle = [&](const std::array<Vec3, 3>& other) {
      if (&other == &t) return false;
      for (size_t k = 0; k < 3; ++k) {
        const Vec3 edge = other[(k + 1) % 3] - other[k];
        if (normal.dot(edge.cross(middle - other[k])) <= 0.0) return false;
      }
      return true;
    };
    if (std::ranges::any_of(triangles, holds_middle)) return false;
  }
  return true;
}

size_t LightParts::bypasses() const {
  size_t count = 0;
  if (!design) return count;
  for (const ArrayWiring::String& s : design->wiring.strings) count += s.substrings.size();
  return count;
}

size_t LightParts::count_of(LightEffectKind::Index index) const {
  switch (index) {
    case LightEffectKind::Index::none:
      return 1;
    case LightEffectKind::Index::lamp:
      return lamps;
    case LightEffectKind::Index::cell:
      return cells();
    case LightEffectKind::Index::string:
      return strings();
    case LightEffectKind::Index::bypass:
      return bypasses();
    case LightEffectKind::Index::wall:
      return walls.size();
    case LightEffectKind::Index::frame:
      return 2;
  }
  return 0;
}

LightParts light_parts(const Experiment& experiment) {
  LightParts parts;
  find_receiver(experiment, parts);
  parts.walls = walls_of(experiment.scene, *parts.grid, parts.plane_m);
  parts.lamps = experiment.beams.size();
  const auto arrays = experiment.file.others("array");
  if (arrays.size() == 1) {
    if (arrays[0].has(array_key::back)) {
      throw arrays[0].error(array_key::back, "bifacial cells",
                            "no back: the effects of light support the front only");
    }
    parts.design =
        read_array_design(arrays[0], read_cell_places(arrays[0], experiment.scene, *parts.grid));
  }
  return parts;
}

}  // namespace photorque

// Light by way of a wall, once.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "diagnosis/light/model/illumination.h"

namespace photorque {
namespace {

// A small piece of a wall, its normal on the side of the receiver.
struct WallPatch {
  Vec3 centre_m, normal;
  double area_m2;
};

void cut_triangle(const std::array<Vec3, 3>& t, double largest_m2, std::vector<WallPatch>& into,
                  const Vec3& towards) {
  const Vec3 area = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]);
  const double size = area.norm();
  if (size > largest_m2) {
    const Vec3 a = 0.5 * (t[0] + t[1]), b = 0.5 * (t[1] + t[2]), c = 0.5 * (t[2] + t[0]);
    for (const auto& part : {std::array{t[0], a, c}, std::array{a, t[1], b}, std::array{c, b, t[2]},
                             std::array{a, b, c}}) {
      cut_triangle(part, largest_m2, into, towards);
    }
    return;
  }
  if (!(size > 0.0)) return;
  const Vec3 centre = (t[0] + t[1] + t[2]) / 3.0;
  Vec3 normal = area / size;
  if (normal.dot(towards - centre) < 0.0) normal = -normal;
  into.push_back({centre, normal, size});
}

std::vector<WallPatch> patches_of(const LightLab& lab, const LightWall& wall) {
  constexpr double parts = 1500.0;
  const SurfaceGrid& g = lab.grid();
  const Vec3 middle = lab.point_body_m(0.5 * (g.u_low + g.u_high), 0.5 * (g.v_low + g.v_high)) +
                      1e-3 * lab.normal_body();
  double area = 0.0;
  for (const auto& t : wall.triangles) area += 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
  std::vector<WallPatch> patches;
  for (const auto& t : wall.triangles) cut_triangle(t, area / parts, patches, middle);
  return patches;
}

// π times the share of what a patch throws back diffusely that meets a unit area at a point.
double exchange(const WallPatch& patch, const Vec3& point, const Vec3& normal) {
  const Vec3 to = point - patch.centre_m;
  const double r2 = to.squaredNorm();
  const double leaves = patch.normal.dot(to), arrives = -normal.dot(to);
  if (leaves <= 0.0 || arrives <= 0.0) return 0.0;
  return leaves * arrives / (r2 * r2) * patch.area_m2;
}

// Of every group of places, by patch: the light on it over that which leaves the patch.
using Shares = std::vector<std::vector<float>>;

Shares shares_of(const LightLab& lab, const LightSites& sites,
                 const std::vector<WallPatch>& patches) {
  Shares share(sites.groups.size());
  std::vector<double> sum(patches.size());
  for (size_t g = 0; g < sites.groups.size(); ++g) {
    std::ranges::fill(sum, 0.0);
    const LightSites::Group& group = sites.groups[g];
    for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
      for (size_t k = 0; k < patches.size(); ++k) {
        sum[k] +=
            sites.weights[i] / pi * exchange(patches[k], sites.points_body_m[i], lab.normal_body());
      }
    }
    share[g].assign(sum.begin(), sum.end());
  }
  return share;
}

LampField diffuse_field(const LightSites& sites, Illumination& lamp,
                        const std::vector<WallPatch>& patches, const Shares& share, size_t index) {
  LampField field(sites.outputs.size(), 0.0);
  std::vector<float> on_patch(patches.size());
  size_t attitude = no_wall;
  for (size_t o = 0; o < sites.outputs.size(); ++o) {
    if (sites.outputs[o].attitude != attitude) {
      attitude = sites.outputs[o].attitude;
      lamp.move_to(attitude);
      for (size_t k = 0; k < patches.size(); ++k) {
        on_patch[k] = static_cast<float>(lamp.on(patches[k].centre_m, patches[k].normal, index));
      }
    }
    const std::vector<float>& to = share[sites.outputs[o].group];
    double sum = 0.0;
    for (size_t k = 0; k < patches.size(); ++k) sum += to[k] * on_patch[k];
    field[o] = sum;
  }
  return field;
}

// A mirror shows a point what the point's own mirror image would see through the wall.
LampField specular_field(const LightLab& lab, Illumination& lamp, const LightWall& wall,
                         size_t index) {
  static const std::vector<Vec2> disc = even_disc(64);
  return lamp.over_places([&](const Vec3& point) {
    double sum = 0.0;
    for (const auto& triangle : wall.triangles) {
      const Vec3 m = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
      const double height = m.dot(point - triangle[0]);
      const double lamp_height = m.dot(lamp.lamp_body_m() - triangle[0]);
      if (height * lamp_height <= 0.0) continue;
      const Vec3 image = point - 2.0 * height * m;
      const Vec3 normal = lab.normal_body() - 2.0 * m.dot(lab.normal_body()) * m;
      const LampAtAttitude& at = lamp.lamp();
      double through = 0.0;
      for (const Vec2& d : disc) {
        const Vec3 to = lamp.lamp_body_m() + d.x() * at.side + d.y() * at.up;
        if (crosses(triangle, image, to)) through += 1.0 / static_cast<double>(disc.size());
      }
      if (through > 0.0) sum += through * lamp.on(image, normal, index);
    }
    return sum;
  });
}

}  // namespace

std::vector<LampField> wall_fields(const LightLab& lab, const LampSet& lamps,
                                   const LightSites& sites,
                                   const std::vector<LampGeometry>& geometries, size_t wall,
                                   bool specular) {
  const LightWall& w = lab.walls()[wall];
  std::vector<WallPatch> patches;
  Shares share;
  if (!specular) {
    patches = patches_of(lab, w);
    share = shares_of(lab, sites, patches);
  }
  std::vector<LampField> fields;
  for (const LampGeometry& geometry : geometries) {
    Illumination lamp(lab, lamps, sites, geometry);
    fields.push_back(specular ? specular_field(lab, lamp, w, wall)
                              : diffuse_field(sites, lamp, patches, share, wall));
  }
  return fields;
}

}  // namespace photorque

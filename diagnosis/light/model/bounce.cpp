// Light after one reflection at a wall.
#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "diagnosis/light/model/illumination.h"

namespace photorque {
namespace {

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
  into.push_back({t, centre, normal, size});
}

std::vector<WallPatch> patches_of(const LightLab& lab, const LightWall& wall) {
  constexpr double parts = 1500.0;
  const Vec3 middle = lab.middle_body_m() + 1e-3 * lab.normal_body();
  double area = 0.0;
  for (const auto& t : wall.triangles) area += 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
  std::vector<WallPatch> patches;
  for (const auto& t : wall.triangles) cut_triangle(t, area / parts, patches, middle);
  return patches;
}

// Form factor of a triangle at a point: irradiance per unit of diffuse light that leaves a unit
// area. Lambert's sum over the edges of the part above the point's horizon (M. Cohen, J. Wallace,
// Radiosity and Realistic Image Synthesis, 1993, eq. 4.13).
double triangle_form_factor(const std::array<Vec3, 3>& triangle, const Vec3& point,
                            const Vec3& normal) {
  std::array<Vec3, 4> corner;
  size_t corners = 0;
  for (size_t i = 0; i < 3; ++i) {
    const Vec3 a = triangle[i] - point, b = triangle[(i + 1) % 3] - point;
    const double up_a = normal.dot(a), up_b = normal.dot(b);
    if (up_a >= 0.0) corner[corners++] = a;
    if ((up_a > 0.0 && up_b < 0.0) || (up_a < 0.0 && up_b > 0.0)) {
      corner[corners++] = a + up_a / (up_a - up_b) * (b - a);
    }
  }
  double sum = 0.0;
  for (size_t i = 0; i < corners; ++i) {
    const Vec3 &a = corner[i], &b = corner[(i + 1) % corners], across = a.cross(b);
    const double size = across.norm();
    if (size > 0.0) sum += std::atan2(size, a.dot(b)) * normal.dot(across) / size;
  }
  return std::abs(sum) / (2.0 * pi);
}

// Form factor of a patch; a distant patch is treated as a point source at its centre.
double patch_form_factor(const WallPatch& patch, const Vec3& point, const Vec3& normal) {
  constexpr double far2 = 64.0;  // (distance/size)²; error of some tenths of a per cent
  const Vec3 to = point - patch.centre_m;
  const double r2 = to.squaredNorm();
  const double leaves = patch.normal.dot(to), arrives = -normal.dot(to);
  if (leaves <= 0.0) return 0.0;
  if (r2 < far2 * patch.area_m2) return triangle_form_factor(patch.corners_m, point, normal);
  return arrives > 0.0 ? leaves * arrives / (r2 * r2) * patch.area_m2 / pi : 0.0;
}

// Fields of all lamps at once. Outputs of one attitude are contiguous, and so are their groups.
std::vector<LampField> diffuse_fields(const LightSites& sites, std::vector<Illumination>& lamps,
                                      const WallExchange& wall, size_t index) {
  const auto patches = static_cast<Eigen::Index>(wall.patches.size());
  Eigen::MatrixXf on_patch(patches, static_cast<Eigen::Index>(lamps.size()));
  std::vector<LampField> fields(lamps.size(), LampField(sites.outputs.size(), 0.0));
  for (size_t first = 0, last = 0; first < sites.outputs.size(); first = last) {
    const LightSites::Output& from = sites.outputs[first];
    while (last < sites.outputs.size() && sites.outputs[last].attitude == from.attitude &&
           sites.outputs[last].group == from.group + (last - first)) {
      ++last;
    }
    for (size_t l = 0; l < lamps.size(); ++l) {
      lamps[l].move_to(from.attitude);
      for (Eigen::Index k = 0; k < patches; ++k) {
        const WallPatch& patch = wall.patches[static_cast<size_t>(k)];
        on_patch(k, static_cast<Eigen::Index>(l)) =
            static_cast<float>(lamps[l].on(patch.centre_m, patch.normal, index));
      }
    }
    const Eigen::MatrixXf light = wall.shares.middleRows(static_cast<Eigen::Index>(from.group),
                                                         static_cast<Eigen::Index>(last - first)) *
                                  on_patch;
    for (size_t l = 0; l < lamps.size(); ++l) {
      const auto of_lamp = light.col(static_cast<Eigen::Index>(l));
      std::ranges::copy(of_lamp, fields[l].begin() + static_cast<std::ptrdiff_t>(first));
    }
  }
  return fields;
}

// A mirror reflects to a point the light that would otherwise arrive, through the wall, at the
// point's mirror image.
LampField specular_field(const LightLab& lab, Illumination& lamp, const LightWall& wall,
                         size_t index) {
  static const std::vector<Vec2> disc = even_disc(64);
  const auto mirrored = [&](const Vec3& point) {
    double sum = 0.0;
    for (const auto& triangle : wall.triangles) {
      const Vec3 m = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
      const double height = m.dot(point - triangle[0]);
      const double lamp_height = m.dot(lamp.lamp_body_m() - triangle[0]);
      if (height * lamp_height <= 0.0) continue;
      const Vec3 image = point - 2.0 * height * m;
      const Vec3 normal = lab.normal_body() - 2.0 * m.dot(lab.normal_body()) * m;
      double through = 0.0;
      for (const Vec2& d : disc) {
        const Vec3 to = lamp.lamp_body_m() + d.x() * lamp.side_m() + d.y() * lamp.up_m();
        if (crosses(triangle, image, to)) through += 1.0 / static_cast<double>(disc.size());
      }
      if (through > 0.0) sum += through * lamp.on(image, normal, index);
    }
    return sum;
  };
  return lamp.over_places(mirrored, [](size_t) -> const double* { return nullptr; });
}

}  // namespace

WallExchange exchange_with(const LightLab& lab, const LightSites& sites, size_t wall) {
  WallExchange result{patches_of(lab, lab.walls()[wall]), {}};
  const std::vector<WallPatch>& patches = result.patches;
  result.shares.resize(static_cast<Eigen::Index>(sites.groups.size()),
                       static_cast<Eigen::Index>(patches.size()));
  std::vector<double> sum(patches.size());
  for (size_t g = 0; g < sites.groups.size(); ++g) {
    std::ranges::fill(sum, 0.0);
    const LightSites::Group& group = sites.groups[g];
    for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
      for (size_t k = 0; k < patches.size(); ++k) {
        sum[k] += sites.weights[i] *
                  patch_form_factor(patches[k], sites.points_body_m[i], lab.normal_body());
      }
    }
    const Eigen::Map<const Eigen::RowVectorXd> row(sum.data(), result.shares.cols());
    result.shares.row(static_cast<Eigen::Index>(g)) = row.cast<float>();
  }
  return result;
}

std::vector<LampField> wall_fields(const LightLab& lab, const LampSet& lamps,
                                   const LightSites& sites,
                                   const std::vector<LampGeometry>& geometries, size_t wall,
                                   const WallExchange* diffuse) {
  std::vector<Illumination> lit;
  for (const LampGeometry& geometry : geometries) lit.emplace_back(lab, lamps, sites, geometry);
  if (diffuse != nullptr) return diffuse_fields(sites, lit, *diffuse, wall);
  std::vector<LampField> fields;
  for (Illumination& lamp : lit) {
    fields.push_back(specular_field(lab, lamp, lab.walls()[wall], wall));
  }
  return fields;
}

}  // namespace photorque

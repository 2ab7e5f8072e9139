#include "diagnosis/light/model/field.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "photovoltaics/cell/front.h"

namespace photorque {
namespace {

// Points that cover a disc of radius 1 evenly, in a spiral of golden angles.
// Source: H. Vogel, Mathematical Biosciences 44, 179 (1979).
std::vector<Vec2> even_disc(size_t count) {
  const double golden = pi * (3.0 - std::sqrt(5.0));
  std::vector<Vec2> points;
  for (size_t i = 0; i < count; ++i) {
    const double r = std::sqrt((static_cast<double>(i) + 0.5) / static_cast<double>(count));
    points.emplace_back(r * std::cos(golden * static_cast<double>(i)),
                        r * std::sin(golden * static_cast<double>(i)));
  }
  return points;
}

bool crosses(const std::array<Vec3, 3>& t, const Vec3& from, const Vec3& to) {
  const Vec3 d = to - from, a = t[1] - t[0], b = t[2] - t[0], n = d.cross(b);
  const double det = a.dot(n);
  if (std::abs(det) < 1e-18) return false;
  const Vec3 s = from - t[0];
  const double u = s.dot(n) / det;
  if (u < 0.0 || u > 1.0) return false;
  const Vec3 q = s.cross(a);
  const double v = d.dot(q) / det, along = b.dot(q) / det;
  constexpr double touch = 1e-9;  // what it starts or ends on does not hide it
  return v >= 0.0 && u + v <= 1.0 && along > touch && along < 1.0 - touch;
}

bool crosses(const ShadowBox& box, const Vec3& from, const Vec3& to) {
  double enter = 0.0, leave = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double d = to[k] - from[k];
    if (std::abs(d) < 1e-15) {
      if (from[k] < box.low_m[k] || from[k] > box.high_m[k]) return false;
      continue;
    }
    const double a = (box.low_m[k] - from[k]) / d, b = (box.high_m[k] - from[k]) / d;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter < leave;
}

// Of a sphere, from the straight line between two points.
bool may_reach(const Vec3& centre, double radius, const Vec3& from, const Vec3& to) {
  const Vec3 d = to - from;
  const double t = std::clamp((centre - from).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (from + t * d - centre).squaredNorm() < radius * radius;
}

// What stands between the lamps and the receiver at one attitude, in body axes.
class Obstacles {
 public:
  Obstacles(const LightLab& lab, const std::vector<ShadowBox>& boxes, const Quat& lab_from_body)
      : lab_(lab), boxes_(boxes), lab_from_body_(lab_from_body) {}

  bool any() const { return !boxes_.empty() || !lab_.walls().empty(); }

  // The share of a lamp's aperture that a point sees. Body frame; `side` and `up` span the disc
  // and have its radius. `skipped`: a wall that does not count, none where it is past the last.
  double visible(const Vec3& point, const Vec3& lamp, const Vec3& side, const Vec3& up,
                 size_t skipped) const {
    const double radius = side.norm();
    near_walls_.clear();
    near_boxes_.clear();
    for (size_t w = 0; w < lab_.walls().size(); ++w) {
      const LightWall& wall = lab_.walls()[w];
      if (w != skipped && may_reach(wall.centre_m, wall.radius_m + radius, point, lamp)) {
        near_walls_.push_back(w);
      }
    }
    for (size_t b = 0; b < boxes_.size(); ++b) {
      const ShadowBox& box = boxes_[b];
      Vec3 centre = 0.5 * (box.low_m + box.high_m);
      if (!box.on_body) centre = lab_from_body_.conjugate() * centre;
      const double size = 0.5 * (box.high_m - box.low_m).norm();
      if (may_reach(centre, size + radius, point, lamp)) near_boxes_.push_back(b);
    }
    if (near_walls_.empty() && near_boxes_.empty()) return 1.0;
    static const std::vector<Vec2> disc = even_disc(100);
    double sum = 0.0;
    const Vec3 point_lab = lab_from_body_ * point;
    for (const Vec2& d : disc) {
      const Vec3 to = lamp + d.x() * side + d.y() * up;
      double passes = 1.0;
      for (const size_t w : near_walls_) {
        const auto& triangles = lab_.walls()[w].triangles;
        if (std::ranges::any_of(triangles, [&](const auto& t) { return crosses(t, point, to); })) {
          passes = 0.0;
          break;
        }
      }
      for (const size_t b : near_boxes_) {
        const ShadowBox& box = boxes_[b];
        const bool hit =
            box.on_body ? crosses(box, point, to) : crosses(box, point_lab, lab_from_body_ * to);
        if (hit) passes *= 1.0 - box.opacity;
      }
      sum += passes;
    }
    return sum / static_cast<double>(disc.size());
  }

 private:
  const LightLab& lab_;
  const std::vector<ShadowBox>& boxes_;
  Quat lab_from_body_;
  mutable std::vector<size_t> near_walls_, near_boxes_;
};

Quat turned(const Quat& recorded, const Vec2& bias_rad) {
  const double angle = bias_rad.norm();
  if (angle == 0.0) return recorded;
  const Vec3 axis(bias_rad.x() / angle, bias_rad.y() / angle, 0.0);
  return Quat(Eigen::AngleAxisd(angle, axis)) * recorded;
}

// A lamp at one attitude, in body axes.
struct LampAtAttitude {
  RigidTransform body_from_lamp;
  Mat3 lamp_from_body;
  Vec3 offset_m;
  Vec3 side, up;  // the disc's radii

  LampAtAttitude(const RigidTransform& lab_from_lamp, const Quat& lab_from_body, double radius_m)
      : body_from_lamp{(lab_from_body.conjugate() * lab_from_lamp.rotation).normalized(),
                       lab_from_body.conjugate() * lab_from_lamp.translation_m} {
    const Mat3 rotation = body_from_lamp.rotation.toRotationMatrix();
    lamp_from_body = rotation.transpose();
    offset_m = -(lamp_from_body * body_from_lamp.translation_m);
    side = radius_m * rotation.col(0);
    up = radius_m * rotation.col(1);
  }
};

// Irradiance of a lamp on points, attitude by attitude.
class Illumination {
 public:
  Illumination(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
               const LampGeometry& geometry)
      : lab_(lab),
        sites_(sites),
        geometry_(geometry),
        light_(*lamps.lights[geometry.lamp]),
        pose_(pose_of(lamps.beams[geometry.lamp], geometry)) {}

  void move_to(size_t attitude) {
    const Quat q = turned(sites_.lab_from_body[attitude], geometry_.attitude_bias_rad);
    at_.emplace(pose_, q, std::isfinite(light_.radius_m()) ? light_.radius_m() : 0.0);
    obstacles_.emplace(lab_, geometry_.boxes, q);
  }

  double on(const Vec3& point, const Vec3& normal, size_t skipped) const {
    const Vec3 p = at_->lamp_from_body * point + at_->offset_m, n = at_->lamp_from_body * normal;
    const double E = light_.irradiance_W_m2(p, n);
    if (!(E > 0.0)) return 0.0;
    if (!obstacles_->any()) return E;
    return E * obstacles_->visible(point, at_->body_from_lamp.translation_m, at_->side, at_->up,
                                   skipped);
  }
  const Vec3& lamp_body_m() const { return at_->body_from_lamp.translation_m; }
  const LampAtAttitude& lamp() const { return *at_; }

 private:
  const LightLab& lab_;
  const LightSites& sites_;
  const LampGeometry& geometry_;
  const DiscLight& light_;
  RigidTransform pose_;
  std::optional<LampAtAttitude> at_;
  std::optional<Obstacles> obstacles_;
};

constexpr size_t no_wall = static_cast<size_t>(-1);

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

LampField diffuse_field(const LightLab& lab, const LightSites& sites, Illumination& lamp,
                        const LightWall& wall, size_t index) {
  const std::vector<WallPatch> patches = patches_of(lab, wall);
  std::vector<std::vector<double>> share(sites.groups.size());
  for (size_t g = 0; g < sites.groups.size(); ++g) {
    share[g].assign(patches.size(), 0.0);
    const LightSites::Group& group = sites.groups[g];
    for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
      for (size_t k = 0; k < patches.size(); ++k) {
        share[g][k] +=
            sites.weights[i] / pi * exchange(patches[k], sites.points_body_m[i], lab.normal_body());
      }
    }
  }
  LampField field(sites.outputs.size(), 0.0);
  std::vector<double> on_patch(patches.size());
  size_t attitude = no_wall;
  for (size_t o = 0; o < sites.outputs.size(); ++o) {
    if (sites.outputs[o].attitude != attitude) {
      attitude = sites.outputs[o].attitude;
      lamp.move_to(attitude);
      for (size_t k = 0; k < patches.size(); ++k) {
        on_patch[k] = lamp.on(patches[k].centre_m, patches[k].normal, index);
      }
    }
    const std::vector<double>& to = share[sites.outputs[o].group];
    for (size_t k = 0; k < patches.size(); ++k) field[o] += to[k] * on_patch[k];
  }
  return field;
}

// A mirror shows a point what the point's own mirror image would see through the wall.
LampField specular_field(const LightLab& lab, const LightSites& sites, Illumination& lamp,
                         const LightWall& wall, size_t index) {
  static const std::vector<Vec2> disc = even_disc(64);
  LampField field(sites.outputs.size(), 0.0);
  size_t attitude = no_wall;
  for (size_t o = 0; o < sites.outputs.size(); ++o) {
    if (sites.outputs[o].attitude != attitude) {
      attitude = sites.outputs[o].attitude;
      lamp.move_to(attitude);
    }
    const LightSites::Group& group = sites.groups[sites.outputs[o].group];
    for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
      const Vec3& point = sites.points_body_m[i];
      for (size_t t = 0; t < wall.triangles.size(); ++t) {
        const auto& triangle = wall.triangles[t];
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
        if (through > 0.0) {
          field[o] += sites.weights[i] * through * lamp.on(image, normal, index);
        }
      }
    }
  }
  return field;
}

}  // namespace

LampGeometry geometry_of(const LightState& state, size_t lamp, bool enters_cells) {
  return {lamp,
          state.lamp_aim[lamp],
          state.divergence,
          state.shift_m,
          state.attitude_bias_rad,
          state.boxes,
          enters_cells ? state.glass_index : std::nullopt};
}

RigidTransform pose_of(const Beam& beam, const LampGeometry& geometry) {
  RigidTransform pose = beam.lab_from_emitter;
  pose.translation_m += geometry.shift_m;
  if (geometry.aim.isZero(0.0)) return pose;
  const Vec3 d = pose.direction(Vec3::UnitZ());
  const auto across = [&](const Vec3& axis) {
    const Vec3 e = axis - axis.dot(d) * d;
    return e.norm() > 1e-9 ? Vec3(e.normalized()) : Vec3(Vec3::Zero());
  };
  const Vec3 turned_to =
      d + geometry.aim.x() * across(Vec3::UnitX()) + geometry.aim.y() * across(Vec3::UnitY());
  pose.rotation = (Quat::FromTwoVectors(d, turned_to) * pose.rotation).normalized();
  return pose;
}

LampField lamp_field(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                     const LampGeometry& geometry) {
  Illumination lamp(lab, lamps, sites, geometry);
  std::optional<CellFront> front;
  if (sites.enters_cells) {
    if (lab.has_array()) front = lab.design().front;
    if (geometry.glass_index) {
      front.emplace();
      front->index = *geometry.glass_index;
    }
  }
  const double wavelength_m = lamps.beams[geometry.lamp].spectrum.centre_m;
  LampField field(sites.outputs.size(), 0.0);
  size_t attitude = no_wall;
  for (size_t o = 0; o < sites.outputs.size(); ++o) {
    if (sites.outputs[o].attitude != attitude) {
      attitude = sites.outputs[o].attitude;
      lamp.move_to(attitude);
    }
    const LightSites::Group& group = sites.groups[sites.outputs[o].group];
    for (size_t i = group.first_point; i < group.first_point + group.count; ++i) {
      const Vec3& point = sites.points_body_m[i];
      double E = lamp.on(point, lab.normal_body(), no_wall);
      if (front && E > 0.0) {
        const Vec3 to = (lamp.lamp_body_m() - point).normalized();
        E *= front->modifier(std::clamp(to.dot(lab.normal_body()), 0.0, 1.0), wavelength_m);
      }
      field[o] += sites.weights[i] * E;
    }
  }
  return field;
}

LampField wall_field(const LightLab& lab, const LampSet& lamps, const LightSites& sites,
                     const LampGeometry& geometry, size_t wall, bool specular) {
  Illumination lamp(lab, lamps, sites, geometry);
  const LightWall& w = lab.walls()[wall];
  return specular ? specular_field(lab, sites, lamp, w, wall)
                  : diffuse_field(lab, sites, lamp, w, wall);
}

}  // namespace photorque

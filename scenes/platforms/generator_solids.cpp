#include "scenes/platforms/generator_solids.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"

namespace photorque {
namespace {

// Over the radius of a circle, that of the corners of the regular polygon of the same area.
double equal_area_factor(int segments) {
  const double angle = 2.0 * pi / segments;
  return std::sqrt(angle / std::sin(angle));
}

// ∫ π (R² − z²) dz: a ball between two planes.
double ball_volume(double radius, double low, double high) {
  const auto below = [radius](double z) { return pi * z * (radius * radius - z * z / 3.0); };
  return below(high) - below(low);
}

// The volume that a polyline (r, z) sweeps about z, as a sum of frusta.
double swept_volume(std::span<const Vec2> polyline) {
  double volume = 0.0;
  for (size_t i = 1; i < polyline.size(); ++i) {
    const double a = polyline[i - 1].x(), b = polyline[i].x();
    volume += pi / 3.0 * (a * a + a * b + b * b) * (polyline[i].y() - polyline[i - 1].y());
  }
  return volume;
}

// A circular arc from z = low up to z = high in equal steps of latitude, its radii enlarged until
// it sweeps the volume of the ball.
std::vector<Vec2> ball_profile(double radius, double low, double high, int segments) {
  const double from = std::asin(std::clamp(low / radius, -1.0, 1.0));
  const double to = std::asin(std::clamp(high / radius, -1.0, 1.0));
  const int steps = std::max(2, static_cast<int>(std::ceil(segments * (to - from) / (2.0 * pi))));
  std::vector<Vec2> arc;
  for (int i = 0; i <= steps; ++i) {
    const double latitude = from + (to - from) * i / steps;
    arc.emplace_back(radius * std::cos(latitude), radius * std::sin(latitude));
  }
  const double factor = std::sqrt(ball_volume(radius, low, high) / swept_volume(arc));
  for (Vec2& point : arc) point.x() *= factor;
  if (low <= -radius) arc.front().x() = 0.0;  // exactly on the axis: a pole
  if (high >= radius) arc.back().x() = 0.0;
  return arc;
}

void add_quad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

// The angles at which a box with a hole is cut: evenly, and through the corners.
std::vector<double> cut_angles(const Vec2& half, int segments) {
  std::vector<double> angles;
  for (int i = 0; i < segments; ++i) angles.push_back(2.0 * pi * i / segments);
  const double corner = std::atan2(half.y(), half.x());
  const std::array<double, 4> corners = {corner, pi - corner, pi + corner, 2.0 * pi - corner};
  // An even cut near a corner gives way, or slivers appear.
  std::erase_if(angles, [&](double a) {
    return std::ranges::any_of(corners,
                               [&](double angle) { return std::abs(a - angle) < pi / segments; });
  });
  angles.insert(angles.end(), corners.begin(), corners.end());
  std::sort(angles.begin(), angles.end());
  return angles;
}

// The point at which a ray from the centre at `angle` leaves the rectangle.
Vec2 on_rectangle(const Vec2& half, double angle) {
  const Vec2 direction(std::cos(angle), std::sin(angle));
  const Vec2 reach = half.cwiseQuotient(direction.cwiseAbs());
  Vec2 point = direction * reach.minCoeff();
  // The edge itself, without rounding.
  const int edge = reach.x() < reach.y() ? 0 : 1;
  point[edge] = std::copysign(half[edge], direction[edge]);
  return point;
}

}  // namespace

Mesh box_solid(const Vec3& size_m) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vec3 unit(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    mesh.vertices_m.emplace_back((unit - Vec3::Constant(0.5)).cwiseProduct(size_m));
  }
  add_quad(mesh, 0, 2, 3, 1);  // bottom
  add_quad(mesh, 4, 5, 7, 6);  // top
  add_quad(mesh, 0, 1, 5, 4);  // −y
  add_quad(mesh, 2, 6, 7, 3);  // +y
  add_quad(mesh, 0, 4, 6, 2);  // −x
  add_quad(mesh, 1, 3, 7, 5);  // +x
  return mesh;
}

Mesh sheet(const Vec2& size_m) {
  Mesh mesh;
  for (int i = 0; i < 4; ++i) {
    const Vec2 unit(i & 1, (i >> 1) & 1);
    const Vec2 corner_m = (unit - Vec2::Constant(0.5)).cwiseProduct(size_m);
    mesh.vertices_m.emplace_back(corner_m.x(), corner_m.y(), 0.0);
    mesh.uv.push_back(unit);
  }
  add_quad(mesh, 0, 1, 3, 2);
  return mesh;
}

Mesh box_with_hole_solid(const Vec3& size_m, double hole_radius_m, int segments) {
  const Vec2 half(0.5 * size_m.x(), 0.5 * size_m.y());
  const std::vector<double> angles = cut_angles(half, segments);
  const auto count = static_cast<uint32_t>(angles.size());
  double unit_area = 0.0;
  for (uint32_t i = 0; i < count; ++i) {
    unit_area += 0.5 * std::sin(angles[(i + 1) % count] - angles[i]);
  }
  const double radius_m = hole_radius_m * std::sqrt(pi / unit_area);

  Mesh mesh;  // four vertices per angle: hole and edge at the bottom, hole and edge at the top
  for (const double angle : angles) {
    const Vec2 inner(radius_m * std::cos(angle), radius_m * std::sin(angle));
    const Vec2 outer = on_rectangle(half, angle);
    for (const double z : {-0.5 * size_m.z(), 0.5 * size_m.z()}) {
      mesh.vertices_m.emplace_back(inner.x(), inner.y(), z);
      mesh.vertices_m.emplace_back(outer.x(), outer.y(), z);
    }
  }
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t a = 4 * i, b = 4 * ((i + 1) % count);
    add_quad(mesh, a, b, b + 1, a + 1);          // bottom
    add_quad(mesh, a + 2, a + 3, b + 3, b + 2);  // top
    add_quad(mesh, a + 1, b + 1, b + 3, a + 3);  // outside
    add_quad(mesh, a, a + 2, b + 2, b);          // hole
  }
  return mesh;
}

Mesh cylinder_solid(double bottom_radius_m, double top_radius_m, double height_m,
                    double inner_radius_m, int segments) {
  const double h = 0.5 * height_m;
  const std::vector<Vec2> profile = {
      {inner_radius_m, -h}, {bottom_radius_m, -h}, {top_radius_m, h}, {inner_radius_m, h}};
  return revolved_solid(profile, segments);
}

Mesh ball_solid(double radius_m, double low_m, double high_m, int segments) {
  std::vector<Vec2> profile = ball_profile(radius_m, low_m, high_m, segments);
  if (high_m < radius_m) profile.emplace_back(0.0, high_m);
  if (low_m > -radius_m) profile.insert(profile.begin(), Vec2(0.0, low_m));
  return revolved_solid(profile, segments);
}

Mesh shell_solid(double outer_radius_m, double thickness_m, double high_m, int segments) {
  const double inner_radius_m = outer_radius_m - thickness_m;
  std::vector<Vec2> profile = ball_profile(outer_radius_m, -outer_radius_m, high_m, segments);
  const std::vector<Vec2> inside = ball_profile(inner_radius_m, -inner_radius_m, high_m, segments);
  profile.insert(profile.end(), inside.rbegin(), inside.rend());
  return revolved_solid(profile, segments);
}

Mesh dish_solid(double rim_radius_m, double focal_length_m, double thickness_m, int segments) {
  const int steps = std::max(4, segments / 4);
  const auto height = [&](double r) { return r * r / (4.0 * focal_length_m); };
  std::vector<Vec2> profile;
  for (int i = 0; i <= steps; ++i) {
    const double r = rim_radius_m * i / steps;
    profile.emplace_back(r, height(r) - thickness_m);
  }
  for (int i = steps; i >= 0; --i) {
    const double r = rim_radius_m * i / steps;
    profile.emplace_back(r, height(r));
  }
  return revolved_solid(profile, segments);
}

Mesh revolved_solid(std::span<const Vec2> profile_m, int segments) {
  Mesh mesh;
  const double factor = equal_area_factor(segments);
  std::vector<uint32_t> first;  // of each profile point's ring; a point on the axis is one vertex
  for (const Vec2& point : profile_m) {
    first.push_back(static_cast<uint32_t>(mesh.vertices_m.size()));
    if (point.x() == 0.0) {
      mesh.vertices_m.emplace_back(0.0, 0.0, point.y());
      continue;
    }
    for (int k = 0; k < segments; ++k) {
      const double angle = 2.0 * pi * k / segments;
      const double r = factor * point.x();
      mesh.vertices_m.emplace_back(r * std::cos(angle), r * std::sin(angle), point.y());
    }
  }
  for (size_t i = 0; i < profile_m.size(); ++i) {
    const size_t next = (i + 1) % profile_m.size();
    const bool a_on_axis = profile_m[i].x() == 0.0, b_on_axis = profile_m[next].x() == 0.0;
    if (a_on_axis && b_on_axis) continue;
    for (uint32_t k = 0; k < static_cast<uint32_t>(segments); ++k) {
      const uint32_t k1 = (k + 1) % static_cast<uint32_t>(segments);
      const uint32_t a0 = first[i] + (a_on_axis ? 0 : k), a1 = first[i] + (a_on_axis ? 0 : k1);
      const uint32_t b0 = first[next] + (b_on_axis ? 0 : k),
                     b1 = first[next] + (b_on_axis ? 0 : k1);
      if (!a_on_axis) mesh.triangles.push_back({a0, a1, b1});
      if (!b_on_axis) mesh.triangles.push_back({a0, b1, b0});
    }
  }
  return mesh;
}

SolidMoments moments_of(const Mesh& mesh) {
  // ∫ x xᵀ over the tetrahedron of the origin and the unit vectors.
  Mat3 canonical = Mat3::Constant(1.0 / 120.0);
  canonical.diagonal().setConstant(1.0 / 60.0);

  SolidMoments moments;
  for (const auto& triangle : mesh.triangles) {
    Mat3 corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = mesh.vertices_m[triangle[static_cast<size_t>(i)]];
    const double determinant = corners.determinant();
    moments.volume_m3 += determinant / 6.0;
    moments.first_m4 += determinant / 24.0 * corners.rowwise().sum();
    moments.second_m5 += determinant * corners * canonical * corners.transpose();
  }
  return moments;
}

MassProperties mass_properties(const SolidMoments& part_moments, double mass_kg,
                               const RigidTransform& body_from_part) {
  const double density = mass_kg / part_moments.volume_m3;
  const Mat3 rotation = body_from_part.rotation.toRotationMatrix();
  const Vec3& shift = body_from_part.translation_m;
  const Vec3 rotated_first = rotation * (density * part_moments.first_m4);
  // ∫ (R x + t)(R x + t)ᵀ ρ dV
  const Mat3 second = rotation * (density * part_moments.second_m5) * rotation.transpose() +
                      rotated_first * shift.transpose() + shift * rotated_first.transpose() +
                      mass_kg * shift * shift.transpose();
  return {mass_kg, rotated_first / mass_kg + shift, second.trace() * Mat3::Identity() - second};
}

MassProperties operator+(const MassProperties& a, const MassProperties& b) {
  const double mass_kg = a.mass_kg + b.mass_kg;
  if (mass_kg == 0.0) return {};
  return {mass_kg, (a.mass_kg * a.centre_m + b.mass_kg * b.centre_m) / mass_kg,
          a.inertia_kg_m2 + b.inertia_kg_m2};
}

}  // namespace photorque

// Small scenes and emitters, built by hand, for tests of the tracer.
#pragma once

#include <cmath>
#include <span>

#include "core/constants.h"
#include "raytrace/tracing/tracer.h"

namespace photorque::fixtures {

inline void set_ray(RayBlock& rays, int i, const Vec3& origin_m, const Vec3& direction) {
  for (int k = 0; k < 3; ++k) {
    rays.origin_m[k][i] = origin_m[k];
    rays.direction[k][i] = direction[k];
  }
}

// Parallel light: fills a square of side `side_m` about the emitter's z axis, or a disc, uniformly.
class ParallelBeam final : public Emitter {
 public:
  enum class Shape { square, disc };
  ParallelBeam(double power_W, double size_m, Shape shape = Shape::square)
      : power_W_(power_W), size_m_(size_m), shape_(shape) {}
  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    for (int i = 0; i < ray_block; ++i) {
      const double u = sobol_fraction(samples.bits[0][i]), v = sobol_fraction(samples.bits[1][i]);
      const double radius = size_m_ * std::sqrt(u), angle = 2 * pi * v;
      const Vec3 on_square(size_m_ * (u - 0.5), size_m_ * (v - 0.5), 0.0);
      const Vec3 on_disc(radius * std::cos(angle), radius * std::sin(angle), 0.0);
      set_ray(rays, i, shape_ == Shape::square ? on_square : on_disc, Vec3::UnitZ());
    }
  }
  double relative_intensity(double angle_rad) const override {
    return angle_rad == 0.0 ? 1.0 : 0.0;
  }

 private:
  double power_W_;
  double size_m_;  // side of the square, radius of the disc
  Shape shape_;
};

// Disc of radius R, every point radiating the same cone, evenly in angle: the reference case A.
class PillboxDisc final : public Emitter {
 public:
  PillboxDisc(double power_W, double radius_m, double half_angle_rad)
      : power_W_(power_W), radius_m_(radius_m), half_angle_rad_(half_angle_rad) {}
  double power_W() const override { return power_W_; }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    for (int i = 0; i < ray_block; ++i) {
      double f[4];
      for (int d = 0; d < 4; ++d) f[d] = sobol_fraction(samples.bits[static_cast<size_t>(d)][i]);
      const double radius = radius_m_ * std::sqrt(f[0]), around = 2 * pi * f[1];
      const double theta = half_angle_rad_ * std::sqrt(f[2]);
      set_ray(rays, i, {radius * std::cos(around), radius * std::sin(around), 0.0},
              {std::sin(theta) * std::cos(2 * pi * f[3]), std::sin(theta) * std::sin(2 * pi * f[3]),
               std::cos(theta)});
    }
  }
  double relative_intensity(double angle_rad) const override {
    return angle_rad <= half_angle_rad_ ? 1.0 : 0.0;
  }

 private:
  double power_W_, radius_m_, half_angle_rad_;
};

// A rectangle centre ± u/2 ± v/2 with its front along u × v.
inline Mesh rectangle(const Vec3& centre, const Vec3& u, const Vec3& v) {
  Mesh mesh;
  mesh.vertices_m = {centre - u / 2 - v / 2, centre + u / 2 - v / 2, centre + u / 2 + v / 2,
                     centre - u / 2 + v / 2};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return mesh;
}

// An axis-parallel box, fronts outwards.
inline Mesh box(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_m.emplace_back((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(),
                                 (i & 4) ? high.z() : low.z());
  }
  const uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

// A sphere about the origin, rings × 2·rings cells, vertices on the sphere, fronts outwards.
inline Mesh sphere(double radius_m, int rings) {
  Mesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double theta = pi * i / rings, phi = 2 * pi * j / around;
      mesh.vertices_m.emplace_back(radius_m * std::sin(theta) * std::cos(phi),
                                   radius_m * std::sin(theta) * std::sin(phi),
                                   radius_m * std::cos(theta));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<uint32_t>(i * around + j % around); };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i < rings - 1) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  }
  return mesh;
}

// Force and torque about the body origin, summed over all hits: bins fx fy fz tx ty tz.
class TotalWrench final : public Receiver {
 public:
  size_t bins() const override { return 6; }
  void score(const Hits& hits, std::span<double> sums) const override {
    for (int i = 0; i < hits.count; ++i) {
      const Vec3 force = hits.force_at_N(static_cast<size_t>(i));
      const Vec3 torque = hits.position_at_m(static_cast<size_t>(i)).cross(force);
      for (int k = 0; k < 3; ++k) {
        sums[static_cast<size_t>(k)] += force[k];
        sums[static_cast<size_t>(3 + k)] += torque[k];
      }
    }
  }
  Product product(const BinSums&) const override { return {}; }
};

// Adds a mesh with the same surface on both sides; returns the instance's index.
inline uint32_t add(Scene& scene, Mesh mesh, const OpticalSurface& surface,
                    const std::string& node) {
  Instance instance;
  instance.node = instance.path = node;
  instance.mesh = static_cast<uint32_t>(scene.meshes.size());
  instance.front_surface = instance.back_surface = static_cast<uint32_t>(scene.surfaces.size());
  scene.meshes.push_back(std::move(mesh));
  scene.surfaces.push_back(surface);
  scene.instances.push_back(instance);
  return static_cast<uint32_t>(scene.instances.size() - 1);
}

inline Scene scene_of_part(Mesh mesh, const OpticalSurface& surface, const std::string& node) {
  Scene scene;
  add(scene, std::move(mesh), surface, node);
  return scene;
}

// A beam from `origin_m` along `direction`.
inline Beam beam(std::shared_ptr<const Emitter> emitter, const Vec3& origin_m,
                 const Vec3& direction) {
  return {"beam", std::move(emitter), frame_looking_along(direction, origin_m), Spectrum{}};
}

}  // namespace photorque::fixtures

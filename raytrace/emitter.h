// The interface between the tracer and all light sources.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/numerics/random.h"
#include "core/spectrum.h"
#include "core/transform.h"

namespace photorque {

// Number of rays per block. Blocks are structures of arrays, so that compilers vectorise the loops
// of an emitter.
inline constexpr int ray_block = sobol_block;

// Points of the unit hypercube as 32-bit fixed-point fractions (see sobol_fraction()).
struct SampleBlock {
  alignas(64) std::array<std::array<uint32_t, ray_block>, sobol_dimensions> bits;

  // Where sobol_points() writes them.
  std::array<uint32_t*, sobol_dimensions> columns() {
    return {bits[0].data(), bits[1].data(), bits[2].data(), bits[3].data()};
  }
};

// Rays in the emitter's frame: origins in metres, directions of unit norm to 3e-7. Single
// precision, which Embree requires, is sufficient at any distance (see RayPlacement).
struct RayBlock {
  alignas(64) std::array<std::array<float, ray_block>, 3> origin_m;
  alignas(64) std::array<std::array<float, ray_block>, 3> direction;

  Vec3 origin_at_m(size_t i) const { return {origin_m[0][i], origin_m[1][i], origin_m[2][i]}; }
  Vec3 direction_at(size_t i) const { return {direction[0][i], direction[1][i], direction[2][i]}; }
};

// A source of light in its own frame: z along the axis of the beam, origin at the aperture.
// Immutable; called from many threads at once.
class Emitter {
 public:
  virtual ~Emitter() = default;

  // Total radiant power of all rays [W], > 0. Every ray carries an equal fraction.
  virtual double power_W() const = 0;

  // Maps uniform points to rays. To preserve a good distribution of the points, each dimension
  // enters through a monotone or otherwise area-preserving map. Dimensions 0 and 1 select the point
  // of the aperture, 2 and 3 the direction.
  virtual void emit(const SampleBlock& samples, RayBlock& rays) const = 0;

  // Radiant intensity at `angle_rad` ∈ [0, π] from the axis, divided by its maximum; in [0, 1]. For
  // beams without axial symmetry: the average around the axis.
  virtual double relative_intensity(double angle_rad) const = 0;
};

// Light from so far away that only its directions matter, such as sunlight: an emitter whose rays
// fill, for each direction, a disc normal to that direction and centred on (0, 0, radius). The
// sphere of this radius about that point is lit evenly. The tracer may choose the points of the
// disc itself, also those of a smaller disc about the scene, and omit those from which no ray meets
// anything.
class ParallelLight : public Emitter {
 public:
  explicit ParallelLight(double radius_m) : radius_m_(radius_m) {}

  // Radius of the lit sphere.
  double radius_m() const { return radius_m_; }

  // Fills rays.direction from dimensions 2 and 3. The angle from the axis increases with dimension
  // 2.
  virtual void fill_directions(const SampleBlock& samples, RayBlock& rays) const = 0;

  // Places each point (x, y) of rays.origin_m on the disc of its ray. The point is turned by the
  // shortest rotation from z to the ray's direction, moved to (0, 0, height_m), and moved back
  // along the ray to the plane z = 0. Source of the axes: J. R. Frisvad, J. Graphics Tools 16
  // (2012) 151.
  static void place_on_discs(double height_m, RayBlock& rays) {
    for (int i = 0; i < ray_block; ++i) {
      const double dx = rays.direction[0][i], dy = rays.direction[1][i], dz = rays.direction[2][i];
      const double a_m = rays.origin_m[0][i], b_m = rays.origin_m[1][i];
      const double along_m = a_m * dx + b_m * dy;
      const double bend_m = along_m / (1.0 + dz);
      const double back_m = (height_m - along_m) / dz;
      rays.origin_m[0][i] = static_cast<float>(a_m - bend_m * dx - back_m * dx);
      rays.origin_m[1][i] = static_cast<float>(b_m - bend_m * dy - back_m * dy);
      rays.origin_m[2][i] = 0.0f;
    }
  }

 private:
  double radius_m_;
};

// An emitter with the rays of another and its power multiplied by a factor.
class ScaledEmitter final : public Emitter {
 public:
  ScaledEmitter(std::shared_ptr<const Emitter> one, double factor)
      : one_(std::move(one)), factor_(factor) {}
  double power_W() const override { return factor_ * one_->power_W(); }
  void emit(const SampleBlock& samples, RayBlock& rays) const override {
    one_->emit(samples, rays);
  }
  double relative_intensity(double angle_rad) const override {
    return one_->relative_intensity(angle_rad);
  }

 private:
  std::shared_ptr<const Emitter> one_;
  double factor_;
};

// An aperture whose points all radiate alike, with the emitter's relative_intensity() about the
// axis. It is a disc at z = 0, or an area so far away that only directions matter. Light from it
// can be integrated over a surface without rays (see direct/disc_light.h).
struct UniformAperture {
  // > 0; infinite for parallel light, whose rays fill a plane normal to each direction
  double radius_m = 0.0;
  double exitance_W_m2 = 0.0;  // power divided by the area of the aperture
  // Angles where the relative intensity jumps or changes its formula, rising. The last is the end
  // of the beam; 0 for collimated light.
  std::vector<double> edges_rad;

  bool operator==(const UniformAperture&) const = default;
};

// An emitter placed in the laboratory.
struct Beam {
  std::string name;
  std::shared_ptr<const Emitter> emitter;
  RigidTransform lab_from_emitter;
  Spectrum spectrum;
  std::optional<UniformAperture> aperture = std::nullopt;  // empty: rays only
};

}  // namespace photorque

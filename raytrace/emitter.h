// The interface between the tracer and everything that shines.
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

// Rays in blocks, structure of arrays, so that compilers vectorise the loops of an emitter.
inline constexpr int ray_block = sobol_block;

// Points of the unit hypercube as 32-bit fixed-point fractions (see sobol_fraction()).
struct SampleBlock {
  alignas(64) std::array<std::array<uint32_t, ray_block>, sobol_dimensions> bits;
};

// Rays in the emitter's frame: origins in metres, directions of unit norm to 3e-7. In single
// precision, which Embree requires; the distance of the emitter costs no precision.
struct RayBlock {
  alignas(64) std::array<std::array<float, ray_block>, 3> origin_m;
  alignas(64) std::array<std::array<float, ray_block>, 3> direction;
};

// A source of light in its own frame: z along the axis of the beam, origin at the aperture.
// Immutable; called from many threads at once.
class Emitter {
 public:
  virtual ~Emitter() = default;

  // Radiant power of all rays together [W], > 0. Every ray carries an equal fraction.
  virtual double power_W() const = 0;

  // Turns uniform points into rays. Points that are well distributed must give rays that are: each
  // dimension enters through a monotone or otherwise area-preserving map. Dimensions 0 and 1 choose
  // the point of the aperture, 2 and 3 the direction.
  virtual void emit(const SampleBlock& samples, RayBlock& rays) const = 0;

  // Radiant intensity at `angle_rad` ∈ [0, π] from the axis over its maximum, for beams that are
  // the same all round the axis; the average around the axis for others. In [0, 1].
  virtual double relative_intensity(double angle_rad) const = 0;
};

// An emitter that gives another power.
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

// An aperture that shines alike from all its points, with the emitter's relative_intensity() about
// the axis: a disc at z = 0, or an area so far away that only directions matter. What lets the
// light on a surface be gathered from the surface's side (see direct/disc_light.h).
struct UniformAperture {
  double radius_m = 0.0;  // > 0; infinite for parallel light, whose rays fill a plane normal to
                          // each direction
  double exitance_W_m2 = 0.0;  // power over the area of the aperture
  // Where the relative intensity jumps or changes its law, rising; the last is where it ends, 0 for
  // collimated light.
  std::vector<double> edges_rad;

  bool operator==(const UniformAperture&) const = default;
};

// An emitter placed in the laboratory.
struct Beam {
  std::string name;
  std::shared_ptr<const Emitter> emitter;
  RigidTransform lab_from_emitter;
  Spectrum spectrum;
  std::optional<UniformAperture> aperture = std::nullopt;  // none: rays only
};

}  // namespace photorque

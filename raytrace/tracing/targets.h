// Selects the part of parallel light that can meet a scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "raytrace/emitter.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

// Interleaves the bits of a 16-bit number with zeros, for Morton codes.
constexpr uint32_t with_gaps(uint32_t x) {
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}

// Cells of a disc about the scene, perpendicular to a ParallelLight, from which rays can meet a
// triangle. This disc replaces that of the light, which may be far from the scene: rays in single
// precision would lose digits over that distance.
//
// Seen along a direction at the angle θ from the axis, a point moves by at most
// |z| sin θ + ρ (1 − cos θ) from its position along the axis (z: height over the disc's middle, ρ:
// distance from the axis). Triangles with this margin are drawn on a bitmap. The bitmap is halved
// in both directions until few cells are left. Light far from the axis has wide margins and little
// power. Therefore directions are divided into a few ranges of angles, each with separate cells.
// Points and directions are drawn in proportion to the cells' area times the range's power, so that
// every ray carries the same power. The omitted light meets nothing: the results are unbiased.
class Targets {
 public:
  // Empty if the light is not parallel, or if nearly all of the disc is needed. The number of
  // `rays` of the emitter limits the number of cells.
  static std::optional<Targets> of(const Emitter& emitter, const RigidTransform& body_from_emitter,
                                   const TraceableScene::Data& scene, uint64_t rays);

  // Fraction of the emitter's power that is sent, in (0, 1); the rest would meet nothing.
  double fraction() const { return fraction_; }

  // See Emitter::emit(); the points lie in the cells only, in the frame body_from_rays(). Changes
  // dimension 2 of the samples.
  void emit(SampleBlock& samples, RayBlock& rays) const;

  // Transform from the frame of the rays: the emitter's axes, with the origin just before the
  // scene.
  const RigidTransform& body_from_rays() const { return body_from_rays_; }

  struct Cell {
    uint16_t x, y;
  };
  // Square cells in the order of a Morton curve, from a corner.
  struct Cells {
    double x_m = 0.0, y_m = 0.0, size_m = 0.0;
    std::vector<Cell> cells;

    double area_m2() const { return size_m * size_m * static_cast<double>(cells.size()); }
  };

 private:
  // Directions between two fractions of the light, measured from the axis outwards.
  struct AngleRange {
    double from, to;      // fractions of the light
    double begin, scale;  // fraction = from + (draw − begin) · scale
    Cells cells;
  };

  // For a disc at `middle_m` above the scene's centre, along the light.
  static std::optional<Targets> at_height(const ParallelLight& light, const Quat& body_from_emitter,
                                          const TraceableScene::Data& scene, double middle_m,
                                          uint64_t rays);
  Targets(const ParallelLight& light, const RigidTransform& body_from_rays, double height_m,
          std::vector<AngleRange> ranges);

  const ParallelLight* light_;
  RigidTransform body_from_rays_;
  double height_m_;  // height of the disc's middle in this frame
  std::vector<AngleRange> ranges_;
  double fraction_ = 0.0;
};

}  // namespace photorque

// Where parallel light has to be sent so that it meets a scene.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "raytrace/parallel_light.h"
#include "raytrace/tracing/traceable_scene_data.h"

namespace photorque {

// The cells of a disc about the scene, across a ParallelLight, from which rays can meet a triangle.
// The disc takes the place of the light's own, which may be centred far away: the light is the same
// everywhere, and rays in single precision must not see that distance.
//
// Seen along a direction at the angle θ from the axis a point at height z over the disc's middle
// lies within |z| sin θ + ρ (1 − cos θ) of its place (ρ from the axis) along the axis. Triangles
// with this margin are drawn onto a grid of bits, which is halved in both directions until few
// cells are left. Light far from the axis has wide margins and little power, so directions are cut
// into a few ranges of angles, each with separate cells. Points and directions are drawn in
// proportion to the cells' area times the range's power: every ray carries the same power, and the
// light left out meets nothing. Exact: no result is biased.
class Targets {
 public:
  // Nothing if the light is not parallel, or if nearly all of the disc is needed. `rays` of the
  // emitter bound the work.
  static std::optional<Targets> of(const Emitter& emitter, const RigidTransform& body_from_emitter,
                                   const TraceableScene::Data& scene, uint64_t rays);

  // Fraction of the emitter's power that is sent; the rest would meet nothing. In (0, 1).
  double fraction() const { return fraction_; }

  // As Emitter::emit(), onto the cells alone, in the frame body_from_rays(). Changes dimension 2 of
  // the samples.
  void emit(SampleBlock& samples, RayBlock& rays) const;

  // The emitter's axes, with the origin just before the scene.
  const RigidTransform& body_from_rays() const { return body_from_rays_; }

  struct Cell {
    uint16_t x, y;
  };
  // Square cells from a corner on, along a Morton curve.
  struct Cells {
    double x_m = 0.0, y_m = 0.0, size_m = 0.0;
    std::vector<Cell> cells;

    double area_m2() const { return size_m * size_m * static_cast<double>(cells.size()); }
  };

 private:
  // Directions between two fractions of the light, counted from the axis.
  struct AngleRange {
    double from, to;      // fractions of the light
    double begin, scale;  // fraction = from + (draw − begin) · scale
    Cells cells;
  };

  Targets(const ParallelLight& light, const RigidTransform& body_from_rays, double height_m,
          std::vector<AngleRange> ranges);

  const ParallelLight* light_;
  RigidTransform body_from_rays_;
  double height_m_;  // of the middle of the disc in this frame
  std::vector<AngleRange> ranges_;
  double fraction_ = 0.0;
};

}  // namespace photorque

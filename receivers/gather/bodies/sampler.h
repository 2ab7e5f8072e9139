// Shadow rays between the facets of one instance and one lamp. For the files of this folder only.
#pragma once

#include <span>
#include <vector>

#include "raytrace/tracing/shadow.h"
#include "receivers/gather/bodies/lamp.h"

namespace photorque {

// A side that may be in a shadow, or that not every ray meets from the front.
struct SampledSide {
  FacetSide side;
  bool whole;           // Exposure::whole
  double power_W;       // about
  uint32_t points = 1;  // rays per replicate: a power of two
};

// The lamp, what both sides of the instance do with its light [back, front], and the point of
// torques.
struct SampledLight {
  const TraceableScene& scene;
  const BodyLamp& lamp;
  std::array<FirstContact, 2> contact;
  Vec3 about_m;
};

// Where results go: six numbers for each replicate, and the bounds of their errors.
struct WrenchEntries {
  std::span<WrenchSum> replicates;
  WrenchSum& bound;
};

// Adds the light on a side that nothing can shade.
void add_open(const SampledLight& light, const FacetSide& side, const WrenchEntries& entries);

// Adds the light that gets through to `sides`. Where all rays get through to a plain side, it is
// what nothing shades, without noise; where most do, that less what is kept away. The points of
// replicate r come from the stream (seed, hash of `which` and r). Returns the number of rays.
uint64_t add_sampled(const SampledLight& light, std::vector<SampledSide> sides, uint64_t seed,
                     uint64_t which, const WrenchEntries& entries);

}  // namespace photorque

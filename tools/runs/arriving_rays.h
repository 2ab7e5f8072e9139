// The rays that arrive on a surface, for other optics programs.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "raytrace/tracing/tracer.h"
#include "receivers/maps/flux_map.h"
#include "sources/photometry/ray_set.h"

namespace photorque {

// Traces `options.rays` rays and keeps those that meet each of the surfaces, in the body frame:
// where, the direction of arrival, the power, and the wavelength where the source is a line. A ray
// that comes back after bounces is there once for every arrival. Their flux sums to the power on
// the surface; their number varies with options.rays alone, not with options.threads. The set of
// a surface that no ray meets is empty.
std::vector<RaySet> arriving_rays(const TraceableScene& scene, const RigidTransform& lab_from_body,
                                  std::span<const Beam> beams,
                                  std::span<const FluxMapReceiver* const> surfaces,
                                  TraceOptions options);

}  // namespace photorque

// The torque of direct light on a flat surface, gathered from the surface's side.
//
// With the force f per area of first_contact.h, torques per bin are integrals of (r − p) × f by the
// same rules as irradiance; what bounces is for rays.
#pragma once

#include "receivers/gather/gather.h"
#include "receivers/maps/torque_map.h"

namespace photorque {

// Whether gather_torque() applies: as can_gather(), for both sides, and surfaces whose fractions
// are the same for every angle and that send light nowhere else.
bool can_gather_torque(const Scene& scene, const SurfaceGrid& grid, std::span<const Beam> beams);

// The direct entries of the torque map, at the attitude `lab_from_body`; else as gather_direct().
// `target_error` is not used.
Gathered gather_torque(const TraceableScene& scene, const RigidTransform& lab_from_body,
                       std::span<const Beam> beams, const TorqueMapReceiver& map,
                       const GatherOptions& options);

}  // namespace photorque

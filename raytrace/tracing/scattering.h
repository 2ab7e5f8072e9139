// What is not absorbed at a hit: how hard it pushes the surface, and where the ray goes on. All
// surfaces, plain or with a BSDF, take this way.
#pragma once

#include "core/numerics/random.h"
#include "raytrace/surfaces/bsdf.h"
#include "raytrace/tracing/find_hits.h"
#include "raytrace/tracing/interaction.h"

namespace photorque {

// How light meets the surface at hit i, in the body frame.
Incidence incidence_at(const TraceableScene::Data& scene, const HitBuffer& buffer, int i);

// Settles hit i of the buffer, whose absorbed_W is known: takes the momentum of what leaves, heat
// radiation included, from force_N, and appends the ray that goes on to `next`, or ends it if it
// carries less than the cutoff. The component and direction of the ray come from its own point of
// `sequence`.
void scatter(const InteractionContext& context, const SobolSequence& sequence, HitBuffer& buffer,
             int i, PowerBalanceSums& power_balance, Continuation& next);

}  // namespace photorque

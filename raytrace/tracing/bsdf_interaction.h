// Hits on surfaces with a BSDF (bsdf.h); the plain ones are settled in interaction.cpp.
#pragma once

#include "raytrace/tracing/interaction.h"

namespace photorque {

// Puts absorbed_W and left_W right where they depend on the angle of incidence.
void absorb_by_angle(const TraceableScene::Data& scene, HitBuffer& buffer);

// Settles every hit on a BSDF: takes what leaves from force_N, heat radiation included, adds rays
// to `next`, and sets left_W to zero, so that nothing is left to do.
void settle_finishes(const InteractionContext& context, const SobolSequence& sequence,
                     HitBuffer& buffer, PowerBalanceSums& power_balance, Continuation& next);

}  // namespace photorque

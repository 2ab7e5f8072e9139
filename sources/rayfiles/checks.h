// What the readers of ray files share.
#pragma once

#include "core/errors.h"
#include "sources/rayfiles/set.h"

namespace photorque {

// Throws InputError unless ray `index` has finite numbers, a start within largest_extent_m, a
// direction of length one (to 1e-3) and no negative flux.
void require_sound(const RaySet::Ray& ray, size_t index, const InputLocation& where);

// Throws InputError for a set without rays or without flux.
void require_flux(const RaySet& set, const InputLocation& where);

// Throws InputError for more rays than fit in memory kept for them.
void require_affordable(uint64_t rays, const InputLocation& where);

}  // namespace photorque

// A rest before the motion about one axis.
#pragma once

#include "attitude/observation/observation.h"

namespace photorque {

// The first of the rows [first, last) after a rest from which the body sets off at once, as where a
// motor is switched on or a hand lets go. While it rests, at least five readings scatter about one
// value as noise does, for a rate about zero, without a slope. At most twelve readings later all of
// the next are further away than five times that scatter, on one side, and with their slope the
// body would have moved by ten times the scatter within the rest. `first` where there is no such
// rest.
size_t sets_off_at(const Observation& rows, const Vec3& axis, size_t first, size_t last);

}  // namespace photorque

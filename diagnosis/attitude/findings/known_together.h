// Numbers of one key that are known together, and none of them by itself.
#pragma once

#include <string>

#include "core/transform.h"

namespace photorque {

// Of three numbers with their covariance (the squares of their unit), of which none is beyond twice
// its standard error: the principal combination that is furthest from zero in standard errors, its
// largest coefficient 1, as "x − 0.99 z = (4.4 ± 0.1)×10⁻¹⁰". Empty where none is beyond four, or
// where a number is known by itself.
std::string known_together(const Vec3& value, const Mat3& covariance);

}  // namespace photorque

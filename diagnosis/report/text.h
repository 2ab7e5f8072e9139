// Text of the report: numbers, units and names as people read them, as HTML.
#pragma once

#include <string>

namespace photorque {

// "−1.13 × 10<sup>−9</sup>": `digits` significant ones, a true minus sign, and a power of ten
// outside of [1e-3, 1e5). "–" for what is not finite.
std::string html_number(double value, int digits = 3);

// The same for value ± sigma, with the value to the two digits that sigma has. Without ± where
// sigma is 0 or not finite.
std::string html_estimate(double value, double sigma);

// "dipole_A_m2" as "dipole" and as "A m²".
std::string spoken_key(const std::string& key);
std::string spoken_unit(const std::string& key);
// "magnetic_dipole" as "magnetic dipole".
std::string spoken(std::string name);

}  // namespace photorque

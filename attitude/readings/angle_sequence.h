// Roll, pitch and yaw: three turns about body x, y and z, in one of six sequences.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "core/transform.h"

namespace photorque {

// The axes in the order of the turns about axes that move with the body: "zyx" is yaw, then pitch,
// then roll, q = Rz(yaw) Ry(pitch) Rx(roll), which is the usual one; the same as turns about fixed
// axes in the reverse order.
inline constexpr std::array<std::string_view, 6> angle_sequences = {"zyx", "xyz", "xzy",
                                                                    "yxz", "yzx", "zxy"};

// `roll_pitch_yaw`: the turns about x, y and z [rad], whatever their sequence (one of the six).
Quat attitude_of_angles(std::string_view sequence, const Vec3& roll_pitch_yaw);

// The reverse, the middle turn in [−π/2, π/2]; where that is a right angle, the last one is zero.
// Source: with R = R_i(a) R_j(b) R_k(c) and ε the sign of the permutation ijk,
// R_ik = ε sin b, R_jk = −ε sin a cos b, R_kk = cos a cos b, R_ij = −ε cos b sin c,
// R_ii = cos b cos c.
Vec3 angles_of_attitude(std::string_view sequence, const Quat& lab_from_body);

// "q = Rz(yaw) Ry(pitch) Rx(roll)".
std::string formula_of(std::string_view sequence);

}  // namespace photorque

// Reference frames of CCSDS messages. Names are in upper case, as read by MessageFile.
//
// Sources: SANA registries of celestial body reference frames and of spacecraft body reference
// frames.
#pragma once

#include <string>
#include <string_view>

#include "core/errors.h"

namespace photorque {

// Axes of a reference frame for orbits about the Earth.
enum class FrameAxes {
  J2000,    // inertial, equator of J2000: EME2000, J2000, GCRF, ICRF…
  of_date,  // inertial, equator and equinox of date: TOD, MOD, TEME
  earth,    // rotating with the Earth: ITRF…
  unknown,
};
FrameAxes axes_of_frame(std::string_view frame);

// Whether a frame is fixed in the body: SC_BODY, STARTRACKER_2…
bool is_body_frame(std::string_view frame);

// Frames A and B of a rotation. One is fixed in the body, the other one is the lab's.
struct FramePair {
  // InputError unless one frame is a body's and the other one is inertial or LAB.
  FramePair(const std::string& frame_a, const std::string& frame_b, const InputLocation& where);

  std::string a, b;
  bool is_from_body;  // A is fixed in the body
  const std::string& lab() const { return is_from_body ? b : a; }
};

// Whether the axes `frame` of an angular velocity are those of A, not of B. They are named or
// stated as REF_FRAME_A or REF_FRAME_B. InputError for another frame.
bool are_axes_of_a(const std::string& frame, const std::string& a, const std::string& b,
                   const InputLocation& where);

}  // namespace photorque

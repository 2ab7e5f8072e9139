#include "attitude/recordings/frames.h"

#include <algorithm>
#include <array>

#include "core/text/parse.h"

namespace photorque {

FrameAxes axes_of_frame(std::string_view frame) {
  if (frame == "EME2000" || frame == "J2000" || frame == "GCRF" || frame.starts_with("ICRF")) {
    return FrameAxes::J2000;
  }
  if (frame.starts_with("TOD") || frame.starts_with("MOD") || frame.starts_with("TEME")) {
    return FrameAxes::of_date;
  }
  return frame.starts_with("ITRF") ? FrameAxes::earth : FrameAxes::unknown;
}

bool is_body_frame(std::string_view frame) {
  constexpr std::array<std::string_view, 16> parts = {
      "ACC",        "ACTUATOR", "AST", "CSS", "DSS",    "ESA",     "GYRO_FRAME",  "IMU_FRAME",
      "INSTRUMENT", "MTA",      "RW",  "SA",  "SENSOR", "SC_BODY", "STARTRACKER", "TAM"};
  // The number or letter of the part follows, as in SENSOR_1.
  return std::ranges::any_of(parts, [frame](std::string_view part) {
    if (!frame.starts_with(part)) return false;
    const std::string_view rest = frame.substr(part.size());
    return rest.empty() || rest.front() == '_' || (rest.front() >= '0' && rest.front() <= '9');
  });
}

FramePair::FramePair(const std::string& frame_a, const std::string& frame_b,
                     const InputLocation& where)
    : a(frame_a), b(frame_b), is_from_body(is_body_frame(a)) {
  const FrameAxes axes = axes_of_frame(lab());
  // MCI: inertial about Mars. LVLH_INERTIAL and the like: those of an orbit at one instant.
  const bool is_still = lab().starts_with("LAB") || lab().ends_with("INERTIAL") ||
                        lab() == "B1950" || lab() == "MCI" || axes == FrameAxes::J2000 ||
                        axes == FrameAxes::of_date;
  if (is_body_frame(b) != is_from_body && is_still) return;
  throw InputError(where, "", "the frames " + in_quotes(a) + " and " + in_quotes(b),
                   "one of the body (SC_BODY_1) and one of space: inertial (EME2000, J2000, GCRF, "
                   "ICRF, TOD, MOD, TEME, B1950, MCI) or LAB");
}

bool are_axes_of_a(const std::string& frame, const std::string& a, const std::string& b,
                   const InputLocation& where) {
  if (frame == "REF_FRAME_A" || frame == a) return true;
  if (frame == "REF_FRAME_B" || frame == b) return false;
  throw InputError(where, "ANGVEL_FRAME", frame.empty() ? "nothing" : in_quotes(frame),
                   "one of the two frames, " + in_quotes(a) + " or " + in_quotes(b));
}

}  // namespace photorque

// Light-pressure tables in the SPAD layout (.spo) that GMAT reads.
//
// A text of "Key : value" lines, the ranges of azimuth and elevation, and a row per direction with
// azimuth and elevation of the Sun in body axes [deg], force over pressure [m²] and, optionally,
// torque over pressure [m³]. GMAT (R2026a) requires azimuths −180 … 180 and elevations −90 … 90 deg
// in even steps and reads the force alone, of analysis type "Area".
#pragma once

#include <string>

#include "core/wrench.h"

namespace photorque {

// The content of a file.
struct SpadFile {
  std::string system;  // content of the table
  // Force and torque under light of 1 Pa pressure (so that 1 m² is 1 N): scale by the irradiance
  // over the speed of light. About the file's centre of mass, taken as metres: the format does not
  // name its unit.
  WrenchTable table;
  bool has_torque = false;  // else the torques are left out
};

// The text of a file. The table must be of azimuth and elevation, whole and regular (−180 … 180 and
// −90 … 90 deg), InputError otherwise; it is made single-valued first. Forces and torques keep 12
// digits. `provenance` becomes a header line.
std::string format_spad(const SpadFile& file, const std::string& provenance);

}  // namespace photorque

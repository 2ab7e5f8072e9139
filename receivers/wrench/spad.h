// Light-pressure tables in the SPAD format (.spo) that GMAT reads.
//
// The file consists of "Key : value" lines, the ranges of azimuth and elevation, and one row per
// direction. A row contains azimuth and elevation of the Sun in body axes [deg], force over
// pressure [m²] and, optionally, torque over pressure [m³]. GMAT (R2026a) requires azimuths −180 …
// 180 and elevations −90 … 90 deg in equal steps. It reads only the force, of analysis type "Area".
#pragma once

#include <string>

#include "core/wrench.h"

namespace photorque {

// The content of a file.
struct SpadFile {
  std::string system;  // description of the table
  // Force and torque under light of 1 Pa pressure (1 m² corresponds to 1 N); scale by the
  // irradiance divided by the speed of light. About the file's centre of mass, in metres: the
  // format does not state its unit.
  WrenchTable table;
  bool has_torque = false;  // if false, the file has no torques
};

// Text of a file. The table must be a regular grid of azimuth and elevation over the whole sphere
// (−180 … 180 and −90 … 90 deg); throws InputError otherwise. It is made single-valued first.
// Forces and torques have 12 digits. `provenance` becomes a header line.
std::string format_spad(const SpadFile& file, const std::string& provenance);

}  // namespace photorque

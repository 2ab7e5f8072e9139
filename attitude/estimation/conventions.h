// Checks of frames and conventions before any fit: the rates must integrate to the attitude.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "attitude/observation/observation.h"

namespace photorque {

// Repairs the convention of gyro and attitude if they contradict each other. The observations are
// changed if one other interpretation of the numbers makes them agree: conjugated quaternion,
// scalar last, axes permuted or reversed, degrees per second under a header in radians, or the
// reverse. Returns a sentence about the change; empty: none. Nothing is checked without a gyro. All
// segments of a recording get the same interpretation, and long segments have more weight.
std::string repair_conventions(std::span<Observation> segments);

// Convention of roll, pitch and yaw in a recording.
struct AngleConvention {
  std::string sequence;   // of angle_sequences
  double factor = 1.0;    // from the radians of the header to true radians
  std::string text = {};  // a sentence; empty for the usual convention
};

// The sequence and unit of roll, pitch and yaw with which the rates integrate to the angles, if the
// recording states no sequence. nullopt if there are no such angles or no rates. The usual sequence
// if it agrees, if none agrees, or if permuted or reversed gyro axes agree better.
std::optional<AngleConvention> convention_of_angles(const Recording& recording,
                                                    const Platform& platform,
                                                    const std::string& name);

// The recording with its angles converted from the convention `angles`.
Recording read_as(const AngleConvention& angles, Recording recording);

// Repairs the rates of a body on which little more than its inertia acts. Its rates must change
// according to Euler's equations. An odd number of reversed axes, two exchanged axes or another
// unit violate them. The data do not show which axes are reversed, so the interpretation with the
// fewest changes is used. Nothing is changed if attitudes were read, or if the moments are too
// similar.
//
// If the stated inertia explains little, for example because it is a guess, the rates must be
// consistent with some inertia, with measured wheels included (free_inertia.h). An interpretation
// of axes and units is used if its residual is below a third of that of the header. Among
// equivalent ones the nearest to the stated moments is used. A wheel whose moment of inertia is
// negative by five standard errors has the wrong sign; its speed is reversed.
std::string repair_free_rates(std::span<Observation> segments, const Mat3& inertia_kg_m2);

}  // namespace photorque

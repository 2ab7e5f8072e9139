// Frame and convention checks before any physics: the rates must integrate to the attitude.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "attitude/observation/observation.h"

namespace photorque {

// When gyro and attitude contradict each other as read, and one other reading of the same numbers
// (quaternion conjugated, scalar last, axes permuted or reversed, degrees per second under a header
// that says radians or the reverse) makes them agree, the observations are changed to that reading.
// Returns a sentence about it; empty: nothing was changed. Without a gyro nothing can be checked.
// The segments of one recording are read in one way: long ones decide for short ones.
std::string repair_conventions(std::span<Observation> segments);

// Convention of roll, pitch and yaw in a recording.
struct AngleConvention {
  std::string sequence;   // of angle_sequences
  double factor = 1.0;    // to radians, of the header's radians
  std::string text = {};  // a sentence; empty where they are as usual
};

// The sequence, and the unit, with which the rates integrate to the angles, where the recording
// states no sequence. Nothing where there are no such angles or no rates; the usual one where it
// agrees, where none does, or where gyro axes that are permuted or reversed explain it better.
std::optional<AngleConvention> convention_of_angles(const Recording& recording,
                                                    const Platform& platform,
                                                    const std::string& name);

// Repairs the rates of a body on which little more than its own inertia acts: they must change as
// Euler's equations say, which an odd number of reversed axes, two axes exchanged or another unit
// spoil. Such a body does not show which axes are reversed: the one with the fewest changes is
// taken. Nothing is done where an attitude is read, or where the moments are so alike that nothing
// follows from them.
//
// Where the stated inertia explains little, as it does when it is only a guess, the rates have to
// change as some inertia says, measured wheels included (free_inertia.h): a reading of the axes and
// units that leaves a third of what the header's reading leaves is taken, the one nearest to the
// stated moments. A wheel whose own moment of inertia comes out negative by five standard errors
// was read with the wrong sign; its speed is turned.
std::string repair_free_rates(std::span<Observation> segments, const Mat3& inertia_kg_m2);

}  // namespace photorque

// Motion and light recorded together: one answer of two.
//
// The domains share the tilt of the body against its recorded attitude. A camera that is not level
// makes a pendulum swing about another attitude than the upright one, as a draught does. It also
// changes the light on the array, as dirt does. So
//   the motion is explained first, and gives the attitude without the camera's noise,
//   which would be noise of the light;
//   light is explained with any tilt; where it determines the tilt,
//   the motion is explained with that as a prior; and where the motion determines it better,
//   light is explained again, with the result of the motion alone as a prior.
// Light acts on the motion by the lamps' current in the recording (disturbance lamp_pressure).
#pragma once

#include <optional>

#include "diagnosis/attitude/diagnose.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/light/diagnose.h"

namespace photorque {

// The rotation vector about lab x and y from the recorded to the true attitude of the body.
struct Tilt {
  Vec2 bias_rad, sigma_rad;
};

struct MotionRecorded {
  NominalModel nominal;
  std::vector<NamedRecording> recordings, holdouts;
  DiagnoseOptions how;
};

struct LightRecorded {
  const LightLab& lab;
  LightBelief nominal;
  std::vector<LightRecording> recordings, holdouts;
  LightDiagnoseOptions how;
};

// A tilt that light and motion together leave beyond doubt is an effect, on either.
Diagnosis diagnose_together(MotionRecorded motion, LightRecorded light);

// Gives the rows of each run the attitudes that the motion was found to have where it has the same
// name and is explained; others keep their recorded values.
void take_attitudes(const Diagnosis& motion, std::vector<LightRecording>& runs);

// Both in one, the motion first. `tilt`: what both say of it, if anything.
Diagnosis joined(const Diagnosis& motion, const Diagnosis& light, const std::optional<Tilt>& tilt);

}  // namespace photorque

// Joint diagnosis of motion and light that are recorded together.
//
// Both domains depend on the tilt of the body relative to its recorded attitude. If the camera is
// not level, a pendulum swings about another attitude than the upright one, as in a draught. The
// tilt also changes the light on the array, as dirt does. The steps are:
//   1. explain the motion; its attitude has no camera noise, which would affect the light;
//   2. explain the light with any tilt;
//   3. if the light determines the tilt, explain the motion with that as a prior;
//   4. if the motion determines it better, explain the light again with the result of the motion
//      alone as a prior.
// Light acts on the motion by the recorded lamp current (disturbance lamp_pressure).
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
  NominalLight nominal;
  std::vector<LightRecording> recordings, holdouts;
  LightDiagnoseOptions how;
};

// A tilt that is significant in light and motion together is reported as an effect on both.
Diagnosis diagnose_together(MotionRecorded motion, LightRecorded light);

// Replaces the attitudes of each run by those of the motion recording of equal name if the motion
// is explained; others keep their recorded values.
void take_attitudes(const Diagnosis& motion, std::vector<LightRecording>& runs);

// Combines both, motion first. `tilt`: the joint estimate, if any.
Diagnosis joined(const Diagnosis& motion, const Diagnosis& light, const std::optional<Tilt>& tilt);

}  // namespace photorque

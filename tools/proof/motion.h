// The moving platform of `prove`: what really happens in an injected case.
//
// A second implementation of the catalogue, so that `diagnose` is not tried on its own equations.
// Each kind's file holds its law twice (attitude/injection), the second time in plain arithmetic;
// every case is integrated by the classical Runge–Kutta method with fixed steps, and nothing is
// differentiated. Shared are the formulas themselves (the catalogue and its conventions), physical
// constants, and the hash that makes random numbers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "attitude/injection/injection.h"

namespace photorque {

// What holds from its time to the next.
struct InjectedCommand {
  double time_s = 0.0;
  Triple torque_N_m = {};
  double battery_current_A = 0.0;
};

struct InjectedStart {
  std::array<double, 4> attitude = {1, 0, 0, 0};  // w, x, y, z: lab from body
  Triple rate_rad_s = {};                         // body axes
};

// Everything that acts.
struct InjectedWorld {
  double mass_kg = 1.0;
  std::array<Triple, 3> inertia_kg_m2 = {};
  double gravity_m_s2 = 9.80665;
  Triple magnetic_field_T = {};  // lab: east, north, up
  double latitude_rad = 0.0;
  Triple offset_m = {};     // of the centre of mass
  double drag_N_m_s = 0.0;  // of the bearing
  Triple gyro_bias_rad_s = {};
  std::vector<InjectedEffect> effects;
};

// What noiseless instruments read, and the state behind it.
struct InjectedContext {
  double time_s = 0.0;
  std::array<double, 4> attitude = {1, 0, 0, 0};  // true
  std::array<double, 4> camera = {1, 0, 0, 0};    // misaligned; not delayed
  Triple rate_rad_s = {};
  Triple gyro_rad_s = {};
};

// Kinds that act here: those of the registry whose files say how they are injected, and the laws of
// outside.h.
std::vector<std::string> injected_kinds();
bool is_outside_catalogue(const std::string& kind);
// Multiplies what makes the effect strong (Injection::strength), not times or frequencies.
void scale_effect(InjectedEffect& effect, double by);
double injected_latency_s(const InjectedWorld& world);
// With what the effects add, about the body axes.
std::array<Triple, 3> injected_inertia_kg_m2(const InjectedWorld& world);

// The motion of a case starts before its clock, so that a camera may lag; where an appendage
// swings, with the clock, at which a model takes it to be at rest.
double injected_start_s(const InjectedWorld& world);

// Noiseless readings at `times_s` (rising, not before `from_s`, where the motion starts). Steps of
// at most `step_s` that end at every jump; the error falls with its fourth power: 1e-9 rad for
// 0.01 s and rates below 1 rad/s. With `bend_rad_s` > 0, steps are halved until the torque bends
// them by no more than that: where a law has a kink, dry friction at rest. NumericalError for an
// unknown kind and when the motion diverges.
std::vector<InjectedContext> injected_motion(const InjectedWorld& world,
                                             const std::vector<InjectedCommand>& commands,
                                             const InjectedStart& start, double from_s,
                                             const std::vector<double>& times_s, double step_s,
                                             double bend_rad_s = 0.0);

}  // namespace photorque

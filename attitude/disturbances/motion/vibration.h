// Floor vibration from its spectrum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

// One sinusoid of the floor's acceleration: a sin(2π f t + φ), each axis with its own phase.
struct VibrationTone {
  double frequency_Hz = 0.0;
  Vec3 amplitude_lab_m_s2 = Vec3::Zero();
  Vec3 phase_rad = Vec3::Zero();
};

// One-sided power spectral density of the acceleration at a frequency, along lab x, y and z, in
// (m/s²)²/Hz.
struct SpectrumPoint {
  double frequency_Hz = 0.0;
  Vec3 density_m2_s3 = Vec3::Zero();
};

// A sum of `tones` sinusoids with the given spectrum, between its first and last frequency: bands
// of equal width on a logarithmic scale, one tone at a random place in each with the band's whole
// power, phases random. The density is linear between its points. The same seed gives the same
// floor. Needs two points, frequencies positive and rising, densities ≥ 0 (NumericalError
// otherwise). The signal repeats only after times far beyond 1/f.
std::vector<VibrationTone> tones_of_spectrum(std::span<const SpectrumPoint> spectrum, int tones,
                                             uint64_t seed);

// A sinusoid of time with parameters, shared by the periodic disturbances.

// Standard deviation of an unknown phase: π/√3.
constexpr double phase_scale = 1.8;

// sin(2π f t + φ).
template <class T>
T sinusoid(const T& time_s, const T& frequency_Hz, const T& phase_rad) {
  return sin(2.0 * pi * frequency_Hz * time_s + phase_rad);
}

// `phase` in radians, or phase_deg; 0 when neither is given.
inline PlacedParameters phase_parameter(const Settings& settings, ScalarKey phase) {
  return settings.has(phase.name)
             ? scalar_parameter(settings, phase)
             : scalar_parameter_or(settings, ScalarKey("phase_rad", phase.first), 0.0);
}

}  // namespace photorque

// Floor vibration from its spectrum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/constants.h"
#include "core/transform.h"

namespace photorque {

// One sinusoid of the floor's acceleration, a sin(2π f t + φ), equal along lab x, y and z but for a
// separate phase of each.
struct VibrationTone {
  double frequency_Hz = 0.0, amplitude_m_s2 = 0.0;
  Vec3 phase_rad = Vec3::Zero();
};

// One-sided power spectral density of the acceleration at a frequency, in (m/s²)²/Hz.
struct SpectrumPoint {
  double frequency_Hz = 0.0, density_m2_s3 = 0.0;
};

// A sum of `tones` sinusoids with the given spectrum, between its first and last frequency: at
// least two points with positive, increasing frequencies and densities ≥ 0. Each band of equal
// width on a logarithmic scale has one tone at a random frequency, with the power of the band and
// random phases. The density is linear between its points. Equal seeds give equal signals. The
// signal repeats only after times far beyond 1/f.
std::vector<VibrationTone> tones_of_spectrum(std::span<const SpectrumPoint> spectrum, int tones,
                                             uint64_t seed);

// Prior standard deviation of an unknown phase: π/√3.
constexpr double phase_scale = 1.8;

// Sinusoid of time, sin(2π f t + φ).
template <class T>
T sinusoid(const T& time_s, const T& frequency_Hz, const T& phase_rad) {
  return sin(2.0 * pi * frequency_Hz * time_s + phase_rad);
}

// The parameter `phase` [rad], or phase_deg; 0 if neither is given.
inline PlacedParameters phase_parameter(const Settings& settings, ScalarKey phase) {
  return parameters_of(settings, settings.has(phase.name)
                                     ? phase
                                     : ScalarKey("phase_rad", 0.0, {}, "", phase.first));
}

}  // namespace photorque

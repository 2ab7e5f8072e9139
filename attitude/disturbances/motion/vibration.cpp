#include "attitude/disturbances/motion/vibration.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/numerics/random.h"

namespace photorque {

namespace {

// Integral of the piecewise linear density from the first point to the frequency.
double power_below(std::span<const SpectrumPoint> spectrum, double frequency_Hz) {
  double sum = 0.0;
  for (size_t i = 0; i + 1 < spectrum.size(); ++i) {
    const SpectrumPoint &a = spectrum[i], &b = spectrum[i + 1];
    if (frequency_Hz <= a.frequency_Hz) break;
    const double end_Hz = std::min(frequency_Hz, b.frequency_Hz);
    const double fraction = (end_Hz - a.frequency_Hz) / (b.frequency_Hz - a.frequency_Hz);
    const double density_at_end = (1.0 - fraction) * a.density_m2_s3 + fraction * b.density_m2_s3;
    sum += 0.5 * (end_Hz - a.frequency_Hz) * (a.density_m2_s3 + density_at_end);
  }
  return sum;
}

}  // namespace

std::vector<VibrationTone> tones_of_spectrum(std::span<const SpectrumPoint> spectrum, int tones,
                                             uint64_t seed) {
  const double low_Hz = spectrum.front().frequency_Hz;
  const double ratio = std::pow(spectrum.back().frequency_Hz / low_Hz, 1.0 / tones);
  std::vector<VibrationTone> all;
  for (int i = 0; i < tones; ++i) {
    const double from_Hz = low_Hz * std::pow(ratio, i), to_Hz = low_Hz * std::pow(ratio, i + 1);
    const double power_m2_s4 = power_below(spectrum, to_Hz) - power_below(spectrum, from_Hz);
    const auto random = [&](uint64_t dimension) {
      return unit_interval(hash_words(seed, static_cast<uint64_t>(i), dimension));
    };
    VibrationTone tone;
    tone.frequency_Hz = from_Hz * std::pow(ratio, random(0));
    tone.amplitude_m_s2 = std::sqrt(std::max(0.0, 2.0 * power_m2_s4));
    tone.phase_rad = 2.0 * pi * Vec3(random(1), random(2), random(3));
    all.push_back(tone);
  }
  return all;
}

}  // namespace photorque

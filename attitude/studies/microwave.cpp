#include "attitude/studies/microwave.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace photorque {

double MicrowaveBeam::wavelength_m() const {
  return speed_of_light_m_s / frequency_Hz;
}

double aperture_transmission(const MicrowaveBeam& beam, double tilt_rad) {
  const double reach_m2 = beam.wavelength_m() * beam.distance_m;
  const double tau2 = beam.transmitter_area_m2 * beam.rectenna_area_m2 *
                      std::max(0.0, std::cos(tilt_rad)) / (reach_m2 * reach_m2);
  return -std::expm1(-tau2);
}

// With its image, the element has the factor sin(π/2 cos θ) in both planes. In the plane along the
// dipole, the pattern of the dipole is another factor.
double dipole_pattern_h(double tilt_rad) {
  const double pair = std::sin(0.5 * pi * std::cos(tilt_rad));
  return std::cos(tilt_rad) > 0.0 ? pair * pair : 0.0;
}

double dipole_pattern_e(double tilt_rad) {
  if (!(std::cos(tilt_rad) > 1e-9)) return 0.0;
  const double own = std::cos(0.5 * pi * std::sin(tilt_rad)) / std::cos(tilt_rad);
  return own * own * dipole_pattern_h(tilt_rad);
}

double element_capture(double pattern, double tilt_rad) {
  const double cosine = std::cos(tilt_rad);
  return cosine > 0.0 ? std::min(1.0, pattern / cosine) : 0.0;
}

// Absorbed power transfers its momentum; reflected power transfers twice the component along the
// normal. Only a force perpendicular to the arm has a torque: P/c sin θ for absorbed power, zero
// for reflected power.
BeamPressure beam_pressure(double taken_W, double mirrored_W, double tilt_rad, double height_m) {
  const double cosine = std::cos(tilt_rad);
  BeamPressure pressure;
  pressure.force_N = (taken_W + 2.0 * mirrored_W * cosine * cosine) / speed_of_light_m_s;
  pressure.torque_N_m = height_m * std::sin(tilt_rad) * taken_W / speed_of_light_m_s;
  return pressure;
}

}  // namespace photorque

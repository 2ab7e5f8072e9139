// Power by a microwave beam: arriving power, power of a tilted rectenna, and pressure.
#pragma once

namespace photorque {

struct MicrowaveBeam {
  double frequency_Hz = 2.45e9;
  double transmitter_area_m2 = 0.1;
  double rectenna_area_m2 = 0.1;
  double distance_m = 1.0;
  double wavelength_m() const;
};

// The largest fraction of a beam that passes from one aperture to another, 1 − exp(−τ²) with τ² =
// A_t A_r/(λ d)², for the best tapered illumination. A_r is the projected area. Source: W. C.
// Brown, IEEE Trans. Microwave Theory Tech. 32 (1984) 1230, after G. Goubau and F. Schwering, IRE
// Trans. Antennas Propag. 9 (1961) 248. At large distances τ² is Friis's formula.
double aperture_transmission(const MicrowaveBeam& beam, double tilt_rad);

// The pattern of one rectifying element relative to normal incidence. The element is a half-wave
// dipole a quarter of a wavelength above a reflector, tilted in the plane across (H) or along (E)
// the dipole. Each element of a rectenna has a separate rectifier, so this is the pattern of the
// whole. Source: C. A. Balanis, Antenna Theory, 4th ed. (2016), eq. 4-84 and sec. 4.8.
double dipole_pattern_h(double tilt_rad);
double dipole_pattern_e(double tilt_rad);

// Fraction of the power incident on the rectenna's outline that its elements absorb: the pattern
// divided by the cosine of the projection, at most 1.
double element_capture(double pattern, double tilt_rad);

// Radiation pressure on a plane that absorbs `taken_W` of a beam and reflects `mirrored_W` like a
// mirror: the force along the beam, and the torque about a centre that is `height_m` below the
// plane along its normal.
struct BeamPressure {
  double force_N = 0.0;     // along the beam
  double torque_N_m = 0.0;  // positive: increases the tilt
};
BeamPressure beam_pressure(double taken_W, double mirrored_W, double tilt_rad, double height_m);

}  // namespace photorque

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

// The largest fraction of a beam that passes from one aperture to another, 1 − exp(−τ²) with
// τ² = A_t A_r/(λ d)², for the tapered illumination that focuses best; A_r is the area as it is
// seen. Source: W. C. Brown, IEEE Trans. Microwave Theory Tech. 32 (1984) 1230, after G. Goubau and
// F. Schwering, IRE Trans. Antennas Propag. 9 (1961) 248. Far away τ² is Friis's formula.
double aperture_transmission(const MicrowaveBeam& beam, double tilt_rad);

// The pattern of one rectifying element, a half-wave dipole a quarter of a wavelength over a
// reflector, relative to straight on, tilted by an angle in the plane across (H) or along (E) the
// dipole. Each element of a rectenna has its own rectifier, so that this is the pattern of the
// whole. Source: C. A. Balanis, Antenna Theory, 4th ed. (2016), eq. 4-84 and sec. 4.8.
double dipole_pattern_h(double tilt_rad);
double dipole_pattern_e(double tilt_rad);

// The fraction of what the rectenna's outline is hit by that its elements take: the pattern over
// the cosine by which the outline shrinks, at most 1.
double element_capture(double pattern, double tilt_rad);

// Radiation pressure on a plane that absorbs `taken_W` of a beam and mirrors `mirrored_W`: the
// force along the beam and the torque on a body whose centre is `height_m` below the plane's, along
// its normal.
struct BeamPressure {
  double force_N = 0.0;     // along the beam
  double torque_N_m = 0.0;  // positive: tilts further
};
BeamPressure beam_pressure(double taken_W, double mirrored_W, double tilt_rad, double height_m);

}  // namespace photorque

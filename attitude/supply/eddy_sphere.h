// A conducting, non-magnetic sphere in an alternating field: the ball of an air bearing between
// coils.
#pragma once

#include <complex>

namespace photorque {

// The magnetic moment is α V B/μ₀ with this α; −3/2 for a perfect conductor, 0 for none. Time as
// exp(−iωt), so that the imaginary part is that of what is lost.
// Source: L. D. Landau, E. M. Lifshitz, Electrodynamics of Continuous Media, § 59, in SI.
std::complex<double> sphere_polarisability(double radius_m, double conductivity_S_m,
                                           double angular_frequency_rad_s);

// Power turned to heat by an even field of amplitude `field_T` [W].
double sphere_eddy_loss_W(double radius_m, double conductivity_S_m, double angular_frequency_rad_s,
                          double field_T);

}  // namespace photorque

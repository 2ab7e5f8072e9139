// The air film between ball and socket in closed form: load and drag.
//
// The ball is a sphere of radius R in a concentric socket from the bottom to the polar angle θ_S.
// There may be a recess around the bottom, up to θ_r, with full inlet pressure and without shear.
// The film is thin (h ≪ R), laminar and isothermal. Source: eq. 4–17 of the paper; docs/physics.md
// lists the corrections to the printed equations.
#pragma once

namespace photorque {

struct SphericalSocket {
  double radius_m = 0.0;               // R > 0
  double half_angle_rad = 0.0;         // θ_S, in (0, π/2] for loads, up to π for drag
  double gap_m = 0.0;                  // h > 0, uniform
  double recess_half_angle_rad = 0.0;  // θ_r, in [0, θ_S)
  // Fraction of the film's area that is thin; grooves, without shear, have the rest.
  double sheared_fraction = 1.0;
};

// Load capacity [N]: the gauge pressure projected on the vertical (eq. 4). The pressure decreases
// linearly in θ from `inlet_Pa` at the rim of the recess to `ambient_Pa` at that of the socket (eq.
// 6). Pressures are absolute. For a bearing with the supply pressure p_t, the inlet pressure is k_p
// p_t with k_p between 0.8 and 0.9.
double load_capacity_N(const SphericalSocket& socket, double inlet_Pa, double ambient_Pa);

// Eq. 7 as printed: without projection, gauge pressure and recess. It is 2.0 to 2.7 times
// load_capacity_N() for half angles of 90 to 30 deg at 5 bar. Only for comparison with the paper.
double load_capacity_as_published_N(const SphericalSocket& socket, double inlet_Pa,
                                    double ambient_Pa);

// The drag torque about the centre is −D ω with D = axial s sᵀ + transverse (1 − s sᵀ), where s is
// the axis of the socket. Both are > 0.
struct FilmDrag {
  double axial_N_m_s = 0.0;
  double transverse_N_m_s = 0.0;
};

// Drag of Couette flow across the film (eq. 14–17): D = μ R⁴/h ∫ (1 − n nᵀ) dΩ over the film. Its
// axial part is the closed form of eq. 17; the transverse part is the corresponding integral for a
// tilting ball. Relative error 2 h/R, due to the curvature.
FilmDrag film_drag(const SphericalSocket& socket, double viscosity_Pa_s);

// The paper's gap as a function of the load [m], at least 0: a linear spring of the catalogue's
// stiffness about the rated point. Real films are much softer at small loads, see
// gap_under_load_m().
double spring_gap_m(double rated_gap_m, double rated_load_N, double stiffness_N_m, double load_N);

// Thickness of the air film from the balance of supply, restrictor and compressible film.
//
// The closed forms above need a gap. A catalogue states it for one load. At another load the film
// has the gap at which the flow through the restrictor equals the flow out of the film. The model
// is isothermal and laminar, with a uniform gap.
//
// Source: Reynolds' equation for p² (Hamrock, Schmid, Jacobson, Fundamentals of Fluid Film
// Lubrication, 2nd ed., ch. 7 and 16), nozzle flow (White, Fluid Mechanics, 7th ed.,
// eq. 9.44–9.46).

// Air at the outlet of the bearing.
struct FilmAir {
  double pressure_Pa = 101325.0;
  double temperature_K = 293.15;
  double viscosity_Pa_s = 1.813e-5;
};

// The load that a film carries, with its flow and inlet pressure.
struct FilmState {
  double load_N = 0.0;
  double flow_kg_s = 0.0;
  double inlet_Pa = 0.0;  // absolute, downstream of the restrictor
};

// A socket fed through small holes into its recess (θ_r > 0).
struct OrificeFeed {
  double supply_Pa = 0.0;              // absolute, above ambient
  double hole_area_m2 = 0.0;           // of all holes
  double discharge_coefficient = 0.8;  // of sharp-edged holes
};

// The film at the socket's gap. NumericalError unless θ_r > 0 and the supply exceeds the ambient
// pressure. Accuracy of the balance 1e-10.
FilmState orifice_fed_film(const SphericalSocket& socket, const OrificeFeed& feed,
                           const FilmAir& air);

// The gap at which the film carries `load_N` [m]; socket.gap_m is not used. NumericalError for a
// load at or above the capacity of the full supply pressure, or too small for any gap up to a
// hundredth of the radius.
double gap_under_load_m(const SphericalSocket& socket, const OrificeFeed& feed, const FilmAir& air,
                        double load_N);

}  // namespace photorque

// How thick the air film is: supply, restrictor and compressible film in balance.
//
// The closed forms of air_bearing.h need a gap. A catalogue quotes it at one load; at another load
// the film settles where the flow that the restrictor lets through equals the flow that the film
// lets out. The model is isothermal, laminar, and of uniform gap.
//
// Source: Reynolds' equation for p² (Hamrock, Schmid, Jacobson, Fundamentals of Fluid Film
// Lubrication, 2nd ed., ch. 7 and 16), nozzle flow (White, Fluid Mechanics, 7th ed.,
// eq. 9.44–9.46).
#pragma once

#include "attitude/disturbances/bearing/air_bearing.h"

namespace photorque {

// Air where it leaves the bearing.
struct FilmAir {
  double pressure_Pa = 101325.0;
  double temperature_K = 293.15;
  double viscosity_Pa_s = 1.813e-5;
};

// A load and what it takes.
struct FilmState {
  double load_N = 0.0;
  double flow_kg_s = 0.0;
  double inlet_Pa = 0.0;  // absolute, behind the restrictor
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

// The gap at which the film carries `load_N` [m]; the socket's own gap is not used. NumericalError
// for a load at or above what the full supply pressure can carry, or too small for any gap up to
// a hundredth of the radius.
double gap_under_load_m(const SphericalSocket& socket, const OrificeFeed& feed, const FilmAir& air,
                        double load_N);

}  // namespace photorque

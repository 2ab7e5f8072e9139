// The torque of still air on a platform that rotates steadily about its vertical axis.
//
// The platform is divided into plates, discs, spheres and cylinders without interference, as in the
// paper (section II.B.2). Laminar friction is proportional to ω^1.5, form drag to ω². The
// disturbances air_friction and air_pressure_drag use the coefficients of both powers. The CFD of
// the paper gives about ten times this torque, from air that stagnates on stiffeners. Such faces
// can be added as separate parts (blunt_face).
#pragma once

#include <string>
#include <vector>

#include "attitude/model/disturbance.h"
#include "core/product.h"
#include "core/settings/typed_keys.h"

namespace photorque {

enum class AirShape {
  disc,              // thin disc spinning in its plane about its centre
  plate,             // flat plate moved edgewise, its centre at a distance (eq. 20)
  swept_plate,       // flat strip from an inner to an outer radius, local speed (eq. 19 integrated)
  sphere,            // ball spinning about its diameter (eq. 21)
  radial_cylinder,   // cylinder whose axis points away from the axis of rotation (eq. 22)
  upright_cylinder,  // cylinder parallel to the axis of rotation, at a distance
  blunt_face,        // flat face normal to the flow: a stiffener, a box
};

// One or several equal parts.
struct AirPart {
  std::string name = {};
  AirShape shape = AirShape::disc;
  double count = 1.0;                // may be fractional: the fraction of a sphere that is exposed
  int faces = 2;                     // wetted faces of discs and plates, 1 or 2
  double radius_m = 0.0;             // disc, sphere, cylinder
  double length_m = 0.0;             // plates: along the flow; cylinders: along their axis
  double area_m2 = 0.0;              // plate, blunt_face
  double distance_m = 0.0;           // of the centre (plate, upright_cylinder, blunt_face)
  double inner_m = 0.0;              // swept_plate, radial_cylinder: nearest to the axis
  double outer_m = 0.0;              // swept_plate
  double drag_coefficient = 1.0;     // cylinders and faces, on their frontal area
  double moment_coefficient = 2.93;  // sphere: torque / √(μρ) R⁴ ω^1.5
};

struct Air {
  double density_kg_m3 = 1.2041;
  double viscosity_Pa_s = 1.813e-5;

  double kinematic_viscosity_m2_s() const { return viscosity_Pa_s / density_kg_m3; }
};

// Howarth's coefficient as the paper prints it (eq. 21).
inline constexpr double sphere_moment_howarth = 2.93;

// Torque = friction · ω^1.5 + form · ω².
struct AirCoefficients {
  double friction_N_m_s1_5 = 0.0;
  double form_N_m_s2 = 0.0;

  AirCoefficients& operator+=(const AirCoefficients& other);
  double torque_N_m(double rate_rad_s) const;  // magnitude, for a rate ≥ 0
};

AirCoefficients air_coefficients(const AirPart& part, const Air& air);
AirCoefficients air_coefficients(const std::vector<AirPart>& parts, const Air& air);

// Eq. 18 as printed, with μ as the dynamic viscosity, for comparison only. Its unit is not that of
// a torque.
double disc_torque_as_published(const AirPart& disc, const Air& air, double rate_rad_s);

// Whether the laws' assumptions hold at a rate.
struct AirFlow {
  double reynolds = 0.0;             // with the length in the law
  double transition_reynolds = 0.0;  // above: turbulent, the law underestimates
  double smallest_reynolds = 0.0;    // below: no thin boundary layer or no separated wake
  bool laminar_law_holds() const {
    return reynolds >= smallest_reynolds && reynolds <= transition_reynolds;
  }
};
AirFlow air_flow(const AirPart& part, const Air& air, double rate_rad_s);

// Reads the parts of an experiment, whose keys are air_parts_key().
std::vector<AirPart> read_air_parts(const std::vector<Settings>& parts);

// One row per part: torque, fraction, Reynolds number, transition, and whether the law holds.
Table air_table(const std::vector<AirPart>& parts, const Air& air, double rate_rad_s);

// The key [[disturbance.part]].
Key air_parts_key();

// The coefficient of a disturbance: the stated one or, with parts, the member `of` of their sum in
// the air of the environment.
PlacedParameters coefficient_of_air(const Settings& settings, const Environment& environment,
                                    const ScalarKey& key, double AirCoefficients::*of);

}  // namespace photorque

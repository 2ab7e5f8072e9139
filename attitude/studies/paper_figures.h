// All figures of the source paper about attitude, recomputed.
//
// PaperInputs contains the inputs that the paper omits, each value with its origin; none is fitted
// to the figures. paper_sensitivities() returns the change of each figure with each input, and the
// value that would give the published figure.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "attitude/disturbances/air/external_air.h"
#include "attitude/disturbances/bearing/air_bearing.h"
#include "core/product.h"
#include "core/transform.h"

namespace photorque {

// Results of ray tracing (commands power and torque-map), given by the user. NaN: not given.
struct PaperLight {
  double source_to_cell = std::numeric_limits<double>::quiet_NaN();  // fraction, at zero tilt
  double conversion = std::numeric_limits<double>::quiet_NaN();      // fraction, at zero tilt
  double power_W = std::numeric_limits<double>::quiet_NaN();         // of the array at zero tilt
  double power_at_30_deg_W =
      std::numeric_limits<double>::quiet_NaN();  // sum of the cells' maximum powers
  // Torque on the array about the centre of rotation, at a tilt of 30 deg about y.
  Vec3 torque_at_30_deg_N_m = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
};

// Inputs that the paper omits. Dimensions are those of scenes/stasis/parameters.toml.
struct PaperInputs {
  // Typical parts of a screw with a stepper motor: 200 steps per turn, 2 mm lead, the mass of a
  // motor.
  double step_angle_rad = 0.031415926535897931;  // 1.8 deg
  double screw_lead_m = 2e-3;
  double moving_mass_kg = 0.25;
  // Square plates, approximated by discs of equal area: the top plate of 0.40 m with the array on
  // it, and the bottom plate of 0.34 m.
  double platform_scale = 1.0;  // factor of all following lengths in the air
  double top_plate_side_m = 0.40;
  double bottom_plate_side_m = 0.34;
  // The four vertical rails, as upright cylinders of 12 mm diameter.
  double rail_radius_m = 0.006;
  double rail_length_m = 0.088;
  double rail_distance_m = 0.212;
  double cylinder_drag_coefficient = 1.2;  // Re 1e2 to 1e5; 2 at the Re of about 20 of 1 rpm
  // Blunt faces in the air, as in the scene: c_d 1.05 for boxes, 2 for ribs.
  double box_drag_coefficient = 1.05;
  double rib_drag_coefficient = 2.0;
  // Height of the array above the centre of rotation, and the light on its cells at zero tilt.
  double array_height_m = 0.0238;
  double light_on_cells_W = 79.0;  // 30 W at 38 %
  // A typical bearing of the catalogue: 2.5 inches, 45 deg, 5 µm at its rated load, supply at 80
  // psi, k_p 0.85. The recess is a guess. The unloaded ball is solid aluminium.
  double ball_radius_m = 0.03175;
  double socket_half_angle_rad = 0.78539816339744831;
  double recess_half_angle_rad = 0.10;
  double rated_gap_m = 5e-6;
  double supply_gauge_Pa = 5.5e5;
  double inlet_fraction = 0.85;
  double ball_mass_kg = 0.36;
  PaperLight light = {};
};

struct PaperFigure {
  std::string quantity;  // ends in its unit
  std::string section;   // of the paper
  double published = 0.0;
  double ours = 0.0;          // NaN: needs data of the user
  double as_published = 0.0;  // by the equation as printed, with these inputs; NaN: none
  std::string why;            // the reason for the difference or agreement
};
std::vector<PaperFigure> paper_figures(const PaperInputs& inputs = {});

// Sensitivity of a figure to an assumed input: locally, figure ∝ input^exponent.
struct PaperSensitivity {
  std::string quantity;
  std::string input;
  double value = 0.0;
  double exponent = 0.0;
  double value_for_published = 0.0;  // by this power law; NaN for small exponents
};
std::vector<PaperSensitivity> paper_sensitivities(const PaperInputs& inputs = {});

// The bearing of PaperInputs: the ratio of the gap of an unloaded ball to the rated gap. By this
// ratio the drag in a catalogue, measured without load, is smaller than eq. 17 at the rated gap.
struct UnloadedDrag {
  double rated_load_N = 0.0;         // of the film at the rated gap
  double load_as_published_N = 0.0;  // eq. 7
  double ratio_spring = 0.0;         // the gap of a spring with the film's stiffness at rated load
  double ratio_film = 0.0;           // the gap at which supply and film balance
};
UnloadedDrag unloaded_drag(const PaperInputs& inputs = {});

// A bearing of a catalogue, for the comparison of figure 7.
struct BearingDatasheet {
  std::string name;
  SphericalSocket socket;
  double inlet_Pa = 0.0;                       // absolute, k_p p_t
  double load_N = 0.0;                         // as printed
  double drag_N_m = 0.0;                       // as printed, at `drag_rate_rad_s`; 0: not printed
  double drag_rate_rad_s = 3.141592653589793;  // 30 rpm
};
// The paper's two measures of a catalogue: the mean relative error of the load (eq. 7 as printed,
// and corrected), and the mean ratio of eq. 17 to the printed drag.
struct BearingComparison {
  double load_error_as_published = 0.0;
  double load_error = 0.0;
  double drag_ratio = 0.0;
};
BearingComparison compare_bearings(std::span<const BearingDatasheet> catalogue,
                                   double ambient_Pa = 101325.0, double viscosity_Pa_s = 1.813e-5);

// Tables "paper_figures", "paper_sensitivities" and "paper_external_air"; plot
// "elastic_torque_by_tilt" (figure 5 of the paper).
Product paper_product(const PaperInputs& inputs = {});

}  // namespace photorque

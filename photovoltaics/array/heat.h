// Temperature of the cells of an array: a plate that absorbs light, delivers electric power, and
// loses heat by convection and radiation.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/settings/settings.h"
#include "photovoltaics/cell/model.h"

namespace photorque {

// Surroundings of the array, unless `[array.thermal]` states others.
struct Surroundings {
  double air_K = 293.15;
  double air_pressure_Pa = 101325.0;
  bool is_vacuum = false;
};

// One temperature T for all cells. Per area of the cells, with n faces:
//   C dT/dt = α E − P/A − n (h (T − T_air) + ε σ (T⁴ − T_s⁴))
// α E is the absorbed light, P the electric power. If h is not stated, it is that of natural
// convection at a vertical plate whose height is the side of a square with the area of all cells
// (S. W. Churchill, H. H. S. Chu, Int. J. Heat Mass Transfer 18 (1975) 1323, eq. 9; 15 % of h over
// all Rayleigh numbers), with the properties of dry air at the mean of T and T_air. Conduction into
// the platform is neglected.
struct CellHeat {
  double air_K = 293.15;  // T_air
  double air_pressure_Pa = 101325.0;
  double surroundings_K = 293.15;                // T_s, to which the faces radiate
  std::optional<double> convection_W_m2_K = {};  // h of each face; none: natural convection
  double emissivity = 0.84;                      // ε of each face
  double absorptance = 0.93;                     // α of the light that falls on the cells
  int faces = 2;                                 // n
  double capacity_J_m2_K = 2000.0;               // C: a cell with 1 mm of glass has about 2 kJ/m²K
  double start_K = 293.15;                       // initial temperature of a run over time

  // "both faces in still air of 293.15 K, emissivity 0.84"
  std::string in_words() const;
};

// The heat balance of a plate of a given area.
class CellPlate {
 public:
  CellPlate(const CellHeat& heat, double area_m2);

  // Heat lost by all faces, per area of the cells; increases with the temperature.
  double loss_W_m2(double temperature_K) const;
  double loss_slope_W_m2_K(double temperature_K) const;
  // The temperature at which the loss is `loss_W_m2`, within [1 K, hottest_cell_K].
  double temperature_at_loss_K(double loss_W_m2) const;

  // The steady-state temperature at a constant irradiance. `electric_W_m2` returns the delivered
  // power per area at a temperature; its slope must not exceed that of the loss. The result is
  // within [coldest_cell_K, hottest_cell_K], with a relative error of 1e-8.
  double steady_K(double light_W_m2, const std::function<double(double)>& electric_W_m2) const;

  // A step of constant heating α E − P/A. The error is of second order in the step and vanishes in
  // the steady state.
  struct Step {
    double end_K = 0.0;
    double given_off_J_m2 = 0.0;
  };
  Step step(double from_K, double heating_W_m2, double step_s) const;

 private:
  double natural_convection_W_m2_K(double temperature_K) const;

  CellHeat heat_;
  double side_m_;
};

// Reads `[array.thermal]` of the table `[array]`. Values that are not stated are those of `around`.
// In a vacuum there is no convection, and the faces radiate to deep space (2.725 K). Throws
// InputError for a plate that cannot lose heat.
CellHeat read_cell_heat(const Settings& array, const Surroundings& around);

}  // namespace photorque

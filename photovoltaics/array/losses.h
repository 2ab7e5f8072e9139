// Power losses between the supply of the lamps and the load, and uniformity of the light.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "photovoltaics/array/array.h"

namespace photorque {

// Results of the trace and efficiencies of the devices around the array.
struct LossInputs {
  double emitted_W = 0.0;                      // light that leaves the lamps' optics
  double on_receiver_W = 0.0;                  // part of it on the whole receiver
  double photon_V = 1.7;                       // mean energy of a photon over the elementary charge
  double quantum_efficiency = 1.0;             // mean external
  bool is_bifacial = false;                    // with light on the back of the cells
  std::optional<double> wall_plug_efficiency;  // lamps: light over electric power
  std::optional<double> collimator_efficiency;
  std::optional<double> tracker_efficiency;
  std::optional<double> converter_efficiency;
};

struct LossStage {
  std::string name;      // name of the power
  double power_W = 0.0;  // remaining power
  std::string loss;      // cause of the difference to the previous stage
};

// Stages from the electric power of the lamps, or from their light if their efficiency is unknown,
// to the load. The power falls from stage to stage, and the ratios multiply to the total
// efficiency.
std::vector<LossStage> loss_waterfall(const ArrayResult& array, const LossInputs& inputs);

// Table "losses", the plot "loss_waterfall" and one quantity per stage.
Product loss_product(const std::vector<LossStage>& stages);

// Uniformity of the irradiance on some cells.
struct Uniformity {
  double mean_W_m2 = 0.0;
  double minimum_over_mean = 0.0;
  double variation = 0.0;  // standard deviation over mean
};
Uniformity uniformity(const ArrayResult& array, std::span<const int> cells);

// Table "uniformity": the whole array, then each string.
Table uniformity_table(const ArrayResult& array, const ArrayWiring& wiring);

// The maximum power of `design` if every cell receives `light_factor` ≥ 0 times its light in
// `array`. The photocurrents of `array` refer to cells at `array_K`.
double array_power_W(const ArrayDesign& design, const ArrayResult& array, double array_K,
                     double light_factor);

// Relative change of the power per change of one input.
struct ArraySensitivity {
  std::string change;     // "temperature + 1 K"
  double power_W = 0.0;   // with the change
  double relative = 0.0;  // relative to the power without the change
};
std::vector<ArraySensitivity> sensitivities(const ArrayDesign& design, const ArrayResult& array);

// Efficiency of a known cell in monochromatic light of an irradiance: EQE V_oc FF over photon_V.
struct CellFigures {
  std::string name;
  double open_circuit_V = 0.0, fill_factor = 0.0;
  double product_V = 0.0;  // EQE V_oc FF
  double efficiency = 0.0;
};
std::vector<CellFigures> known_cell_figures(double irradiance_W_m2, double photon_V,
                                            double quantum_efficiency, double temperature_K);

}  // namespace photorque

// The nominal model of lamps, receiver and array, made ready for the forward model of light.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/light/model/lit_cells.h"
#include "diagnosis/light/model/state.h"
#include "photovoltaics/array/design.h"
#include "raytrace/direct/disc_light.h"
#include "scenes/experiment/experiment.h"

namespace photorque {

class LampTable;  // diagnosis/light/model/lamp_table.h

// Noise of the readings as stated, one standard deviation; 0: not stated.
struct LightNoise {
  double irradiance_W_m2 = 0.0, relative = 0.0;
  double voltage_V = 0.0, current_A = 0.0;
  std::optional<double> tracker_step_V;
};

// A part of the scene other than the receiver: flat triangles that shade, and may reflect.
struct LightWall {
  std::string node;
  std::vector<std::array<Vec3, 3>> triangles;  // body frame
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0.0;  // of the sphere about the centre that holds it
  bool is_sheet = false;  // see is_sheet()
};

// Whether triangles lie side by side in one plane and look the same way, so that no two of them
// hide the same. (More than 64 are not looked at.)
bool is_sheet(const std::vector<std::array<Vec3, 3>>& triangles);

// All lamps with beams of one width.
struct LampSet {
  std::vector<Beam> beams;
  // Of each beam; those of one emitter share one.
  std::vector<std::shared_ptr<const DiscLight>> lights;
  std::vector<std::shared_ptr<const LampTable>> tables;
};

// Active area of a cell on the receiver, with a rule to average over it.
struct LightCell {
  CellRectangle rectangle;
  double area_m2 = 0.0;
  double photocurrent_factor = 1.0;  // of what its light would give a cell like the others
  std::vector<Vec3> points_body_m;
  std::vector<double> weights;  // sum 1
};

class LightLab {
 public:
  // InputError where there is no flat receiver, or a lamp without an aperture. `experiment` must
  // outlive this.
  explicit LightLab(const Experiment& experiment);

  const Experiment& experiment() const { return experiment_; }
  const SurfaceGrid& grid() const { return *grid_; }
  const std::string& receiver() const { return receiver_; }
  const LightNoise& noise() const { return noise_; }
  const std::vector<LightWall>& walls() const { return walls_; }
  size_t lamps() const { return lamps_->beams.size(); }
  bool has_array() const { return design_.has_value(); }
  const ArrayDesign& design() const { return *design_; }
  const std::vector<LightCell>& cells() const { return cells_; }
  size_t strings() const;
  size_t bypasses() const;
  // What each cell is.
  std::vector<const CellModel*> models() const;
  // The cells' diodes at a temperature, with a conductance more across each.
  LitCells lit(double temperature_K, double extra_shunt_S, bool tabulated) const;
  // Photocurrent over light [A/W] at the reference temperature.
  double responsivity_A_W() const { return responsivity_A_W_; }

  // The point of the receiver at map coordinates u, v.
  Vec3 point_body_m(double u_m, double v_m) const;
  Vec3 normal_body() const { return grid_->normal_body; }
  // Over which the light of the sharpest lamp falls off on the receiver: the standard deviation of
  // the Gaussian spot that is as bright and as steep.
  double narrowest_edge_m() const;

  // The lamps with all beams' widths multiplied, > 0.
  std::shared_ptr<const LampSet> lamps_with(double divergence) const;

  // Nothing acts beside the nominal model.
  LightState nominal() const { return {lamps(), cells_.size(), strings(), bypasses()}; }

 private:
  void find_receiver();
  void read_array();
  void read_noise();
  void find_walls();
  void place_cells();
  size_t points_of_rule() const;
  void tabulate(LampSet& set) const;

  const Experiment& experiment_;
  const SurfaceGrid* grid_ = nullptr;
  std::string receiver_;
  double plane_m_ = 0.0;  // of the receiver, along its normal
  LightNoise noise_;
  std::vector<LightWall> walls_;
  std::shared_ptr<const LampSet> lamps_;
  std::optional<ArrayDesign> design_;
  std::vector<LightCell> cells_;
  double responsivity_A_W_ = 0.0;
};

}  // namespace photorque

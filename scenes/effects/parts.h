// The parts of an experiment on which effects on light and power act.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "photovoltaics/array/design.h"
#include "receivers/surface_grid.h"
#include "scenes/effects/state.h"
#include "scenes/experiment/experiment.h"

namespace photorque {

// A part of the scene other than the receiver: flat triangles that shade, and may reflect.
struct LightWall {
  std::string node;
  std::vector<std::array<Vec3, 3>> triangles;  // body frame
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0.0;  // of the sphere about the centre that holds it
  bool is_sheet = false;  // see is_sheet()
};

// Whether triangles lie side by side in one plane and face the same way, so that no two of them
// hide the same. (More than 64 are not examined.)
bool is_sheet(const std::vector<std::array<Vec3, 3>>& triangles);

struct LightParts {
  // The flat receiver on which light is measured; the grid belongs to the experiment.
  const SurfaceGrid* grid = nullptr;
  std::string receiver;
  double plane_m = 0.0;  // of the receiver, along its normal
  std::vector<LightWall> walls;
  size_t lamps = 0;
  std::optional<ArrayDesign> design;  // where there is one table [array]

  size_t cells() const { return design ? static_cast<size_t>(design->cells()) : 0; }
  size_t strings() const { return design ? design->wiring.strings.size() : 0; }
  size_t bypasses() const;
  // No effect acts.
  LightState nominal() const { return {lamps, cells(), strings(), bypasses()}; }
};

// InputError where there is no flat receiver, and for an array that cannot be read.
LightParts light_parts(const Experiment& experiment);

}  // namespace photorque

// Parts of an experiment on which effects on light and power act.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "photovoltaics/array/design.h"
#include "receivers/surface_grid.h"
#include "scenes/effects/kind.h"
#include "scenes/experiment/experiment.h"

namespace photorque {

// A part of the scene other than the receiver: triangles that shade and may reflect.
struct LightWall {
  std::string node;
  std::vector<std::array<Vec3, 3>> triangles;  // body frame
  Vec3 centre_m = Vec3::Zero();
  double radius_m = 0.0;  // radius of a sphere about the centre that contains the part
  bool is_sheet = false;  // see is_sheet()
};

// Whether triangles lie side by side in one plane and face the same way, so that they do not
// overlap in any view. False for more than 64 triangles, which are not examined.
bool is_sheet(const std::vector<std::array<Vec3, 3>>& triangles);

struct LightParts {
  // The flat receiver on which light is measured; the grid belongs to the experiment.
  const SurfaceGrid* grid = nullptr;
  std::string receiver;
  double plane_m = 0.0;  // position of the receiver along its normal
  std::vector<LightWall> walls;
  size_t lamps = 0;
  std::optional<ArrayDesign> design;  // empty if there is no table [array]

  size_t cells() const { return design ? static_cast<size_t>(design->cells()) : 0; }
  size_t strings() const { return design ? design->wiring.strings.size() : 0; }
  size_t bypasses() const;
  // Number of objects or frames of this kind; 1 for none.
  size_t count_of(LightEffectKind::Index index) const;
  // State without effects.
  LightState nominal() const { return {lamps, cells(), strings(), bypasses()}; }
};

// Throws InputError if there is no flat receiver, or if the array is invalid.
LightParts light_parts(const Experiment& experiment);

}  // namespace photorque

#include "receivers/maps/grid_map.h"

#include <cmath>

namespace photorque {
namespace {

std::string plane_label(const Vec3& axis_body, const std::string& otherwise) {
  const char* names[] = {"x [m]", "y [m]", "z [m]"};
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis_body[i] - 1.0) < 1e-9) return names[i];
    if (std::abs(axis_body[i] + 1.0) < 1e-9) return std::string("−") + names[i];
  }
  return otherwise;
}

}  // namespace

Map grid_map(const SurfaceGrid& grid, const std::vector<Estimate>& bins, const std::string& name,
             const std::string& title, const std::string& unit) {
  Map map;
  map.name = name;
  map.title = title;
  map.unit = unit;
  map.width = grid.width;
  map.height = grid.height;
  map.x_low = grid.u_low;
  map.x_high = grid.u_high;
  map.y_low = grid.v_low;
  map.y_high = grid.v_high;
  const bool plane = grid.over == SurfaceGrid::Over::plane;
  map.x_label = plane ? plane_label(grid.u_axis_body, "u [m]") : "texture u";
  map.y_label = plane ? plane_label(grid.v_axis_body, "v [m]") : "texture v";
  for (const Estimate& bin : bins) {
    map.value.push_back(bin.value);
    map.standard_error.push_back(bin.standard_error);
  }
  return map;
}

}  // namespace photorque

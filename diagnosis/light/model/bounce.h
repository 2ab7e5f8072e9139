// Light by way of a wall, once: diffuse light from patch to place, specular light by mirror images.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "diagnosis/light/model/illumination.h"

namespace photorque {

// A small piece of a wall, its normal on the side of the receiver.
struct WallPatch {
  std::array<Vec3, 3> corners_m;
  Vec3 centre_m, normal;
  double area_m2;
};

// What a wall and the places of a recording are to each other, whatever shines.
struct WallExchange {
  std::vector<WallPatch> patches;
  // Of every group of places, by patch: the light on it over that which leaves the patch.
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> shares;
};
WallExchange exchange_with(const LightLab& lab, const LightSites& sites, size_t wall);

// Light of each lamp by way of a wall that throws back all that it gets: diffusely, or like a
// mirror where `diffuse` is null.
std::vector<LampField> wall_fields(const LightLab& lab, const LampSet& lamps,
                                   const LightSites& sites,
                                   const std::vector<LampGeometry>& geometries, size_t wall,
                                   const WallExchange* diffuse);

}  // namespace photorque
